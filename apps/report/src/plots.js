// Which curves a plot shows. A plot: {id, title, about, x, y, series}; x, y: {label, log}; a series: {label, x, y, error,
// fit, key, species, colour, dash}. Fits are drawn dashed and belong to the series before them. `key` is the same for what
// is the same curve of another run, whatever the label says of this one. `species` counts from 0; curves of all bodies have
// none. In a mixture a species has one colour in all plots, that of its card and of its bodies.
import { kAllBodies } from './dom.js';
import { short } from './format.js';

/** Dashes of the curves that share a colour, in their order. */
const kDashes = [undefined, [8, 4], [2, 3], [9, 3, 2, 3], [14, 4], [4, 4], [14, 3, 2, 3], [2, 6]];

/** Column of a file of observables/, with its error and unit; null: there is none. */
function curve(run, file, column) {
  const table = run.curves[file];
  if (!table) return null;
  const at = table.columns.findIndex((c) => c.name === column);
  if (at < 0) return null;
  const error = table.columns.findIndex((c) => c.name === `${column}_error`);
  return { x: table.data[0], y: table.data[at], error: error < 0 ? null : table.data[error], unit: table.columns[at].unit };
}

function series(run, file, column, label) {
  const found = curve(run, file, column);
  return found ? [{ label, ...found }] : [];
}

/** Whether a curve about orientation may be shown: not of spheres. `species`: as in a series. */
function oriented(run, species) {
  return species === undefined ? run.oriented !== false : run.species[species]?.oriented !== false;
}

/** Returns the columns of a file that begin with a line's column, of all bodies first, then of species or body axes. */
function family(run, file, line) {
  const table = run.curves[file];
  if (!table) return [];
  const pattern = new RegExp(`^${line.column}((?:_[0-9]+){0,2}(?:_[xyz])?)$`);
  return table.columns.flatMap((c) => {
    const match = pattern.exec(c.name);
    if (!match) return [];
    const numbers = match[1].match(/[0-9]+/g)?.map((n) => Number(n) - 1) ?? [];
    if (line.of_orientation && !(numbers.length ? numbers : [undefined]).every((species) => oriented(run, species))) return [];
    const found = series(run, file, c.name, line.label + suffixText(run, match[1]));
    return found.map((s) => (numbers.length > 1 ? { ...s, pair: numbers.join() } : { ...s, species: numbers[0] }));
  });
}

function suffixText(run, suffix) {
  const [, species, other, axis] = /^(?:_([0-9]+))?(?:_([0-9]+))?(?:_([xyz]))?$/.exec(suffix);
  if (other) return `, species ${species} and ${other}`;
  const title = species ? run.species[Number(species) - 1]?.title ?? `species ${species}` : '';
  return (species ? `, ${title}` : '') + (axis ? `, body ${axis}` : '');
}

function value(run, key) {
  const found = run.headlines.find((line) => line.key === key);
  return found && Number.isFinite(found.value) ? found.value : null;
}

function fitWindow(run, name) {
  const found = run.summary?.fit_windows?.[name];
  return Array.isArray(found) ? found : null;
}

const inside = (x, [from, to]) => x >= from * (1 - 1e-9) && x <= to * (1 + 1e-9);

/** The straight line of a diffusion coefficient over the window it was fitted in, through the middle of the points. */
function slope(run, base, key, windowName, factor, label) {
  const D = value(run, key);
  const window = fitWindow(run, windowName);
  if (!base || D === null || !window) return [];
  const known = base.x.map((x, k) => (inside(x, window) && base.y[k] !== null ? k : -1)).filter((k) => k >= 0);
  if (!known.length) return [];
  const offset = known.reduce((sum, k) => sum + base.y[k] - factor * D * base.x[k], 0) / known.length;
  return [{ label, fit: true, x: base.x, y: base.x.map((x) => (inside(x, window) ? offset + factor * D * x : null)) }];
}

/** A exp[-(t/tau)^beta] over its window; A is that of the points there. */
function stretched(run, base, tauKey, betaKey, name, label) {
  const tau = value(run, tauKey);
  const beta = value(run, betaKey);
  const window = fitWindow(run, name);
  if (!base || tau === null || beta === null || !window) return [];
  let sum = 0;
  let weight = 0;
  base.x.forEach((x, k) => {
    if (!inside(x, window) || !(base.y[k] > 0)) return;
    const w = base.error?.[k] > 0 ? (base.y[k] / base.error[k]) ** 2 : 1;
    sum += w * (Math.log(base.y[k]) + (x / tau) ** beta);
    weight += w;
  });
  if (!weight) return [];
  const A = Math.exp(sum / weight);
  const y = base.x.map((x) => (inside(x, window) ? A * Math.exp(-((x / tau) ** beta)) : null));
  return [{ label, fit: true, x: base.x, y }];
}

/** The fit that a plot's line asks for, from the run's values. */
function fitted(run, base, fit) {
  if (!fit) return [];
  const [key, second] = fit.keys;
  if (fit.kind === 'mean') return mean(run, base, key, fit.label);
  if (fit.kind === 'stretched') return stretched(run, base, key, second, fit.window, fit.label);
  const factor = fit.factor || 2 * run.rotational_freedoms / run.number;
  return slope(run, base, key, fit.window, factor, `${short(factor, 3)} ${fit.label}`);
}

/** The mean over the run, as a line. */
function mean(run, base, key, label) {
  const level = value(run, key);
  if (!base || level === null) return [];
  return [{ label, fit: true, x: base.x, y: base.x.map(() => level) }];
}

/** F_self at each wave number, of all bodies and of each species. */
function scattering(run, file, stem) {
  const numbers = run.summary?.wave_numbers ?? [];
  const all = [];
  for (let k = 1; k <= 16; k += 1) {
    const q = Number.isFinite(numbers[k - 1]) ? `q l = ${short(numbers[k - 1], 3)}` : `q${k}`;
    const add = (column, rest, species) => all.push(...series(run, file, column, q + rest).map((s) => ({ ...s, species, key: `wave number ${k}${rest}` })));
    add(`${stem}_q${k}`, '');
    for (let s = 1; s <= run.species.length; s += 1) add(`${stem}_${s}_q${k}`, `, ${run.species[s - 1].title}`, s - 1);
  }
  return all;
}

/** The van Hove function of all bodies at every second of its lags, from the longest on. */
function displacements(run, file, stem) {
  const lags = run.summary?.van_hove_lags ?? [];
  return lags.map((t, k) => series(run, file, `${stem}_t${k + 1}`, `t = ${short(t, 3)}`).map((s) => ({ ...s, key: `lag ${k + 1}` })))
    .filter((_, k) => (lags.length - 1 - k) % 2 === 0).flat();
}

/** Returns a column over its value at t = 0, which the file has in its first row. */
function normalised(run, file, column, label) {
  return series(run, file, column, label).map((s) => {
    const first = s.y[0];
    return { ...s, y: s.y.map((y) => (y === null ? null : y / first)), error: s.error?.map((e) => (e === null ? null : e / first)) };
  });
}

/** Averages over stretches of the run, against their middle. */
function blocks(run, column, label) {
  const table = run.curves.blocks;
  const found = curve(run, 'blocks', column);
  if (!found || !table) return [];
  const end = table.data[1];
  return [{ label, x: found.x.map((begin, k) => (begin + end[k]) / 2), y: found.y, error: null }];
}

/** Kinetic energy over its first value: hard bodies have no other energy, and conserve it to rounding. */
function energy(run) {
  const translation = blocks(run, 'kT_trans', 'E')[0];
  const rotation = blocks(run, 'kT_rot', 'E')[0];
  if (!translation || !rotation) return [];
  const energies = translation.y.map((kT, k) => {
    if (kT === null || rotation.y[k] === null) return null;
    return 0.5 * ((3 * run.number - 3) * kT + run.rotational_freedoms * rotation.y[k]);
  });
  const first = energies.find((E) => E !== null);
  return [{ label: 'E(t) / E(0) − 1', x: translation.x, y: energies.map((E) => (E === null ? null : E / first - 1)), error: null }];
}

/** The curves of one line of a plot: that of all bodies first. */
function curvesOf(run, plot, line) {
  if (plot.file === 'blocks') return blocks(run, line.column, line.label);
  if (plot.normalised) return normalised(run, plot.file, line.column, line.label);
  if (line.lags) return displacements(run, plot.file, line.column);
  if (line.wave_numbers) return scattering(run, plot.file, line.column);
  return family(run, plot.file, line);
}

/** Returns the curves of a plot: where there are fits, those of all bodies with their fits first, then those of species and body axes. */
function seriesOf(run, plot) {
  if (!plot.file) return energy(run);
  const { lines } = plot;
  const families = lines.map((line) => curvesOf(run, plot, line));
  if (!lines.some((line) => line.fit)) return families.flat();
  const heads = families.flatMap((all, k) => [...all.slice(0, 1), ...fitted(run, all[0], lines[k].fit)]);
  return [...heads, ...families.flatMap((all) => all.slice(1))];
}

/** Plots that are drawn, of the program's registry. */
let registry = [];

export function setPlots(plots) {
  registry = plots;
}

function hasPoints(s) {
  return s.y.some((y) => y !== null && Number.isFinite(y));
}

/** A plot of the registry with the lines that a run can have; null if there is none. */
function plotFor(run, entry) {
  if (!entry.lines.length) return entry;
  const lines = entry.lines.filter((line) => !line.of_orientation || oriented(run));
  if (!lines.length) return null;
  const following = (key) => lines.map((line) => line[key] ?? '').join('');
  return { ...entry, lines, about: entry.about + following('about'), y: { ...entry.y, label: entry.y.label + following('y_label') } };
}

/** Gives curves their colours: of a mixture those of the species and further ones of pairs of species, else one each. A fit takes the colour of its curve. */
function colour(run, all) {
  const mixture = run.species.length > 1;
  const used = new Map();
  const pairs = [];
  all.forEach((s, k) => {
    const base = s.fit ? all[k - 1] : null;
    s.key = base ? base.key : s.key ?? s.label;
    s.colour = base ? base.colour : k;
    if (base || !mixture) return;
    s.colour = s.species ?? kAllBodies;
    if (s.pair) {
      if (!pairs.includes(s.pair)) pairs.push(s.pair);
      s.colour = run.species.length + pairs.indexOf(s.pair);
    }
    const before = used.get(s.colour) ?? 0;
    used.set(s.colour, before + 1);
    s.dash = kDashes[before % kDashes.length];
  });
}

/** The plots of a run, without series that have no value. */
export function plotsOf(run) {
  return registry.map((entry) => plotFor(run, entry)).filter(Boolean).map((entry) => {
    const plot = { ...entry, series: seriesOf(run, entry).filter(hasPoints) };
    if (plot.series.some((s) => s.fit)) plot.about += plot.lines.map((line) => line.fit?.about ?? '').join('');
    colour(run, plot.series);
    return plot;
  });
}

/** Returns the plots of several runs together: for each plot the curves that any run has. One is shown at a time, with its
 * fits. */
export function comparisonsOf(runs) {
  const all = runs.map((run) => new Map(plotsOf(run).map((plot) => [plot.id, plot])));
  return registry.filter(({ id }) => all.some((plots) => plots.has(id))).map(({ id }) => {
    const keys = [...new Set(all.flatMap((plots) => (plots.get(id)?.series ?? []).map((s) => s.key)))];
    const choices = keys.map((key) => ({
      label: key,
      series: all.flatMap((plots, r) => (plots.get(id)?.series ?? []).filter((s) => s.key === key).map((s) => ({
        ...s, label: s.label === key ? runs[r].name : `${runs[r].name}, ${s.label}`, colour: r, dash: undefined }))),
    }));
    return { ...all.find((plots) => plots.has(id)).get(id), choices, series: choices[0]?.series ?? [] };
  });
}
