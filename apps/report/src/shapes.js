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
