// The page of one run, or of several side by side.
import { Chart } from './chart.js';
import { downloadText, fileName, h, rich, symbol, tool } from './dom.js';
import { bytes, duration, estimate, grouped, short } from './format.js';
import { comparisonsOf, plotsOf } from './plots.js';
import { View3d } from './view3d.js';

/** Content of the page, for tests and for the console; `card`: keys of the results that are shown first. */
export const page = { views: [], card: [] };

// ---- Head ------------------------------------------------------------------------------------------------------------

/** Returns the list of remarks: good ones by their labels, others in full, or only bad ones in full. */
export function remarks(run, brief = false) {
  return h('ul', { class: 'remarks' }, run.remarks.map((r) => h('li', { class: r.kind, title: r.text },
    h('b', {}, r.label), ' ', r.kind === 'good' || (brief && r.kind !== 'bad') ? null : rich(r.text))));
}

/** `missing`: what stands for a value of a run that has not been finished. */
export function number(line, missing) {
  const text = line ? estimate(line.value, line.error) : null;
  if (!text) return h('span', { class: 'none', title: line?.missing ?? '' }, missing ?? 'no value');
  return h('span', { class: 'number' }, h('b', {}, text.value), text.error ? h('span', { class: 'error' }, ` ± ${text.error}`) : null);
}

/** Numbers one below the other, as on a data sheet. */
export function sheet(headlines, missing) {
  return h('dl', { class: 'sheet' }, headlines.map((line) => {
    const name = h('dt', {}, symbol(line.symbol), h('span', { class: 'name' }, rich(line.name)));
    const why = missing === undefined && !Number.isFinite(line.value) && line.missing;
    const value = why ? h('dd', { class: 'why' }, h('span', { class: 'none' }, line.missing))
      : h('dd', {}, number(line, missing), h('span', { class: 'unit' }, line.unit));
    return h('div', { 'data-key': line.key, class: why ? 'lacks' : '', title: line.meaning }, name, value);
  }));
}

function resultsCard(run) {
  const missing = run.headlines.some((line) => line.value !== null) ? undefined : 'none yet';
  const first = page.card.map((key) => run.headlines.find((line) => line.key === key)).filter(Boolean);
  const rest = run.headlines.filter((line) => !page.card.includes(line.key));
  if (!run.headlines.length) {
    return h('article', { class: 'card results' }, h('header', {}, h('h3', {}, 'Results')), h('p', { class: 'none' }, 'None yet: this run has not been finished.'));
  }
  return h('article', { class: 'card results' },
    h('header', {}, h('div', {}, h('h3', {}, 'Results'), h('p', { class: 'caption' }, '± one standard error, over blocks of the run')),
      h('div', { class: 'tools' }, tool('Save the results as CSV', 'CSV', () => saveResults([run])))),
    sheet(first, missing),
    rest.length ? h('details', {}, h('summary', {}, `${rest.length} more`), sheet(rest, missing)) : null);
}

function saveResults(runs) {
  const quoted = (text) => `"${String(text).replaceAll('"', '""')}"`;
  const rows = ['run,quantity,value,error,unit'];
  for (const run of runs) {
    for (const line of run.headlines) rows.push([quoted(run.name), line.key, line.value ?? '', line.error ?? '', quoted(line.unit)].join(','));
  }
  downloadText(`${fileName(runs.map((run) => run.name).join('-'))}-results.csv`, `${rows.join('\n')}\n`);
}

// ---- Tables ----------------------------------------------------------------------------------------------------------

function rows(pairs) {
  return h('table', { class: 'facts' }, h('tbody', {}, pairs.map(([name, text, unit]) => h('tr', {},
    h('th', { scope: 'row' }, name), h('td', {}, text, unit ? h('span', { class: 'unit' }, ` ${unit}`) : null)))));
}

/** [section], key and value of each line, the [[sections]] numbered; comments are left to the file. */
function configRows(text) {
  const list = [];
  const counts = new Map();
  let section = '';
  for (const line of text.split('\n')) {
    const head = /^\s*\[+([^\]]+)\]+/.exec(line);
    const repeated = /^\s*\[\[/.test(line);
    const entry = /^\s*([A-Za-z0-9_]+)\s*=\s*("[^"]*"|\[[^#]*\]|[^#]*)/.exec(line);
    if (head) {
      [, section] = head;
      if (repeated) {
        counts.set(section, (counts.get(section) ?? 0) + 1);
        section += ` ${counts.get(section)}`;
      }
    } else if (entry) list.push({ section, key: entry[1], value: entry[2].trim() });
  }
  return list;
}

export function settingsCard(run) {
  const sections = new Map();
  for (const { section, key, value } of configRows(run.config)) {
    if (!sections.has(section)) sections.set(section, []);
    sections.get(section).push([key, h('code', {}, value)]);
  }
  return h('article', { class: 'card settings' }, h('header', {}, h('h3', {}, 'Settings')),
    [...sections].map(([name, list]) => h('section', {}, h('h4', {}, name || 'run'), rows(list))),
    h('details', {}, h('summary', {}, 'config.toml'), h('pre', { tabindex: 0 }, run.config)));
}

const kCounters = {
  collisions: 'collisions', predictions: 'predictions of contacts', evaluations: 'gap evaluations of them',
  refinements: 'refinements', rescues: 'rescues by a fallback', cold_restarts: 'cold restarts of a normal',
  neighbour_rebuilds: 'neighbour lists renewed', envelope_checks: 'envelope checks', kernel_calls: 'gap kernel calls',
  candidate_tests: 'candidate tests', parting_contacts: 'contacts without impulse', overlaps: 'overlaps',
  declined: 'pairs without an answer',
};

export function countersCard(run) {
  const { counters, performance, audit } = run.summary ?? {};
  if (!counters) return null;
  const parts = [['production', counters], ['equilibration', run.summary.counters_of_equilibration],
    ['the start’s compression', run.summary.counters_of_start],
    ['the choice of neighbour lists', run.summary.counters_of_tuning]].filter(([, counted]) => counted?.predictions > 0)
    .flatMap(([phase, counted]) => [h('h4', {}, `Events of ${phase}`),
      rows(Object.entries(kCounters).filter(([key]) => key in counted).map(([key, name]) => [name, grouped(counted[key])]))]);
  if (audit) {
    parts.push(h('h4', {}, 'Audit'), rows([
      ['minimum distance at the end', short(audit.minimum_distance, 4), 'l'],
      ['energy drift, relative', short(audit.energy_relative_drift, 3)],
      ['momentum drift, a body', short(audit.momentum_drift, 3), '√(m kT)']]));
  }
  if (performance) {
    parts.push(h('h4', {}, 'Performance'), rows([
      ['collisions a second', grouped(Math.round(performance.collisions_per_second))],
      ['wall time of production', duration(performance.wall_seconds)], ['wall time in all', duration(performance.total_wall_seconds)],
      ['times resumed', grouped(performance.resumed)], ['peak memory', bytes(performance.peak_memory_bytes)],
      ['processor features', (run.summary.cpu_features ?? []).join(' ') || 'none']]));
  }
  return h('article', { class: 'card counters' }, h('header', {}, h('h3', {}, 'Counters')), parts);
}

function logCard(run) {
  if (!run.log) return null;
  return h('details', { class: 'card log' }, h('summary', {}, 'log.txt'), h('pre', { tabindex: 0 }, run.log));
}

function unitsNote(run) {
  const units = run.summary?.units;
  return h('p', { class: 'notice' }, units ? `Units: ${units.energy}, ${units.mass}, length ${units.length}, time ${units.time}.` : '');
}

function speciesCards(run) {
  if (!run.species.length) return null;
  return [h('h2', {}, 'Species'), h('div', { class: 'grid' }, run.species.map((s, k) => h('article', { class: 'card results' },
    h('header', {}, h('h3', { class: `c${k % 8}` }, s.title)), sheet(s.headlines))))];
}

// ---- Pages -----------------------------------------------------------------------------------------------------------

export function viewCard(run) {
  if (!run.view) {
    return h('article', { class: 'card view' }, h('header', {}, h('h3', {}, 'The bodies')), h('p', { class: 'none' }, 'No stored state to show.'));
  }
  const view = new View3d(run);
  page.views.push(view);
  return view.element;
}

export function runPage(run) {
  return [
    h('section', { class: 'hero', id: 'results' }, h('p', { class: 'over' }, run.path, run.summary ? ` · seed ${run.summary.seed} · hardbody ${run.summary.version}` : ''),
      h('h1', {}, run.title), remarks(run)),
    h('div', { class: 'split', id: 'bodies' }, viewCard(run), resultsCard(run)),
    speciesCards(run),
    h('h2', { id: 'plots' }, 'Plots'),
    h('div', { class: 'grid charts' }, plotsOf(run).map((plot) => new Chart(plot, run.name).element)),
    h('h2', { id: 'settings' }, 'Settings and counters'),
    h('div', { class: 'grid' }, settingsCard(run), countersCard(run)), logCard(run), unitsNote(run),
  ];
}

/** Returns the table with one row a quantity, one column a run. */
function comparison(runs) {
  const keys = [...new Map(runs.flatMap((run) => run.headlines).map((line) => [line.key, line])).values()];
  return h('div', { class: 'card scroll' }, h('table', { class: 'comparison' },
    h('thead', {}, h('tr', {}, h('th', { scope: 'col' }, 'Quantity'), runs.map((run, k) => h('th', { scope: 'col' }, swatch(k), run.name)), h('th', { scope: 'col' }, 'Unit'))),
    h('tbody', {}, keys.map((line) => h('tr', { 'data-key': line.key, title: line.meaning },
      h('th', { scope: 'row' }, symbol(line.symbol), h('span', { class: 'name' }, rich(line.name))),
      runs.map((run) => h('td', {}, number(run.headlines.find((own) => own.key === line.key), run.headlines.length ? undefined : 'none yet'))),
      h('td', { class: 'unit' }, line.unit))))));
}

function swatch(k) {
  const mark = h('i', { class: 'swatch' });
  mark.style.setProperty('--colour', `var(--c${k % 8})`);
  return mark;
}

/** Settings that the runs do not share. */
function differences(runs) {
  const all = runs.map((run) => new Map(configRows(run.config).map((r) => [`${r.section ? `${r.section}.` : ''}${r.key}`, r.value])));
  const keys = [...new Set(all.flatMap((map) => [...map.keys()]))].filter((key) => new Set(all.map((map) => map.get(key))).size > 1);
  if (!keys.length) return h('p', { class: 'notice' }, 'All settings are the same.');
  return h('div', { class: 'card scroll' }, h('table', { class: 'comparison' },
    h('thead', {}, h('tr', {}, h('th', { scope: 'col' }, 'Setting'), runs.map((run, k) => h('th', { scope: 'col' }, swatch(k), run.name)))),
    h('tbody', {}, keys.map((key) => h('tr', {}, h('th', { scope: 'row' }, h('code', {}, key)),
      all.map((map) => h('td', {}, map.has(key) ? h('code', {}, map.get(key)) : h('span', { class: 'none' }, 'not set'))))))));
}

/** The bodies of one of the runs at a time: each has a context of the graphics card, of which browsers give few. */
function viewChooser(runs) {
  const place = h('div', {});
  const select = h('select', { onchange: show }, runs.map((run) => h('option', {}, run.name)));
  function show() {
    page.views.splice(0).forEach((view) => view.dispose());
    place.replaceChildren(viewCard(runs[select.selectedIndex]));
  }
  show();
  return [h('label', { class: 'chooser' }, h('span', {}, 'Run '), select), place];
}

export function severalPage(runs, title) {
  return [
    h('section', { class: 'hero', id: 'results' }, h('p', { class: 'over' }, runs.map((run) => run.path).join('  ·  ')), h('h1', {}, title),
      h('ul', { class: 'runs' }, runs.map((run, k) => h('li', {}, h('p', {}, swatch(k), h('b', {}, run.name), ` ${run.title}`), remarks(run, true))))),
    h('div', { class: 'headed' }, h('h2', {}, 'Results'), tool('Save the results as CSV', 'CSV', () => saveResults(runs))),
    comparison(runs),
    h('h2', { id: 'plots' }, 'Plots'),
    h('div', { class: 'grid charts' }, comparisonsOf(runs).map((plot) => new Chart(plot, 'comparison').element)),
    h('h2', { id: 'bodies' }, 'Bodies'), viewChooser(runs),
    h('h2', { id: 'settings' }, 'What differs'), differences(runs),
    runs.map((run) => h('details', { class: 'card log' }, h('summary', {}, `${run.name}: settings and counters`),
      h('div', { class: 'grid' }, settingsCard(run), countersCard(run)), logCard(run))),
    unitsNote(runs[0]),
  ];
}
