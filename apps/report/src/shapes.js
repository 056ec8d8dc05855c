// Meshes of superellipsoids with semi-axes 1 from their implicit surface,
// (|x|^(2/e2) + |y|^(2/e2))^(e2/e1) + |z|^(2/e1) = 1: points along rays, normals from the gradient.
import { BufferAttribute, BufferGeometry } from 'three';

const power = (x, p) => Math.abs(x) ** p;
const signed = (x, p) => Math.sign(x) * Math.abs(x) ** p;

/** The norm whose unit ball the body is. */
function norm([x, y, z], p1, p2) {
  return power(power(power(x, p2) + power(y, p2), p1 / p2) + power(z, p1), 1 / p1);
}

/** Returns the direction of the gradient, of any length. */
function gradient([x, y, z], p1, p2) {
  const section = power(x, p2) + power(y, p2);
  const inner = section > 0 ? section ** (p1 / p2 - 1) : 0;
  return [inner * signed(x, p2 - 1), inner * signed(y, p2 - 1), signed(z, p1 - 1)];
}

function unit(v) {
  const length = Math.hypot(...v) || 1;
  return v.map((x) => x / length);
}

/** Directions through the knots of a grid on the faces of a cube, and the triangles between them. */
function cubeSphere(divisions) {
  const directions = [];
  const triangles = [];
  for (let face = 0; face < 6; face += 1) {
    const axis = face % 3;
    const side = face < 3 ? 1 : -1;
    const first = directions.length;
    for (let i = 0; i <= divisions; i += 1) {
      for (let j = 0; j <= divisions; j += 1) {
        const u = Math.tan((Math.PI / 4) * ((2 * i) / divisions - 1));
        const v = Math.tan((Math.PI / 4) * ((2 * j) / divisions - 1));
        const d = [0, 0, 0];
        d[axis] = side;
        d[(axis + 1) % 3] = u * side;
        d[(axis + 2) % 3] = v;
        directions.push(unit(d));
      }
    }
    const row = divisions + 1;
    for (let i = 0; i < divisions; i += 1) {
      for (let j = 0; j < divisions; j += 1) {
        const a = first + i * row + j;
        triangles.push(a, a + row, a + 1, a + 1, a + row, a + row + 1);
      }
    }
  }
  return { directions, triangles };
}

/** Returns a point half-way between the one that the direction looks at and the one whose normal it is: a grid that is
    fine where the surface is curved, and nowhere empty. */
function surfacePoint(direction, p1, p2) {
  const q1 = p1 / (p1 - 1);
  const q2 = p2 / (p2 - 1);
  const seen = unit(direction);
  const touched = unit(gradient(direction, q1, q2));
  const middle = unit(seen.map((x, k) => x + touched[k]));
  const length = norm(middle, p1, p2);
  return middle.map((x) => x / length);
}

export function superellipsoidGeometry([e1, e2], divisions) {
  const p1 = 2 / e1;
  const p2 = 2 / e2;
  const { directions, triangles } = cubeSphere(divisions);
  const points = directions.map((d) => surfacePoint(d, p1, p2));
  const normals = points.map((x) => unit(gradient(x, p1, p2)));
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(points.flat()), 3));
  geometry.setAttribute('normal', new BufferAttribute(new Float32Array(normals.flat()), 3));
  geometry.setIndex(triangles);
  return geometry;
}

// ---- Polytopes with a ball swept over them -------------------------------------------------------------------------

const minus = (a, b) => a.map((x, k) => x - b[k]);
const plus = (a, b, s = 1) => a.map((x, k) => x + s * b[k]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** Corners with normals, and the triangles between them. */
class Surface {
  constructor() {
    this.points = [];
    this.normals = [];
    this.triangles = [];
  }

  corner(point, normal) {
    this.points.push(point);
    this.normals.push(normal);
    return this.points.length - 1;
  }

  /** Adds a triangle whose front is on the side of its corners' normals. */
  triangle(a, b, c) {
    const [p, q, r] = [this.points[a], this.points[b], this.points[c]];
    const outward = plus(plus(this.normals[a], this.normals[b]), this.normals[c]);
    const front = dot(cross(minus(q, p), minus(r, p)), outward) >= 0;
    this.triangles.push(a, front ? b : c, front ? c : b);
  }

  /** Adds the quadrilaterals between two rows of corners of the same length. */
  strip(first, second) {
    for (let k = 0; k + 1 < first.length; k += 1) {
      this.triangle(first[k], first[k + 1], second[k]);
      this.triangle(second[k], first[k + 1], second[k + 1]);
    }
  }

  geometry() {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(this.points.flat()), 3));
    geometry.setAttribute('normal', new BufferAttribute(new Float32Array(this.normals.flat()), 3));
    geometry.setIndex(this.triangles);
    return geometry;
  }
}

/** Returns the normals from m to n in equal parts of their chord. */
function fan(m, n, parts) {
  return Array.from({ length: parts + 1 }, (_, k) => unit(plus(m.map((x) => x * (1 - k / parts)), n, k / parts)));
}

/** Adds the ball swept along a segment: rings about it, half of them about each end. */
function addCapsule(surface, [from, to], rounding, divisions) {
  const axis = unit(minus(to, from));
  const across = unit(cross(axis, Math.abs(axis[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0]));
  const third = cross(axis, across);
  const around = 4 * divisions;
  let before = null;
  for (const [end, side] of [[from, -1], [to, 1]]) {
    for (let i = 0; i <= divisions; i += 1) {
      const height = (side * (Math.PI / 2) * (side < 0 ? divisions - i : i)) / divisions;
      const ring = Array.from({ length: around + 1 }, (_, k) => {
        const turn = (2 * Math.PI * k) / around;
        const flat = plus(across.map((x) => x * Math.cos(turn)), third, Math.sin(turn));
        const normal = plus(flat.map((x) => x * Math.cos(height)), axis, Math.sin(height));
        return surface.corner(plus(end, normal, rounding), normal);
      });
      if (before) surface.strip(before, ring);
      before = ring;
    }
  }
}

/** Adds the part of the ball about a corner between the normals of its faces. */
function addCorner(surface, vertex, normals, rounding, parts) {
  const middle = unit(normals.reduce((sum, n) => plus(sum, n)));
  const across = unit(cross(middle, normals[0]));
  const third = cross(middle, across);
  const angle = (n) => Math.atan2(dot(n, third), dot(n, across));
  const ordered = [...normals].sort((m, n) => angle(m) - angle(n));
  ordered.forEach((m, k) => {
    const n = ordered[(k + 1) % ordered.length];
    let before = null;
    for (let i = 0; i <= parts; i += 1) {
      const share = i / parts;
      const begin = unit(plus(middle.map((x) => x * (1 - share)), m, share));
      const end = unit(plus(middle.map((x) => x * (1 - share)), n, share));
      const row = (i === 0 ? [middle] : fan(begin, end, i)).map((x) => surface.corner(plus(vertex, x, rounding), x));
      if (before) {
        for (let j = 0; j < i; j += 1) {
          surface.triangle(before[j], row[j], row[j + 1]);
          if (j + 1 < i) surface.triangle(before[j], row[j + 1], before[j + 1]);
        }
      }
      before = row;
    }
  });
}

/** Returns the mesh of a polytope with a ball swept over it: flat faces, with rounded edges and corners if there is a
    ball; of two vertices a capsule. */
export function polytopeGeometry({ vertices, faces, rounding }, divisions) {
  const surface = new Surface();
  if (vertices.length === 2) {
    addCapsule(surface, vertices, rounding, divisions);
    return surface.geometry();
  }
  const parts = Math.max(2, Math.ceil(divisions / 3));
  const edges = new Map();
  const corners = vertices.map(() => []);
  for (const face of faces) {
    const [a, b, c] = face.map((k) => vertices[k]);
    const normal = unit(cross(minus(b, a), minus(c, a)));
    const flat = face.map((k) => surface.corner(plus(vertices[k], normal, rounding), normal));
    for (let k = 1; k + 1 < flat.length; k += 1) surface.triangle(flat[0], flat[k], flat[k + 1]);
    face.forEach((k, place) => {
      corners[k].push(normal);
      const next = face[(place + 1) % face.length];
      const key = `${Math.min(k, next)},${Math.max(k, next)}`;
      edges.set(key, [...(edges.get(key) ?? []), normal]);
    });
  }
  if (rounding > 0) {
    for (const [key, [m, n]] of edges) {
      const rows = key.split(',').map((k) => fan(m, n, parts).map((x) => surface.corner(plus(vertices[k], x, rounding), x)));
      surface.strip(rows[0], rows[1]);
    }
    // Vertices that are within a face or an edge, to rounding, are corners of no face.
    corners.forEach((normals, k) => {
      if (normals.length > 0) addCorner(surface, vertices[k], normals, rounding, parts);
    });
  }
  return surface.geometry();
}
