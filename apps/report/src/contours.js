// Isolines of values on the knots of a grid, linear in between.

/** Returns the point of a straight edge between two points with values that has the level. */
function crossing(a, b, level) {
  const share = (level - a.v) / (b.v - a.v);
  return [a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)];
}

function triangleSegment(corners, level) {
  const points = [];
  for (let k = 0; k < 3; k += 1) {
    const a = corners[k];
    const b = corners[(k + 1) % 3];
    if ((a.v < level) !== (b.v < level)) points.push(crossing(a, b, level));
  }
  return points.length === 2 ? points : null;
}

/** The triangles of a cell: four around its middle where all corners are known, else one of three corners. */
function triangles(corners) {
  const known = corners.filter((c) => c !== null);
  if (known.length < 3) return [];
  if (known.length === 3) return [known];
  const middle = { x: 0, y: 0, v: 0 };
  for (const c of known) for (const key of ['x', 'y', 'v']) middle[key] += c[key] / 4;
  return known.map((c, k) => [c, known[(k + 1) % 4], middle]);
}

const near = ([ax, ay], [bx, by]) => Math.abs(ax - bx) + Math.abs(ay - by) < 1e-9;

/** Segments put together to lines, as long as they go on. */
function chained(segments) {
  const keyed = new Map();
  const key = ([x, y]) => `${x.toFixed(7)},${y.toFixed(7)}`;
  segments.forEach((s) => s.forEach((p) => {
    if (!keyed.has(key(p))) keyed.set(key(p), []);
    keyed.get(key(p)).push(s);
  }));
  const used = new Set();
  const grow = (line, atEnd) => {
    for (;;) {
      const tip = atEnd ? line[line.length - 1] : line[0];
      const next = keyed.get(key(tip)).find((s) => !used.has(s));
      if (!next) return;
      used.add(next);
      const other = near(next[0], tip) ? next[1] : next[0];
      if (atEnd) line.push(other);
      else line.unshift(other);
    }
  };
  const lines = [];
  for (const s of segments) {
    if (used.has(s)) continue;
    used.add(s);
    const line = [...s];
    grow(line, true);
    grow(line, false);
    lines.push(line);
  }
  return lines;
}

/** `value(i, j)`: at knot (xs[i], ys[j]), or null. Lines as lists of [x, y]. */
export function isolines(xs, ys, value, level) {
  const segments = [];
  const corner = (i, j) => {
    const v = value(i, j);
    return v === null ? null : { x: xs[i], y: ys[j], v };
  };
  for (let i = 0; i + 1 < xs.length; i += 1) {
    for (let j = 0; j + 1 < ys.length; j += 1) {
      for (const t of triangles([corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)])) {
        const segment = triangleSegment(t, level);
        if (segment && !near(segment[0], segment[1])) segments.push(segment);
      }
    }
  }
  return chained(segments);
}

/** Returns about `count` round levels strictly between low and high. */
export function levels(low, high, count, logarithmic) {
  if (!(high > low)) return [];
  if (logarithmic) {
    const decades = Math.log10(high / low);
    const steps = decades > 3 ? [1] : decades > 1.2 ? [1, 2, 5] : [1, 1.5, 2, 3, 4, 5, 6, 8];
    const list = [];
    for (let k = Math.floor(Math.log10(low)); k <= Math.log10(high); k += 1) for (const s of steps) list.push(s * 10 ** k);
    return list.filter((x) => x > low && x < high);
  }
  const raw = (high - low) / count;
  const decade = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].find((s) => s * decade >= raw) * decade;
  const list = [];
  for (let k = Math.ceil(low / step); k * step < high; k += 1) if (k * step > low) list.push(k * step);
  return list;
}
