"""Species, states and starts: arrays in and out, groups, bad input."""

import logging
import pathlib
import pickle

import numpy as np
import pytest
from conftest import rotations, unit_rows
from scipy.spatial.transform import Rotation

import hardbody as hb

ROD = hb.Ellipsoid.spheroid(3.0)


def test_arrays_go_in_and_come_out(random):
    n = 20
    q = unit_rows(random, n, 4)
    q[q[:, 0] < 0] *= -1
    p, v, w = random.uniform(-9, 9, (n, 3)), random.normal(size=(n, 3)), random.normal(size=(n, 3))
    kinds = random.integers(0, 2, n)
    system = hb.System(
        50.0, [hb.Species(ROD, spins=True), hb.Species(hb.Ellipsoid([1, 2, 3]), mass=2)], p, q, v, w, kinds
    )
    assert len(system) == n and system.box == 50
    np.testing.assert_array_equal(system.positions, p)
    np.testing.assert_allclose(system.orientations, q, atol=2e-15)
    np.testing.assert_allclose(system.rotations, rotations(q), atol=2e-15)
    np.testing.assert_array_equal(system.velocities, v)
    np.testing.assert_array_equal(system.angular_velocities, w)
    np.testing.assert_array_equal(system.species_of, kinds)
    assert [s.mass for s in system.species] == [1, 2]
    volume = 4 / 3 * np.pi * np.where(kinds == 0, 1, 6).sum()
    assert system.packing_fraction == pytest.approx(volume / 50**3)
    again = hb.System(50.0, system.species, p, system.rotations, v, w, kinds)
    np.testing.assert_array_equal(again.rotations, system.rotations)
    scipy = hb.System(50.0, system.species, p, Rotation.from_quat(q, scalar_first=True), v, w, kinds)
    np.testing.assert_allclose(scipy.rotations, system.rotations, atol=2e-15)
    copy = pickle.loads(pickle.dumps(system))
    np.testing.assert_array_equal(copy.rotations, system.rotations)
    assert copy.groups == system.groups


def test_nematic_order_is_the_largest_eigenvalue(random):
    q = unit_rows(random, 50, 4)
    system = hb.System(50, ROD, random.uniform(0, 50, (50, 3)), q)
    u = rotations(q)[:, :, 2]
    Q = 1.5 * np.einsum("ki,kj->ij", u, u) / 50 - 0.5 * np.eye(3)
    assert system.nematic_order == pytest.approx(np.linalg.eigvalsh(Q)[-1], rel=1e-12)


def test_species_have_the_moments_of_their_kind():
    paper = hb.Species(ROD)
    b = 3 ** (-1 / 3)
    assert not paper.spins
    np.testing.assert_allclose(paper.inertia[:2], 0.4 * b * b)
    uniform = hb.Species(hb.Ellipsoid([1, 2, 3]), mass=5)
    assert uniform.spins and uniform.symmetry_axis is None
    np.testing.assert_allclose(uniform.inertia, [5 / 5 * (4 + 9), 5 / 5 * (1 + 9), 5 / 5 * (1 + 4)])
    assert hb.Species(ROD, inertia="uniform").spins and not hb.Species(ROD, inertia="uniform", spins=False).spins
    own = hb.Species(ROD, inertia=[1, 1, 0.5])
    np.testing.assert_array_equal(own.inertia, [1, 1, 0.5])
    half = uniform.scaled(0.5)
    assert half.mass == 5 / 8
    np.testing.assert_allclose(half.inertia, uniform.inertia / 32)
    copy = pickle.loads(pickle.dumps(paper))
    assert copy.shape == ROD and copy.spins is False


def test_starts_are_thermal_and_without_overlap():
    system = hb.random_start(ROD, number=100, packing_fraction=0.3, seed=4)
    assert len(system) == 100 and system.packing_fraction == pytest.approx(0.3)
    audit = system.audit()
    assert audit.sound and audit.minimum_distance > 0
    assert audit.kinetic.translational_kT == pytest.approx(1) and audit.kinetic.rotational_kT == pytest.approx(1)
    denser = hb.compressed(system, 0.4)
    assert denser.packing_fraction == pytest.approx(0.4) and denser.audit().sound
    crystal = hb.lattice_start(ROD, number=240, packing_fraction=0.6)
    assert crystal.nematic_order == pytest.approx(1) and crystal.audit().sound
    ordered = hb.lattice_start(ROD, number=256, packing_fraction=0.3, nematic_order=0.6)
    assert ordered.nematic_order == pytest.approx(0.6, abs=0.1)
    reached = []
    hb.random_start(ROD, number=500, packing_fraction=0.5, progress=reached.append)
    assert reached == sorted(reached) and all(0 < f <= 0.5 for f in reached)


def test_audit_tries_all_images():
    rod, ball = hb.Ellipsoid([1.6, 0.1, 0.1]), hb.Sphere(0.1)
    half = 0.5 * np.arctan2(0.6, 1.4)
    along = [np.cos(half), 0, 0, np.sin(half)]
    found = hb.System(2.5, [rod, ball], [[0, 0, 0], [1.4, 0.6, 0]], [along, [1, 0, 0, 0]]).audit()
    assert (found.sound, found.overlaps, found.closest_pair) == (False, 1, (0, 1))
    alone = hb.System(1.5, hb.Sphere(1), [[0, 0, 0]]).audit()
    assert (alone.overlaps, alone.closest_pair) == (3, (0, 0))
    assert alone.minimum_distance == pytest.approx(-0.5, abs=1e-13)


def test_velocities_are_drawn_anew():
    system = hb.random_start([(ROD, 20), (hb.Species(hb.Ellipsoid([1, 1, 1]), mass=9), 30)], packing_fraction=0.1)
    other = system.thermalized(seed=3)
    assert other.groups == [20, 30]
    np.testing.assert_array_equal(other.positions, system.positions)
    assert (other.velocities != system.velocities).all()
    assert other.kinetic().translational_kT == pytest.approx(1)
    np.testing.assert_array_equal(other.velocities, system.thermalized(3).velocities)
    # Without spin about its axis.
    u = other.rotations[:20, :, 2]
    np.testing.assert_allclose((other.angular_velocities[:20] * u).sum(axis=1), 0, atol=1e-14)


def test_sizes_are_distributed():
    bodies = hb.Polydisperse(ROD, 400, 0.2, sizes="uniform", seed=11)
    system = hb.random_start([bodies, (hb.Ellipsoid([0.5, 0.5, 0.5]), 10)], packing_fraction=0.05)
    sizes = np.array([s.mass for s in system.species[:400]]) ** (1 / 3)
    assert sizes.mean() == pytest.approx(1, abs=0.05) and sizes.std() == pytest.approx(0.2, abs=0.03)
    assert system.groups == [400, 10]


def test_groups_follow_the_species():
    positions = np.arange(12).reshape(4, 3) * 5.0

    def groups(species_of, **options):
        return hb.System(60, [ROD, ROD], positions, species_of=species_of, **options).groups

    assert groups([0, 0, 1, 1]) == [2, 2]
    assert groups([0, 1, 0, 1]) == [4]
    assert groups([0, 0, 0, 1], groups=[1, 3]) == [1, 3]
    assert hb.System(60, [ROD] * 4, positions).groups == [4]


CASES = pathlib.Path(__file__).resolve().parents[1] / "reference/cases"


def test_files_of_other_programs(caplog):
    with caplog.at_level(logging.INFO, "hardbody"):
        system = hb.from_gsd(CASES / "m2_velocity_of_frame_0.gsd", 1)
    assert "velocities drawn" in caplog.text  # frame 1 stores none
    assert len(system) == 2 and system.box == 10 and system.species[0].shape == hb.Ellipsoid([0.5, 0.5, 0.5])
    assert system.kinetic().translational_kT == pytest.approx(1)
    caplog.clear()
    with caplog.at_level(logging.INFO, "hardbody"):
        first = hb.from_gsd(str(CASES / "m2_velocity_of_frame_0.gsd"), -3)
    assert "frame 0" in caplog.text and "translation rescaled" in caplog.text
    assert not np.array_equal(first.positions, system.positions)
    with pytest.raises(ValueError, match=r"accepted: components="):
        hb.from_gsd(CASES / "m5_wrapped.lammpstrj")
    ball = hb.Species(hb.Ellipsoid([0.5, 0.5, 0.5]), mass=2)
    alike = hb.from_gsd(CASES / "m8_velocities.lammpstrj", 0, ball)  # as many as the file has
    assert len(alike) == 2 and alike == hb.from_gsd(CASES / "m8_velocities.lammpstrj", 0, [(ball, 2)])
    with pytest.raises(ValueError, match="has 2 bodies of its types, components have 3; accepted: the same numbers"):
        hb.from_gsd(CASES / "m8_velocities.lammpstrj", 0, [(ball, 3)])
    with pytest.raises(ValueError, match="body 0 is .*, in components .*; accepted: the same, or no components"):
        hb.from_gsd(CASES / "m2_velocity_of_frame_0.gsd", 1, hb.Ellipsoid([0.6, 0.6, 0.6]))
    assert hb.from_gsd(CASES / "m8_velocities.lammpstrj", 0, [(ball, 2)]).species[0].mass == 2
    with pytest.raises(ValueError, match="has no orientations"):
        hb.from_gsd(CASES / "m3_orientation_of_frame_0.gsd")
    with pytest.raises(ValueError, match="^frame is 7; accepted: -3 to 2 in "):
        hb.from_gsd(CASES / "m2_velocity_of_frame_0.gsd", 7)
    with pytest.raises(ValueError, match="frame is -4; accepted: -3 to 2"):
        hb.from_gsd(CASES / "m2_velocity_of_frame_0.gsd", -4)
    with pytest.raises(ValueError, match="overlap.*mend=True"):
        hb.from_gsd(CASES / "m10_diameter_overlap.gsd", components=[(ball, 2)])
    with pytest.raises(ValueError, match="a box 1.1 times as large does not separate them"):
        hb.from_gsd(CASES / "m10_diameter_overlap.gsd", components=[(ball, 2)], mend=True)


def test_one_species_is_that_of_all_types_of_a_file(tmp_path):
    shape = {"kind": "sphere", "diameter": 1.0}
    config = {
        "seed": 4,
        "system": {"packing_fraction": 0.1},
        "species": [{"number": 8} | shape, {"number": 24, "mass": 2.0} | shape],
        "equilibration": {"time": 0.0},
        "production": {"time": 0.1},
        "output": {"trajectory": ["gsd"], "frames": 2},
    }
    run = hb.run(config, tmp_path / "a")
    system = hb.from_gsd(run.path / "trajectory.gsd", components=hb.Species(hb.Sphere(0.5), mass=3))
    assert system.groups == [8, 24]
    assert {s.mass for s in system.species} == {3.0}
    assert system.kinetic().translational_kT == pytest.approx(1)


def test_sizes_of_a_polydisperse_run_are_drawn_again(tmp_path):
    config = {
        "seed": 4,
        "system": {"number": 32, "packing_fraction": 0.1},
        "species": [{"aspect_ratio": 2.0, "sizes": "gaussian", "width": 0.1}],
        "equilibration": {"time": 0.0},
        "production": {"time": 0.1},
        "output": {"trajectory": ["gsd"], "frames": 2},
    }
    file = hb.run(config, tmp_path / "a").path / "trajectory.gsd"
    with pytest.raises(ValueError, match="components with a Polydisperse"):
        hb.from_gsd(file)
    rods = hb.Species(hb.Ellipsoid.spheroid(2.0))
    system = hb.from_gsd(file, components=hb.Polydisperse(rods, 32, 0.1), seed=4)
    assert len({s.shape.volume for s in system.species}) == 32
    assert system.packing_fraction == pytest.approx(0.1, rel=1e-12)
    with pytest.raises(ValueError, match=f"{file}: "):
        hb.from_gsd(file, components=hb.Polydisperse(rods, 32, 0.1), seed=5)


def test_lattices_have_numbers_that_fill_them():
    for lattice, number in (("fcc", 500), ("cubic", 512)):
        assert len(hb.lattice_start(hb.Sphere(1), packing_fraction=0.5, lattice=lattice)) == number
    assert len(hb.lattice_start(hb.Sphere(1), packing_fraction=0.55)) == 500


P = [[0, 0, 0], [5, 0, 0]]
REFUSED = [
    (ValueError, "box", lambda: hb.System(0, ROD, P)),
    (ValueError, "box", lambda: hb.System(np.nan, ROD, P)),
    (TypeError, "box", lambda: hb.System("9", ROD, P)),
    (TypeError, "species", lambda: hb.System(9, "rod", P)),
    (TypeError, r"species\[1\]", lambda: hb.System(9, [ROD, None], P)),
    (ValueError, "species has 3 elements", lambda: hb.System(9, [ROD] * 3, P)),
    (ValueError, "positions has shape", lambda: hb.System(9, ROD, [1, 2, 3])),
    (ValueError, r"positions\[1\]", lambda: hb.System(9, ROD, [[0, 0, 0], [np.inf, 0, 0]])),
    (ValueError, r"orientations\[0\].*length", lambda: hb.System(9, ROD, P, np.ones((2, 4)))),
    (ValueError, "orientations has 1 rows", lambda: hb.System(9, ROD, P, [[1, 0, 0, 0]])),
    (ValueError, r"orientations has shape", lambda: hb.System(9, ROD, P, np.ones((2, 5)))),
    (ValueError, r"orientations\[1\]", lambda: hb.System(9, ROD, P, [np.eye(3), -np.eye(3)])),
    (ValueError, "velocities has 1 rows", lambda: hb.System(9, ROD, P, velocities=[[0, 0, 0]])),
    (
        ValueError,
        r"angular_velocities\[1\] is .* about its axis .* spins=True",
        lambda: hb.System(9, ROD, P, angular_velocities=[[1, 0, 0], [1, 0, 1e-3]]),
    ),
    (ValueError, r"angular_velocities\[0\]", lambda: hb.System(9, ROD, P, angular_velocities=[[np.nan, 0, 0]] * 2)),
    (ValueError, r"species_of\[1\] is 1", lambda: hb.System(9, ROD, P, species_of=[0, 1])),
    (TypeError, "species_of", lambda: hb.System(9, ROD, P, species_of=[0.0, 0.0])),
    (ValueError, "sum of groups", lambda: hb.System(9, ROD, P, groups=[1])),
    (TypeError, "shape", lambda: hb.Species(3)),
    (ValueError, "mass", lambda: hb.Species(ROD, mass=-1)),
    (ValueError, "inertia", lambda: hb.Species(ROD, inertia="thin")),
    (ValueError, "inertia", lambda: hb.Species(ROD, inertia=[1, 1, 3])),
    (ValueError, "inertia", lambda: hb.Species(hb.Ellipsoid([1, 2, 3]), inertia="paper")),
    (TypeError, "spins", lambda: hb.Species(ROD, spins=1)),
    (ValueError, "spin", lambda: hb.Species(hb.Ellipsoid([1, 2, 3]), spins=False)),
    (ValueError, "exponent", lambda: hb.Species(hb.Superellipsoid([1, 1, 1], 0.2, 0.2))),
    (ValueError, "width", lambda: hb.Polydisperse(ROD, 10, 0.9)),
    (ValueError, "sizes", lambda: hb.Polydisperse(ROD, 10, 0.1, sizes="flat")),
    (ValueError, "number", lambda: hb.Polydisperse(ROD, 0, 0.1)),
    (ValueError, "number of bodies", lambda: hb.random_start([(ROD, 1)], packing_fraction=0.1)),
    (TypeError, r"components\[0\]", lambda: hb.random_start([ROD], packing_fraction=0.1)),
    (TypeError, "number is 5", lambda: hb.random_start([(ROD, 9)], number=5, packing_fraction=0.1)),
    (TypeError, "components", lambda: hb.random_start({}, packing_fraction=0.1)),
    (ValueError, "packing", lambda: hb.random_start(ROD, packing_fraction=0.9)),
    (ValueError, "packing_fraction", lambda: hb.random_start(ROD, packing_fraction=np.nan)),
    (ValueError, "number", lambda: hb.random_start(ROD, number=4, packing_fraction=0.4)),
    (ValueError, "number is 0; accepted: an integer from 2", lambda: hb.random_start(ROD, 0, packing_fraction=0.1)),
    (ValueError, "number is 1; accepted: an integer from 2", lambda: hb.random_start(ROD, 1, packing_fraction=0.1)),
    (ValueError, "seed", lambda: hb.random_start(ROD, packing_fraction=0.1, seed=-1)),
    (
        ValueError,
        r"^the frame of shape cone .*; accepted: a shape of in_principal_frame",
        lambda: hb.Species(hb.Cone(2, 1, base=-1)),
    ),
    (
        ValueError,
        r"^the frame of shape cone .*, rounded by 0.1 is not",
        lambda: hb.Species(hb.Rounded(hb.Cone(2, 1), 0.1)),
    ),
    (TypeError, "seed", lambda: hb.random_start(ROD, packing_fraction=0.1, seed=1.5)),
    (ValueError, "nematic", lambda: hb.random_start(ROD, packing_fraction=0.1, nematic_order=1.5)),
    (TypeError, "progress", lambda: hb.random_start(ROD, packing_fraction=0.1, progress=3)),
    (ValueError, "lattice", lambda: hb.lattice_start(ROD, number=32, packing_fraction=0.1, lattice="hcp")),
    (ValueError, "number", lambda: hb.lattice_start(ROD, number=33, packing_fraction=0.1)),
    (ValueError, "axis", lambda: hb.lattice_start(ROD, number=32, packing_fraction=0.1, axis=3)),
    (FileNotFoundError, "nowhere", lambda: hb.from_gsd("nowhere.gsd")),
    (TypeError, "path", lambda: hb.from_gsd(3)),
    (ValueError, "accepted: ", lambda: hb.from_gsd(__file__)),
]


@pytest.mark.parametrize("kind, message, call", REFUSED, ids=[f"{k}-{m}" for k, (_, m, _) in enumerate(REFUSED)])
def test_bad_input_is_named(kind, message, call):
    with pytest.raises(kind, match=message):
        call()


def moving(speed, z=8.0):
    """Two rods, of which one moves."""
    return hb.Simulation(hb.System(30, ROD, [[0, 0, 0], [0, 0, z]], None, [[0, 0, 0], [0, speed, 0]]))


def test_the_number_of_bodies_that_is_accepted_is_the_smallest():
    with pytest.raises(ValueError, match=r"^number: .*; accepted: at least \d+ bodies$") as caught:
        hb.random_start(ROD, number=2, packing_fraction=0.3)
    least = int(str(caught.value).split()[-2])
    assert len(hb.random_start(ROD, number=least, packing_fraction=0.3)) == least
    with pytest.raises(ValueError, match=f"at least {least} bodies"):
        hb.random_start(ROD, number=least - 1, packing_fraction=0.3)


def test_states_in_single_precision(random):
    """Angular velocities across the axis of exact orientations; orientations are then rounded."""
    start = hb.random_start(ROD, number=64, packing_fraction=0.1, seed=5)
    arguments = (start.positions, start.orientations, start.velocities, start.angular_velocities)
    rounded = hb.System(start.box, ROD, *(a.astype("f4") for a in arguments))
    np.testing.assert_allclose(rounded.orientations, start.orientations, atol=1e-6)
    exact = hb.System(start.box, ROD, arguments[0], arguments[1].astype("f4"), *arguments[2:])
    hb.Simulation(exact).run(collisions=50)
    with pytest.raises(ValueError, match=r"angular_velocities\[0\] is .*, which turns body 0 about its axis"):
        hb.System(9, ROD, [[0, 0, 0]], None, None, [[1, 0, 1e-4]])


SYSTEM = hb.random_start(ROD, number=32, packing_fraction=0.1)
DILUTE = hb.random_start(ROD, number=64, packing_fraction=0.01)  # cells are the fastest neighbours
CELLS, OBP = {"neighbours": "cells"}, {"neighbours": "obp"}
REFUSED_BY_SIMULATIONS = [
    (TypeError, "system is 3; accepted: System", lambda s: hb.Simulation(3)),
    (TypeError, "system is None", lambda s: hb.compressed(None, 0.5)),
    (ValueError, "overlap at the start", lambda s: hb.Simulation(hb.System(30, ROD, [[0, 0, 0], [0.1, 0, 0]]))),
    (ValueError, r"^velocity of the fastest body, 1, is \[0, 1e.51, 0\]; accepted: 0, or a", lambda s: moving(1e51)),
    (ValueError, "^velocity of the fastest body, 1, is .*; accepted: 0, or a", lambda s: moving(1e-200)),
    (ValueError, "^1 pairs of bodies overlap at the start, the deepest by 1.38627 ", lambda s: moving(1.0, z=0.1)),
    (ValueError, "number is 1", lambda s: hb.Simulation(hb.System(30, ROD, [[0, 0, 0]]))),
    (ValueError, "box", lambda s: hb.Simulation(hb.System(5, ROD, [[0, 0, 0], [2.5, 2.5, 0]]))),
    (ValueError, "neighbours", lambda s: hb.Simulation(SYSTEM, neighbours="all")),
    (ValueError, "finder", lambda s: hb.Simulation(SYSTEM, finder="best")),
    (ValueError, "distance", lambda s: hb.Simulation(SYSTEM, distance="newton8")),
    (ValueError, "envelope", lambda s: hb.Simulation(SYSTEM, envelope=-1)),
    (ValueError, "envelope is 1000; accepted: at most ", lambda s: hb.Simulation(SYSTEM, envelope=1000)),
    (ValueError, "envelope is 1e-09; accepted: at least ", lambda s: hb.Simulation(SYSTEM, envelope=1e-9)),
    (ValueError, "envelope is 1e.300; accepted: at most ", lambda s: hb.Simulation(SYSTEM, envelope=1e300, **OBP)),
    (ValueError, "envelope is 0.3 with neighbours=None, where cells", lambda s: hb.Simulation(DILUTE, envelope=0.3)),
    (
        ValueError,
        "envelope is 0.3 with neighbours=.cells.; accepted: None",
        lambda s: hb.Simulation(DILUTE, envelope=0.3, **CELLS),
    ),
    (RuntimeError, "tune_envelopes needs .*cells", lambda s: hb.Simulation(DILUTE).tune_envelopes()),
    (ValueError, "eps_d is given, but finder", lambda s: hb.Simulation(SYSTEM, eps_d=1e-6)),
    (ValueError, "root is given, but finder", lambda s: hb.Simulation(SYSTEM, root="newton")),
    (ValueError, "eps_d", lambda s: hb.Simulation(SYSTEM, finder="bracketing", eps_d=100.0)),
    (ValueError, "instruction_set", lambda s: hb.Simulation(SYSTEM, instruction_set="sse")),
    (ValueError, "prepare_from", lambda s: hb.Simulation(SYSTEM, prepare_from=0)),
    (TypeError, "one of time, collisions and until", lambda s: s.run()),
    (TypeError, "one of time, collisions and until", lambda s: s.run(1.0, 5)),
    (ValueError, "time is -1", lambda s: s.run(-1)),
    (ValueError, "time is inf", lambda s: s.run(np.inf)),
    (ValueError, "until is 0", lambda s: (s.run(1), s.run(until=0))),
    (ValueError, "collisions is -1", lambda s: s.run(collisions=-1)),
    (TypeError, "collisions", lambda s: s.run(collisions=1.5)),
    (TypeError, "every and callback", lambda s: s.run(1, every=0.1)),
    (TypeError, "callback", lambda s: s.run(1, every=0.1, callback=3)),
    (ValueError, "every", lambda s: s.run(1, every=0, callback=print)),
    (ValueError, "every", lambda s: s.run(1, every=1e-17, callback=print)),
    (TypeError, "progress", lambda s: s.run(1, progress=3)),
    (ValueError, "target_box", lambda s: s.shrink_box(0)),
    (ValueError, "number", lambda s: s.record_collisions(-1)),
    (ValueError, "duration", lambda s: s.measure(0)),
    (ValueError, "longest_lag", lambda s: s.measure(1, longest_lag=2)),
    (ValueError, "wave_numbers", lambda s: s.measure(1, wave_numbers=[-1.0])),
    (ValueError, "number of wave_numbers", lambda s: s.measure(1, wave_numbers=np.ones(9))),
    (ValueError, 'order is "nematic"', lambda s: s.measure(1, order=["nematic"])),
    (ValueError, "each at most once", lambda s: s.measure(1, order=["hexatic", "hexatic"])),
    (TypeError, "order is 'hexatic'", lambda s: s.measure(1, order="hexatic")),
    (ValueError, "order_neighbours is 3", lambda s: s.measure(1, order_neighbours=3)),
    (ValueError, "time is 1", lambda s: (s.run(1), s.measure(1))),
    (RuntimeError, "measured", lambda s: (s.measure(1), s.shrink_box(5))),
    (TypeError, r"shapes\[0\]", lambda s: hb.Simulation.restore(s.save(), shapes=[3])),
]


@pytest.mark.parametrize(
    "kind, message, call",
    REFUSED_BY_SIMULATIONS,
    ids=[f"{k}-{m}" for k, (_, m, _) in enumerate(REFUSED_BY_SIMULATIONS)],
)
def test_simulations_name_bad_input(kind, message, call):
    with pytest.raises(kind, match=message):
        call(hb.Simulation(SYSTEM))
