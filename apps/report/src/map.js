// A map over two swept keys: a cell a state point, isolines between them, and the point that is chosen.
import { rampColour, cssRgb } from './colours.js';
import { isolines, levels } from './contours.js';
import { cssColour, download, h } from './dom.js';
import { estimate, short } from './format.js';
import { onThemeChange } from './theme.js';

const kMargin = { left: 68, right: 92, top: 14, bottom: 50 };
const kFont = '12px -apple-system, "Segoe UI", Inter, Roboto, "Noto Sans", "Liberation Sans", Arial, system-ui, sans-serif';

/** Returns a measure of how unequal the steps are: 0 for an even ladder. */
function unevenness(places) {
  const steps = places.slice(1).map((p, k) => p - places[k]);
  const mean = steps.reduce((sum, s) => sum + s, 0) / steps.length;
  return Math.max(...steps.map((s) => Math.abs(s / mean - 1)));
}

/** An axis of values: numbers, on a logarithmic scale if their steps are more even there, or names. */
export function makeAxis(values) {
  const unique = [...new Set(values)];
  const numeric = unique.every((v) => typeof v === 'number');
  if (!numeric) return { values: unique, places: unique.map((v, k) => k), text: (v) => String(v), numeric };
  unique.sort((a, b) => a - b);
  const logarithmic = unique[0] > 0 && unique.length > 2 && unique[unique.length - 1] / unique[0] >= 4
    && unevenness(unique.map(Math.log10)) < unevenness(unique);
  return { values: unique, places: unique.map((v) => (logarithmic ? Math.log10(v) : v)), text: (v) => short(v, 3), numeric, logarithmic };
}

/** Borders of cells: half-way between the values. */
function borders(places) {
  const n = places.length;
  if (n === 1) return [places[0] - 0.5, places[0] + 0.5];
  const inner = places.slice(1).map((p, k) => (p + places[k]) / 2);
  return [places[0] - (inner[0] - places[0]), ...inner, places[n - 1] + (places[n - 1] - inner[n - 2])];
}

export class SweepMap {
  /** Function that draws the contour lines, for tests. */
  static isolines = isolines;

  /** `onChoose(i, j)`, of the axes' indices. */
  constructor(onChoose) {
    this.onChoose = onChoose;
    this.cursor = [0, 0];
    this.canvas = h('canvas', { tabindex: 0, role: 'application', 'aria-roledescription': 'map' });
    this.tip = h('div', { class: 'tip', hidden: true });
    this.live = h('p', { class: 'hidden', 'aria-live': 'polite' });
    this.element = h('div', { class: 'map' }, this.canvas, this.tip, this.live);
    this.canvas.addEventListener('pointermove', (event) => this.hover(this.cellAt(event)));
    this.canvas.addEventListener('pointerleave', () => this.hover(null));
    this.canvas.addEventListener('click', (event) => this.choose(this.cellAt(event)));
    this.canvas.addEventListener('keydown', (event) => this.key(event));
    this.canvas.addEventListener('focus', () => this.draw());
    this.canvas.addEventListener('blur', () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.element);
    onThemeChange(() => this.draw());
  }

  /** `cell(i, j)`: {value, error, text, status} or null; `title`: the observable with its unit. */
  show({ x, y, xLabel, yLabel, cell, title, logarithmic, lines }) {
    Object.assign(this, { x, y, xLabel, yLabel, cell, title, logarithmic, lines });
    const all = [];
    for (let i = 0; i < x.values.length; i += 1) for (let j = 0; j < y.values.length; j += 1) all.push(this.value(i, j));
    const known = all.filter((v) => v !== null && (!logarithmic || v > 0));
    this.low = Math.min(...known);
    this.high = Math.max(...known);
    this.known = known.length;
    this.canvas.setAttribute('aria-label',
      `Map of ${title} over ${xLabel} and ${yLabel}, ${known.length} points; arrow keys move, Enter opens a point`);
    this.draw();
  }

  value(i, j) {
    const cell = this.cell(i, j);
    return cell && Number.isFinite(cell.value) ? cell.value : null;
  }

  /** 0 to 1 on the scale of colours. */
  share(value) {
    if (this.high === this.low) return 0.5;
    if (this.logarithmic) return Math.log(value / this.low) / Math.log(this.high / this.low);
    return (value - this.low) / (this.high - this.low);
  }

  // ---- Drawing -------------------------------------------------------------------------------------------------------

  geometry() {
    const width = this.element.clientWidth;
    const narrow = width < 480;
    const margin = narrow ? { ...kMargin, left: 60, right: 66 } : kMargin;
    const height = Math.round(Math.min(560, Math.max(300, width * 0.62)));
    const [bx, by] = [borders(this.x.places), borders(this.y.places)];
    const spanX = width - margin.left - margin.right;
    const spanY = height - margin.top - margin.bottom;
    return { width, height, margin, bx, by,
      px: (p) => margin.left + ((p - bx[0]) / (bx[bx.length - 1] - bx[0])) * spanX,
      py: (p) => margin.top + spanY - ((p - by[0]) / (by[by.length - 1] - by[0])) * spanY };
  }

  draw() {
    if (!this.x || !this.element.clientWidth) return;
    const g = this.geometry();
    if (g.width <= g.margin.left + g.margin.right) return;
    this.g = g;
    const ratio = window.devicePixelRatio;
    this.canvas.width = Math.round(g.width * ratio);
    this.canvas.height = Math.round(g.height * ratio);
    this.canvas.style.height = `${g.height}px`;
    const ctx = this.canvas.getContext('2d');
    ctx.scale(ratio, ratio);
    ctx.font = kFont;
    this.drawCells(ctx, g);
    if (this.lines) this.drawLines(ctx, g);
    this.drawAxes(ctx, g);
    this.drawScale(ctx, g);
    if (this.chosen) this.frame(ctx, g, this.chosen, cssColour('--ink'), 2.5);
    if (document.activeElement === this.canvas) this.frame(ctx, g, this.cursor, cssColour('--accent'), 2.5, [4, 3]);
  }

  rectangle(g, [i, j]) {
    const left = g.px(g.bx[i]);
    const top = g.py(g.by[j + 1]);
    return [left, top, g.px(g.bx[i + 1]) - left, g.py(g.by[j]) - top];
  }

  drawCells(ctx, g) {
    for (let i = 0; i < this.x.values.length; i += 1) {
      for (let j = 0; j < this.y.values.length; j += 1) {
        const [left, top, width, height] = this.rectangle(g, [i, j]);
        const cell = this.cell(i, j);
        const value = this.value(i, j);
        const drawn = value !== null && (!this.logarithmic || value > 0);
        ctx.fillStyle = drawn ? cssRgb(rampColour(this.share(value))) : cssColour('--well');
        // Overlapping by half a pixel: no seams.
        ctx.fillRect(left, top, width + 0.5, height + 0.5);
        const at = [g.px(this.x.places[i]), g.py(this.y.places[j])];
        if (!drawn && cell) this.mark(ctx, ...at, cell.status === 'failed');
        if (drawn && cell.open) this.ring(ctx, ...at, this.share(value), Math.min(width, height));
      }
    }
  }

  /** A cross for what failed, a dot for what is not known. */
  mark(ctx, x, y, failed) {
    ctx.strokeStyle = ctx.fillStyle = cssColour(failed ? '--bad' : '--muted');
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    if (failed) {
      ctx.moveTo(x - 4, y - 4);
      ctx.lineTo(x + 4, y + 4);
      ctx.moveTo(x + 4, y - 4);
      ctx.lineTo(x - 4, y + 4);
      ctx.stroke();
    } else {
      ctx.arc(x, y, 1.6, 0, 2 * Math.PI);
      ctx.fill();
    }
  }

  /** An open circle for what was not shown to be equilibrated. */
  ring(ctx, x, y, share, room) {
    ctx.strokeStyle = share > 0.55 ? 'rgb(20 30 40 / 85%)' : 'rgb(255 255 255 / 90%)';
    ctx.lineWidth = 1.4;
    ctx.beginPath();
    ctx.arc(x, y, Math.min(4, 0.35 * room), 0, 2 * Math.PI);
    ctx.stroke();
  }

  /** Draws contour lines, of logarithms where colours are. */
  drawLines(ctx, g) {
    const scale = (v) => (this.logarithmic ? Math.log(v) : v);
    const at = (i, j) => {
      const v = this.value(i, j);
      return v === null || (this.logarithmic && v <= 0) ? null : scale(v);
    };
    this.levels = levels(this.low, this.high, 8, this.logarithmic);
    this.segments = 0;
    const labels = [];
    for (const level of this.levels) {
      for (const line of isolines(this.x.places, this.y.places, at, scale(level))) {
        const points = line.map(([x, y]) => [g.px(x), g.py(y)]);
        this.segments += points.length - 1;
        this.stroke(ctx, points, this.share(level));
        labels.push({ points, level });
      }
    }
    const placed = [];
    for (const { points, level } of labels) this.label(ctx, points, level, placed);
  }

  stroke(ctx, points, share) {
    ctx.beginPath();
    points.forEach(([x, y], k) => (k ? ctx.lineTo(x, y) : ctx.moveTo(x, y)));
    ctx.strokeStyle = share > 0.55 ? 'rgb(20 30 40 / 75%)' : 'rgb(255 255 255 / 80%)';
    ctx.lineWidth = 1.2;
    ctx.lineJoin = 'round';
    ctx.stroke();
  }

  /** Writes the level along the line, in its middle, where there is room. */
  label(ctx, points, level, placed) {
    const text = short(level, 3);
    const width = ctx.measureText(text).width;
    const length = points.slice(1).reduce((sum, [x, y], k) => sum + Math.hypot(x - points[k][0], y - points[k][1]), 0);
    if (length < 2.5 * width) return;
    const [x, y] = points[Math.floor(points.length / 2)];
    if (placed.some(([a, b]) => Math.abs(a - x) < width + 14 && Math.abs(b - y) < 18)) return;
    placed.push([x, y]);
    const share = this.share(level);
    ctx.fillStyle = cssRgb(rampColour(share));
    ctx.beginPath();
    ctx.roundRect(x - width / 2 - 4, y - 8, width + 8, 16, 4);
    ctx.fill();
    ctx.fillStyle = share > 0.55 ? '#14202b' : '#ffffff';
    ctx.textAlign = 'center';
    ctx.textBaseline = 'middle';
    ctx.fillText(text, x, y + 0.5);
  }

  drawAxes(ctx, g) {
    ctx.fillStyle = cssColour('--muted');
    ctx.textBaseline = 'middle';
    const bottom = g.height - g.margin.bottom;
    let last = -Infinity;
    ctx.textAlign = 'center';
    this.x.values.forEach((v, i) => {
      const x = g.px(this.x.places[i]);
      const text = this.x.text(v);
      if (x - last < ctx.measureText(text).width + 14) return;
      ctx.fillText(text, x, bottom + 14);
      last = x;
    });
    last = Infinity;
    ctx.textAlign = 'right';
    this.y.values.forEach((v, j) => {
      const y = g.py(this.y.places[j]);
      if (last - y < 18) return;
      ctx.fillText(this.y.text(v), g.margin.left - 8, y);
      last = y;
    });
    ctx.textAlign = 'center';
    ctx.fillStyle = cssColour('--soft');
    ctx.fillText(this.xLabel, (g.margin.left + g.width - g.margin.right) / 2, g.height - 12);
    ctx.save();
    ctx.translate(12, (g.margin.top + bottom) / 2);
    ctx.rotate(-Math.PI / 2);
    ctx.fillText(this.yLabel, 0, 0);
    ctx.restore();
  }

  drawScale(ctx, g) {
    if (!this.known) return;
    const left = g.width - g.margin.right + 18;
    const height = g.height - g.margin.top - g.margin.bottom;
    for (let k = 0; k < height; k += 1) {
      ctx.fillStyle = cssRgb(rampColour(1 - k / height));
      ctx.fillRect(left, g.margin.top + k, 12, 1.5);
    }
    ctx.fillStyle = cssColour('--muted');
    ctx.textAlign = 'left';
    const marks = this.high > this.low ? [this.low, ...levels(this.low, this.high, 8, this.logarithmic), this.high] : [this.low];
    let last = Infinity;
    for (const mark of marks) {
      const y = Math.min(g.margin.top + height - 6, Math.max(g.margin.top + 6, g.margin.top + height * (1 - this.share(mark))));
      const edge = mark === this.low || mark === this.high;
      if (last - y < 15 || (!edge && y - g.margin.top < 21)) continue;
      ctx.fillText(short(mark, 3), left + 18, y);
      last = y;
    }
  }

  frame(ctx, g, cell, colour, width, dash = []) {
    const [left, top, w, height] = this.rectangle(g, cell);
    ctx.setLineDash(dash);
    ctx.lineWidth = width + 2;
    ctx.strokeStyle = cssColour('--card');
    ctx.strokeRect(left, top, w, height);
    ctx.lineWidth = width;
    ctx.strokeStyle = colour;
    ctx.strokeRect(left, top, w, height);
    ctx.setLineDash([]);
  }

  // ---- Pointer and keys ----------------------------------------------------------------------------------------------

  cellAt(event) {
    if (!this.g) return null;
    const find = (edges, place, at) => edges.slice(1).findIndex((edge, k) => {
      const [a, b] = [place(edges[k]), place(edge)];
      return at >= Math.min(a, b) && at <= Math.max(a, b);
    });
    const i = find(this.g.bx, this.g.px, event.offsetX);
    const j = find(this.g.by, this.g.py, event.offsetY);
    return i < 0 || j < 0 ? null : [i, j];
  }

  describe([i, j]) {
    const cell = this.cell(i, j);
    const where = `${this.xLabel} ${this.x.text(this.x.values[i])}, ${this.yLabel} ${this.y.text(this.y.values[j])}`;
    if (!cell) return [where, 'no such point'];
    const text = estimate(cell.value, cell.error);
    const open = cell.open ? ', not shown to be equilibrated' : '';
    if (text) return [where, `${this.title}: ${text.value}${text.error ? ` ± ${text.error}` : ''}${open}`];
    return [where, cell.status === 'done' ? cell.missing || 'no value' : `${cell.status}${cell.message ? `: ${cell.message}` : ''}`];
  }

  hover(cell) {
    this.tip.hidden = !cell;
    if (!cell) return;
    const [where, what] = this.describe(cell);
    this.tip.replaceChildren(h('span', {}, where), h('b', {}, what));
    const [left, top, width] = this.rectangle(this.g, cell);
    const x = Math.min(this.g.width - this.tip.offsetWidth - 4, Math.max(4, left + width / 2 - this.tip.offsetWidth / 2));
    this.tip.style.transform = `translate(${x}px, ${Math.max(2, top - this.tip.offsetHeight - 8)}px)`;
  }

  choose(cell) {
    if (!cell || !this.cell(...cell)) return;
    this.chosen = cell;
    this.cursor = cell;
    this.draw();
    this.onChoose(...cell);
  }

  key(event) {
    const move = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!move && event.key !== 'Enter' && event.key !== ' ') return;
    event.preventDefault();
    if (!move) {
      this.choose(this.cursor);
      return;
    }
    const within = (k, n) => Math.min(n - 1, Math.max(0, k));
    this.cursor = [within(this.cursor[0] + move[0], this.x.values.length), within(this.cursor[1] + move[1], this.y.values.length)];
    this.live.textContent = this.describe(this.cursor).join(': ');
    this.hover(this.cursor);
    this.draw();
  }

  savePicture(name) {
    const copy = h('canvas', { width: this.canvas.width, height: this.canvas.height });
    const ctx = copy.getContext('2d');
    ctx.fillStyle = cssColour('--card');
    ctx.fillRect(0, 0, copy.width, copy.height);
    ctx.drawImage(this.canvas, 0, 0);
    copy.toBlob((blob) => download(name, blob));
  }
}
