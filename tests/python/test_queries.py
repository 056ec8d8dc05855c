"""Queries about one pair, one point, one ray."""

import csv

import numpy as np
import pytest
from conftest import REFERENCE, Pairs, rotations, unit_rows

import hardbody as hb


def pose(p=(0, 0, 0)):
    return hb.Pose(p)


def test_distance_of_spheres():
    a, b = hb.Ellipsoid([1, 1, 1]), hb.Ellipsoid([2, 2, 2])
    r = hb.distance(a, pose(), b, pose([0, 3, 4]))
    assert r.status == "separated"
    assert r.distance == pytest.approx(2, abs=1e-14)
    np.testing.assert_allclose(r.normal, [0, 0.6, 0.8], atol=1e-12)
    np.testing.assert_allclose(r.point_a, [0, 0.6, 0.8], atol=1e-12)
    np.testing.assert_allclose(r.point_b, [0, 1.8, 2.4], atol=1e-12)
    assert 0 <= r.error_bound <= 1e-13
    assert r.residual >= 0
    assert r.iterations >= 1
    r = hb.distance(a, pose(), b, pose([0, 0, 2.5]))
    assert r.status == "overlapping"
    assert r.distance == pytest.approx(-0.5, abs=1e-14)
    assert "status='overlapping', distance=-0.5" in repr(r)


def test_distance_of_manufactured_pairs(random):
    m = Pairs(random, (1.0, 2.0, 3.0), 50)
    e = hb.Ellipsoid(m.axes)
    for k, (i, j) in enumerate(m.pairs):
        X, Y = hb.Pose(m.positions[i], m.quaternions[i]), hb.Pose(m.positions[j], m.quaternions[j])
        for start in (None, m.normal[k], -m.normal[k]):
            r = hb.distance(e, X, e, Y, start=start)
            size = np.linalg.norm(m.positions[j] - m.positions[i]) + 6
            assert r.distance == pytest.approx(m.gap[k], abs=1e-13 * size)
            np.testing.assert_allclose(r.normal, m.normal[k], atol=1e-7)
            np.testing.assert_allclose(r.point_a, m.point_a[k], atol=1e-6)
        assert hb.distance_lower_bound(e, X, e, Y, m.normal[k]) == pytest.approx(m.gap[k], abs=1e-13 * size)
        assert not hb.overlap(e, X, e, Y)


def test_overlap_and_penetration_options():
    a = hb.Superellipsoid([1, 2, 3], 0.5, 0.5)
    deep = hb.distance(a, pose(), a, pose([0.1, 0, 0]))
    assert deep.status == "overlapping"
    assert deep.distance == pytest.approx(-1.9, abs=1e-6)  # across the flat faces
    local = hb.distance(a, pose(), a, pose([0.1, 0, 0]), penetration="local")
    assert local.distance <= deep.distance + deep.error_bound
    assert hb.overlap(a, pose(), a, pose([1.9, 0, 0])) is True
    assert hb.overlap(a, pose(), a, pose([2.1, 0, 0])) is False
    assert hb.overlap(hb.Ellipsoid([1, 1, 1]), pose(), a, pose([0, 0, 4.1])) is False


def test_contains_agrees_with_the_formulas(random):
    q = unit_rows(random, 1, 4)
    X, R = hb.Pose([1, 2, 3], q[0]), rotations(q)[0]
    e, s = hb.Ellipsoid([1, 2, 3]), hb.Superellipsoid([1, 2, 3], 0.5, 1.2)
    for local in random.uniform(-2, 2, (200, 3)):
        world = R @ local + [1, 2, 3]
        x, y, z = np.abs(local) / [1, 2, 3]
        assert hb.contains(e, X, world) == (x * x + y * y + z * z <= 1)
        assert hb.contains(s, X, world) == ((x ** (2 / 1.2) + y ** (2 / 1.2)) ** (1.2 / 0.5) + z ** (2 / 0.5) <= 1)


def test_closest_point_along_normals(random):
    q = unit_rows(random, 1, 4)
    X, R = hb.Pose([1, 2, 3], q[0]), rotations(q)[0]
    e = hb.Ellipsoid([1, 2, 3])
    for n in unit_rows(random, 30, 3):
        surface = X.apply(e.support(n)[1])
        for height in (1e-3, 2.0, -0.1):  # the smallest radius of curvature is 1/3
            r = hb.closest_point(e, X, surface + height * (R @ n))
            assert r.distance == pytest.approx(height, abs=1e-12)
            np.testing.assert_allclose(r.point, surface, atol=1e-6)
            np.testing.assert_allclose(r.normal, R @ n, atol=1e-6)
            assert r.status == ("separated" if height > 0 else "overlapping")
            assert r.error_bound <= 1e-12


def test_ray_cast_agrees_with_the_quadratic(random):
    q = unit_rows(random, 1, 4)
    p = np.array([1.0, 2.0, 3.0])
    X, R = hb.Pose(p, q[0]), rotations(q)[0]
    e = hb.Ellipsoid([1, 2, 3])
    seen = set()
    for origin, direction in zip(random.uniform(-5, 5, (300, 3)), random.normal(size=(300, 3)), strict=True):
        o, d = R.T @ (origin - p) / e.semi_axes, R.T @ direction / e.semi_axes
        a, b, c = d @ d, o @ d, o @ o - 1
        r = hb.ray_cast(e, X, origin, direction)
        discriminant = b * b - a * c
        if c <= 0:
            expected = "inside"
        elif discriminant > 0 and b < 0:
            expected = "hit"
            assert r.t == pytest.approx((-b - np.sqrt(discriminant)) / a, rel=1e-7)
            np.testing.assert_allclose(r.point, origin + r.t * direction, atol=1e-12)
            gradient = R @ (R.T @ (r.point - p) / e.semi_axes**2)
            np.testing.assert_allclose(r.normal, gradient / np.linalg.norm(gradient), atol=1e-9)
        else:
            expected = "missed"
            assert np.isnan(r.t)
        assert r.status == expected
        seen.add(expected)
    assert seen == {"hit", "inside", "missed"}


def test_time_of_contact_of_translating_bodies(random):
    m = Pairs(random, (1.0, 1.0, 3.0), 20)
    e = hb.Ellipsoid(m.axes)
    for k, (i, j) in enumerate(m.pairs):
        a = hb.Motion(hb.Pose(m.positions[i], m.quaternions[i]), time=1)
        b = hb.Motion(hb.Pose(m.positions[j], m.quaternions[j]), velocity=-2 * m.normal[k], time=1)
        hit = hb.time_of_contact(e, a, e, b, t_max=100)
        assert hit.status == "hit"
        assert hit.time == pytest.approx(1 + m.gap[k] / 2, abs=1e-12)
        np.testing.assert_allclose(hit.normal, m.normal[k], atol=1e-5)
        np.testing.assert_allclose(hit.point, m.point_a[k], atol=1e-5)
        miss = hb.time_of_contact(e, a, e, hb.Motion(b.pose, velocity=2 * m.normal[k], time=1), np.inf)
        assert (miss.status, miss.time) == ("separated", np.inf)


@pytest.mark.parametrize("speed", [1e50, 1e49, 1e-49, 1e-50])
@pytest.mark.parametrize("way", [3.0, 1e6])
def test_time_of_contact_at_every_speed(speed, way):
    """Squares of the speeds, and of their products with the largest coordinate, neither overflow nor underflow."""
    e = hb.Ellipsoid([1, 1, 3])
    moving = hb.Motion(hb.Pose([way + 2, 0, 0]), velocity=[-speed, 0, 0])
    hit = hb.time_of_contact(e, hb.Motion(), e, moving, np.inf)
    assert hit.status == "hit"
    assert hit.time == pytest.approx(way / speed, rel=1e-14)
    early = hb.time_of_contact(e, hb.Motion(), e, moving, 0.5 * way / speed)
    assert (early.status, early.time) == ("separated", 0.5 * way / speed)
    turning = hb.Motion(hb.Pose([3.5, 0, 0]), angular_velocity=[0, speed, 0])
    assert hb.time_of_contact(e, hb.Motion(), e, turning, 100 / speed).status == "hit"
    assert hb.time_of_contact(e, hb.Motion(), e, turning, 0.1 / speed).status == "separated"


def test_speeds_whose_squares_overflow_or_underflow_are_refused():
    for speed in (1.1e50, 1e155, 1e300, 0.9e-50, 1e-200, 5e-324):
        for name in ("velocity", "angular_velocity"):
            with pytest.raises(ValueError, match=rf"^{name} is \[.*; accepted: 0, or a length from 1e-50 to 1e\+50$"):
                hb.Motion(**{name: [0, speed, 0]})
    assert hb.Motion(velocity=[1e-200, 1, 0]).velocity[0] == 1e-200
    late = hb.Motion(velocity=[1e50, 0, 0])
    e = hb.Ellipsoid([1, 1, 3])
    with pytest.raises(
        ValueError, match="position at time 1e.60, the later of both motions' times, is .* beyond .*1e.100"
    ):
        hb.time_of_contact(e, late, e, hb.Motion(time=1e60), np.inf)


def test_motion_agrees_with_the_reference():
    with open(REFERENCE / "free_top.csv", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith(('"#', "#"))))
    assert rows
    for row in rows:
        value = {key: float(text) for key, text in row.items()}
        motion = hb.Motion(
            hb.Pose(),
            angular_velocity=[value[f"w{k}(0)"] for k in (1, 2, 3)],
            inertia=[value[f"I{k}"] for k in (1, 2, 3)],
        ).at(value["t"])
        expected = np.array([value[f"q{k}"] for k in range(4)])
        np.testing.assert_allclose(motion.pose.quaternion, expected * np.sign(expected[0]), atol=1e-13)
        body = motion.pose.rotation.T @ motion.angular_velocity
        np.testing.assert_allclose(body, [value[f"w{k}"] for k in (1, 2, 3)], atol=1e-13)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda e, X: hb.distance(1, X, e, X), "a is 1; accepted: Ellipsoid, Superellipsoid"),
        # Half-spaces take part in queries, not in motion.
        (lambda e, X: hb.distance(e, X, None, X), "RoundedCone, CustomShape, HalfSpace"),
        (lambda e, X: hb.overlap(None, X, e, X), "RoundedCone, CustomShape, HalfSpace"),
        (lambda e, X: hb.closest_point(3, X, [0, 0, 0]), "RoundedCone, CustomShape, HalfSpace"),
        (lambda e, X: hb.contains("a", X, [0, 0, 0]), "RoundedCone, CustomShape, HalfSpace"),
        (lambda e, X: hb.ray_cast([], X, [0, 0, 9], [0, 0, 1]), "RoundedCone, CustomShape, HalfSpace"),
        (lambda e, X: hb.distance(e, [0, 0, 0], e, X), "pose_a is of type list; accepted: Pose"),
        (
            lambda e, X: hb.distance(e, X, e, X, penetration="deep"),
            'penetration is "deep"; accepted: "global", "local"',
        ),
        (lambda e, X: hb.distance(e, X, e, X, max_iterations=0), "max_iterations is 0; accepted: an integer from 1"),
        (lambda e, X: hb.distance(e, X, e, X, max_iterations=2.0), "max_iterations is 2.0"),
        (lambda e, X: hb.distance(e, X, e, X, start=[1, 2]), "start has shape (2,)"),
        (lambda e, X: hb.contains(e, X, [0, 0, np.nan]), "point is [0, 0, nan]; accepted: three finite numbers"),
        (lambda e, X: hb.ray_cast(e, X, [0, 0, 9], [0, 0, 0]), "direction is [0, 0, 0]"),
        (lambda e, X: hb.Motion(velocity=[0, np.inf, 0]), "velocity is [0, inf, 0]"),
        (lambda e, X: hb.Motion(inertia=[1, 1, 3]), "inertia is [1, 1, 3]"),
        (lambda e, X: hb.Motion("pose"), "pose is 'pose'; accepted: Pose"),
        (lambda e, X: hb.time_of_contact(e, hb.Motion(time=2), e, hb.Motion(), 1), "t_max is 1"),
        (lambda e, X: hb.time_of_contact(e, X, e, hb.Motion(), 1), "motion_a is of type Pose; accepted: Motion"),
        (lambda e, X: hb.time_of_contact(e, hb.Motion(), e, hb.Motion(), 1, finder="x"), "finder"),
    ],
)
def test_bad_arguments_are_refused(call, words):
    with pytest.raises((ValueError, TypeError)) as caught:
        call(hb.Ellipsoid([1, 2, 3]), hb.Pose())
    assert words in str(caught.value)
