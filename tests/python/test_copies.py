"""Pickling, copying and comparison of everything that users hold."""

import copy
import dataclasses
import gc
import pickle
import weakref

import numpy as np
import pytest
from test_custom_shapes import Spheroid

import hardbody as hb
from hardbody._tables import read_table

ROD = hb.Ellipsoid([1.0, 1.0, 3.0])
APART = hb.Pose([0.5, 0.2, 8.0])
HERE = hb.Pose()
SYSTEM = hb.random_start(ROD, number=30, packing_fraction=0.1, seed=3)


@dataclasses.dataclass
class Sized(Spheroid):
    """Shape that compares by its value."""

    size: float = 1.0


def simulation():
    made = hb.Simulation(SYSTEM)
    made.run(collisions=20)
    return made


def measured(seed=1):
    made = hb.Simulation(SYSTEM.thermalized(seed))
    observables = made.measure(1.0)
    made.run(time=1.0)
    return observables.results()


POSITIONS = np.array([[0.0, 0, 0], [0, 0, 8.0]])


def scene():
    """Two rods."""
    rods = hb.Scene()
    rods.add_many(ROD, POSITIONS)
    return rods


VALUES = {
    "Pose": APART,
    "Motion": hb.Motion(APART, [1, 0, 0], [0, 1, 0], [1, 2, 2.5], 0.5),
    "DistanceResult": hb.distance(ROD, HERE, ROD, APART),
    "DistanceResult without answer": hb.distance(ROD, HERE, hb.Ellipsoid([1, 1, 1e4]), HERE, max_iterations=1),
    "ClosestPoint": hb.closest_point(ROD, HERE, [0, 0, 9]),
    "RayHit": hb.ray_cast(ROD, HERE, [0, 0, 9], [0, 0, -1]),
    "RayHit that misses": hb.ray_cast(ROD, HERE, [0, 0, 9], [0, 0, 1]),
    "ContactResult": hb.time_of_contact(ROD, hb.Motion(), ROD, hb.Motion(APART, [0, 0, -1]), 20),
    "ContactResult without a hit": hb.time_of_contact(ROD, hb.Motion(), ROD, hb.Motion(APART), 20),
    "MassProperties": hb.mass_properties(ROD, 2.0),
    "Counters": simulation().counters,
    "Kinetic": SYSTEM.kinetic(),
    "Audit": SYSTEM.audit(),
    "Species": hb.Species(ROD, mass=2.0, inertia="uniform"),
    "Species of one's own shape": hb.Species(Sized()),
    "Polydisperse": hb.Polydisperse(hb.Species(ROD), 10, 0.1, "lognormal", seed=7),
    "Polydisperse without a seed": hb.Polydisperse(hb.Species(ROD), 10, 0.1),
    "CustomShape": hb.CustomShape(Sized(2.0), name="mine", volume=4.2, symmetry_axis=2, centrally_symmetric=True),
    "CustomShape as it is": hb.CustomShape(Sized()),
    "Distances": hb.distance_many(ROD, POSITIONS, None, [[0, 1]]),
    "Overlaps": hb.overlap_many(ROD, POSITIONS, None, [[0, 1]]),
    "ClosestPoints": hb.closest_point_many(ROD, POSITIONS, None, POSITIONS + 5),
    "RayHits": hb.ray_cast_many(ROD, POSITIONS, None, POSITIONS + 5, -POSITIONS - 5),
    "Masses": hb.mass_properties_many([ROD, ROD]),
    "Derivatives": hb.distance_derivatives(ROD, HERE, ROD, APART),
    "DerivativesMany": hb.distance_derivatives_many(ROD, POSITIONS, None, [[0, 1]]),
    "ContactPatch": hb.contact_patch(ROD, HERE, ROD, hb.Pose([0, 0, 6]), 0.1),
    "ContactPatches": hb.contact_patch_many(ROD, POSITIONS, None, [[0, 1]], 3.0),
    "ScenePairs": scene().pairs_within(9.0),
    "SceneOverlaps": scene().overlapping_pairs(),
    "SceneBodies": scene().overlapping(ROD, HERE),
    "ScenePair": scene().distance(0, 1),
    "SceneNearest": scene().nearest_to(0),
    "ScenePoint": scene().closest_point([9, 9, 9]),
    "ScenePoints": scene().closest_point_many(POSITIONS + 5),
    "SceneRayHit": scene().ray_cast([0, 0, 9], [0, 0, -1]),
    "SceneRayHits": scene().ray_cast_many(POSITIONS + 5, -POSITIONS - 5),
    "Results": measured(),
    "Estimate that is missing": hb.Estimate(float("nan"), float("nan"), "too short"),
}


@pytest.mark.parametrize("value", VALUES.values(), ids=VALUES)
@pytest.mark.parametrize("copied", [lambda v: pickle.loads(pickle.dumps(v)), copy.copy, copy.deepcopy])
def test_copies_are_equal(value, copied):
    again = copied(value)
    assert type(again) is type(value)
    assert again == value and not again != value
    assert repr(again) == repr(value)


def test_other_values_are_not_equal():
    different = {
        "Motion": hb.Motion(APART),
        "DistanceResult": hb.distance(ROD, HERE, ROD, hb.Pose([0, 0, 9])),
        "ClosestPoint": hb.closest_point(ROD, HERE, [0, 0, 10]),
        "RayHit": VALUES["RayHit that misses"],
        "ContactResult": VALUES["ContactResult without a hit"],
        "MassProperties": hb.mass_properties(ROD),
        "Counters": hb.Simulation(SYSTEM).counters,
        "Kinetic": SYSTEM.thermalized(2).kinetic(),
        "Audit": SYSTEM.thermalized(2).audit(),
        "Species": hb.Species(ROD, mass=2.5, inertia="uniform"),
        "Species of one's own shape": hb.Species(Sized(3.0)),
        "Polydisperse": hb.Polydisperse(hb.Species(ROD), 10, 0.1, "lognormal", seed=8),
        "CustomShape": hb.CustomShape(Sized(2.0), name="other", volume=4.2, symmetry_axis=2, centrally_symmetric=True),
        "CustomShape as it is": hb.CustomShape(Sized(3.0)),
        "Distances": hb.distance_many(ROD, POSITIONS / 2, None, [[0, 1]]),
        "Overlaps": hb.overlap_many(ROD, POSITIONS / 4, None, [[0, 1]]),
        "Masses": hb.mass_properties_many([ROD]),
        "Results": measured(2),
        "Estimate that is missing": hb.Estimate(float("nan"), float("nan"), "another reason"),
    }
    for name, other in different.items():
        assert type(other) is type(VALUES[name])
        assert other != VALUES[name], name
    for name, value in VALUES.items():
        assert value != 3 and value != "", name


def test_members_survive(random):
    """Equality alone could forget a member that __repr__ does not show."""
    for name in ("DistanceResult", "ContactResult", "MassProperties", "Kinetic", "Audit", "Counters", "Polydisperse"):
        value = VALUES[name]
        again = pickle.loads(pickle.dumps(value))
        members = [m for m in dir(type(value)) if not m.startswith("_") and not callable(getattr(value, m))]
        assert len(members) > 4
        for member in members:
            np.testing.assert_equal(getattr(again, member), getattr(value, member))


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_every_protocol(protocol):
    for name, value in VALUES.items():
        assert pickle.loads(pickle.dumps(value, protocol)) == value, name


@pytest.mark.parametrize("kind", sorted({type(v) for v in VALUES.values()} | {hb.Simulation}, key=lambda k: k.__name__))
def test_weak_references(kind):
    value = simulation() if kind is hb.Simulation else next(v for v in VALUES.values() if type(v) is kind)
    assert weakref.ref(value)() is value


def test_a_shape_that_refers_weakly_to_its_species_is_freed():
    class Owner(Sized):
        species: weakref.ref[hb.Species]

    shape = Owner(1.0)
    species = hb.Species(shape, inertia=[0.4, 0.4, 0.4])
    shape.species = weakref.ref(species)
    found = weakref.ref(shape)
    del shape, species
    gc.collect()
    assert found() is None


@pytest.mark.parametrize("state", [(), (1.0,), ("a",) * 8, (1.0, 2, 3, 4, 5, 6, 7, 8), tuple(range(14)), (-1,) * 14])
@pytest.mark.parametrize("name", ["DistanceResult", "RayHit", "Counters", "MassProperties", "Audit"])
def test_other_states_are_refused(name, state):
    kind = type(VALUES[name])
    if name == "Counters" and state == tuple(range(14)):
        return  # a state
    with pytest.raises((TypeError, ValueError), match="state"):
        kind.__new__(kind).__setstate__(state)


def test_what_cannot_be_pickled_says_what_can():
    made = simulation()
    observables = hb.Simulation(SYSTEM).measure(1.0)
    for duplicate in (pickle.dumps, copy.copy, copy.deepcopy):
        with pytest.raises(TypeError, match=r"^a Simulation cannot be pickled .*; accepted: the bytes of save\(\)"):
            duplicate(made)
        with pytest.raises(TypeError, match=r"^Observables cannot be pickled .*; accepted: results\(\)"):
            duplicate(observables)
    local = type("Local", (Spheroid,), {})
    with pytest.raises((TypeError, AttributeError, pickle.PicklingError), match="Local"):
        pickle.dumps(hb.CustomShape(local()))


def test_systems_of_own_shapes(random):
    system = hb.System(50.0, hb.Species(Sized(1.5)), random.uniform(0, 50, (5, 3)))
    again = pickle.loads(pickle.dumps(system))
    assert again == system and again.species == system.species
    assert system != hb.System(50.0, hb.Species(Sized(1.5)), random.uniform(0, 50, (5, 3)))
    np.testing.assert_array_equal(again.positions, system.positions)


def test_tables_keep_their_units(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("t [time],n\n0.5,1\n,2\n1.5,3\n")
    table = read_table(file)
    for again in (pickle.loads(pickle.dumps(table)), copy.copy(table), copy.deepcopy(table), table[1:], table.copy()):
        assert type(again) is hb.Table and again.names == table.names
        assert again.units == {"t": "time", "n": ""}
        again.units["t"] = "another"
        assert table.units["t"] == "time"
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(table))["t"], table["t"])


def test_directories_and_files_compare_by_their_path(tmp_path):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "config.toml").write_text("")
    one, other = hb.Run(tmp_path / "a"), hb.Run(tmp_path / "b")
    assert one == hb.Run(tmp_path / "b" / ".." / "a") and one != other and len({one, hb.Run(one)}) == 1
    assert one.observables == hb.Run(one).observables and one.observables != other.observables
    assert hb.Report(tmp_path / "r") == hb.Report(tmp_path / "r") != hb.Report(tmp_path / "q")
    assert hb.Map(tmp_path / "m", tmp_path / "c") == hb.Map(tmp_path / "m", tmp_path / "c")


def test_errors_of_runs_keep_the_run(tmp_path):
    (tmp_path / "config.toml").write_text("")
    error = pickle.loads(pickle.dumps(hb.UnsoundError("NOT SOUND", hb.Run(tmp_path))))
    assert (str(error), error.run) == ("NOT SOUND", hb.Run(tmp_path))
    assert pickle.loads(pickle.dumps(hb.UnsoundError("NOT SOUND"))).run is None
