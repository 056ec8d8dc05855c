"""Contact patches: known polygons; arrays are single answers."""

import numpy as np
import pytest
from conftest import unit_rows

import hardbody as hb


def test_boxes_that_lie_on_each_other():
    box = hb.Box([1, 1, 1])
    patch = hb.contact_patch(box, hb.Pose(), box, hb.Pose([0.5, 0.25, 1.9]))
    assert patch.kind == "polygon" and patch.area == pytest.approx(1.5 * 1.75, abs=1e-12)
    assert np.allclose(patch.depth, 0.1, atol=1e-14) and len(set(patch.id)) == 4
    assert np.allclose(patch.centre, [0.25, 0.125, 0.95], atol=1e-13)
    assert np.allclose(patch.point_a - patch.point_b, [0, 0, 0.1], atol=1e-13)
    tilted = hb.contact_patch(box, hb.Pose(), box, hb.Pose.normalized([0.5, 0.25, 1.9], [1, 1e-7, 2e-7, 0]))
    assert set(tilted.id) == set(patch.id)
    empty = hb.contact_patch(box, hb.Pose(), box, hb.Pose([0, 0, 3]), 0.9)
    assert empty.kind == "empty" and len(empty.depth) == 0 and np.isnan(empty.centre).all()


def test_half_spaces_and_shapes_written_in_python():
    class Ball:
        bounding_radius = inscribed_radius = 1.0

        def support(self, n):
            return np.linalg.norm(n), n / np.linalg.norm(n)

    floor = hb.HalfSpace(), hb.Pose()
    for ground, pose, ball in ((*floor, hb.Sphere(1)), (hb.Box([2, 2, 1]), hb.Pose([0, 0, -1]), Ball())):
        disc = hb.contact_patch(ground, pose, ball, hb.Pose([0, 0, 1]), 0.1, max_points=100)
        exact = np.pi * (1 - 0.9**2)
        assert exact * (1 - 1e-9) <= disc.area <= 1.02 * exact
        assert disc.error <= 0.01 * 2 * np.sqrt(1 - 0.9**2) * 1.1


def test_arrays_are_single_answers(random):
    shapes = [hb.Box([0.5, 0.6, 0.7]), hb.Superellipsoid([0.6, 0.6, 0.8], 0.4, 0.4), hb.Capsule(0.5, 0.4)]
    positions, quaternions = random.uniform(-1.2, 1.2, (24, 3)), unit_rows(random, 24, 4)
    shape_of = np.arange(24) % 3
    pairs = np.stack(np.triu_indices(24, 1), axis=1)[::3]
    many = hb.contact_patch_many(shapes, positions, quaternions, pairs, 0.1, shape_of, 2)
    assert many == hb.contact_patch_many(shapes, positions, quaternions, pairs, 0.1, shape_of, 1)
    assert {"empty", "polygon"} <= set(many.kind)
    X = [hb.Pose(p, q) for p, q in zip(positions, quaternions, strict=True)]
    for k, (i, j) in enumerate(pairs):
        one = hb.contact_patch(shapes[shape_of[i]], X[i], shapes[shape_of[j]], X[j], 0.1)
        mine = many.pair == k
        assert one.kind == many.kind[k]
        assert one.area == pytest.approx(many.area[k], rel=1e-3, abs=1e-6)
        if i % 3 == j % 3 == 0:  # two boxes: exact, but for the normal of deep overlaps
            assert len(one.depth) == mine.sum()
    assert "corners" in repr(many)
