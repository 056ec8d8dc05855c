"""Proof of a distance of two ellipsoids, from their equations alone, in a few lines of NumPy."""

from __future__ import annotations

import numpy as np

import hardbody as hb


class Ellipsoids:
    """Random pairs of ellipsoids; bodies 2k and 2k + 1 are a pair."""

    def __init__(self, number: int, seed: int) -> None:
        random = np.random.default_rng(seed)
        self.axes = np.exp(random.uniform(np.log(0.3), np.log(3), (2 * number, 3)))
        q = random.normal(size=(2 * number, 4))
        self.quaternions = q / np.linalg.norm(q, axis=1, keepdims=True)
        direction = random.normal(size=(number, 3))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        self.positions = np.zeros((2 * number, 3))
        self.positions[1::2] = direction * random.uniform(1.5, 9, (number, 1))
        self.pairs = np.arange(2 * number).reshape(number, 2)
        self.shapes = [hb.Ellipsoid(axes) for axes in self.axes]
        self.rotations = np.array([hb.Pose([0, 0, 0], q).rotation for q in self.quaternions])

    def distances(self) -> hb.Distances:
        return hb.distance_many(self.shapes, self.positions, self.quaternions, self.pairs)

    def interval(self, found: hb.Distances) -> tuple[np.ndarray, np.ndarray]:
        """Bounds of the true distances of separate pairs, from the normals and points found.

        Lower: planes across the normal n touch A from within and B from within: the gap between them, by the support
        heights |D R^T n|. Upper: the points' distance, once they are proved to be in the bodies by the equations
        |D^-1 R^T (x - p)| <= 1; a point that rounding has left outside is drawn in along its ray from the centre.
        """
        heights, points = [], []
        for side, n, x in ((0, found.normal, found.point_a), (1, -found.normal, found.point_b)):
            R, D, p = self.rotations[side::2], self.axes[side::2], self.positions[side::2]
            heights.append(np.linalg.norm(D * np.einsum("kji,kj->ki", R, n), axis=1) + (n * p).sum(axis=1))
            outside = np.linalg.norm(np.einsum("kji,kj->ki", R, x - p) / D, axis=1, keepdims=True)
            assert (outside < 1 + 1e-9).all()
            points.append(p + (x - p) / np.maximum(outside, 1))
        lower = -(heights[0] + heights[1]) / np.linalg.norm(found.normal, axis=1)
        return lower, np.linalg.norm(points[1] - points[0], axis=1)

    def depths(self, pair: int, directions: np.ndarray) -> np.ndarray:
        """Lengths of the translations along directions that separate a pair: its depth is the least of all."""
        heights = []
        for body, n in ((2 * pair, directions), (2 * pair + 1, -directions)):
            heights.append(np.linalg.norm(self.axes[body] * (n @ self.rotations[body]), axis=1) + n @ self.positions[body])
        return heights[0] + heights[1]
