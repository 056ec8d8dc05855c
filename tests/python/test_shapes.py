"""Shapes and their mass properties."""

import csv
import pickle

import numpy as np
import pytest
from conftest import REFERENCE, unit_rows

import hardbody as hb


def test_ellipsoid():
    e = hb.Ellipsoid([1, 2, 3])
    assert e.volume == pytest.approx(4 / 3 * np.pi * 6, rel=1e-15)
    np.testing.assert_allclose(e.inertia(5), [13, 10, 5], rtol=1e-15)
    assert (e.bounding_radius, e.inscribed_radius, e.symmetry_axis) == (3, 1, None)
    assert e.min_curvature_radius == pytest.approx(1 / 3)
    assert hb.Ellipsoid([2, 1, 1]).symmetry_axis == 0
    assert repr(e) == "Ellipsoid([1, 2, 3])"


def test_spheroid_has_the_volume_of_the_unit_sphere():
    for ratio in (0.2, 1.0, 3.0):
        a, b, c = hb.Ellipsoid.spheroid(ratio).semi_axes
        assert a == b
        assert c / a == pytest.approx(ratio, rel=1e-15)
        assert a * b * c == pytest.approx(1, rel=1e-15)


def test_support(random):
    e = hb.Ellipsoid([1, 2, 3])
    for n in unit_rows(random, 10, 3):
        h, s = e.support(2 * n)
        assert h == pytest.approx(2 * np.linalg.norm(n * e.semi_axes), rel=1e-15)
        np.testing.assert_allclose(s, e.semi_axes**2 * n / np.linalg.norm(n * e.semi_axes), rtol=1e-14)


@pytest.mark.parametrize("length", [1e-320, 1e-300, 1e-170, 1e170, 1e300])
def test_support_in_directions_of_any_length(length):
    n = np.array([0.6, 0, 0.8])
    shapes = [hb.Sphere(1), hb.Ellipsoid([1, 1, 3]), hb.Capsule(2, 1), hb.Cylinder(2, 1), hb.Cone(2, 1)]
    shapes += [hb.Box([1, 2, 3]), hb.Rounded(hb.Box([1, 2, 3]), 0.1), hb.Superellipsoid([1, 2, 3], 0.5, 0.7)]
    for shape in shapes:
        h, s = shape.support(length * n)
        expected, point = shape.support(n)
        tolerance = 1e-3 if length < 1e-310 else 1e-15  # the direction is rounded
        assert h / length == pytest.approx(expected, rel=tolerance)
        np.testing.assert_allclose(s, point, atol=4 * tolerance)


def test_superellipsoid_of_exponents_one_is_the_ellipsoid():
    s, e = hb.Superellipsoid([1, 2, 3], 1, 1), hb.Ellipsoid([1, 2, 3])
    assert s.volume == pytest.approx(e.volume, rel=1e-12)
    assert s != e
    assert repr(s) == "Superellipsoid([1, 2, 3], 1, 1)"


def test_equality_hash_and_copies():
    shapes = [hb.Ellipsoid([1, 2, 3]), hb.Superellipsoid([1, 2, 3], 0.5, 0.7)]
    for shape in shapes:
        again = pickle.loads(pickle.dumps(shape))
        assert again == shape
        assert hash(again) == hash(shape)
        assert shape.scaled(2) != shape
    assert len({*shapes, *shapes}) == 2


def rows_of(name):
    with open(REFERENCE / name, newline="") as file:
        yield from csv.DictReader(line for line in file if not line.startswith("#"))


def test_mass_properties_agree_with_the_reference():
    number = 0
    for row in rows_of("superellipsoid_mass_barr.csv"):
        a, b, c, e1, e2, volume, *inertia = (
            float(row[k]) for k in ("a", "b", "c", "e1", "e2", "V", "Ixx", "Iyy", "Izz")
        )
        if not (0.2 <= e1 <= 1.6 and 0.2 <= e2 <= 1.6):
            continue
        mass = hb.mass_properties(hb.Superellipsoid([a, b, c], e1, e2), 2)
        assert mass.volume == pytest.approx(volume, rel=1e-12)
        assert mass.mass == pytest.approx(2 * volume, rel=1e-12)
        np.testing.assert_allclose(mass.inertia, 2 * np.diag(inertia), rtol=1e-12)
        np.testing.assert_array_equal(mass.center_of_mass, 0)
        number += 1
    assert number >= 5


def test_quadrature_agrees_with_closed_forms():
    shape = hb.Superellipsoid([1, 2, 3], 0.7, 1.2)
    exact, integrated = hb.mass_properties(shape), hb.mass_properties(shape, quadrature_tolerance=1e-7)
    assert integrated.volume == pytest.approx(exact.volume, rel=1e-7)
    np.testing.assert_allclose(integrated.inertia, exact.inertia, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: hb.Ellipsoid([1, 2]), "semi_axes has shape (2,); accepted: 3 real numbers"),
        (lambda: hb.Ellipsoid([1, 2, 0]), "semi-axis z is 0"),
        (lambda: hb.Ellipsoid([1, 2, float("nan")]), "semi-axis z is nan"),
        (lambda: hb.Ellipsoid([1, 2, 1e5]), "ratio of the largest to the smallest semi-axis"),
        (lambda: hb.Ellipsoid(None), "semi_axes is None"),
        (lambda: hb.Superellipsoid([1, 1, 1], 0.1, 1), "exponent e1 is 0.1"),
        (lambda: hb.Superellipsoid([1, 1, 1], 1, "1"), "e2 is '1'"),
        (lambda: hb.Ellipsoid.spheroid(0), "aspect_ratio is 0"),
        (lambda: hb.Ellipsoid([1, 1, 1]).inertia(-1), "mass is -1"),
        (
            lambda: hb.mass_properties(hb.Pose()),
            "shape is of type Pose; accepted: Ellipsoid, Superellipsoid, Sphere, Capsule,",
        ),
        (lambda: hb.mass_properties(hb.Ellipsoid([1, 1, 1]), np.inf), "density is inf"),
    ],
)
def test_bad_shapes_are_refused(call, words):
    with pytest.raises((ValueError, TypeError)) as caught:
        call()
    assert words in str(caught.value)
