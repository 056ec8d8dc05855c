"""Bad input to every function: an exception that names the argument and what is accepted, never a crash."""

import numpy as np
import pytest
from generated import CALLS, HUGE, HUGE_INDICES, E, S, X, bad_calls, check_refusal, is_named
from hypothesis import given, settings

import hardbody as hb

PAIR = dict(a=E, pose_a=hb.Pose(), b=S, pose_b=X)
BODIES = dict(shapes=[E, S], positions=[[0, 0, 0], [4, 0, 2]], quaternions=[[1, 0, 0, 0], [0, 1, 0, 0]])
MANY = dict(**BODIES, pairs=[[0, 1], [1, 0], [0, 0]], shape_of=[1, 0], threads=2)
POINTS = dict(**BODIES, points=[[0, 0, 1], [4, 0, 9]], body_of=[1, 0], shape_of=[0, 0], threads=1)
RAYS = dict(**BODIES, origins=[[0, 0, 9], [4, 0, 9]], directions=[[0, 0, -1], [1, 0, 0]], body_of=[0, 1], threads=1)
CONTACTS = dict(
    **MANY,
    velocities=[[0, 0, 0], [-1, 0, 0]],
    angular_velocities=[[0, 1, 0], [0, 0, 1]],
    t_max=3.0,
    inertias=[[1, 1, 1], [1, 1.2, 1.5]],
    finder="bracketing",
    max_evaluations=100,
    eps_d=1e-6,
    distance="dual",
    root="newton",
)
START = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
PLACES = {name: BODIES[name] for name in ("positions", "quaternions")}
SCENE, GROWING = hb.Scene(), hb.Scene()
SCENE.add_many(**BODIES)

FUNCTIONS = {
    "Ellipsoid": (hb.Ellipsoid, dict(semi_axes=[1, 2, 3])),
    "spheroid": (hb.Ellipsoid.spheroid, dict(aspect_ratio=3.0)),
    "inertia": (E.inertia, dict(mass=1.0)),
    "scaled": (S.scaled, dict(factor=2.0)),
    "support": (S.support, dict(n=[0, 0, 1])),
    "Superellipsoid": (hb.Superellipsoid, dict(semi_axes=[1, 2, 3], e1=0.5, e2=1.5)),
    "Pose": (hb.Pose, dict(position=[1, 2, 3], orientation=[0, 0, 0, 1])),
    "from_matrix": (hb.Pose.from_matrix, dict(matrix=np.eye(4))),
    "normalized": (hb.Pose.normalized, dict(position=[1, 2, 3], quaternion=[1, 1, 0, 0])),
    "nearest": (hb.Pose.nearest, dict(matrix=np.eye(4))),
    "apply": (X.apply, dict(points=[[1, 2, 3]])),
    "apply_inverse": (X.apply_inverse, dict(points=[1, 2, 3])),
    "Motion": (hb.Motion, dict(pose=X, velocity=[1, 0, 0], angular_velocity=[0, 1, 0], inertia=[1, 1, 1], time=0.0)),
    "at": (hb.Motion().at, dict(time=1.0)),
    "at far": (hb.Motion(velocity=[1e50, 0, 0]).at, dict(time=1.0)),
    "distance": (hb.distance, dict(**PAIR, start=[1, 0, 0], max_iterations=60, penetration="global")),
    "distance_lower_bound": (hb.distance_lower_bound, dict(**PAIR, n=[1, 0, 0])),
    "overlap": (hb.overlap, dict(**PAIR, start=[1, 0, 0])),
    "closest_point": (hb.closest_point, dict(shape=E, pose=X, point=[0, 0, 0])),
    "contains": (hb.contains, dict(shape=S, pose=X, point=[0, 0, 0])),
    "ray_cast": (hb.ray_cast, dict(shape=S, pose=X, origin=[0, 0, 0], direction=[1, 0, 0])),
    "mass_properties": (hb.mass_properties, dict(shape=E, density=1.0, quadrature_tolerance=1e-2)),
    "time_of_contact": (
        hb.time_of_contact,
        dict(
            a=E,
            motion_a=hb.Motion(),
            b=E,
            motion_b=hb.Motion(X, [-1, 0, 0]),
            t_max=3.0,
            finder="bracketing",
            max_evaluations=100,
            eps_d=1e-6,
            distance="dual",
            root="newton",
        ),
    ),
    "distance_many": (hb.distance_many, dict(**MANY, start=START, max_iterations=60, penetration="local")),
    "overlap_many": (hb.overlap_many, dict(**MANY, start=START)),
    "contains_many": (hb.contains_many, POINTS),
    "closest_point_many": (hb.closest_point_many, POINTS),
    "ray_cast_many": (hb.ray_cast_many, RAYS),
    "time_of_contact_many": (hb.time_of_contact_many, CONTACTS),
    "mass_properties_many": (hb.mass_properties_many, dict(shapes=[E, S], density=[1.0, 2.0])),
    "distance_derivatives": (
        hb.distance_derivatives,
        dict(**PAIR, start=[1, 0, 0], max_iterations=60, penetration="global"),
    ),
    "distance_derivatives_many": (
        hb.distance_derivatives_many,
        dict(**MANY, start=START, max_iterations=60, penetration="local", second=True),
    ),
    "contact_patch": (hb.contact_patch, dict(**PAIR, within=0.5, tolerance=0.02, max_points=6)),
    "contact_patch_many": (hb.contact_patch_many, dict(**MANY, within=2.0, tolerance=0.02, max_points=6)),
    "Scene": (hb.Scene, dict(margin=0.1, lattice=[[9, 0, 0], [0, 9, 0], [0, 0, 9]])),
    "add": (GROWING.add, dict(shape=E, pose=X, group=1, meets=3)),
    "add_many": (GROWING.add_many, dict(**BODIES, shape_of=[1, 0], group=1, meets=3)),
    "move": (SCENE.move, dict(body=1, pose=X)),
    "move_many": (SCENE.move_many, dict(**PLACES, bodies=[0, 1])),
    "set_filter": (SCENE.set_filter, dict(body=1, group=1, meets=3)),
    "pairs_within": (SCENE.pairs_within, dict(cutoff=5.0, threads=2, max_iterations=60, penetration="local")),
    "overlapping": (SCENE.overlapping, dict(shape=S, pose=X)),
    "distance of two": (SCENE.distance, dict(i=0, j=1, max_iterations=60, penetration="global")),
    "nearest to a shape": (SCENE.nearest, dict(shape=S, pose=X, within=3.0)),
    "nearest_to": (SCENE.nearest_to, dict(body=1, within=3.0)),
    "closest_point of a scene": (SCENE.closest_point, dict(point=[0, 0, 0], within=3.0)),
    "points of a scene": (SCENE.closest_point_many, dict(points=[[0, 0, 0]], within=3.0, threads=2)),
    "ray of a scene": (SCENE.ray_cast, dict(origin=[0, 0, 9], direction=[0, 0, -1], t_max=20.0)),
    "rays of a scene": (
        SCENE.ray_cast_many,
        dict(origins=[[0, 0, 9]], directions=[[0, 0, -1]], t_max=20.0, threads=2),
    ),
}

# What messages say in place of an argument's name.
OTHER_WORDS = {
    "semi_axes": r"semi-axis [xyz] is|^(Ellipsoid|Superellipsoid): ratio of the largest to the smallest semi-axis is",
    "factor": r"semi-axis [xyz] is",
    "orientation": r"^Pose: (quaternion|rotation)",
    "matrix": r"^Pose: (position|rotation)",
    "time": r"propagate: t is",
    "shapes": r"shape_of\[\d+\] is|^density has shape \(2,\); accepted: a number, or one a shape",
    "positions": r"body_of\[\d+\] is .*; accepted: none, there are no bodies",
    "lattice": r"^Lattice: vector",
    "i": r"^Scene: body \d+ has (not been added|been removed)",
    "j": r"^Scene: body \d+ has (not been added|been removed)",
}


def test_masked_arrays_of_which_nothing_is_masked():
    plain = hb.distance_many(**MANY)
    for mask in (np.ma.nomask, False):
        masked = np.ma.masked_array(MANY["positions"], mask=mask)
        assert hb.distance_many(**MANY | {"positions": masked}) == plain


def test_a_letter_is_no_name():
    assert is_named("a is 3; accepted: Ellipsoid", ["a"], {})
    assert is_named("start has 1 rows; accepted: as many as pairs, which has 3", ["pairs"], {})
    assert not is_named("b is 3; accepted: a shape", ["a"], {})
    assert not is_named("pairs[0] is 3; accepted: integers of shape (n,)", ["n"], {})


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_right_arguments_are_accepted(name):
    function, arguments = FUNCTIONS[name]
    function(**arguments)


@pytest.mark.filterwarnings("ignore:overflow encountered", "ignore:invalid value encountered")
@pytest.mark.filterwarnings("ignore:nanobind.*uninitialized:RuntimeWarning")
@settings(max_examples=CALLS)
@given(bad_calls(FUNCTIONS))
def test_bad_arguments_are_named(call):
    try:
        check_refusal(call, OTHER_WORDS, (ValueError, TypeError, MemoryError))
    except hb.UndecidedError:
        assert call.name == "overlap"


@pytest.mark.parametrize(
    ("function", "bad", "words"),
    [
        ("distance_many", dict(pairs=[[0, 2]], start=None), "pairs[0, 1] is 2; accepted: 0 to 1"),
        ("distance_many", dict(pairs=[[0, 1], [-1, 0]], start=None), "pairs[1, 0] is -1; accepted: 0 to 1"),
        ("distance_many", dict(pairs=[0, 1]), "pairs has shape (2,); accepted: integers of shape (rows, 2)"),
        ("distance_many", dict(pairs=[[0.0, 1.0]]), "pairs has dtype float64; accepted: integers of shape (rows, 2)"),
        ("distance_many", dict(positions=[[0, 0], [1, 1]]), "positions has shape (2, 2)"),
        (
            "distance_many",
            dict(positions=[[0, 0, 0], [1, 1, np.nan]]),
            "positions[1]: Pose: position is not finite (nan)",
        ),
        ("distance_many", dict(positions=[[0, 0, 0], [1, 1]]), "positions cannot be read"),
        ("distance_many", dict(quaternions=[[1, 0, 0, 0]]), "quaternions has 1 rows; accepted: as many as positions"),
        ("distance_many", dict(quaternions=[[1, 0, 0, 0], [1, 1, 0, 0]]), "quaternions[1]: Pose: quaternion"),
        ("distance_many", dict(shape_of=[0, 2]), "shape_of[1] is 2; accepted: 0 to 1"),
        ("distance_many", dict(shape_of=[0]), "shape_of has 1 rows; accepted: as many as positions, which has 2"),
        ("distance_many", dict(shapes=[E] * 3, shape_of=None), "shapes has 3 elements for 2 bodies"),
        ("distance_many", dict(shapes=[E, X]), "shapes[1] is of type Pose; accepted: Ellipsoid, Superellipsoid"),
        ("distance_many", dict(shapes="E"), "RoundedCylinder, RoundedCone, or a list of them"),
        ("distance_many", dict(shapes=np.array([E, S])), "shapes is of type ndarray; accepted: Ellipsoid, Superelli"),
        (
            "contains_many",
            dict(shapes=(s for s in (E, S))),
            "shapes is of type generator; accepted: Ellipsoid, Superel",
        ),
        (
            "distance_many",
            dict(start=[START[0], [0, np.nan, 0], START[2]]),
            "start[1] is [0, nan, 0]; accepted: finite",
        ),
        ("overlap_many", dict(start=[START[0], START[1], [np.inf, 0, 0]]), "start[2] is [inf, 0, 0]; accepted: finite"),
        ("distance", dict(start=[0, 0, np.nan]), "start is [0, 0, nan]; accepted: three finite numbers"),
        ("overlap", dict(start=[0, 0, np.inf]), "start is [0, 0, inf]; accepted: three finite numbers"),
        ("Motion", dict(time=np.inf), "time is inf; accepted: a finite number"),
        ("at", dict(time=np.nan), "time is nan; accepted: a finite number"),
        ("distance_many", dict(threads=0), "threads is 0; accepted: an integer from 1 to 1024"),
        ("distance_many", dict(threads=True), "threads is True"),
        ("distance_many", dict(start=[[0, 0, 1]]), "start has 1 rows; accepted: as many as pairs, which has 3"),
        ("distance_many", dict(positions=HUGE), "positions cannot be read: Unable to allocate"),
        ("distance_many", dict(pairs=HUGE_INDICES), "pairs cannot be read: Unable to allocate"),
        (
            "distance_many",
            dict(positions=np.ma.masked_array(np.zeros((2, 3)), mask=True)),
            "positions is a masked array",
        ),
        ("contains_many", dict(points=[[0, 0, np.inf]] * 2), "points[0] is [0, 0, inf]; accepted: finite numbers"),
        ("contains_many", dict(body_of=None, points=np.zeros((3, 3))), "points has 3 rows for 2 bodies"),
        ("contains_many", dict(body_of=[0, 5]), "body_of[1] is 5; accepted: 0 to 1"),
        ("ray_cast_many", dict(directions=[[0, 0, 0]] * 2), "directions[0] is zero"),
        ("ray_cast_many", dict(directions=[[0, 0, 1]]), "directions has 1 rows; accepted: as many as origins"),
        ("time_of_contact_many", dict(velocities=[[0, 0, 0]]), "velocities has 1 rows; accepted: as many as positions"),
        (
            "time_of_contact_many",
            dict(velocities=[[0, 0, 0], [0, 0, np.nan]]),
            "velocities[1] is [0, 0, nan]; accepted: finite numbers",
        ),
        (
            "time_of_contact_many",
            dict(angular_velocities=[[np.inf, 0, 0], [0, 0, 0]]),
            "angular_velocities[0] is [inf,",
        ),
        ("time_of_contact_many", dict(inertias=[[1, 1, 1], [1, 1, 3]]), "inertias[1]: inertia is [1, 1, 3]; accepted"),
        ("time_of_contact_many", dict(inertias=[1, 1, 1]), "inertias has shape (3,); accepted: real numbers of shape"),
        ("time_of_contact_many", dict(t_max=-1), "t_max is -1; accepted: a number from 0, which may be infinite"),
        ("time_of_contact_many", dict(t_max=np.nan), "t_max is nan"),
        (
            "distance_many",
            dict(pairs=np.array([[0, 2**64 - 1]], np.uint64), start=None),
            "pairs[0, 1] is 18446744073709551615; accepted: 0 to 1",
        ),
        ("time_of_contact_many", dict(pairs=[[0, 2]]), "pairs[0, 1] is 2; accepted: 0 to 1"),
        ("time_of_contact_many", dict(quaternions=[[1, 0, 0, 0], [1, 1, 0, 0]]), "quaternions[1]: Pose: quaternion"),
        (
            "time_of_contact_many",
            dict(shapes=[E, hb.Superellipsoid([1, 1, 1], 0.2, 1)]),
            "pairs[0]: exponent is 0.2; accepted of bodies in motion: 0.25 to 1.6",
        ),
        ("time_of_contact_many", dict(finder="bracketing", eps_d=2.0), "pairs[0]: "),
        (
            "time_of_contact_many",
            dict(finder="certified"),
            'root is given, but finder="certified" has no root; accepted',
        ),
        ("time_of_contact_many", dict(finder="certified", root=None), 'eps_d is given, but finder="certified" has no'),
        ("time_of_contact", dict(finder="certified", distance="newton5"), 'distance is "newton5"; accepted: "dual"'),
        ("time_of_contact", dict(finder="certified", eps_d=None), "root is given"),
        ("Motion", dict(velocity=[1e51, 0, 0]), "velocity is [1e+51, 0, 0]; accepted: 0, or a length from 1e-50"),
        ("Motion", dict(velocity=[0, 1e-51, 0]), "velocity is [0, 1e-51, 0]"),
        ("Motion", dict(angular_velocity=[0, 1e-200, 0]), "angular_velocity is [0"),
        ("Motion", dict(angular_velocity=[1e155, 0, 0]), "angular_velocity is [1e+155"),
        (
            "time_of_contact_many",
            dict(velocities=[[1e155, 0, 0], [0, 0, 0]]),
            "velocities[0] is [1e+155, 0, 0]; accept",
        ),
        ("time_of_contact_many", dict(angular_velocities=[[0, 0, 0], [0, 0, 1e-60]]), "angular_velocities[1] is [0, 0"),
        (
            "time_of_contact_many",
            dict(shapes=[], shape_of=[0, 0]),
            "shape_of[0] is 0; accepted: none, there are no sha",
        ),
        ("at far", dict(time=1e80), "time is 1e+80: Pose: position is too far away"),
        ("mass_properties_many", dict(density=[1, 2, 3]), "density has shape (3,); accepted: a number, or one a shape"),
        ("mass_properties_many", dict(density=[1, 0]), "density[1] is 0; accepted: a finite number above 0"),
        ("mass_properties_many", dict(density=np.nan), "density is nan; accepted: a finite number above 0"),
        ("mass_properties_many", dict(shapes=[E, None]), "shapes[1] is None; accepted: Ellipsoid, Superellipsoid"),
    ],
)
def test_messages(function, bad, words):
    call, arguments = FUNCTIONS[function]
    with pytest.raises((ValueError, TypeError, MemoryError)) as caught:
        call(**{**arguments, **bad})
    assert words in str(caught.value)


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_wrong_calls_are_explained_in_one_line(name):
    function, arguments = FUNCTIONS[name]
    with pytest.raises(TypeError, match=r"^nonsense is no argument of .*; accepted: \w+\(.*\)$|argument 'nonsense'$"):
        function(**arguments, nonsense=1)
    wrong = r"^\w+ is called with \(.*\); accepted: \w+\(.*\)$|^[\w.]+\(\) takes .* given$"
    with pytest.raises(TypeError, match=wrong):
        function(*range(30))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda: hb.Ellipsoid(1, 2, 3),
            "Ellipsoid is called with (int, int, int); accepted: Ellipsoid(semi_axes: ArrayLike)",
        ),
        (lambda: hb.Ellipsoid(), "Ellipsoid is called with (); accepted: Ellipsoid(semi_axes: ArrayLike)"),
        (
            lambda: hb.Superellipsoid([1, 2, 3], e1=0.5),
            "Superellipsoid is called with (list, e1: float); accepted: "
            "Superellipsoid(semi_axes: ArrayLike, e1: float, e2: float)",
        ),
        (
            lambda: hb.contains(E, X, [0, 0, 0], tolerance=1),
            "tolerance is no argument of contains; accepted: contains(shape: AnyBody, pose: Pose, point: ArrayLike)",
        ),
        (lambda: X.apply(), "apply is called with (Pose); accepted: apply(self, points: ArrayLike)"),
    ],
)
def test_messages_about_wrong_calls(call, words):
    with pytest.raises(TypeError) as caught:
        call()
    assert str(caught.value) == words


def test_first_bad_entry_is_named_whatever_the_number_of_threads():
    positions = np.zeros((100_000, 3))
    positions[:, 0] = 10 * np.arange(100_000)
    positions[[40_000, 77_777, 99_999]] = np.nan
    pairs = np.stack([np.arange(99_999), np.arange(1, 100_000)], axis=1)
    for some in (pairs, np.tile(pairs, (2, 1))):  # poses computed at each pair, and in advance
        for threads in (1, 2, 8):
            with pytest.raises(ValueError, match=r"positions\[40000\]"):
                hb.distance_many(E, positions, None, some, threads=threads)
            # A bad index behind a bad position is not named, one before it is.
            bad = some.copy()
            bad[40_033, 1] = 100_000
            with pytest.raises(ValueError, match=r"positions\[40000\]"):
                hb.distance_many(E, positions, None, bad, threads=threads)
            bad[39_990, 0] = -1
            with pytest.raises(ValueError, match=r"pairs\[39990, 0\] is -1"):
                hb.distance_many(E, positions, None, bad, threads=threads)


@pytest.mark.parametrize("threads", [1, 3])
def test_many_answers_are_those_of_few(threads):
    """Large results are stored past the caches, two numbers at once, from blocks that are read ahead."""
    random = np.random.default_rng(2)
    positions = 4 * np.arange(300)[:, None] * np.array([1.0, 0, 0]) + random.uniform(-1, 1, (300, 3))
    quaternions = random.normal(size=(300, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    pairs = np.stack([np.arange(299), np.arange(1, 300)], axis=1)
    few = hb.distance_many(hb.Ellipsoid([1, 1, 2]), positions, quaternions, pairs)
    rows = 40_001
    which = np.resize(np.arange(299), rows)
    many = hb.distance_many(hb.Ellipsoid([1, 1, 2]), positions, quaternions, pairs[which], threads=threads)
    for name in ("distance", "normal", "point_a", "point_b", "error_bound", "residual", "iterations"):
        np.testing.assert_array_equal(getattr(many, name), getattr(few, name)[which])
    assert (np.asarray(many.status) == np.asarray(few.status)[which]).all()


def test_bodies_in_no_pair_are_not_looked_at():
    positions, quaternions = np.array([[0, 0, 0], [4, 0, 0], [np.nan, 0, 0]]), np.array([[1.0, 0, 0, 0]] * 3)
    quaternions[2] = 0
    for pairs in ([[0, 1]], [[0, 1]] * 4):  # poses computed at each pair, and in advance
        assert np.isfinite(hb.distance_many(E, positions, quaternions, pairs).distance).all()
        contacts = hb.time_of_contact_many(E, positions, quaternions, -positions, None, pairs, 9.0)
        assert set(contacts.status) == {"hit"}
