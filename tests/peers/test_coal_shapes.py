"""Coal's distances of spheres, capsules, boxes and hulls agree with ours within its tolerance."""

from __future__ import annotations

import itertools

import coal
import eigenpy
import numpy as np
import pytest

import hardbody as hb

PAIRS = 300
TOLERANCE = 1e-6  # Coal's own, of its search; its distances of apart bodies were within it


def hull_of(points: np.ndarray) -> tuple[hb.Shape, object]:
    vertices = coal.StdVec_Vec3s()
    for point in points:
        vertices.append(point)
    return hb.ConvexPolyhedron(points), coal.ConvexBase.convexHull(vertices, False, None)


def random_hull(random: np.random.Generator) -> tuple[hb.Shape, object]:
    while True:
        points = random.normal(size=(12, 3))
        points /= np.linalg.norm(points, axis=1, keepdims=True)
        try:
            return hull_of(points)
        except ValueError:  # the origin is outside
            continue


KINDS = {
    "sphere": lambda random: (hb.Sphere(0.7), coal.Sphere(0.7)),
    "capsule": lambda random: (hb.Capsule(1.5, 0.5), coal.Capsule(0.5, 3.0)),
    "box": lambda random: (hb.Box([1, 2, 0.5]), coal.Box(2, 4, 1)),
    "hull": random_hull,
}


@pytest.mark.parametrize(("a", "b"), list(itertools.combinations_with_replacement(KINDS, 2)))
def test_coal_finds_the_same_distances(a: str, b: str) -> None:
    random = np.random.default_rng(1)
    request = coal.DistanceRequest()
    assert request.gjk_tolerance == TOLERANCE
    apart = 0
    for _ in range(PAIRS):
        (ours_a, peer_a), (ours_b, peer_b) = KINDS[a](random), KINDS[b](random)
        p, q = random.uniform(-3, 3, 3), random.normal(size=(2, 4))
        q /= np.linalg.norm(q, axis=1, keepdims=True)
        r = hb.distance(ours_a, hb.Pose([0, 0, 0], q[0]), ours_b, hb.Pose(p, q[1]))
        poses = [coal.Transform3s(eigenpy.Quaternion(*turn), at) for turn, at in zip(q, (np.zeros(3), p), strict=True)]
        found = coal.distance(peer_a, poses[0], peer_b, poses[1], request, coal.DistanceResult())
        size = np.linalg.norm(p) + ours_a.bounding_radius + ours_b.bounding_radius
        assert r.error_bound <= 1e-13 * size
        if r.distance > 0:
            apart += 1
            assert abs(found - r.distance) <= TOLERANCE * size
    assert apart > PAIRS / 4
