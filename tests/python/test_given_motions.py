"""Motions given as functions of time: time_of_contact and Scene.first_contact."""

import copy
import math

import numpy as np
import pytest

import hardbody as hb

BALL = hb.Sphere(1)


def along_x(x):
    return lambda t: hb.Pose([x(t), 0, 0])


def test_contact_of_a_python_function():
    motion = hb.GivenMotion(along_x(lambda t: 4 - 2.5 * math.sin(t)), (2.5, 0, 2.5, 0))
    hit = hb.time_of_contact(BALL, hb.GivenMotion.resting(hb.Pose()), BALL, motion, t_max=2)
    assert hit.status == "hit" and abs(hit.time - math.asin(0.8)) < 1e-12
    np.testing.assert_allclose(hit.normal, [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(hit.point, [1, 0, 0], atol=1e-12)
    speeds = hb.GivenMotion(along_x(lambda t: 4 - 2.5 * math.sin(t)), lambda begin, end: (2.5, 0))
    slow = hb.time_of_contact(BALL, hb.GivenMotion.resting(hb.Pose()), BALL, speeds, t_max=2)
    assert abs(slow.time - hit.time) < 1e-12 and slow.evaluations > hit.evaluations
    assert hb.time_of_contact(BALL, speeds, BALL, hb.Motion(), t_max=2, t_min=1.2).status == "overlapping"


def test_scales_are_roundings():
    # A clock that began long ago: places are rounded to 1e-7.
    late, rest = along_x(lambda t: (t + 1e9) - 1e9 - 5), hb.GivenMotion.resting(hb.Pose())
    hit = hb.time_of_contact(BALL, hb.GivenMotion(late, (1, 0, 0, 0), scales=(0, 1e9)), BALL, rest, t_max=10)
    assert hit.status == "hit" and hit.time == pytest.approx(3, abs=1e-6)


def test_motions_of_machines():
    arm = hb.GivenMotion.screw(hb.Pose([3, 0, 0]), [0, 0, 1], [0, 0, 0], angular_speed=1)
    wall = hb.GivenMotion.resting(hb.Pose([0, 2.5, 0]))
    hit = hb.time_of_contact(BALL, arm, hb.Box([5, 0.5, 5]), wall, t_max=3)
    assert abs(hit.time - math.asin(1 / 3)) < 1e-12
    hand = hb.GivenMotion.screw(hb.Pose([2, 0, 0]), [0, 0, 1], [1, 0, 0], angular_speed=-1).on(
        hb.GivenMotion.screw(hb.Pose(), [0, 0, 1], angular_speed=1)
    )
    np.testing.assert_allclose(hand.pose(math.pi / 2).position, [1, 1, 0], atol=1e-15)
    way = hb.GivenMotion.spline([0, 1, 2], [hb.Pose(), hb.Pose([1, 0, 0]), hb.Pose([1, 1, 0])])
    np.testing.assert_allclose(way.pose(1).position, [1, 0, 0], atol=1e-15)
    assert len(way.bounds(0, 2)) == 4 and way.check(0, 2) == "" and way.bounds(3, 4) == (0, 0, 0, 0)
    flight = hb.GivenMotion.flight(hb.Motion(hb.Pose([5, 0, 0]), velocity=[-1, 0, 0]))
    assert flight.bounds(0, 1)[0] == pytest.approx(1)


def test_first_contact_of_a_scene():
    scene = hb.Scene()
    ball, near, far = (scene.add(BALL, hb.Pose([x, 0, 0])) for x in (0, 4, 9))
    right = hb.GivenMotion.screw(hb.Pose(), [1, 0, 0], speed=1)
    found = scene.first_contact({ball: right}, 10)
    assert (found.i, found.j, found.contact.status) == (ball, near, "hit")
    assert found.contact.time == pytest.approx(2) and not found.image.any()
    np.testing.assert_allclose(scene.pose(ball).position, [2, 0, 0])
    both = scene.first_contact({ball: right, near: hb.Motion(hb.Pose([4, 0, 0]), velocity=[4, 0, 0])}, 10)
    assert (both.i, both.j) == (near, far) and both.contact.time == pytest.approx(0.75)
    none = scene.first_contact({ball: right}, 1)
    assert (none.i, none.j, none.image, none.contact.status) == (None, None, None, "separated")


def test_exceptions_of_functions_are_passed_on():
    def fails(t):
        raise ZeroDivisionError("at " + str(t))

    rest = hb.GivenMotion.resting(hb.Pose())
    with pytest.raises(ZeroDivisionError):
        hb.time_of_contact(BALL, rest, BALL, hb.GivenMotion(fails, (1, 0)), t_max=1)
    scene = hb.Scene()
    body = scene.add(BALL, hb.Pose([3, 0, 0]))
    with pytest.raises(ZeroDivisionError):
        scene.first_contact({body: hb.GivenMotion(fails, (1, 0))}, 1)
    np.testing.assert_array_equal(scene.pose(body).position, [3, 0, 0])

    def moves(t):
        if len(scene) == 1:
            scene.move(body, hb.Pose())
        return hb.Pose()

    with pytest.raises(RuntimeError, match="query is running"):
        scene.first_contact({body: hb.GivenMotion(moves, (1, 0))}, 1)

    def asks(t):
        scene.pairs_within(1)
        return hb.Pose()

    with pytest.raises(RuntimeError, match="first_contact is running"):
        scene.first_contact({body: hb.GivenMotion(asks, (1, 0))}, 1)
    assert len(scene.pairs_within(1)) == 0


def test_bad_input():
    rest = hb.GivenMotion.resting(hb.Pose())

    def contact(b, **more):
        return hb.time_of_contact(BALL, rest, BALL, b, **{"t_max": 1, **more})

    fast = hb.GivenMotion(along_x(lambda t: 5 - t), (0.1, 0, 0, 0))
    with pytest.raises(ValueError, match="the motion of B breaks its bounds: it moves by"):
        contact(fast, t_max=50)
    with pytest.raises(TypeError, match="motion_b is 3; accepted: Motion, GivenMotion"):
        contact(3)
    with pytest.raises(TypeError, match="pose"):
        hb.GivenMotion(3, (1, 0))
    with pytest.raises(ValueError, match="bounds"):
        hb.GivenMotion(along_x(abs), (-1, 0))
    for wrong in ((1, 0, 0), (1,), 3):
        with pytest.raises(ValueError, match=r"^bounds has shape .*; accepted: 2 or 4 real numbers"):
            hb.GivenMotion(along_x(abs), wrong)
    for bounds in [(np.inf, 0), (0, np.inf), (np.inf, 0, 1, 1)]:
        with pytest.raises(ValueError, match=r"^bounds is .*inf.*; accepted: finite speeds; accelerations may be inf"):
            hb.GivenMotion(lambda t: hb.Pose(), bounds)
    assert hb.GivenMotion(lambda t: hb.Pose(), (0, 0, np.inf, np.inf)).bounds(0, 1) == (0, 0, np.inf, np.inf)
    with pytest.raises(TypeError, match=r"^poses\[1\] is None"):
        hb.GivenMotion.spline([0, 1], [hb.Pose(), None])
    with pytest.raises(ValueError, match=r"^GivenMotion\.spline: 3 times and 2 poses"):
        hb.GivenMotion.spline([0, 1, 2], [hb.Pose(), hb.Pose()])
    with pytest.raises(ValueError, match="a scale is -1"):
        hb.GivenMotion(along_x(abs), (1, 0), scales=(-1, 0))
    with pytest.raises((TypeError, ValueError), match="scales"):
        hb.GivenMotion(along_x(abs), (1, 0), scales=1)
    with pytest.raises(TypeError, match=r"pose\(t\)"):
        contact(hb.GivenMotion(lambda t: 3, (1, 0)))
    with pytest.raises(ValueError, match="t_max"):
        contact(rest, t_max=math.inf)
    with pytest.raises(ValueError, match="tolerance"):
        contact(rest, tolerance=1)
    with pytest.raises(ValueError, match="finder"):
        contact(rest, finder="bracketing")
    with pytest.raises(ValueError, match="t_min is given"):
        hb.time_of_contact(BALL, hb.Motion(), BALL, hb.Motion(hb.Pose([5, 0, 0])), t_max=1, t_min=0)
    with pytest.raises(ValueError, match="too large"):
        hb.GivenMotion.spline([0, 1], [hb.Pose(), hb.Pose([0, 0, 0], [0, 1, 0, 0])])
    scene = hb.Scene()
    scene.add(BALL, hb.Pose())
    for moving in ({1.9: rest}, {"0": rest}, {True: rest}, [(0, rest)]):
        with pytest.raises(TypeError, match="moving"):
            scene.first_contact(moving, 1)
    with pytest.raises(TypeError, match="accepted: Motion, GivenMotion"):
        scene.first_contact({0: 3}, 1)
    with pytest.raises(ValueError, match="end is 0; accepted: a time not before begin"):
        rest.check(1, 0)
    with pytest.raises(TypeError, match="pickled"):
        copy.copy(rest)
    with pytest.raises(ValueError, match="way|poses"):
        hb.GivenMotion.spline([0], [hb.Pose()])
