// Nematic order of a frame.

/** Largest eigenvalue of Q = <3 u u - 1> / 2 and its eigenvector, by Jacobi's rotations. `axes`: x, y, z of each body. */
export function nematicOrder(axes) {
  const n = axes.length / 3;
  const Q = [[-0.5, 0, 0], [0, -0.5, 0], [0, 0, -0.5]];
  for (let k = 0; k < axes.length; k += 3) {
    for (let i = 0; i < 3; i += 1) for (let j = 0; j < 3; j += 1) Q[i][j] += (1.5 * axes[k + i] * axes[k + j]) / n;
  }
  const V = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < 12; sweep += 1) {
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) rotate(Q, V, p, q);
  }
  const best = [0, 1, 2].reduce((a, b) => (Q[b][b] > Q[a][a] ? b : a));
  return { S: Q[best][best], director: V.map((row) => row[best]) };
}

function rotate(Q, V, p, q) {
  if (Math.abs(Q[p][q]) < 1e-15) return;
  const angle = 0.5 * Math.atan2(2 * Q[p][q], Q[q][q] - Q[p][p]);
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  for (let k = 0; k < 3; k += 1) [Q[k][p], Q[k][q]] = [c * Q[k][p] - s * Q[k][q], s * Q[k][p] + c * Q[k][q]];
  for (let k = 0; k < 3; k += 1) [Q[p][k], Q[q][k]] = [c * Q[p][k] - s * Q[q][k], s * Q[p][k] + c * Q[q][k]];
  for (let k = 0; k < 3; k += 1) [V[k][p], V[k][q]] = [c * V[k][p] - s * V[k][q], s * V[k][p] + c * V[k][q]];
}
