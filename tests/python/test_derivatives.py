"""Derivatives of distances against differences of distances, which are sharper in tests/unit/geom/derivatives."""

import numpy as np
import pytest
from conftest import unit_rows

import hardbody as hb

SHAPES = [
    hb.Ellipsoid([0.6, 0.8, 1.0]),
    hb.Superellipsoid([0.6, 0.8, 1.0], 0.7, 0.8),
    hb.Capsule(0.5, 0.4),
    hb.Box([0.4, 0.5, 0.6]),
    hb.Cylinder(0.6, 0.4),
    hb.Sphere(0.5),
]


def turned(pose: hb.Pose, x: np.ndarray) -> hb.Pose:
    """Pose moved by x[:3] and turned by the vector x[3:], radian, in the world frame."""
    angle = np.linalg.norm(x[3:])
    R = np.asarray(pose.rotation)
    if angle > 0:
        u = x[3:] / angle
        K = np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
        R = (np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K) @ R
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = R, np.asarray(pose.position) + x[:3]
    return hb.Pose.nearest(matrix)


def central(f, h):
    """Derivative at 0, of fourth order."""
    return (8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h)


def random_pair(random, k):
    a, b = SHAPES[k % 6], SHAPES[(k // 6) % 6]
    q = unit_rows(random, 2, 4)
    direction = unit_rows(random, 1, 3)[0]
    return a, hb.Pose([0.1, 0.2, 0.3], q[0]), b, hb.Pose(2.8 * direction, q[1])


def check_derivatives(pair, d: hb.Derivatives, v: np.ndarray) -> None:
    """Checks derivatives against differences, second ones along v, and against each other."""
    a, pose_a, b, pose_b = pair

    def at(x, query=hb.distance):
        return query(a, turned(pose_a, x[:6]), b, turned(pose_b, x[6:]))

    for i, axis in enumerate(np.eye(12)):
        found = central(lambda h, axis=axis: at(h * axis).distance, 3e-4)
        assert found == pytest.approx(d.gradient[i], abs=1e-8)
    scale = np.linalg.norm(d.hessian)
    # The gradient is (-n, n x s_A, n, s_B x n), s the points less the positions.
    assert np.allclose(d.hessian[6:9], d.normal, atol=1e-9 * scale)
    arm = np.asarray(d.at.point_a) - pose_a.position
    arms = d.point_a.copy()
    arms[:, :3] -= np.eye(3)
    torque = np.cross(d.normal, arm, axis=0) + np.cross(np.asarray(d.at.normal), arms, axis=0)
    torque[:, 3:6] = (torque[:, 3:6] + torque[:, 3:6].T) / 2  # two turns do not commute
    assert np.allclose(d.hessian[3:6], torque, atol=1e-6 * scale)
    # Turns about a fixed vector add up, so that the second derivative along v is that of the Hessian.
    second = central(lambda h: at(h * v, hb.distance_derivatives).gradient @ v, 1e-3)
    assert second == pytest.approx(v @ d.hessian @ v, abs=1e-7 * scale)
    assert np.allclose(d.hessian, d.hessian.T, atol=1e-14 * scale)


def test_gradients_and_hessians_are_those_of_distances(random):
    full = 0
    for k in range(36):
        pair = random_pair(random, k)
        d = hb.distance_derivatives(*pair)
        assert d.at == hb.distance(*pair)
        if d.status == "twice":
            full += 1
            check_derivatives(pair, d, unit_rows(random, 1, 12)[0])
    assert full >= 30


def test_arrays_are_single_answers(random):
    positions = random.uniform(-3, 3, (40, 3))
    quaternions = unit_rows(random, 40, 4)
    shape_of = np.arange(40) % 6
    pairs = random.permutation(np.stack(np.triu_indices(40, 1), axis=1))[:200]
    many = hb.distance_derivatives_many(SHAPES, positions, quaternions, pairs, shape_of, threads=2)
    assert many.at == hb.distance_many(SHAPES, positions, quaternions, pairs, shape_of)
    assert many.hessian.shape == (200, 12, 12) and many.normal.shape == (200, 3, 12)
    twice = 0
    for k, (i, j) in enumerate(pairs):
        poses = [hb.Pose(positions[b], quaternions[b]) for b in (i, j)]
        one = hb.distance_derivatives(SHAPES[shape_of[i]], poses[0], SHAPES[shape_of[j]], poses[1])
        if many.at.distance[k] > 0:
            assert one.status == many.status[k]
        if one.status == many.status[k] == "twice" and many.at.distance[k] > 0:
            twice += 1
            assert np.allclose(one.gradient, many.gradient[k], atol=1e-9)
            scale = np.linalg.norm(one.hessian)
            assert np.allclose(one.hessian, many.hessian[k], atol=1e-7 * scale)
    assert twice > 50
    first = hb.distance_derivatives_many(SHAPES, positions, quaternions, pairs, shape_of, second=False)
    assert (
        first.hessian is None and first.normal is None and np.array_equal(first.gradient, many.gradient, equal_nan=True)
    )
    assert "twice" in repr(many) and len(many) == 200
    one_thread = hb.distance_derivatives_many(SHAPES, positions, quaternions, pairs, shape_of)
    assert one_thread == many


def test_where_derivatives_do_not_exist():
    box = hb.Box([1, 1, 1])
    faces = hb.distance_derivatives(box, hb.Pose(), box, hb.Pose([3, 0.3, 0.2]))
    assert faces.status == "by_position" and faces.gradient[0] == -1 and np.isnan(faces.hessian).all()
    centre = hb.distance_derivatives(hb.Sphere(1), hb.Pose(), hb.Sphere(1), hb.Pose())
    assert centre.status == "none" and np.isnan(centre.gradient).all()
    floor = hb.HalfSpace()
    rest = hb.distance_derivatives(floor, hb.Pose(), hb.Ellipsoid([1, 1, 2]), hb.Pose([0, 0, 3]))
    assert rest.status == "twice" and rest.gradient[8] == 1
    with pytest.raises(TypeError, match="as a is a HalfSpace"):
        hb.distance_derivatives(floor, hb.Pose(), floor, hb.Pose())
    with pytest.raises(TypeError, match="second is 1"):
        hb.distance_derivatives_many(box, [[0, 0, 0], [3, 0, 0]], None, [[0, 1]], second=1)


def test_shapes_written_in_python():
    class Egg:
        bounding_radius, inscribed_radius, min_curvature_radius = 1.0, 0.5, 0.25
        D = np.array([0.5, 0.5, 1.0])

        def support(self, n):
            scaled = self.D * n
            return np.linalg.norm(scaled), self.D * scaled / np.linalg.norm(scaled)

        def support_hessian(self, n):
            w = self.D * n
            h = np.linalg.norm(w)
            return (np.diag(self.D**2) - np.outer(self.D * w, self.D * w) / h**2) / h

    pose = hb.Pose([1.5, 1.2, 1.3], [0.5, 0.5, -0.5, 0.5])
    mine = hb.distance_derivatives(Egg(), hb.Pose(), hb.Ellipsoid([0.6, 0.8, 1]), pose)
    own = hb.distance_derivatives(hb.Ellipsoid([0.5, 0.5, 1]), hb.Pose(), hb.Ellipsoid([0.6, 0.8, 1]), pose)
    assert mine.status == own.status == "twice"
    assert np.allclose(mine.hessian, own.hessian, atol=1e-9)
