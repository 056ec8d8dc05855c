"""Shapes with faces, edges, rims and caps, and half-spaces: known answers, copies, bad input."""

import math
import pickle

import numpy as np
import pytest
from conftest import rotations, unit_rows

import hardbody as hb

TETRAHEDRON = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-2, 2) for z in (-0.5, 0.5)], float)
BOX = hb.Box([1, 2, 0.5])
HULL = hb.ConvexPolyhedron(CORNERS)
KINDS = [
    hb.Sphere(0.7),
    hb.Capsule(2, 0.5),
    BOX,
    HULL,
    hb.Rounded(BOX, 0.3),
    hb.Rounded(HULL, 0.3),
    hb.Cylinder(2, 0.5),
    hb.Rounded(hb.Cylinder(0.5, 2), 0.3),
    hb.Ellipsoid([1, 2, 3]),
    hb.Superellipsoid([1, 2, 3], 0.5, 0.7),
]
CORES = KINDS[:8]
FAR = hb.Pose([9, 0, 0])


def test_attributes():
    assert hb.Sphere(2).volume == pytest.approx(4 / 3 * math.pi * 8, rel=1e-15)
    np.testing.assert_allclose(hb.Sphere(2).inertia(5), [8, 8, 8], rtol=1e-15)
    capsule = hb.Capsule(2, 0.5)
    assert (capsule.half_length, capsule.radius, capsule.bounding_radius, capsule.symmetry_axis) == (2, 0.5, 2.5, 2)
    assert capsule.volume == pytest.approx(math.pi * 0.25 * (4 + 2 / 3), rel=1e-15)
    np.testing.assert_array_equal(BOX.half_extents, [1, 2, 0.5])
    assert (BOX.volume, BOX.symmetry_axis, BOX.min_curvature_radius) == (8, None, 0)
    np.testing.assert_allclose(BOX.inertia(3), [4.25, 1.25, 5], rtol=1e-15)
    rounded = hb.Rounded(BOX, 0.3)
    assert (rounded.shape, rounded.radius, rounded.min_curvature_radius) == (BOX, 0.3, 0.3)
    steiner = 8 + 0.3 * 28 + math.pi * 0.09 * 7 + 4 / 3 * math.pi * 0.027
    assert rounded.volume == pytest.approx(steiner, rel=1e-14)


def test_cylinders_and_cones():
    cylinder = hb.Cylinder(2, 3)
    assert (cylinder.half_length, cylinder.radius, cylinder.inscribed_radius, cylinder.symmetry_axis) == (2, 3, 2, 2)
    assert cylinder.volume == pytest.approx(36 * math.pi, rel=1e-15)
    np.testing.assert_allclose(cylinder.inertia(12), [43, 43, 54], rtol=1e-15)
    cone = hb.Cone(4, 3)
    assert (cone.height, cone.radius, cone.base, cone.is_in_principal_frame) == (4, 3, -1, True)
    assert hb.Cone(4, 3, -2).base == -2
    np.testing.assert_array_equal(hb.Cone(4, 3, -2).center_of_mass, [0, 0, -1])
    inner = hb.Cone.in_principal_frame(4, 3, rounding=0.5)
    rounded = hb.Rounded(inner, 0.5)
    assert (type(rounded), rounded.shape, rounded.is_in_principal_frame) == (hb.RoundedCone, inner, True)
    assert not hb.Rounded(cone, 0.5).is_in_principal_frame
    for shape in (cylinder, cone, rounded, hb.Rounded(cylinder, 0.5)):
        assert pickle.loads(pickle.dumps(shape)) == shape
        assert eval(repr(shape), {"hb": hb, **vars(hb)}) == shape
    # A cone stands on a cylinder, its base parallel to the face, and lies 1 above it.
    assert hb.distance(cylinder, hb.Pose(), cone, hb.Pose([0.5, 0.25, 4])).distance == 1
    assert hb.distance(cone, hb.Pose(), hb.Sphere(1), hb.Pose([0, 0, 7])).distance == 3
    hit = hb.time_of_contact(cylinder, hb.Motion(), cone, hb.Motion(hb.Pose([0, 0, 7]), velocity=[0, 0, -2]), 10)
    assert hit.time == pytest.approx(2, abs=1e-12)


def test_polyhedra_have_vertices_and_faces():
    points = [*CORNERS, [0, 0, 0], CORNERS[0], [1, 0, 0]]
    hull = hb.ConvexPolyhedron(points)
    assert hull == HULL
    assert {tuple(v) for v in hull.vertices} == {tuple(v) for v in CORNERS}
    assert sorted(len(f) for f in hull.faces) == [4] * 6
    for face in hull.faces:
        a, b, c = (hull.vertices[k] for k in face[:3])
        assert np.cross(b - a, c - a) @ a > 0  # anticlockwise from outside
    np.testing.assert_allclose(hull.center_of_mass, 0, atol=1e-16)
    assert hull.is_in_principal_frame
    assert hull.volume == pytest.approx(8, rel=1e-15)


def test_solids():
    icosahedron = hb.ConvexPolyhedron.solid("icosahedron", 2)
    assert icosahedron.vertices.shape == (12, 3)
    np.testing.assert_allclose(np.linalg.norm(icosahedron.vertices, axis=1), 2, rtol=1e-15)
    assert len(hb.ConvexPolyhedron.solid("truncated_icosahedron").vertices) == 60


def test_principal_frames(random):
    points = random.normal(size=(12, 3)) + [5, 0, 0]
    sharp, pose = hb.ConvexPolyhedron.in_principal_frame(points)
    assert sharp.is_in_principal_frame
    world = sharp.vertices @ pose.rotation.T + pose.position
    assert all(np.min(np.linalg.norm(points - v, axis=1)) < 1e-13 for v in world)
    inner, _ = hb.ConvexPolyhedron.in_principal_frame(points, rounding=0.4)
    assert hb.Rounded(inner, 0.4).is_in_principal_frame
    assert not hb.Rounded(sharp, 0.4).is_in_principal_frame
    with pytest.raises(ValueError, match="principal axes"):
        hb.Species(hb.Rounded(sharp, 0.4)).inertia  # noqa: B018


@pytest.mark.parametrize("shape", KINDS, ids=repr)
def test_copies(shape):
    again = pickle.loads(pickle.dumps(shape))
    assert again == shape
    assert hash(again) == hash(shape)
    assert shape.scaled(2) != shape
    assert shape.scaled(2).volume == pytest.approx(8 * shape.volume, rel=1e-12)
    assert eval(repr(shape), vars(hb)) == shape
    floor = hb.HalfSpace([0, 3, 4], 0.5)
    assert pickle.loads(pickle.dumps(floor)) == floor
    assert eval(repr(floor), vars(hb)) == floor


@pytest.mark.parametrize("a", KINDS, ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("b", KINDS, ids=lambda s: type(s).__name__)
def test_distances_of_support_points(random, a, b):
    """Support points in opposite directions, moved apart along them: the distance is known."""
    rows = (10 ** random.uniform(-6, 1, 20), *(unit_rows(random, 20, k) for k in (3, 4, 4)))
    for gap, n, qa, qb in zip(*rows, strict=True):
        turn_a, turn_b = hb.Pose([0, 0, 0], qa).rotation, hb.Pose([0, 0, 0], qb).rotation
        s_a = turn_a @ a.support(turn_a.T @ n)[1]
        s_b = turn_b @ b.support(turn_b.T @ -n)[1]
        pose_a, pose_b = hb.Pose([0, 0, 0], qa), hb.Pose(s_a + gap * n - s_b, qb)
        r = hb.distance(a, pose_a, b, pose_b)
        assert r.status == "separated"
        assert r.distance == pytest.approx(gap, abs=1e-9 if {a, b} & set(KINDS[6:]) else 1e-14 * 20)
        assert not hb.overlap(a, pose_a, b, pose_b)
        assert hb.distance_lower_bound(a, pose_a, b, pose_b, n) == pytest.approx(gap, abs=1e-12)


@pytest.mark.parametrize("shape", CORES, ids=repr)
def test_queries_of_one_body(shape):
    h = {axis: shape.support(np.eye(3)[axis])[0] for axis in range(3)}
    pose = hb.Pose([1, 2, 3])
    closest = hb.closest_point(shape, pose, [1, 2, 3 + h[2] + 0.25])
    assert closest.distance == pytest.approx(0.25, abs=1e-14)
    np.testing.assert_allclose(closest.normal, [0, 0, 1], atol=1e-14)
    assert hb.contains(shape, pose, [1, 2, 3])
    assert not hb.contains(shape, pose, [1, 2, 3 + h[2] + 1e-9])
    hit = hb.ray_cast(shape, pose, [-9, 2, 3], [2, 0, 0])
    assert hit.status == "hit"
    assert hit.t == pytest.approx((10 - h[0]) / 2, abs=1e-13)
    assert hb.ray_cast(shape, pose, [-9, 9, 3], [2, 0, 0]).status == "missed"


def test_overlaps_have_depths():
    cube = hb.Box([1, 1, 1])
    assert hb.distance(cube, hb.Pose(), cube, hb.Pose([1.5, 0.25, 0])).distance == -0.5
    assert hb.distance(hb.Sphere(1), hb.Pose(), hb.Sphere(2), hb.Pose([0, 2, 0])).distance == -1
    assert hb.overlap(cube, hb.Pose(), hb.Capsule(2, 0.5), hb.Pose([1.25, 0, 0]))


@pytest.mark.parametrize("shape", KINDS, ids=repr)
def test_half_spaces(shape):
    floor = hb.HalfSpace([0, 3, 4], 0.5)
    np.testing.assert_allclose(floor.normal, [0, 0.6, 0.8], rtol=1e-15)
    n = floor.normal
    height = shape.support(-n)[0]
    up = hb.Pose((height + 0.75) * n)
    r = hb.distance(floor, hb.Pose(), shape, up)
    assert r.distance == pytest.approx(0.25, abs=1e-14)
    assert r.error_bound == 0
    back = hb.distance(shape, up, floor, hb.Pose())
    assert back.distance == r.distance
    np.testing.assert_array_equal(back.normal, -r.normal)
    assert not hb.overlap(shape, up, floor, hb.Pose())
    assert hb.overlap(floor, hb.Pose(), shape, hb.Pose())
    assert hb.contains(floor, hb.Pose(), [0, 0, 0])
    assert hb.closest_point(floor, hb.Pose(), 2.5 * n).distance == pytest.approx(2, rel=1e-15)
    assert hb.ray_cast(floor, hb.Pose(), 2.5 * n, -n).t == pytest.approx(2, rel=1e-15)


def test_arrays_take_mixed_kinds(random):
    number = 60
    positions = random.uniform(-6, 6, (number, 3))
    quaternions = unit_rows(random, number, 4)
    shape_of = random.integers(0, len(KINDS), number)
    pairs = random.permutation(number).reshape(-1, 2)
    many = hb.distance_many(KINDS, positions, quaternions, pairs, shape_of=shape_of)
    for k, (i, j) in enumerate(pairs):
        one = hb.distance(
            KINDS[shape_of[i]],
            hb.Pose(positions[i], quaternions[i]),
            KINDS[shape_of[j]],
            hb.Pose(positions[j], quaternions[j]),
        )
        assert many.status[k] == one.status
        # The poses differ by rounding. Both answers are within their bounds of the true distance.
        allowed = many.error_bound[k] + one.error_bound + 1e-14 * 20
        assert abs(many.distance[k] - one.distance) <= allowed
    overlaps = hb.overlap_many(KINDS, positions, quaternions, pairs, shape_of=shape_of)
    np.testing.assert_array_equal(overlaps.overlap, many.distance <= 0)
    masses = hb.mass_properties_many(KINDS)
    np.testing.assert_allclose(masses.volume, [s.volume for s in KINDS], rtol=1e-12)


FACES = {
    **{"tetrahedron": 4, "cube": 6, "octahedron": 8, "dodecahedron": 12, "icosahedron": 20},
    **{"truncated tetrahedron": 8, "cuboctahedron": 14, "truncated cube": 14, "truncated octahedron": 14},
    **{"rhombicuboctahedron": 26, "truncated cuboctahedron": 26, "snub cube": 38, "icosidodecahedron": 32},
    **{"truncated dodecahedron": 32, "truncated icosahedron": 32, "rhombicosidodecahedron": 62},
    **{"truncated icosidodecahedron": 62, "snub dodecahedron": 92},
}


@pytest.mark.parametrize("name", FACES)
def test_faces_are_those_of_the_solid(name, random):
    solid = hb.ConvexPolyhedron.solid(name)
    R = rotations(unit_rows(random, 1, 4))[0]
    turned = hb.ConvexPolyhedron(solid.vertices @ R.T)
    for shape in (solid, turned, solid.scaled(1e-20)):
        assert len(shape.faces) == FACES[name]
        for face in shape.faces:
            a, b, c = shape.vertices[face[:3]]
            normal = np.cross(b - a, c - a)
            heights = shape.vertices @ normal / np.linalg.norm(normal) / shape.bounding_radius
            assert heights.max() - heights[face].min() < 1e-14


def test_mass_properties_of_any_hull():
    shifted = hb.ConvexPolyhedron(CORNERS + [0.25, 0, 0])
    mass = hb.mass_properties(shifted, 2)
    assert mass.mass == pytest.approx(16, rel=1e-14)
    np.testing.assert_allclose(mass.center_of_mass, [0.25, 0, 0], atol=1e-15)
    moved = 16 * np.diag([0, 0.0625, 0.0625])
    np.testing.assert_allclose(mass.inertia, np.diag(BOX.inertia(16)) + moved, atol=1e-13)
    exact = hb.mass_properties(hb.Capsule(2, 0.5))
    integrated = hb.mass_properties(hb.Capsule(2, 0.5), quadrature_tolerance=1e-3)
    with pytest.warns(RuntimeWarning, match=r"the relative error is .*, quadrature_tolerance 1e-08 is not reached"):
        assert hb.mass_properties(hb.Capsule(1, 0.5), quadrature_tolerance=1e-8).relative_error > 1e-8
    assert integrated.volume == pytest.approx(exact.volume, rel=1e-3)


@pytest.mark.parametrize("a", CORES, ids=lambda s: type(s).__name__)
def test_times_of_contact(a):
    """Head on along x."""
    b = hb.Rounded(BOX, 0.3)
    hit = hb.time_of_contact(a, hb.Motion(), b, hb.Motion(hb.Pose([10, 0, 0]), velocity=[-2, 0, 0]), 10)
    assert hit.status == "hit"
    gap = 10 - a.support([1, 0, 0])[0] - b.support([-1, 0, 0])[0]
    assert hit.time == pytest.approx(gap / 2, abs=1e-12)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        *((lambda r=r: hb.Sphere(r), f"radius is {r}; accepted: 1e-50 to 1e+50") for r in (0, math.nan, math.inf)),
        (lambda: hb.Sphere(1e60), "radius is 1e+60; accepted: 1e-50 to 1e+50"),
        (lambda: hb.Capsule(1, 0), "radius is 0; accepted: 1e-50 to 1e+50"),
        (lambda: hb.Cone(-1, 1), "height is -1; accepted: 1e-50 to 1e+50"),
        (lambda: hb.Sphere("1"), "radius is '1'"),
        (lambda: hb.Capsule(-1, 1), "half-length is -1"),
        (lambda: hb.Capsule(math.nan, 1), "Capsule: half-length is nan"),
        (lambda: hb.Capsule(1e5, 1), "accepted: at most 10000"),
        (lambda: hb.Box([1, 2]), "half_extents has shape (2,); accepted: 3 real numbers"),
        (lambda: hb.Box([1, 0, 2]), "half extent y is 0"),
        (lambda: hb.Box([1, 1, 1e5]), "10000"),
        (lambda: hb.ConvexPolyhedron(CORNERS[:3]), "3 points; accepted: at least 4"),
        (lambda: hb.ConvexPolyhedron(CORNERS * [1, 1, 0]), "in a plane"),
        (lambda: hb.ConvexPolyhedron(CORNERS + [3, 0, 0]), "the origin is not inside"),
        (lambda: hb.ConvexPolyhedron([[1, 2]] * 5), "points has shape (5, 2)"),
        (lambda: hb.ConvexPolyhedron([[1, 2, math.nan]] * 5), "points[0]"),
        (lambda: hb.ConvexPolyhedron(None), "points is None"),
        (lambda: hb.ConvexPolyhedron.solid("cubes"), 'the name of a solid is "cubes"; accepted: tetrahedron, cube'),
        (lambda: hb.ConvexPolyhedron.solid(3), "name is 3"),
        (lambda: hb.ConvexPolyhedron.solid("cube", -1), "circumradius is -1"),
        (lambda: hb.ConvexPolyhedron.in_principal_frame(CORNERS, rounding=-1), "radius is -1"),
        (
            lambda: hb.Rounded(hb.Sphere(1), 0.5),
            "shape is of type Sphere; accepted: Box, ConvexPolyhedron, Cylinder, Cone",
        ),
        (lambda: hb.Cylinder(0, 1), "half_length is 0"),
        (lambda: hb.Cylinder(1, 1e5), "ratio of radius to half-length"),
        (lambda: hb.Cone(1, math.nan), "radius is nan"),
        (lambda: hb.Cone(1, 1, 0.5), "base is 0.5; accepted: more than -1, less than 0"),
        (lambda: hb.Cone.in_principal_frame(1, 1, -1), "Rounded: radius is -1"),
        (lambda: hb.Rounded(BOX, -0.5), "Rounded: radius is -0.5"),
        (lambda: hb.RoundedBox(HULL, 0.5), "shape is"),
        (lambda: hb.HalfSpace([0, 0, 0]), "normal is"),
        (lambda: hb.HalfSpace(None, math.inf), "offset is inf"),
        (lambda: hb.distance(hb.HalfSpace(), FAR, hb.HalfSpace(), FAR), "a body, as a is a HalfSpace"),
        (lambda: hb.time_of_contact(hb.HalfSpace(), hb.Motion(), BOX, hb.Motion(), 1), "a is of type HalfSpace"),
        (lambda: hb.mass_properties(BOX, quadrature_tolerance=1e-3), "None for a box of half extents 1 x 2 x 0.5"),
        (
            lambda: hb.time_of_contact(BOX, hb.Motion(), BOX, hb.Motion(FAR), 1, finder="bracketing"),
            'has none; accepted: "certified"',
        ),
    ],
)
def test_bad_shapes_are_refused(call, words):
    with pytest.raises((ValueError, TypeError)) as caught:
        call()
    assert words in str(caught.value)
