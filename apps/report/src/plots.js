// Which curves a plot shows. A plot: {id, title, about, x, y, series}; x, y: {label, log}; a series: {label, x, y, error,
// fit, key}. Fits are drawn dashed and belong to the series before them. `key` is the same for what is the same curve of
// another run, whatever the label says of this one.
import { short } from './format.js';

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

/** Those columns of a file that begin with `stem`, of all bodies first, then of species or body axes. */
function family(run, file, stem, label) {
  const table = run.curves[file];
  if (!table) return [];
  const pattern = new RegExp(`^${stem}((?:_[0-9]+)?(?:_[xyz])?)$`);
  return table.columns.flatMap((c) => {
    const match = pattern.exec(c.name);
    return match ? series(run, file, c.name, label + suffixText(run, match[1])) : [];
  });
}

function suffixText(run, suffix) {
  const [, species, axis] = /^(?:_([0-9]+))?(?:_([xyz]))?$/.exec(suffix);
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
function slope(run, base, key, factor, label) {
  const D = value(run, key);
  const window = fitWindow(run, 'D');
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

const time = { label: 't  [l √(m/kT)]', log: true };

function msd(run) {
  const all = family(run, 'msd', 'msd', 'MSD');
  return {
    id: 'msd', title: 'Mean square displacement', about: 'Of the centres. A dashed line has the slope 6 D_trans.',
    x: time, y: { label: '⟨Δr²⟩  [l²]', log: true },
    series: [...all.slice(0, 1), ...slope(run, all[0], 'D_trans', 6, '6 D_trans t'), ...all.slice(1)],
  };
}

function rotationalMsd(run) {
  const world = family(run, 'rotational_msd', 'rot_msd', 'world frame');
  const body = family(run, 'rotational_msd', 'rot_msd_body', 'body frame');
  const components = run.rotational_freedoms / run.number;
  const factor = 2 * components;
  return {
    id: 'rotational_msd', title: 'Rotational mean square displacement',
    about: 'Of the integral of the angular velocity, its components taken in the world or along the body’s axes.',
    x: time, y: { label: '⟨ΔΦ²⟩  [rad²]', log: true },
    series: [...world.slice(0, 1), ...slope(run, world[0], 'D_rot', factor, `${short(factor, 3)} D_rot t`),
      ...body.slice(0, 1), ...world.slice(1), ...body.slice(1)],
  };
}

function c1(run) {
  return {
    id: 'c1', title: 'Orientation, first order', about: 'C₁: how far an axis still points where it pointed.',
    x: time, y: { label: 'C₁ = ⟨u(t)·u(0)⟩' }, series: family(run, 'c1', 'c1', 'C₁'),
  };
}

function c2(run) {
  const all = family(run, 'c2', 'c2', 'C₂');
  return {
    id: 'c2', title: 'Orientation, second order', about: 'C₂ decides what is relaxed: the fit leaves the ballistic part out.',
    x: time, y: { label: 'C₂ = ⟨P₂(u(t)·u(0))⟩' },
    series: [...all.slice(0, 1), ...stretched(run, all[0], 'tau_C2', 'beta_C2', 'C2', 'A exp[−(t/τ)ᵝ]'), ...all.slice(1)],
  };
}

function fSelf(run) {
  const numbers = run.summary?.wave_numbers ?? [];
  const all = [];
  for (let k = 1; k <= 16; k += 1) {
    const q = Number.isFinite(numbers[k - 1]) ? `q l = ${short(numbers[k - 1], 3)}` : `q${k}`;
    const add = (column, rest) => all.push(...series(run, 'f_self', column, q + rest).map((s) => ({ ...s, key: `wave number ${k}${rest}` })));
    add(`f_self_q${k}`, '');
    for (let s = 1; s <= run.species.length; s += 1) add(`f_self_${s}_q${k}`, `, species ${s}`);
  }
  return {
    id: 'f_self', title: 'Self-intermediate scattering',
    about: 'F_self at four wave numbers. The first wave number is that of the first peak of S(q); a dashed line is its fit.',
    x: time, y: { label: 'Fₛ(q, t)' },
    series: [...all.slice(0, 1), ...stretched(run, all[0], 'tau_F', 'beta_F', 'F', 'A exp[−(t/τ)ᵝ]'), ...all.slice(1)],
  };
}

/** Over its value at t = 0, which the file has in its first row. */
function normalised(run, column, label) {
  return series(run, 'velocity', column, label).map((s) => {
    const first = s.y[0];
    return { ...s, y: s.y.map((y) => (y === null ? null : y / first)), error: s.error?.map((e) => (e === null ? null : e / first)) };
  });
}

function velocity(run) {
  return {
    id: 'velocity', title: 'Velocity correlations', about: 'Over their values at t = 0. Below zero: bodies bounce back.',
    x: time, y: { label: '⟨v(t)·v(0)⟩ / ⟨v²⟩' },
    series: [...normalised(run, 'vacf', 'velocity'), ...normalised(run, 'wacf', 'angular velocity')],
  };
}

function alpha2(run) {
  return {
    id: 'alpha2', title: 'Non-Gaussian parameter', about: '0 for displacements that are distributed as in free diffusion.',
    x: time, y: { label: 'α₂ = 3⟨Δr⁴⟩ / 5⟨Δr²⟩² − 1' }, series: family(run, 'alpha2', 'alpha2', 'α₂'),
  };
}

function pairs(run) {
  return {
    id: 'g_r', title: 'Pair correlations', about: 'g of the centres; g₂ the mean P₂ of the angle between bodies r apart.',
    x: { label: 'r  [l]' }, y: { label: 'g(r), g₂(r)' }, series: [...family(run, 'g_r', 'g', 'g'), ...family(run, 'g_r', 'g2', 'g₂')],
  };
}

function structure(run) {
  return {
    id: 's_q', title: 'Structure factor', about: 'Of the centres, at wave vectors of the box.',
    x: { label: 'q  [1/l]' }, y: { label: 'S(q)' }, series: family(run, 's_q', 'S', 'S(q)'),
  };
}

/** Averages over stretches of the run, against their middle. */
function blocks(run, column, label) {
  const table = run.curves.blocks;
  const found = curve(run, 'blocks', column);
  if (!found || !table) return [];
  const end = table.data[1];
  return [{ label, x: found.x.map((begin, k) => (begin + end[k]) / 2), y: found.y, error: null }];
}

/** The mean over the run, as a line. */
function mean(run, base, key) {
  const level = value(run, key);
  if (!base || level === null) return [];
  return [{ label: 'mean', fit: true, x: base.x, y: base.x.map(() => level) }];
}

const runTime = { label: 't in production  [l √(m/kT)]' };

function order(run) {
  const all = blocks(run, 'S', 'S');
  return {
    id: 'order', title: 'Nematic order in time', about: 'Largest eigenvalue of Q, averaged over stretches of the run.',
    x: runTime, y: { label: 'S' }, series: [...all, ...mean(run, all[0], 'S')],
  };
}

function pressure(run) {
  const all = blocks(run, 'Z', 'Z');
  return {
    id: 'pressure', title: 'Compressibility factor in time', about: 'A drift would mean that the run is not equilibrated.',
    x: runTime, y: { label: 'Z = PV / NkT' }, series: [...all, ...mean(run, all[0], 'Z')],
  };
}

/** Kinetic energy, which is all that there is, against its first value: it is conserved to rounding. */
function energy(run) {
  const translation = blocks(run, 'kT_trans', 'E')[0];
  const rotation = blocks(run, 'kT_rot', 'E')[0];
  let series = [];
  if (translation && rotation) {
    const energies = translation.y.map((kT, k) => {
      if (kT === null || rotation.y[k] === null) return null;
      return 0.5 * ((3 * run.number - 3) * kT + run.rotational_freedoms * rotation.y[k]);
    });
    const first = energies.find((E) => E !== null);
    series = [{ label: 'E(t) / E(0) − 1', x: translation.x, y: energies.map((E) => (E === null ? null : E / first - 1)), error: null }];
  }
  return {
    id: 'energy', title: 'Energy drift', about: 'Nothing but rounding: collisions are elastic and motion between them is exact.',
    x: runTime, y: { label: 'E(t) / E(0) − 1' }, series,
  };
}

const makers = [msd, rotationalMsd, c2, c1, fSelf, velocity, alpha2, pairs, structure, pressure, order, energy];

function hasPoints(s) {
  return s.y.some((y) => y !== null && Number.isFinite(y));
}

/** Without series that have no value. */
export function plotsOf(run) {
  return makers.map((make) => {
    const plot = make(run);
    plot.series = plot.series.filter(hasPoints);
    // A fit takes the colour of its curve, and its key.
    plot.series.forEach((s, k) => {
      const base = s.fit ? plot.series[k - 1] : null;
      s.colour = base ? base.colour : k;
      s.key = base ? base.key : s.key ?? s.label;
    });
    return plot;
  });
}

/** The same plots of several runs: for each the curves that any of them has, one of which is shown at a time, with its
 * fits. */
export function comparisonsOf(runs) {
  const all = runs.map(plotsOf);
  return all[0].map((plot, at) => {
    const keys = [...new Set(all.flatMap((plots) => plots[at].series.map((s) => s.key)))];
    const choices = keys.map((key) => ({
      label: key,
      series: all.flatMap((plots, r) => plots[at].series.filter((s) => s.key === key).map((s) => ({
        ...s, label: s.label === key ? runs[r].name : `${runs[r].name}, ${s.label}`, colour: r }))),
    }));
    return { ...plot, choices, series: choices[0]?.series ?? [] };
  });
}
