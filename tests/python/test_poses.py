"""Pose: what it is made of, what it does to points."""

import copy
import pickle

import numpy as np
import pytest
from conftest import rotations, unit_rows

import hardbody as hb


def test_default_is_identity():
    X = hb.Pose()
    assert np.array_equal(X.matrix, np.eye(4))
    assert X == hb.Pose([0, 0, 0], [1, 0, 0, 0])
    assert repr(X) == "Pose([0, 0, 0], [1, 0, 0, 0])"


def test_quaternion_is_w_x_y_z_body_to_world():
    X = hb.Pose([1, 2, 3], [np.sqrt(0.5), 0, 0, np.sqrt(0.5)])  # a quarter turn about z
    np.testing.assert_allclose(X.apply([1, 0, 0]), [1, 3, 3], atol=1e-15)
    np.testing.assert_allclose(X.apply_inverse([1, 3, 3]), [1, 0, 0], atol=1e-15)


def test_all_forms_of_an_orientation_agree(random):
    from scipy.spatial.transform import Rotation

    for q, R in zip(Q := unit_rows(random, 20, 4), rotations(Q), strict=True):
        p = random.normal(size=3)
        X = hb.Pose(p, q)
        M = np.eye(4)
        M[:3, :3], M[:3, 3] = R, p
        scipy = Rotation.from_quat([*q[1:], q[0]])
        for other in (
            hb.Pose(p, R),
            hb.Pose(p, scipy),
            hb.Pose.from_matrix(M),
            hb.Pose.normalized(p, 7.5 * q),
            hb.Pose.nearest(M + 1e-9),
            hb.Pose(list(p), tuple(q)),
            hb.Pose(p, R.T.copy().T),
        ):
            np.testing.assert_allclose(other.matrix, X.matrix, atol=5e-9)
        np.testing.assert_allclose(X.rotation, R, atol=1e-15)
        np.testing.assert_allclose(X.quaternion, q * np.sign(q[0]), atol=1e-15)
        np.testing.assert_array_equal(X.position, p)


def test_composition_inverse_and_points(random):
    X, Y = (hb.Pose(random.normal(size=3), unit_rows(random, 1, 4)[0]) for _ in range(2))
    points = random.normal(size=(30, 3))
    np.testing.assert_allclose((X * Y).apply(points), X.apply(Y.apply(points)), atol=1e-14)
    np.testing.assert_allclose((X @ Y).matrix, X.matrix @ Y.matrix, atol=1e-14)
    np.testing.assert_allclose(X.inverse().apply(points), X.apply_inverse(points), atol=1e-14)
    np.testing.assert_allclose(X.apply_inverse(X.apply(points)), points, atol=1e-14)
    assert X.apply(points[0]).shape == (3,)
    assert X.apply(np.zeros((0, 3))).shape == (0, 3)


def test_copies_have_the_same_bits(random):
    for q in unit_rows(random, 50, 4):
        X = hb.Pose(random.normal(size=3), q)
        assert pickle.loads(pickle.dumps(X)) == X
        assert copy.deepcopy(X) == X


def test_attributes_are_copies():
    X = hb.Pose([1, 2, 3])
    X.position[0] = 7
    assert X.position[0] == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (([1, 2],), "position has shape (2,); accepted: 3 real numbers"),
        (([1, 2, np.nan],), "position"),
        (([1, 2, 1e101],), "position"),
        (("abc",), "position is 'abc'; accepted: 3 real numbers"),
        (([0, 0, 0], [1, 0, 0, 1]), "quaternion (w, x, y, z) is not of length 1"),
        (([0, 0, 0], [1, 0, 0]), "orientation has shape (3,); accepted: a quaternion"),
        (([0, 0, 0], 2 * np.eye(3)), "not orthonormal"),
        (([0, 0, 0], -np.eye(3)), "reflection"),
        (([0, 0, 0], np.eye(3) * 1j), "orientation has dtype complex128"),
    ],
)
def test_bad_poses_are_refused(arguments, words):
    with pytest.raises((ValueError, TypeError)) as caught:
        hb.Pose(*arguments)
    assert words in str(caught.value)


def test_rotations_of_scipy_must_be_single(random):
    from scipy.spatial.transform import Rotation

    with pytest.raises(ValueError, match=r"orientation has shape \(2, 3, 3\)"):
        hb.Pose([0, 0, 0], Rotation.random(2))


@pytest.mark.parametrize("array", [np.ones(3), np.eye(4)])
def test_arrays_are_no_operands(array):
    X = hb.Pose()
    for call in (lambda: X @ array, lambda: array @ X, lambda: X * array, lambda: array * X):
        with pytest.raises(TypeError, match=r"^other is of type ndarray; accepted: a Pose; Pose.apply transforms"):
            call()
    with pytest.raises(TypeError, match="unsupported operand"):
        X @ 3

    class Frame:
        def __rmatmul__(self, other):
            return "mine"

    assert X @ Frame() == "mine"


def test_matrices_must_be_homogeneous():
    with pytest.raises(ValueError, match=r"matrix\[3\] is \[0, 0, 1, 1\]"):
        hb.Pose.from_matrix([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1]])
