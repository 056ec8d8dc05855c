// The page of a sweep: a map, cuts through it, the point that is chosen, the table of all.
import { floats } from './bytes.js';
import { Chart, forgetCharts } from './chart.js';
import { downloadText, fileName, h, symbol, tool } from './dom.js';
import { makeAxis, SweepMap } from './map.js';
import { plotsOf } from './plots.js';
import { page, remarks, settingsCard, countersCard, sheet, number, viewCard } from './run_page.js';

const kMostCuts = 8;
const kSeed = 'seed';

/** Whether each value of a list has one value of the other, which it determines. */
function determines(xs, ys) {
  const partner = new Map();
  return xs.every((x, k) => {
    if (!partner.has(x)) partner.set(x, ys[k]);
    return partner.get(x) === ys[k];
  });
}

/** The run of a point, which waits as text in the page until somebody looks at it. */
function pointRun(index) {
  const element = document.getElementById(`point-${index}`);
  if (!element) return null;
  const run = JSON.parse(element.textContent);
  for (const table of Object.values(run.curves)) {
    table.data = table.data.map((column) => (typeof column === 'string' ? Array.from(floats(column), (x) => (Number.isNaN(x) ? null : x)) : column));
  }
  return run;
}

class SweepPage {
  constructor(sweep) {
    this.sweep = sweep;
    this.axes = sweep.keys.map((key, k) => makeAxis(sweep.points.map((p) => p.keys[k])));
    // Keys that do not vary are no axes.
    this.varied = this.axes.map((axis, k) => k).filter((k) => this.axes[k].values.length > 1);
    const places = this.varied.filter((k) => sweep.keys[k] !== kSeed);
    this.xKey = places[0] ?? this.varied[0] ?? 0;
    this.yKey = places.find((k) => k !== this.xKey && !this.follows(k, this.xKey)) ?? null;
    this.fixed = new Map();
    this.observable = this.firstObservable();
    this.lines = true;
    this.logarithmic = this.spansDecades();
    this.pointPlace = h('section', { id: 'point', 'aria-live': 'polite' });
    this.cutPlace = h('div', { class: 'cuts' });
    this.map = new SweepMap((i, j) => this.chooseCell(i, j));
  }

  // ---- Data ----------------------------------------------------------------------------------------------------------

  /** Whether key b follows from key a: there is no plane between them. */
  follows(b, a) {
    const [xs, ys] = [a, b].map((k) => this.sweep.points.map((p) => p.keys[k]));
    return determines(xs, ys);
  }

  keyName(k) {
    return this.sweep.key_names[k].label;
  }

  /** The value and error of an observable at a point, which has them; null otherwise. A failed point's are no results. */
  known(point, observable) {
    const measured = point.values[observable];
    return point.status !== 'failed' && Number.isFinite(measured?.[0]) ? measured : null;
  }

  values() {
    return this.sweep.points.map((p) => this.known(p, this.observable)?.[0]).filter((v) => v !== undefined);
  }

  /** The one with most values; among equals those first that the program names to be opened. */
  firstObservable() {
    const { observables, points } = this.sweep;
    const wanted = page.opened.map((key) => observables.findIndex((o) => o.key === key)).filter((k) => k >= 0);
    const count = (k) => points.filter((p) => this.known(p, k)).length;
    return [...wanted, ...observables.keys()].reduce((best, k) => (count(k) > count(best) ? k : best), wanted[0] ?? 0);
  }

  spansDecades() {
    const all = this.values();
    const low = Math.min(...all);
    return low > 0 && Math.max(...all) / low > 20;
  }

  others() {
    return this.varied.filter((k) => k !== this.xKey && k !== this.yKey
      && !(this.sweep.keys[k] !== kSeed && (this.follows(k, this.xKey) || (this.yKey !== null && this.follows(k, this.yKey)))));
  }

  /** Points that have those values of the keys which are not axes; of seeds all, unless one was chosen. */
  matching(x, y) {
    const others = this.others();
    return this.sweep.points.map((point, index) => ({ point, index })).filter(({ point }) => point.keys[this.xKey] === x
      && (this.yKey === null || point.keys[this.yKey] === y)
      && others.every((k) => !this.fixed.has(k) || point.keys[k] === this.fixed.get(k)));
  }

  /** Returns a cell of the map: a point, or several that differ in their seed, which the program has pooled. */
  cell(x, y) {
    const key = `${x}|${y}`;
    if (!this.cells.has(key)) {
      const found = this.matching(x, y);
      if (!found.length) {
        this.cells.set(key, null);
        return null;
      }
      const one = found[0].point;
      const measured = found.length > 1 ? this.sweep.groups[one.group][this.observable] : this.known(one, this.observable);
      const [value, error, , spread] = measured ?? [null, null, '', []];
      const worst = found.find(({ point }) => point.status !== 'done') ?? found[0];
      const missing = worst.point.values[this.observable]?.[2];
      const open = found.some(({ point }) => point.equilibrated === 'false');
      this.cells.set(key, { value, error, spread, missing, open, status: worst.point.status, message: worst.point.message, index: found[0].index });
    }
    return this.cells.get(key);
  }

  get observableTitle() {
    const { name, unit } = this.sweep.observables[this.observable];
    return unit ? `${name} [${unit}]` : name;
  }

  // ---- Elements ------------------------------------------------------------------------------------------------------

  content() {
    const { sweep } = this;
    const counts = new Map();
    sweep.points.forEach((p) => counts.set(p.status, (counts.get(p.status) ?? 0) + 1));
    const kinds = { done: 'good', failed: 'bad' };
    const hero = h('section', { class: 'hero', id: 'results' }, h('p', { class: 'over' }, sweep.path), h('h1', {}, page.title),
      h('ul', { class: 'remarks' }, [...counts].map(([status, n]) => h('li', { class: kinds[status] ?? 'warning' }, h('b', {}, `${n} ${status}`)))));
    const parts = [hero, h('div', { class: 'sweep' }, this.mapCard(), this.pointPlace), this.cutPlace, h('div', { id: 'plots' }),
      h('h2', { id: 'settings' }, 'All points'), this.table()];
    this.detail = parts[3];
    this.refresh();
    this.showPoint(this.firstPoint());
    return parts;
  }

  /** Returns the point in the middle of those that have something to show. */
  firstPoint() {
    const all = this.sweep.points.map((p, k) => k).filter((k) => this.sweep.points[k].embedded);
    return all[Math.floor(all.length / 2)] ?? 0;
  }

  mapCard() {
    const select = (label, options, chosen, onchange) => {
      const element = h('select', { onchange: () => onchange(element.selectedIndex) }, options.map((o, k) => h('option', { selected: k === chosen }, o)));
      return h('label', {}, h('span', {}, label), element);
    };
    this.logButton = tool('Logarithmic colours', 'log', () => { this.logarithmic = !this.logarithmic; this.refresh(); });
    this.lineButton = tool('Isolines', 'isolines', () => { this.lines = !this.lines; this.refresh(); });
    const observables = select('Show', this.sweep.observables.map((o) => o.name), this.observable, (k) => {
      this.observable = k;
      this.logarithmic = this.spansDecades();
      this.refresh();
    });
    this.keyPlace = h('div', { class: 'keys' });
    this.mapPlace = h('div', { class: 'map-place' });
    const plane = this.yKey !== null;
    const open = this.sweep.points.some((p) => p.equilibrated === 'false') ? ' Open circles: not shown to be equilibrated.' : '';
    const about = plane ? `One cell per state point; click one to open it.${open}` : `The table below opens a point.${open}`;
    const saveMap = tool('Save the map as PNG', 'PNG', () => this.map.savePicture(`${fileName(this.sweep.name)}-map.png`));
    return h('article', { class: 'card map-card', id: 'bodies', 'aria-label': plane ? 'Map of the sweep' : 'Along the sweep' },
      h('header', {}, h('div', {}, h('h3', {}, plane ? 'Map' : 'Along the sweep'), h('p', {}, about)),
        h('div', { class: 'tools' }, plane ? [this.lineButton, this.logButton] : null,
          tool('Save the table as CSV', 'CSV', () => this.saveTable()), plane ? saveMap : null)),
      h('div', { class: 'controls top-controls' }, observables, this.keyPlace), this.mapPlace);
  }

  /** Returns the choices of the keys that are axes, and of the values of the others. */
  keyControls() {
    const names = this.varied.map((k) => this.keyName(k));
    if (this.varied.length < 2) return [];
    const chooser = (label, current, set) => {
      const element = h('select', { onchange: () => { set(this.varied[element.selectedIndex]); this.fixed.clear(); this.refresh(); } },
        names.map((name, k) => h('option', { selected: this.varied[k] === current }, name)));
      return h('label', {}, h('span', {}, label), element);
    };
    const parts = this.yKey !== null && this.varied.length > 2 ? [
      chooser('x', this.xKey, (k) => { if (k === this.yKey) this.yKey = this.xKey; this.xKey = k; }),
      chooser('y', this.yKey ?? this.varied[1], (k) => { if (k === this.xKey) this.xKey = this.yKey; this.yKey = k; }),
    ] : [];
    for (const k of this.others()) {
      const axis = this.axes[k];
      const seeds = this.sweep.keys[k] === kSeed;
      if (!seeds && !this.fixed.has(k)) this.fixed.set(k, axis.values[0]);
      const element = h('select', { onchange: () => {
        const at = element.selectedIndex - (seeds ? 1 : 0);
        if (at < 0) this.fixed.delete(k);
        else this.fixed.set(k, axis.values[at]);
        this.refresh();
      } }, [...(seeds ? ['mean of all'] : []), ...axis.values.map(axis.text)].map((text, at) => h('option',
        { selected: this.fixed.has(k) ? axis.values[at - (seeds ? 1 : 0)] === this.fixed.get(k) : at === 0 }, text)));
      parts.push(h('label', {}, h('span', {}, this.keyName(k)), element));
    }
    return parts;
  }

  refresh() {
    this.keyPlace.replaceChildren(...this.keyControls());
    this.cells = new Map();
    this.logButton.setAttribute('aria-pressed', this.logarithmic);
    this.lineButton.setAttribute('aria-pressed', this.lines);
    if (this.yKey !== null) this.showMap();
    this.showCuts();
  }

  showMap() {
    const [x, y] = [this.axes[this.xKey], this.axes[this.yKey]];
    if (!this.map.element.isConnected) this.mapPlace.replaceChildren(this.map.element);
    this.map.show({ x, y, xLabel: this.keyName(this.xKey), yLabel: this.keyName(this.yKey),
      cell: (i, j) => this.cell(x.values[i], y.values[j]), title: this.observableTitle, logarithmic: this.logarithmic, lines: this.lines });
  }

  /** The observable along one key, a curve for each value of the other; without another one that is all there is. */
  showCuts() {
    if (this.cut) forgetCharts([this.cut]);
    const along = this.yKey ?? this.xKey;
    const axis = this.axes[along];
    if (!axis.numeric) {
      this.cutPlace.replaceChildren();
      return;
    }
    const across = this.yKey === null ? null : this.axes[this.xKey];
    const all = across ? across.values : [null];
    const step = Math.max(1, (all.length - 1) / (kMostCuts - 1));
    const some = all.length <= kMostCuts ? all : Array.from({ length: kMostCuts }, (_, k) => all[Math.round(k * step)]);
    const series = some.map((value, k) => {
      const cells = axis.values.map((v) => (across ? this.cell(value, v) : this.cell(v, null)));
      return { label: across ? `${this.sweep.key_names[this.xKey].symbol} = ${across.text(value)}` : this.sweep.observables[this.observable].name,
        x: axis.values, y: cells.map((c) => c?.value ?? null), error: cells.map((c) => c?.error ?? null), spread: cells.map((c) => c?.spread ?? []), open: cells.map((c) => Boolean(c?.open)), colour: k };
    }).filter((s) => s.y.some((y) => y !== null));
    this.cut = new Chart({ id: 'cuts', title: across ? 'Cuts through the map' : this.sweep.observables[this.observable].name, about: across ? this.observableTitle : 'The mean where a value of the key has several points or replicas; these are the pale dots.',
      x: { label: this.keyName(along), log: axis.logarithmic }, y: { label: this.observableTitle, log: this.logarithmic }, series }, this.sweep.name);
    (this.yKey === null ? this.mapPlace : this.cutPlace).replaceChildren(this.cut.element);
  }

  chooseCell(i, j) {
    const cell = this.cell(this.axes[this.xKey].values[i], this.axes[this.yKey].values[j]);
    if (cell) this.showPoint(cell.index);
  }

  // ---- The point -----------------------------------------------------------------------------------------------------

  showPoint(index) {
    const point = this.sweep.points[index];
    const run = point.embedded ? pointRun(index) : null;
    const headlines = this.sweep.observables
      .map((o, k) => ({ ...o, value: point.values[k]?.[0] ?? null, error: point.values[k]?.[1] ?? null, missing: point.values[k]?.[2] }))
      .filter((o) => point.oriented || !o.of_orientation);
    const title = this.varied.map((k) => `${this.keyName(k)} ${this.axes[k].text(point.keys[k])}`).join(', ');
    const notes = [];
    if (point.status !== 'done' || point.message) notes.push(h('p', { class: 'notice' }, `${point.status}${point.message ? `: ${point.message}` : ''}`));
    if (point.equilibrated === 'false') notes.push(h('p', { class: 'notice' }, 'Not shown to be equilibrated.'));
    this.pointPlace.replaceChildren(h('article', { class: 'card results' },
      h('header', {}, h('div', {}, h('h3', {}, title || 'The point'), h('p', { class: 'caption' }, point.directory))), ...notes,
      sheet(headlines.slice(0, 12), point.status === 'done' ? undefined : 'none')));
    this.showDetail(point, run);
    this.shown = index;
    this.markChosen(point);
  }

  markChosen(point) {
    if (this.yKey === null) return;
    const at = [this.axes[this.xKey].values.indexOf(point.keys[this.xKey]), this.axes[this.yKey].values.indexOf(point.keys[this.yKey])];
    this.map.chosen = at;
    this.map.cursor = at;
    this.map.draw();
  }

  showDetail(point, run) {
    forgetCharts(this.charts ?? []);
    page.views.splice(0).forEach((view) => view.dispose());
    this.charts = [];
    if (!run) {
      const why = point.directory && point.status === 'done' ? `Its plots are not in this file; hardbody report ${this.sweep.path}/${point.directory} shows them.` : 'There is nothing stored of it.';
      this.detail.replaceChildren(h('h2', {}, 'The chosen point'), h('p', { class: 'notice' }, why));
      return;
    }
    this.charts = plotsOf(run).map((plot) => new Chart(plot, run.name));
    const first = this.charts.slice(0, 1).map((c) => c.element);
    this.detail.replaceChildren(h('h2', {}, run.title), remarks(run),
      h('div', { class: 'split' }, run.view ? viewCard(run) : first, settingsCard(run)),
      h('div', { class: 'grid charts' }, this.charts.filter((c, k) => run.view || k > 0).map((c) => c.element)),
      h('details', { class: 'card log' }, h('summary', {}, 'Counters'), h('div', { class: 'grid' }, countersCard(run))));
  }

  // ---- The table -----------------------------------------------------------------------------------------------------

  table() {
    const { sweep } = this;
    this.body = h('tbody', {});
    this.sorted = { column: null, up: true };
    const head = (content, column) => {
      const cell = h('th', { scope: 'col', 'aria-sort': 'none' }, h('button', { type: 'button', onclick: () => this.sort(column, cell) }, content));
      return cell;
    };
    const columns = [...this.varied.map((k) => head(this.keyName(k), (p) => p.keys[k])),
      ...sweep.observables.map((o, k) => head(symbol(o.symbol), (p) => p.values[k]?.[0])), head('status', (p) => p.status)];
    this.order = sweep.points.map((p, k) => k);
    const element = h('div', { class: 'card scroll tall', tabindex: 0, role: 'region', 'aria-label': 'All points' },
      h('table', { class: 'comparison points' }, h('thead', {}, h('tr', {}, columns)), this.body));
    this.fillTable();
    return element;
  }

  sort(column, cell) {
    this.sorted = { column, up: this.sorted.column === column ? !this.sorted.up : true };
    cell.parentNode.querySelectorAll('th').forEach((other) => other.setAttribute('aria-sort', 'none'));
    cell.setAttribute('aria-sort', this.sorted.up ? 'ascending' : 'descending');
    const sign = this.sorted.up ? 1 : -1;
    const value = (k) => column(this.sweep.points[k]) ?? null;
    this.order.sort((a, b) => {
      const [x, y] = [value(a), value(b)];
      if (x === null || y === null) return (x === null) - (y === null);
      return sign * (typeof x === 'number' && typeof y === 'number' ? x - y : String(x).localeCompare(String(y)));
    });
    this.fillTable();
  }

  fillTable() {
    const { sweep } = this;
    this.body.replaceChildren(...this.order.map((k) => {
      const point = sweep.points[k];
      const open = () => { this.showPoint(k); document.getElementById('results').scrollIntoView(); };
      const cells = this.varied.map((axis, at) => h(at ? 'td' : 'th', at ? {} : { scope: 'row' },
        at ? this.axes[axis].text(point.keys[axis]) : h('button', { type: 'button', class: 'link', onclick: open }, this.axes[axis].text(point.keys[axis]))));
      return h('tr', {}, cells, point.values.map(([value, error, missing], at) => h('td', {}, number({ key: sweep.observables[at].key, value, error, missing }, point.status === 'done' ? undefined : ''))),
        h('td', { title: point.message }, point.status));
    }));
  }

  saveTable() {
    const { sweep } = this;
    const quoted = (text) => `"${String(text ?? '').replaceAll('"', '""')}"`;
    const header = [...sweep.keys, ...sweep.observables.flatMap((o) => [o.key, `${o.key}_error`]), 'status'];
    const rows = sweep.points.map((p) => [...p.keys.map((k) => (typeof k === 'number' ? k : quoted(k))), ...p.values.flatMap(([v, e]) => [v ?? '', e ?? '']), quoted(p.status)]);
    downloadText(`${fileName(sweep.name)}.csv`, `${[header, ...rows].map((row) => row.join(',')).join('\n')}\n`);
  }
}

export function sweepPage(sweep) {
  page.sweep = new SweepPage(sweep);
  return page.sweep.content();
}
