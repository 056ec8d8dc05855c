"""Bad input to every function: an exception that names the argument and what is accepted, never a crash.

HARDBODY_PYTHON_CALLS is the number of generated calls, default 2000.
"""

import math
import os
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hardbody as hb

CALLS = int(os.environ.get("HARDBODY_PYTHON_CALLS", "2000"))

E, S, X = hb.Ellipsoid([1, 1, 3]), hb.Superellipsoid([1, 2, 3], 0.5, 0.7), hb.Pose([4, 0, 2.4])
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
    finder="certified",
    max_evaluations=100,
    eps_d=1e-6,
    distance="dual",
    root="newton",
)
START = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]

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
            finder="certified",
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
}

# What messages say in place of an argument's name.
OTHER_WORDS = {
    "semi_axes": r"semi-axis [xyz] is",
    "factor": r"semi-axis [xyz] is",
    "orientation": r"^Pose: (quaternion|rotation)",
    "matrix": r"^Pose: (position|rotation)",
    "time": r"propagate: t is",
    "shapes": r"shape_of\[\d+\] is|density",
    "positions": r"body_of\[\d+\] is .*; accepted: none, there are no bodies",
}

HUGE = np.broadcast_to(np.zeros(3), (10**13, 3))
HUGE_INDICES = np.broadcast_to(np.zeros(2, np.int8), (10**13, 2))


class Hostile:
    """Object whose conversions fail."""

    def __float__(self):
        raise ZeroDivisionError("no number")

    def __repr__(self):
        raise ZeroDivisionError("no text")


def frozen(array):
    array.flags.writeable = False
    return array


shapes_of_arrays = st.lists(st.integers(0, 5), max_size=3).map(tuple)
dtypes = st.sampled_from(["f8", "f4", "f2", ">f8", "g", "i8", "i1", "u8", ">i4", "?", "c16", "O", "U3", "M8[s]", "V8"])
numbers = st.one_of(
    st.floats(), st.integers(-5, 5), st.integers(), st.sampled_from([math.nan, math.inf, 1e101, -0.0, 5e-324, 2**63])
)
arrays = st.builds(
    lambda shape, dtype, number: np.full(shape, number).astype(dtype),
    shapes_of_arrays,
    dtypes.filter(lambda d: d not in ("M8[s]", "V8")),
    st.integers(-3, 3),
)
junk = st.one_of(
    st.none(),
    st.booleans(),
    numbers,
    st.text(max_size=5),
    st.binary(max_size=5),
    st.complex_numbers(),
    arrays,
    arrays.map(lambda a: a.T[::-1] if a.ndim else a),
    arrays.map(lambda a: frozen(a.copy())),
    st.lists(numbers, max_size=5),
    st.lists(st.lists(numbers, min_size=2, max_size=4), max_size=4),
    st.lists(st.sampled_from([E, S, X, None, 1]), max_size=4),
    st.sampled_from(
        [
            E,
            S,
            X,
            hb.Motion(),
            hb,
            hb.Pose,
            object(),
            Hostile(),
            HUGE,
            HUGE_INDICES,
            {},
            {1: 2},
            {1, 2},
            range(3),
            slice(3),
            np.zeros((2, 3)),
            np.full((2, 3), np.nan),
            np.full((2, 4), 0.5),
            np.zeros(2),
            np.array([[1, -1], [0, 2]]),
            np.array([[0, 2**64 - 1]], np.uint64),
            np.datetime64("2024-01-01"),
            np.zeros((2, 3), "V8"),
            np.ma.masked_array(np.zeros((2, 3)), mask=True),
            np.array(3.0),
            np.zeros((3, 0)),
            memoryview(b"abc"),
            np.zeros(2, [("x", "f8")]),
            10**400,
            hb.Ellipsoid.__new__(hb.Ellipsoid),
            hb.Pose.__new__(hb.Pose),
        ]
    ),
)


def is_named(message, arguments, other_words):
    """Whether a message names one of these arguments as what was found, or "as many as" of it as what is accepted."""
    found = re.sub(r"\baccepted: (?!as many as).*", "", message, flags=re.DOTALL)
    return any(
        re.search(rf"\b{name}\b", found) or (name in other_words and re.search(other_words[name], message))
        for name in arguments
    )


def test_a_letter_is_no_name():
    assert is_named("a is 3; accepted: Ellipsoid", ["a"], {})
    assert is_named("start has 1 rows; accepted: as many as pairs, which has 3", ["pairs"], {})
    assert not is_named("b is 3; accepted: a shape", ["a"], {})
    assert not is_named("pairs[0] is 3; accepted: integers of shape (n,)", ["n"], {})


@st.composite
def bad_calls(draw):
    name = draw(st.sampled_from(sorted(FUNCTIONS)))
    function, arguments = FUNCTIONS[name]
    changed = draw(st.lists(st.sampled_from(sorted(arguments)), min_size=1, max_size=2, unique=True))
    return name, function, {**arguments, **{key: draw(junk) for key in changed}}, changed


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_right_arguments_are_accepted(name):
    function, arguments = FUNCTIONS[name]
    function(**arguments)


@pytest.mark.filterwarnings("ignore:overflow encountered", "ignore:invalid value encountered")
@pytest.mark.filterwarnings("ignore:nanobind.*uninitialized:RuntimeWarning")
@settings(max_examples=CALLS)
@given(bad_calls())
def test_bad_arguments_are_named(call):
    name, function, arguments, changed = call
    try:
        function(**arguments)
    except (ValueError, TypeError, MemoryError) as error:
        assert is_named(str(error), changed, OTHER_WORDS), f"{name}, {changed}: {error}"
    except hb.UndecidedError:
        assert name == "overlap"
    except ZeroDivisionError as error:
        assert str(error) in ("no number", "no text")


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
        ("distance_many", dict(shapes="E"), "shapes is 'E'; accepted: Ellipsoid, Superellipsoid, or a list of them"),
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
        ("distance_many", dict(positions=np.ma.masked_array(np.zeros((2, 3)))), "positions is a masked array"),
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
        ("time_of_contact_many", dict(pairs=[[0, 2]]), "pairs[0, 1] is 2; accepted: 0 to 1"),
        ("time_of_contact_many", dict(quaternions=[[1, 0, 0, 0], [1, 1, 0, 0]]), "quaternions[1]: Pose: quaternion"),
        (
            "time_of_contact_many",
            dict(shapes=[E, hb.Superellipsoid([1, 1, 1], 0.2, 1)]),
            "pairs[0]: exponent is 0.2; accepted of bodies in motion: 0.25 to 1.6",
        ),
        ("time_of_contact_many", dict(finder="bracketing", eps_d=2.0), "pairs[0]: "),
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


def test_first_bad_entry_is_named_whatever_the_number_of_threads():
    positions = np.zeros((100_000, 3))
    positions[:, 0] = 10 * np.arange(100_000)
    positions[[40_000, 77_777, 99_999]] = np.nan
    pairs = np.stack([np.arange(99_999), np.arange(1, 100_000)], axis=1)
    for some in (pairs, np.tile(pairs, (2, 1))):  # poses computed at each pair, and in advance
        for threads in (1, 2, 8):
            with pytest.raises(ValueError, match=r"positions\[40000\]"):
                hb.distance_many(E, positions, None, some, threads=threads)


def test_bodies_in_no_pair_are_not_looked_at():
    positions, quaternions = np.array([[0, 0, 0], [4, 0, 0], [np.nan, 0, 0]]), np.array([[1.0, 0, 0, 0]] * 3)
    quaternions[2] = 0
    for pairs in ([[0, 1]], [[0, 1]] * 4):  # poses computed at each pair, and in advance
        assert np.isfinite(hb.distance_many(E, positions, quaternions, pairs).distance).all()
        contacts = hb.time_of_contact_many(E, positions, quaternions, -positions, None, pairs, 9.0)
        assert set(contacts.status) == {"hit"}
