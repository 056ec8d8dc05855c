"""Shapes that are written in Python: the same answers as built-in ones, and no crash whatever they do."""

import pickle

import numpy as np
import pytest
from conftest import work_after_interrupt
from test_simulation import bits

import hardbody as hb

AXES = np.array([0.7, 0.7, 2.0])


class Spheroid:
    """Ellipsoid by its support function."""

    bounding_radius = 2.0
    inscribed_radius = 0.7
    volume = 4 / 3 * np.pi * AXES.prod()
    symmetry_axis = 2
    centrally_symmetric = True

    def min_curvature_radius(self):
        return 0.7**2 / 2.0

    def support(self, n):
        v = AXES * n
        length = np.sqrt(v @ v)
        return length, AXES * v / length

    def inertia(self, mass):
        return hb.Ellipsoid(AXES).inertia(mass)


class Exact(Spheroid):
    """The same with second derivatives."""

    def support_hessian(self, n):
        v = AXES * n
        length = np.sqrt(v @ v)
        return (np.diag(AXES**2) - np.outer(AXES * v, AXES * v) / length**2) / length


class Broken(Spheroid):
    """The same until it is told to fail."""

    calls = 0
    fails_at = None
    answer = None

    def support(self, n):
        self.calls += 1
        if self.fails_at is not None and self.calls >= self.fails_at:
            if self.answer is None:
                raise LookupError("mine")
            return self.answer
        return super().support(n)


BUILT_IN = hb.Ellipsoid(AXES)


class HugeHessian(Spheroid):
    """Shape whose second derivatives overflow."""

    def support_hessian(self, n):
        return np.eye(3) * 1e300


def test_directions_that_have_overflowed_are_not_asked():
    shape = HugeHessian()
    for place in ([3, 4, 5], [0.3, 0.4, 0.5]):
        r = hb.distance(shape, hb.Pose(), shape, hb.Pose(place))
        assert r.status in ("not_converged", "singular") or np.isfinite(r.distance)
    b = hb.Motion(hb.Pose([3, 4, 5]), velocity=[-1, -1, -1])
    assert hb.time_of_contact(shape, hb.Motion(), shape, b, 9).status in ("hit", "budget_exhausted", "failed")


def test_a_bounding_radius_that_is_too_small_is_told_by_the_heights():
    class Small(Spheroid):
        bounding_radius = inscribed_radius = 0.7

    with pytest.raises(ValueError, match=r"^shape Small: the support height along \(0, 0, 1\) is 2; accepted: between"):
        hb.CustomShape(Small())


def start(shape, number=8):
    return hb.random_start(hb.Species(shape, inertia="uniform"), number=number, packing_fraction=0.02, seed=3)


@pytest.mark.parametrize("shape", [Spheroid(), Exact(), hb.CustomShape(Exact(), name="mine")])
def test_contacts_are_those_of_the_built_in_shape(shape):
    system = start(BUILT_IN)
    own = hb.System(
        system.box,
        hb.Species(shape, inertia="uniform"),
        system.positions,
        system.rotations,
        system.velocities,
        system.angular_velocities,
    )
    simulations = [hb.Simulation(s, neighbours="dilated") for s in (system, own)]
    for s in simulations:
        s.record_collisions(100)
        s.run(collisions=12)
    one, other = (s.recorded for s in simulations)
    np.testing.assert_array_equal(one["i"], other["i"])
    np.testing.assert_array_equal(one["j"], other["j"])
    np.testing.assert_allclose(one["time"], other["time"], rtol=1e-9)
    np.testing.assert_allclose(simulations[0].positions, simulations[1].positions, atol=1e-8)
    assert other.size == 12 and simulations[1].audit().sound


def test_shapes_come_back_as_they_were_given():
    shape = Spheroid()
    species = hb.Species(shape, mass=2)
    assert species.shape.object is shape and species.shape.name == "Spheroid"
    assert species.spins and species.symmetry_axis == 2
    np.testing.assert_allclose(species.inertia, BUILT_IN.inertia(2))
    system = hb.random_start(species, number=8, packing_fraction=0.02)
    assert system.species[0].shape.object is shape
    with pytest.raises(ValueError, match="scaled"):
        species.scaled(2)


def test_queries_take_them(random):
    shape, a, b = Exact(), hb.Pose([0.1, 0, 0]), hb.Pose([2, 1, 3], [0.6, 0, 0.8, 0])
    wanted = hb.distance(BUILT_IN, a, BUILT_IN, b)
    for one, other in ((shape, BUILT_IN), (BUILT_IN, shape), (shape, hb.CustomShape(shape)), (Spheroid(), shape)):
        r = hb.distance(one, a, other, b)
        assert r.status == "separated" and r.distance == pytest.approx(wanted.distance, rel=1e-12)
        np.testing.assert_allclose(r.point_b, wanted.point_b, atol=1e-7)
        assert not hb.overlap(one, a, other, b)
        assert hb.distance_lower_bound(one, a, other, b, wanted.normal) == pytest.approx(wanted.distance, rel=1e-12)
    p = hb.closest_point(shape, b, [3, 3, 3])
    np.testing.assert_allclose(p.point, hb.closest_point(BUILT_IN, b, [3, 3, 3]).point, atol=1e-7)
    hit, known = (hb.ray_cast(s, b, [9, 9, 9], [-7, -8, -6]) for s in (shape, BUILT_IN))
    assert hit.status == known.status == "hit" and hit.t == pytest.approx(known.t, rel=1e-9)
    motion = hb.Motion(b, [-1, -0.5, -1.5], inertia=BUILT_IN.inertia())
    contact, known = (hb.time_of_contact(s, hb.Motion(), s, motion, t_max=9) for s in (shape, BUILT_IN))
    assert contact.status == known.status and contact.time == pytest.approx(known.time, rel=1e-9)


def test_restored_states_take_shapes_again():
    simulation = hb.Simulation(start(Exact()))
    simulation.run(collisions=3)
    state = simulation.save()
    restored = hb.Simulation.restore(state, shapes=[Exact()])
    for s in (simulation, restored):
        s.run(collisions=3)
    assert bits(simulation) == bits(restored)
    with pytest.raises(ValueError, match='needs the shape "Exact"'):
        hb.Simulation.restore(state)
    with pytest.raises(ValueError, match="shapes has 2"):
        hb.Simulation.restore(state, shapes=[Exact(), Exact()])
    with pytest.raises(ValueError, match="other species"):
        hb.Simulation.restore(state, shapes=[Spheroid()])


# ---- What they do wrong


def test_exceptions_in_a_run_are_raised_by_it():
    shape = Broken()
    simulation = hb.Simulation(start(shape))
    state = simulation.save()
    shape.fails_at = shape.calls + 200
    with pytest.raises(LookupError, match="mine"):
        simulation.run(collisions=100)
    for access in (lambda: simulation.positions, lambda: simulation.run(time=1), simulation.save):
        with pytest.raises(RuntimeError, match="left within an event"):
            access()
    shape.fails_at = None
    restored = hb.Simulation.restore(state, shapes=[shape])
    restored.run(collisions=2)
    assert restored.collisions == 2


class Growing(Spheroid):
    """The same until it grows: bodies are then in each other."""

    size = 1.0

    def support(self, n):
        height, point = super().support(n)
        return self.size * height, self.size * point


def test_overlaps_raise_with_the_failed_pairs():
    shape = Growing()
    velocities, turns = [[0, 0, 1], [0, 0, -1]], [[0.7, 0, 0], [-0.3, 0.4, 0]]
    system = hb.System(20, shape, [[0, 0, -2.5], [0, 0, 2.5]], None, velocities, turns)
    simulation = hb.Simulation(system)
    simulation.run(time=0.1)

    def grow(simulation):
        shape.size = 1.1

    with pytest.raises(hb.NumericalError, match="overlap") as caught:
        simulation.run(time=2, every=0.01, callback=grow)
    error = caught.value
    assert error.counters.overlaps == simulation.counters.overlaps > 0
    pair = error.failures[0]
    assert {pair.i, pair.j} == {0, 1} and "overlap" in pair.reason
    assert pair.shape_i.object is shape
    r = hb.distance(pair.shape_i, pair.motion_i.at(pair.time).pose, pair.shape_j, pair.motion_j.at(pair.time).pose)
    assert r.distance < 0
    with pytest.raises(TypeError, match="JSON"):
        pair.to_json()
    assert pickle.loads(pickle.dumps(error)).failures == []  # a shape that contradicts its radii cannot be made again
    shape.size = 1.0
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.counters, again.stall) == (str(error), error.counters, error.stall)
    assert [(p.i, p.j, p.time) for p in again.failures] == [(p.i, p.j, p.time) for p in error.failures]
    shape.local = lambda: None  # cannot be pickled
    assert pickle.loads(pickle.dumps(error)).failures == []
    state = list(pair.__getstate__())
    state[1] = state[2] = hb.Ellipsoid([1, 1, 3])
    built_in = hb.FailedPair.__new__(hb.FailedPair)
    built_in.__setstate__(tuple(state))
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        kept = pickle.loads(pickle.dumps(hb.NumericalError("x", [pair, built_in], error.counters), protocol))
        assert kept.failures == [built_in] and kept.failures[0].to_json() == built_in.to_json()
    # The simulation is whole.
    shape.size = 1.1
    assert simulation.positions.shape == (2, 3) and not simulation.audit().sound


@pytest.mark.parametrize("call", [2, 60, 150, 400])
def test_exceptions_in_starts_and_queries_are_raised_by_them(call):
    shape = Broken()
    hb.distance(shape, hb.Pose(), BUILT_IN, hb.Pose([3, 0, 0]))
    shape.calls, shape.fails_at = 0, call
    with pytest.raises(LookupError, match="mine"):
        start(shape, 32)
        hb.Simulation(start(shape, 32)).run(collisions=100)


@pytest.mark.parametrize("name", ["min_curvature_radius", "bounding_radius", "volume", "support_hessian", "support"])
@pytest.mark.parametrize("error", [OSError, KeyboardInterrupt])
def test_exceptions_of_properties_are_raised(name, error):
    def fails(self):
        raise error("mine")

    shape = type("Failing", (Broken,), {name: property(fails)})()
    with pytest.raises(error, match="^mine$"):
        hb.CustomShape(shape)


WRONG = [
    (TypeError, "tuple", 3.0),
    (TypeError, r"has 3 entries; accepted: a tuple of the height", (1.0, 2.0, 3.0)),
    (TypeError, r"\[0\]", ("1", [0, 0, 1])),
    (ValueError, r"\[1\]", (1.0, [0, 0])),
    (ValueError, "height", (1.0, [0, 0, 0])),
    (ValueError, "height", (np.nan, [0, 0, 1])),
    (ValueError, "height", (1.0, [np.inf, 0, 1])),
]


@pytest.mark.parametrize("kind, message, answer", WRONG)
def test_wrong_answers_are_named(kind, message, answer):
    shape = Broken()
    simulation = hb.Simulation(start(shape))
    shape.fails_at, shape.answer = 0, answer
    with pytest.raises(kind, match=r"Broken\.support\(.*" + message):
        simulation.run(collisions=10)


def changed(**attributes):
    return type("Changed", (Spheroid,), attributes)()


REFUSED = [
    (TypeError, "bounding_radius", changed(bounding_radius=None)),
    (TypeError, "bounding_radius", changed(bounding_radius="2")),
    (ValueError, "bounding_radius", changed(bounding_radius=-1.0)),
    (ValueError, "support height", changed(bounding_radius=1.5)),
    (ValueError, "inscribed_radius", changed(inscribed_radius=3.0)),
    (ValueError, "support height", changed(inscribed_radius=0.8)),
    (ValueError, "volume", changed(volume=100.0)),
    (ValueError, "symmetry_axis", changed(symmetry_axis=0)),
    (ValueError, "symmetry_axis", changed(symmetry_axis=3)),
    (TypeError, r"Changed\.volume is 'large'; accepted: a real number", changed(volume="large")),
    (TypeError, r"Changed\.symmetry_axis is 1.5; accepted: an integer from 0 to 2", changed(symmetry_axis=1.5)),
    (TypeError, r"Changed\.centrally_symmetric is 1; accepted: True, False, None", changed(centrally_symmetric=1)),
    (
        TypeError,
        r"Changed\.min_curvature_radius has dtype <U1; accepted: a real number",
        changed(min_curvature_radius=["a"]),
    ),
    (TypeError, r"Changed\.support_hessian is of type ndarray; accepted: a method", changed(support_hessian=np.eye(3))),
    (TypeError, r"Changed\.inertia is of type list; accepted: a method, or None", changed(inertia=[1, 1, 1])),
    (TypeError, "support", changed(support=None)),
    (TypeError, "tuple", changed(support=lambda self, n: n)),
]


@pytest.mark.parametrize("kind, message, shape", REFUSED, ids=[f"{k}-{m}" for k, (_, m, _) in enumerate(REFUSED)])
def test_contradictions_are_refused(kind, message, shape):
    with pytest.raises(kind, match=message):
        hb.CustomShape(shape)
    with pytest.raises(kind, match=message):
        hb.Species(shape)


def test_a_class_is_no_shape():
    with pytest.raises(
        TypeError, match=r"^object is the class Spheroid; accepted: an object of it, Spheroid\(\.\.\.\)$"
    ):
        hb.CustomShape(Spheroid)


def test_dynamics_needs_volume_and_moments():
    shape = changed(volume=None, inertia=None)
    assert hb.CustomShape(shape).volume is None
    assert hb.distance(shape, hb.Pose(), BUILT_IN, hb.Pose([3, 0, 0])).status == "separated"
    with pytest.raises(TypeError, match="volume is missing"):
        hb.Species(shape, inertia=[1, 1, 1])
    with pytest.raises(TypeError, match="inertia is missing"):
        hb.Species(hb.CustomShape(shape, volume=Spheroid.volume))
    assert hb.Species(hb.CustomShape(shape, volume=Spheroid.volume), inertia=[1, 1, 0.5]).inertia[2] == 0.5


def test_ctrl_c_ends_a_run_between_events():
    simulation, other = hb.Simulation(start(Exact())), hb.Simulation(start(Exact()))
    assert work_after_interrupt(lambda: simulation.run(time=1e9)) < 3
    collisions = simulation.collisions
    simulation.run(collisions=3)
    other.run(collisions=collisions)
    other.run(collisions=3)
    assert bits(simulation) == bits(other)


def test_texts_with_nul_are_refused():
    with pytest.raises(ValueError, match=r"^name is 'a\\x00b'; accepted: a string without NUL$"):
        hb.CustomShape(Spheroid(), name="a\0b")
    with pytest.raises(ValueError, match=r"^penetration is 'local\\x00'; accepted: \"global\", \"local\"$"):
        hb.distance(
            hb.Ellipsoid([1, 1, 1]), hb.Pose(), hb.Ellipsoid([1, 1, 1]), hb.Pose([3, 0, 0]), penetration="local\0"
        )
