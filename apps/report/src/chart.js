// A plot on a card: uPlot for the axes, a legend that is also the readout, buttons for the axes and for what is saved.
import uPlot from 'uplot';
import { colourName, cssColour, download, downloadText, fileName, h, rich, seriesColour, tool } from './dom.js';
import { short, superscript } from './format.js';
import { onThemeChange } from './theme.js';

/** Charts on the page, for tests and for the console. */
export const charts = [];

const kHeight = 300;
const kDeepestBar = 0.9; // share of a value by which a logarithmic axis goes down for an error bar
const kFont = '12px -apple-system, "Segoe UI", Inter, Roboto, "Noto Sans", "Liberation Sans", Arial, system-ui, sans-serif';

/** Marks of a logarithmic axis: decades, or 1, 2 and 5 where there are few of them. */
function logValues(u, splits) {
  const decade = (x) => Math.log10(x);
  const span = decade(splits[splits.length - 1] / splits[0]);
  return splits.map((x) => {
    const mantissa = x / 10 ** Math.floor(decade(x) + 1e-9);
    const whole = Math.abs(mantissa - 1) < 1e-6;
    if (!whole && (span > 2.5 || ![2, 5].some((m) => Math.abs(mantissa - m) < 1e-6))) return '';
    if (!whole || (x >= 0.01 && x <= 1000 && span < 5)) return String(Number(x.toPrecision(3)));
    return `10${superscript(Math.round(decade(x)))}`;
  });
}

/** Keeps only the ends of decades where there are many. */
function logGrid(u, splits) {
  const many = Math.log10(splits[splits.length - 1] / splits[0]) > 2.5;
  return splits.map((x) => (many && Math.abs(Math.log10(x) - Math.round(Math.log10(x))) > 1e-6 ? null : x));
}

function linearValues(u, splits) {
  const largest = Math.max(...splits.map(Math.abs));
  if (largest > 0 && (largest < 1e-3 || largest >= 1e6)) return splits.map((x) => (x === 0 ? '0' : short(x, 4)));
  const step = splits.length > 1 ? splits[1] - splits[0] : 1;
  // As many as the step itself has: 0.025 has three.
  let decimals = Math.max(0, Math.min(10, -Math.floor(Math.log10(Math.abs(step)) + 1e-9)));
  while (decimals < 10 && Math.abs(step - Number(step.toFixed(decimals))) > 1e-6 * Math.abs(step)) decimals += 1;
  return splits.map((x) => x.toFixed(decimals).replace('-', '−'));
}

/** The pattern of a dashed curve, for its key. */
function dashes(pattern) {
  let at = 0;
  const stops = pattern.map((length, k) => {
    const from = at;
    at += length;
    return `${k % 2 ? 'transparent' : 'var(--colour)'} ${from}px ${at}px`;
  });
  return `repeating-linear-gradient(90deg, ${stops.join(', ')})`;
}

/** uPlot wants one list of x for all. */
function aligned(series, logX, logY) {
  const usable = (x, y) => y !== null && Number.isFinite(y) && (!logX || x > 0) && (!logY || y > 0);
  const tables = series.map((s) => {
    const keep = s.x.map((x, k) => k).filter((k) => s.x[k] !== null && (!logX || s.x[k] > 0));
    return [keep.map((k) => s.x[k]), keep.map((k) => (usable(s.x[k], s.y[k]) ? s.y[k] : null))];
  });
  const data = tables.length === 1 ? tables[0] : uPlot.join(tables);
  // Where a curve has no point of its own is no gap.
  const errors = series.map((s) => {
    const of = new Map(s.x.map((x, k) => [x, s.error?.[k] ?? null]));
    return data[0].map((x) => of.get(x) ?? null);
  });
  const spreads = series.map((s) => (s.spread ?? []).flatMap((ys, k) => (ys.length > 1 ? ys : [])
    .filter((y) => usable(s.x[k], y)).map((y) => [s.x[k], y])));
  return { data: data.map((column) => Array.from(column, (y) => y ?? null)), errors, spreads };
}

export class Chart {
  constructor(plot, name) {
    this.plot = plot;
    this.name = name;
    this.logX = Boolean(plot.x.log);
    this.logY = Boolean(plot.y.log);
    this.hidden = new Set();
    this.area = h('div', { class: 'plot' });
    this.legend = h('ul', { class: 'legend' });
    this.readout = h('span', { class: 'readout', 'aria-live': 'off' });
    this.element = h('article', { class: 'card chart', id: `plot-${plot.id}`, 'aria-label': plot.title },
      h('header', {}, h('div', {}, h('h3', {}, plot.title), h('p', {}, rich(plot.about))), this.tools()),
      this.chooser(), this.area, h('footer', {}, this.legend, this.readout));
    charts.push(this);
    new ResizeObserver(() => this.resize()).observe(this.area);
    this.build();
  }

  /** Points that are drawn, of all curves. */
  get points() {
    return this.u ? this.u.data.slice(1).reduce((n, column) => n + column.filter((y) => y !== null).length, 0) : 0;
  }

  tools() {
    this.buttons = [
      tool('Logarithmic x axis', 'log x', () => this.toggle('logX'), { 'aria-pressed': this.logX }),
      tool('Logarithmic y axis', 'log y', () => this.toggle('logY'), { 'aria-pressed': this.logY }),
    ];
    return h('div', { class: 'tools' }, this.buttons,
      tool(`Save the data of "${this.plot.title}" as CSV`, 'CSV', () => this.saveData()),
      tool(`Save "${this.plot.title}" as PNG`, 'PNG', () => this.savePicture()));
  }

  /** Returns the choice of the curve that is shown of each of several runs. */
  chooser() {
    const { choices } = this.plot;
    if (!choices || choices.length < 2) return null;
    const select = h('select', { 'aria-label': `Curve of ${this.plot.title}`,
      onchange: () => { this.plot.series = choices[select.selectedIndex].series; this.build(); } },
    choices.map((c) => h('option', {}, c.label)));
    return h('div', { class: 'chooser' }, select);
  }

  toggle(which) {
    this[which] = !this[which];
    this.build();
  }

  build() {
    this.u?.destroy();
    this.u = null;
    this.area.replaceChildren();
    this.buttons[0].setAttribute('aria-pressed', this.logX);
    this.buttons[1].setAttribute('aria-pressed', this.logY);
    const { series } = this.plot;
    const { data, errors, spreads } = series.length ? aligned(series, this.logX, this.logY) : { data: [[]], errors: [], spreads: [] };
    this.errors = errors;
    this.spreads = spreads;
    if (!data.slice(1).some((column) => column.some((y) => y !== null))) {
      const text = series.length ? 'No positive value to draw on this axis.' : 'No values: nothing, or too little, has been measured.';
      this.area.append(h('p', { class: 'none' }, text));
      this.legend.replaceChildren();
      return;
    }
    this.u = new uPlot(this.options(data), data, this.area);
    this.u.root.tabIndex = 0;
    this.u.root.setAttribute('role', 'img');
    this.u.root.setAttribute('aria-label', this.description(data));
    this.u.root.addEventListener('keydown', (event) => this.key(event));
    this.showLegend(null);
  }

  description(data) {
    const names = this.plot.series.map((s) => s.label).join(', ');
    return `${this.plot.title}: ${names} against ${this.plot.x.label}, ${data[0].length} points; arrow keys read values`;
  }

  options(data) {
    const axis = (log, label, side) => ({
      stroke: () => cssColour('--muted'), font: kFont, labelFont: kFont, label, labelSize: 18, labelGap: 2,
      size: side === 'y' ? 56 : 28, gap: 5,
      grid: { stroke: () => cssColour('--grid'), width: 1, filter: log ? logGrid : (u, splits) => splits }, ticks: { show: false },
      values: log ? logValues : linearValues, space: side === 'y' ? 34 : 56,
      ...(log ? { filter: (u, splits) => splits } : {}),
    });
    return {
      width: Math.max(200, this.area.clientWidth), height: kHeight, legend: { show: false }, pxAlign: 0, padding: [10, 14, 0, 0],
      cursor: { points: { size: 7 }, drag: { x: true, y: false }, focus: { prox: 24 } },
      scales: {
        x: { time: false, distr: this.logX ? 3 : 1 },
        y: { distr: this.logY ? 3 : 1, range: this.logY ? this.logRange(data) : this.linearRange(data) },
      },
      axes: [axis(this.logX, this.plot.x.label, 'x'), axis(this.logY, this.plot.y.label, 'y')],
      series: [{}, ...this.plot.series.map((s) => this.style(s, s.x.length))],
      hooks: { drawAxes: [(u) => this.drawSpread(u)], draw: [(u) => this.drawErrors(u)], setCursor: [(u) => this.showLegend(u.cursor.idx)] },
    };
  }

  /** Values with the ends of their error bars. */
  extremes(data) {
    let [low, high] = [Infinity, -Infinity];
    data.slice(1).forEach((column, k) => column.forEach((y, i) => {
      if (y === null) return;
      const error = this.errors[k][i] > 0 && !this.plot.series[k].fit ? this.errors[k][i] : 0;
      // On a logarithmic axis a bar that reaches further down ends at the frame.
      low = Math.min(low, this.logY ? Math.max(y - error, (1 - kDeepestBar) * y) : y - error);
      high = Math.max(high, y + error);
    }));
    this.spreads.flat().forEach(([, y]) => { [low, high] = [Math.min(low, y), Math.max(high, y)]; });
    return [low, high];
  }

  logRange(data) {
    return uPlot.rangeLog(...this.extremes(data), 10, false);
  }

  /** Returns the range with some room; what hardly varies is not blown up, but for drifts, which are rounding by nature. */
  linearRange(data) {
    const [low, high] = this.extremes(data);
    const room = 0.06 * (high - low) || 0.1 * Math.abs(high) || 1e-15;
    return [low - room, high + room];
  }

  style(s, number) {
    const hidden = this.hidden.has(s.label);
    const colour = () => seriesColour(s.colour);
    if (s.fit) return { label: s.label, stroke: () => cssColour('--ink'), width: 1.6, dash: [6, 5], points: { show: false }, spanGaps: true, show: !hidden };
    const size = number > 120 ? 0 : 5;
    return { label: s.label, stroke: colour, width: 1.4, dash: s.dash, spanGaps: true, show: !hidden,
      points: { show: size > 0, size, stroke: colour, fill: colour, width: 0 } };
  }

  drawErrors(u) {
    const { ctx } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    ctx.clip();
    this.plot.series.forEach((s, k) => {
      if (s.fit || !u.series[k + 1].show) return;
      ctx.strokeStyle = seriesColour(s.colour);
      ctx.globalAlpha = 0.55;
      ctx.lineWidth = 1.2 * devicePixelRatio;
      ctx.beginPath();
      u.data[k + 1].forEach((y, i) => {
        const error = this.errors[k][i];
        if (y === null || !(error > 0)) return;
        const x = u.valToPos(u.data[0][i], 'x', true);
        const top = u.valToPos(y + error, 'y', true);
        const low = this.logY && y - error <= 0 ? u.bbox.top + u.bbox.height : u.valToPos(y - error, 'y', true);
        if (low - top < 6 * devicePixelRatio) return;
        ctx.moveTo(x, top);
        ctx.lineTo(x, low);
      });
      ctx.stroke();
    });
    ctx.restore();
    this.drawOpen(u);
  }

  /** Draws the values that a point is the mean of, behind the curves. */
  drawSpread(u) {
    const { ctx } = u;
    ctx.save();
    ctx.globalAlpha = 0.35;
    this.plot.series.forEach((s, k) => {
      if (!u.series[k + 1].show) return;
      ctx.fillStyle = seriesColour(s.colour);
      for (const [x, y] of this.spreads[k]) {
        ctx.beginPath();
        ctx.arc(u.valToPos(x, 'x', true), u.valToPos(y, 'y', true), 2 * devicePixelRatio, 0, 2 * Math.PI);
        ctx.fill();
      }
    });
    ctx.restore();
  }

  /** Rings over the points that a series calls open. */
  drawOpen(u) {
    const { ctx } = u;
    ctx.save();
    ctx.fillStyle = cssColour('--card');
    ctx.lineWidth = 1.6 * devicePixelRatio;
    this.plot.series.forEach((s, k) => {
      if (!s.open || !u.series[k + 1].show) return;
      ctx.strokeStyle = seriesColour(s.colour);
      const open = new Set(s.x.filter((x, i) => s.open[i]));
      u.data[k + 1].forEach((y, i) => {
        if (y === null || !open.has(u.data[0][i])) return;
        ctx.beginPath();
        ctx.arc(u.valToPos(u.data[0][i], 'x', true), u.valToPos(y, 'y', true), 3.6 * devicePixelRatio, 0, 2 * Math.PI);
        ctx.fill();
        ctx.stroke();
      });
    });
    ctx.restore();
  }

  /** The names of the curves, with their values where the cursor is. */
  showLegend(index) {
    if (!this.u) return;
    const { data } = this.u;
    const at = index === null || index === undefined ? null : data[0][index];
    this.readout.textContent = at === null ? '' : `${this.plot.x.label.split(/\s/)[0]} = ${short(at, 4)}`;
    if (this.legend.children.length !== this.plot.series.length || at === null) {
      this.legend.replaceChildren(...this.plot.series.map((s, k) => this.key_of(s, k)));
    }
    if (at === null) return;
    this.plot.series.forEach((s, k) => {
      const y = data[k + 1][index];
      this.legend.children[k].querySelector('.value').textContent = y === null ? '' : short(y, 4);
    });
  }

  key_of(s, k) {
    const button = h('button', { type: 'button', 'aria-pressed': !this.hidden.has(s.label), class: s.fit ? 'key fit' : 'key',
      title: 'Show or hide this curve', onclick: () => {
        const show = this.hidden.delete(s.label);
        if (!show) this.hidden.add(s.label);
        button.setAttribute('aria-pressed', show);
        this.u.setSeries(k + 1, { show });
      } }, h('i', {}), h('span', {}, rich(s.label)), h('span', { class: 'value' }));
    const mark = button.querySelector('i');
    mark.style.setProperty('--colour', `var(${s.fit ? '--ink' : colourName(s.colour)})`);
    if (s.dash) mark.style.background = dashes(s.dash);
    return h('li', {}, button);
  }

  key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const { u } = this;
    const last = u.data[0].length - 1;
    const index = Math.min(last, Math.max(0, (u.cursor.idx ?? (step > 0 ? -1 : last + 1)) + step));
    const known = u.data.slice(1).find((column) => column[index] !== null);
    u.setCursor({ left: u.valToPos(u.data[0][index], 'x'), top: known ? u.valToPos(known[index], 'y') : 0 });
    this.readout.setAttribute('aria-live', 'polite');
  }

  resize() {
    const width = this.area.clientWidth;
    if (this.u && width > 0 && Math.abs(width - this.u.width) > 1) this.u.setSize({ width, height: kHeight });
  }

  recolour() {
    this.u?.redraw(false, true);
  }

  fileName(ending) {
    return `${fileName(this.name)}-${this.plot.id}.${ending}`;
  }

  saveData() {
    const quoted = (text) => `"${text.replaceAll('"', '""')}"`;
    const rows = [['x', ...this.plot.series.flatMap((s) => (s.fit ? [s.label] : [s.label, `${s.label} error`]))].map(quoted)];
    rows[0][0] = quoted(this.plot.x.label);
    const xs = this.u ? this.u.data[0] : [];
    const table = this.plot.series.map((s) => new Map(s.x.map((x, k) => [x, k])));
    for (const x of xs) {
      rows.push([x, ...this.plot.series.flatMap((s, k) => {
        const at = table[k].get(x);
        const y = at === undefined ? '' : s.y[at] ?? '';
        return s.fit ? [y] : [y, at === undefined ? '' : s.error?.[at] ?? ''];
      })]);
    }
    downloadText(this.fileName('csv'), `${rows.map((row) => row.join(',')).join('\n')}\n`);
  }

  savePicture() {
    if (!this.u) return;
    const ratio = devicePixelRatio;
    const from = this.u.ctx.canvas;
    const canvas = h('canvas', { width: from.width, height: from.height + 64 * ratio });
    const ctx = canvas.getContext('2d');
    ctx.fillStyle = cssColour('--card');
    ctx.fillRect(0, 0, canvas.width, canvas.height);
    ctx.drawImage(from, 0, 32 * ratio);
    ctx.scale(ratio, ratio);
    ctx.fillStyle = cssColour('--ink');
    ctx.font = '600 16px Georgia, "Liberation Serif", serif';
    ctx.fillText(this.plot.title, 14, 22);
    ctx.font = kFont;
    let x = 62;
    for (const s of this.plot.series.filter((one) => !this.hidden.has(one.label))) {
      ctx.fillStyle = s.fit ? cssColour('--ink') : seriesColour(s.colour);
      ctx.fillRect(x, kHeight + 46, 14, s.fit ? 2 : 4);
      ctx.fillStyle = cssColour('--ink');
      ctx.fillText(s.label, x + 20, kHeight + 52);
      x += 40 + ctx.measureText(s.label).width;
    }
    canvas.toBlob((blob) => download(this.fileName('png'), blob));
  }
}

export function forgetCharts(list) {
  for (const chart of list) {
    chart.u?.destroy();
    const at = charts.indexOf(chart);
    if (at >= 0) charts.splice(at, 1);
  }
}

onThemeChange(() => charts.forEach((chart) => chart.recolour()));
