"""Coal's distances of shapes with faces, edges, rims and caps agree with ours within its tolerance.

A proof of a few lines of NumPy, from the equations of the bodies alone, shows that the true distance is ours, so that
the difference is Coal's.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import coal
import eigenpy
import numpy as np
import pytest
from scipy.spatial import ConvexHull

import hardbody as hb

PAIRS = 300
TOLERANCE = 1e-6  # Coal's own, of its search; its distances of apart bodies were within it
ROUNDING = 1e-13  # accuracy of our distances, of the size of the pair

Vector = np.ndarray


@dataclass
class Body:
    """Shape of both programs, with its equations: height max n.x over the body, and the violation of a point, a length,
    at most 0 inside."""

    ours: Any
    peer: Any
    height: Callable[[Vector], float]
    violation: Callable[[Vector], float]


def sphere(_: np.random.Generator) -> Body:
    return Body(hb.Sphere(0.7), coal.Sphere(0.7), lambda n: 0.7, lambda x: np.linalg.norm(x) - 0.7)


def capsule(_: np.random.Generator) -> Body:
    def violation(x: Vector) -> float:
        return float(np.linalg.norm(x - [0, 0, np.clip(x[2], -1.5, 1.5)]) - 0.5)

    return Body(hb.Capsule(1.5, 0.5), coal.Capsule(0.5, 3.0), lambda n: 1.5 * abs(n[2]) + 0.5, violation)


def box(_: np.random.Generator) -> Body:
    half = np.array([1, 2, 0.5])
    return Body(hb.Box(half), coal.Box(2, 4, 1), lambda n: half @ np.abs(n), lambda x: (np.abs(x) - half).max())


def cylinder(_: np.random.Generator) -> Body:
    half, radius = 1.2, 0.6

    def violation(x: Vector) -> float:
        return float(max(abs(x[2]) - half, np.hypot(x[0], x[1]) - radius))

    def height(n: Vector) -> float:
        return float(half * abs(n[2]) + radius * np.hypot(n[0], n[1]))

    return Body(hb.Cylinder(half, radius), coal.Cylinder(radius, 2 * half), height, violation)


def cone(_: np.random.Generator) -> Body:
    """Coal's cones have the origin half way between base and apex."""
    half, radius = 1.0, 0.8

    def violation(x: Vector) -> float:
        return float(max(-half - x[2], np.hypot(x[0], x[1]) - radius * (half - x[2]) / (2 * half)))

    def height(n: Vector) -> float:
        return float(max(half * n[2], -half * n[2] + radius * np.hypot(n[0], n[1])))

    return Body(hb.Cone(2 * half, radius, -half), coal.Cone(radius, 2 * half), height, violation)


def hull(random: np.random.Generator) -> Body:
    while True:
        points = random.normal(size=(12, 3))
        points /= np.linalg.norm(points, axis=1, keepdims=True)
        planes = ConvexHull(points).equations
        if planes[:, 3].max() < -1e-3:  # the origin is inside
            break
    vertices = coal.StdVec_Vec3s()
    for point in points:
        vertices.append(point)
    peer = coal.ConvexBase.convexHull(vertices, False, None)
    return Body(
        hb.ConvexPolyhedron(points),
        peer,
        lambda n: float((points @ n).max()),
        lambda x: float((planes[:, :3] @ x + planes[:, 3]).max()),
    )


KINDS = {f.__name__: f for f in (sphere, capsule, box, hull, cylinder, cone)}


def prove(a: Body, X: hb.Pose, b: Body, Y: hb.Pose, r: hb.DistanceResult, size: float) -> None:
    """Bounds of the true distance: planes across the normal touch both bodies, and the points are in them."""
    n = r.normal
    lower = n @ (Y.position - X.position) - a.height(X.rotation.T @ n) - b.height(-(Y.rotation.T @ n))
    assert abs(lower - r.distance) <= ROUNDING * size
    assert abs(np.linalg.norm(r.point_b - r.point_a) - r.distance) <= ROUNDING * size
    assert a.violation(X.apply_inverse(r.point_a)) <= ROUNDING * size
    assert b.violation(Y.apply_inverse(r.point_b)) <= ROUNDING * size


@pytest.mark.parametrize(("a", "b"), list(itertools.combinations_with_replacement(KINDS, 2)))
def test_coal_finds_the_same_distances(a: str, b: str) -> None:
    random = np.random.default_rng(1)
    request = coal.DistanceRequest()
    assert request.gjk_tolerance == TOLERANCE
    apart = 0
    for _ in range(PAIRS):
        A, B = KINDS[a](random), KINDS[b](random)
        p, q = random.uniform(-3, 3, 3), random.normal(size=(2, 4))
        q /= np.linalg.norm(q, axis=1, keepdims=True)
        X, Y = hb.Pose([0, 0, 0], q[0]), hb.Pose(p, q[1])
        r = hb.distance(A.ours, X, B.ours, Y)
        size = np.linalg.norm(p) + A.ours.bounding_radius + B.ours.bounding_radius
        # Depths of cylinders and cones are found by iteration.
        assert r.error_bound <= ROUNDING * size or (r.distance < 0 and {a, b} & {"cylinder", "cone"})
        if not r.distance > 0:
            continue
        apart += 1
        prove(A, X, B, Y, r, size)
        poses = [coal.Transform3s(eigenpy.Quaternion(*turn), at) for turn, at in zip(q, (np.zeros(3), p), strict=True)]
        found = coal.distance(A.peer, poses[0], B.peer, poses[1], request, coal.DistanceResult())
        assert abs(found - r.distance) <= TOLERANCE * size
    assert apart > PAIRS / 4
