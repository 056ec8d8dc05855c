"""Dynamics: the bits of the program and of the C++ library, conservation, callbacks, errors, memory."""

import csv
import gc
import json
import os
import pathlib
import pickle
import re
import struct
import subprocess
import threading
import time

import numpy as np
import pytest
from conftest import work_after_interrupt

import hardbody as hb

ROOT = pathlib.Path(__file__).resolve().parents[2]


def fluid(number=64, packing_fraction=0.2, aspect_ratio=3.0, seed=1, **options):
    shape = hb.Ellipsoid.spheroid(aspect_ratio)
    return hb.random_start(shape, number=number, packing_fraction=packing_fraction, seed=seed, **options)


def dimer(distance=4.0, speed=1.0):
    """Two unit spheres that approach each other."""
    return hb.System(
        20,
        hb.Ellipsoid([1, 1, 1]),
        [[-distance / 2, 0, 0], [distance / 2, 0, 0]],
        None,
        [[speed, 0, 0], [-speed, 0, 0]],
    )


def bits(simulation):
    system = simulation.system
    return b"".join(
        np.ascontiguousarray(a).tobytes()
        for a in (
            system.positions,
            system.rotations,
            system.velocities,
            system.angular_velocities,
            simulation.unwrapped_positions,
            simulation.time,
            simulation.virial,
        )
    )


# ---- The same bits


def fnv(data):
    """FNV-1a, 64 bits."""
    value = 14695981039346656037
    for byte in data:
        value = ((value ^ byte) * 1099511628211) & 0xFFFFFFFFFFFFFFFF
    return value


def golden_hash(simulation):
    """Hash of the state, as tests/common/ed/hash.h computes it."""
    system = simulation.system
    axes = system.rotations.transpose(0, 2, 1).reshape(-1, 9)
    bodies = np.hstack([system.positions, axes, system.velocities, system.angular_velocities])
    of_system = fnv(struct.pack("<d", system.box) + bodies.tobytes())
    numbers = struct.pack("<QdQd", of_system, simulation.time, simulation.collisions, simulation.virial)
    motion = simulation.angular_displacements.tobytes() + simulation.unwrapped_positions.tobytes()
    return f"0x{fnv(numbers + motion):016x}"


GOLDEN = {
    "StateOfRods": (3.0, "paper", {}),
    "StateOfSpinningDiscs": (0.5, "uniform", {}),
    "StateOfRodsInOrientedBoxes": (3.0, "paper", {"neighbours": "obp"}),
    "StateOfRodsInCells": (2.0, "paper", {"neighbours": "cells"}),
    "StateOfRodsByThePapersFinder": (3.0, "paper", {"finder": "bracketing", "eps_d": 1e-6}),
}


@pytest.mark.parametrize("name", GOLDEN)
def test_states_are_those_of_the_library(name):
    aspect_ratio, inertia, options = GOLDEN[name]
    text = (ROOT / "tests/golden/golden_test.cpp").read_text()
    known = re.search(rf'{name}\).*?"x86-64", "(0x[0-9a-f]+)"', text, re.DOTALL).group(1)
    species = hb.Species(hb.Ellipsoid.spheroid(aspect_ratio), inertia=inertia)
    start = hb.random_start(species, number=128, packing_fraction=0.30, seed=7)
    simulation = hb.Simulation(start, **{"neighbours": "dilated", **options})
    simulation.run(collisions=4000)
    simulation.run(collisions=6000)
    assert golden_hash(simulation) == known


PROGRAM = os.environ.get("HARDBODY")
CONFIG = """seed = 5
[system]
{system}
{bodies}
[equilibration]
time = 0
[production]
time = 2
[output]
events = 100000
trajectory = ["gsd"]
frames = 2
"""


def program_run(directory, **parts):
    (directory / "run.toml").write_text(CONFIG.format(**parts))
    subprocess.run([PROGRAM, "run", "run.toml", "--out", "out"], cwd=directory, check=True, capture_output=True)
    with open(directory / "out/events.csv", newline="") as file:
        rows = [(float(r["time"]), int(r["i"]), int(r["j"])) for r in csv.DictReader(file)]
    return rows, json.loads((directory / "out/summary.json").read_text())


def same_start(summary, system):
    return hb.Simulation(system, envelope=summary["neighbours"]["envelope"])


@pytest.mark.skipif(not PROGRAM, reason="needs HARDBODY, the path of the program")
def test_collisions_are_those_of_the_program(tmp_path):
    rows, summary = program_run(
        tmp_path, system="number = 100\npacking_fraction = 0.3", bodies="[shape]\naspect_ratio = 3.0"
    )
    simulation = same_start(summary, fluid(100, 0.3, seed=5))
    simulation.record_collisions(10**6)
    observables = simulation.measure(duration=2, wave_numbers=summary["wave_numbers"])
    simulation.run(time=2, every=0.3, callback=lambda s: None)
    assert [tuple(row) for row in simulation.recorded.tolist()] == rows
    assert simulation.collisions == len(rows) == summary["counters"]["collisions"]
    results = observables.results()
    for key, there in summary["observables"].items():
        here = results[key]
        if isinstance(here, hb.Estimate):
            assert here.value == there["value"] or (np.isnan(here.value) and there["value"] is None), key
            assert here.error == there["error"] or (np.isnan(here.error) and there["error"] is None), key
    decays = summary["observables"]["t_F_1overe_q"]
    assert len(decays) == len(summary["wave_numbers"])
    np.testing.assert_equal(
        [(e.value, e.error) for e in results["t_F_1overe_q"]],
        [tuple(np.nan if e[name] is None else e[name] for name in ("value", "error")) for e in decays],
    )
    # Displacements of the shortest of these lags are all within reach.
    G = results["van_hove"]
    np.testing.assert_allclose((4 * np.pi * (G["r"] ** 2 + 0.1**2 / 12) * 0.1 * G["G_s_t1"]).sum(), 1, rtol=1e-6)
    assert results["overlap"]["overlap"][0] == 1
    with open(tmp_path / "out/observables/msd.csv", newline="") as file:
        next(file)
        there = np.array([[float(x) if x else np.nan for x in line.split(",")] for line in file])
    here = results["msd"]
    assert here.dtype.names == ("t", "msd", "msd_error")
    np.testing.assert_array_equal(np.stack([here[n] for n in here.dtype.names], axis=1), there)


def test_averages_over_time_origins_by_numpy():
    """What frames of a file do not tell: rotational displacements, velocities, rates, pressure, temperatures."""
    simulation = hb.Simulation(fluid(32, 0.15, seed=5))
    observables = simulation.measure(duration=4, longest_lag=1)
    kept = {name: [] for name in ("positions", "velocities", "angular_velocities", "angular_displacements")}
    times = []
    while np.isfinite(observables.next_time):
        times.append(observables.next_time)
        simulation.run(until=times[-1])
        for name, values in kept.items():
            values.append(getattr(simulation, name))
    kept = {name: np.array(values) for name, values in kept.items()}
    times = np.array(times)
    results = observables.results()
    lags = results["velocity"]["t"]
    origins = [t for t in times if np.isclose(t * 4, round(t * 4), atol=1e-9)]  # four in a longest lag

    def at(t):
        return int(np.argmin(abs(times - t)))

    for k, lag in enumerate(lags):
        pairs = [(at(t), at(t + lag)) for t in origins if t + lag <= 4 * (1 + 1e-9)]
        first, second = np.array(pairs).T
        assert np.allclose(times[second] - times[first], lag, atol=1e-9)
        for key, name in (("vacf", "velocities"), ("wacf", "angular_velocities")):
            product = (kept[name][first] * kept[name][second]).sum(axis=2).mean()
            np.testing.assert_allclose(results["velocity"][key][k], product, rtol=1e-10, atol=1e-12)
        if lag > 0:
            turned = kept["angular_displacements"][second] - kept["angular_displacements"][first]
            row = np.flatnonzero(results["rotational_msd"]["t"] == lag)[0]
            found = results["rotational_msd"]["rot_msd"][row]
            np.testing.assert_allclose(found, (turned**2).sum(axis=2).mean(), rtol=1e-8)
    n, duration = len(simulation), simulation.time
    assert results["collision_rate"].value == pytest.approx(2 * simulation.collisions / (n * duration), rel=1e-12)
    samples = [at(t) for t in origins]
    v, w = kept["velocities"][samples], kept["angular_velocities"][samples]
    mass, inertia = 1.0, simulation.system.species[0].inertia[0]
    kT = (mass * v**2).sum(axis=(1, 2)).mean() / (3 * n - 3)
    assert results["kT_trans"].value == pytest.approx(kT, rel=1e-10)
    assert results["kT_rot"].value == pytest.approx((inertia * w**2).sum(axis=(1, 2)).mean() / (2 * n), rel=1e-10)
    assert results["Z"].value == pytest.approx(1 + simulation.virial / (3 * n * kT * duration), rel=1e-10)
    assert np.trace(results["pressure_tensor"].value) == pytest.approx(3 * results["Z"].value, rel=1e-10)


def test_bond_order_where_asked_for():
    crystal = hb.lattice_start(hb.Ellipsoid.spheroid(2.0), 72, packing_fraction=0.6, seed=5)
    simulation = hb.Simulation(crystal)
    observables = simulation.measure(duration=0.5, order=["steinhardt", "hexatic"], order_neighbours=8)
    simulation.run(time=0.5)
    results = observables.results()
    for key in ("q4", "q6", "psi6", "psi6_local"):
        assert 0 < results[key].value < 1, key
    restored = hb.Simulation.restore(simulation.save()).observables[0].results()
    assert restored["psi6"].value == results["psi6"].value
    only = hb.Simulation(crystal).measure(duration=0.5, order=("hexatic",)).results()
    assert "q6" not in only and "psi6" in only


def test_collective_motion_where_asked_for():
    simulation = hb.Simulation(fluid(32, 0.1, seed=5))
    observables = simulation.measure(duration=1, wave_numbers=[3.0], collective=True)
    simulation.run(time=1)
    results = observables.results()
    assert results["f_collective"].names == ("t", "f_collective_q1", "f_collective_q1_error")
    assert results["f_collective"]["f_collective_q1"][0] == pytest.approx(1, abs=0.01)
    assert len(results["t_F_collective_q"]) == 1
    plain = hb.Simulation(simulation.system).measure(duration=1).results()
    assert not {"f_collective", "species", "t_F_collective_q"} & set(plain)


def test_results_are_tables_and_estimates():
    simulation = hb.Simulation(fluid(32, 0.1, seed=5))
    observables = simulation.measure(duration=1)
    simulation.run(time=1)
    results = observables.results()
    msd, Z = results["msd"], results["Z"]
    assert msd.units == {"t": "time", "msd": "length^2", "msd_error": "length^2"}
    assert all(set(curve.units) == set(curve.names) and all(curve.units.values()) for curve in results.curves.values())
    assert pickle.loads(pickle.dumps(results))["msd"].units == msd.units
    assert isinstance(msd, hb.Table) and msd.names == ("t", "msd", "msd_error")
    np.testing.assert_array_equal(msd.to_pandas().to_numpy(), np.stack([msd[name] for name in msd.names], axis=1))
    assert isinstance(results.curves["g_r"], hb.Table)
    assert f"{Z:.3f}" == f"{Z.value:.3f} +- {Z.error:.3f}"
    assert f"{Z}" == str(Z) == f"{Z.value:.6g} +- {Z.error:.2g}"
    assert f"{hb.Estimate(np.nan, np.nan, 'too short'):.3f}" == "missing: too short"
    with pytest.raises(KeyError, match="there is no 'zed'; there are: .*Z.*msd"):
        results["zed"]


@pytest.mark.skipif(not PROGRAM, reason="needs HARDBODY, the path of the program")
def test_mixtures_and_files_are_those_of_the_program(tmp_path):
    bodies = """[[species]]
number = 40
semi_axes = [0.8, 0.8, 1.6]
sizes = "gaussian"
width = 0.1
[[species]]
number = 24
semi_axes = [1.0, 0.9, 0.8]
kind = "superellipsoid"
exponents = [0.8, 0.9]
mass = 2.0
"""
    rows, summary = program_run(tmp_path, system="packing_fraction = 0.15", bodies=bodies)
    rods = hb.Polydisperse(hb.Ellipsoid([0.8, 0.8, 1.6]), 40, 0.1)
    boxes = hb.Species(hb.Superellipsoid([1.0, 0.9, 0.8], 0.8, 0.9), mass=2.0)
    start = hb.random_start([rods, (boxes, 24)], packing_fraction=0.15, seed=5)
    assert start.groups == [40, 24]
    simulation = same_start(summary, start)
    simulation.record_collisions(10**6)
    simulation.run(until=2)
    assert [tuple(row) for row in simulation.recorded.tolist()] == rows

    stored = hb.from_gsd(tmp_path / "out/trajectory.gsd", frame=0, components=[rods, (boxes, 24)], seed=5)
    np.testing.assert_array_equal(stored.positions, start.positions)
    np.testing.assert_array_equal(stored.rotations, start.rotations)
    np.testing.assert_array_equal(stored.velocities, start.velocities)
    last = hb.from_gsd(str(tmp_path / "out/trajectory.gsd"), -1, [rods, (boxes, 24)], seed=5)
    np.testing.assert_array_equal(last.positions, simulation.positions)
    np.testing.assert_array_equal(last.angular_velocities, simulation.angular_velocities)
    with pytest.raises(ValueError, match="of different sizes"):
        hb.from_gsd(tmp_path / "out/trajectory.gsd")


# ---- Dynamics


def test_two_spheres_exchange_their_velocities():
    simulation = hb.Simulation(dimer())
    simulation.record_collisions(10)
    simulation.run(time=3)
    assert simulation.collisions == 1
    np.testing.assert_allclose(simulation.recorded["time"], [1.0], rtol=1e-12)
    assert (simulation.recorded["i"], simulation.recorded["j"]) == (0, 1)
    np.testing.assert_allclose(simulation.velocities, [[-1, 0, 0], [1, 0, 0]], atol=1e-14)
    np.testing.assert_allclose(simulation.positions, [[-3, 0, 0], [3, 0, 0]], atol=1e-13)
    # r_AB . dp = 2 x 2; Z = 1 + virial / (3 N kT t), kT on 3 N - 3 degrees of freedom.
    assert simulation.virial == pytest.approx(4)
    assert simulation.kinetic().translational_kT == pytest.approx(2 / 3)
    assert simulation.Z == pytest.approx(1 + 4 / (3 * 2 * 2 / 3 * 3))
    assert simulation.pressure == pytest.approx(simulation.Z * 2 * (2 / 3) / 20**3)
    assert simulation.collision_rate == pytest.approx(2 / (2 * 3))


def test_energy_and_momentum_are_conserved():
    simulation = hb.Simulation(fluid(packing_fraction=0.4))
    energy = simulation.kinetic().energy
    simulation.run(collisions=5000)
    assert simulation.collisions == 5000
    kinetic = simulation.kinetic()
    assert kinetic.energy == pytest.approx(energy, rel=1e-13)
    assert np.abs(kinetic.momentum).max() < 1e-12
    audit = simulation.audit()
    assert audit.sound and audit.minimum_distance >= -1e-13 and audit.kinetic.energy == kinetic.energy


def test_pressure_has_the_noise_of_collisions_alone():
    """kT of 64 bodies' translation fluctuates by 10 %: Z by that would scatter by 0.3."""
    simulation = hb.Simulation(fluid(packing_fraction=0.3))
    simulation.run(time=30)
    values = []
    simulation.run(time=60, every=0.5, callback=lambda s: values.append((s.Z, s.pressure)))
    Z, pressure = np.array(values).T
    assert np.std(Z) < 0.05
    kinetic = simulation.kinetic()
    kT = 2 * kinetic.energy / (3 * 64 - 3 + 2 * 64)
    np.testing.assert_allclose(pressure, Z * 64 * kT / simulation.box**3, rtol=1e-12)


def test_calls_of_any_length_give_the_same_bits():
    one, many = hb.Simulation(fluid()), hb.Simulation(fluid())
    one.run(until=3)
    for k in range(1, 31):
        many.run(until=k / 10)
    assert many.time == 3 and bits(one) == bits(many)


@pytest.mark.parametrize("box", [1e5, 1e9, 1e20, 1e100])
@pytest.mark.parametrize("neighbours", ["dilated", "obp", "cells"])
def test_boxes_may_be_of_any_size(box, neighbours):
    system = hb.System(box, hb.Ellipsoid([1, 1, 1]), [[-2, 0, 0], [2, 0, 0]], None, [[1, 0, 0], [-1, 0, 0]])
    simulation = hb.Simulation(system, neighbours=neighbours)
    simulation.run(time=3)
    assert simulation.time == 3 and simulation.counters.overlaps == 0
    with pytest.raises(ValueError, match=r"box is 1e\+101; accepted: at most 1e\+?100"):
        hb.System(1e101, hb.Ellipsoid([1, 1, 1]), [[0, 0, 0]])


def test_shrinking_and_tuning():
    simulation = hb.Simulation(fluid())
    envelope, box = simulation.envelope, simulation.box
    simulation.tune_envelopes()
    assert 0.2 * envelope < simulation.envelope < 5 * envelope and simulation.collisions > 0
    new = simulation.shrink_box(0.9 * box)
    assert 0.9 * box <= new < box and simulation.box == new
    with pytest.raises(RuntimeError, match="dilated"):
        hb.Simulation(fluid(), neighbours="obp").shrink_box(1)


# ---- Callbacks and interrupts


def test_callbacks_come_at_multiples_of_their_interval():
    simulation = hb.Simulation(fluid())
    simulation.run(time=0.5)
    times = []
    simulation.run(time=0.3, every=0.1, callback=lambda s: times.append(s.time))
    np.testing.assert_allclose(times, [0.6, 0.7, 0.8], rtol=1e-12)
    assert simulation.time == times[-1]
    simulation.run(time=10, every=0.1, callback=lambda s: s.time < 1.0)
    assert simulation.time == pytest.approx(1.0, abs=0.11)
    done = []
    simulation.run(collisions=2000, progress=done.append)
    assert done[-1] == 1.0 and done == sorted(done)


def test_exceptions_of_callbacks_leave_a_whole_simulation():
    simulation, other = hb.Simulation(fluid()), hb.Simulation(fluid())

    def fail(s):
        raise LookupError("mine")

    with pytest.raises(LookupError, match="mine"):
        simulation.run(time=1, every=0.5, callback=fail)
    assert simulation.time == 0.5
    simulation.run(until=2)
    other.run(until=2)
    assert bits(simulation) == bits(other)

    def nested(s):
        s.run(time=1)

    with pytest.raises(RuntimeError, match="is running"):
        simulation.run(time=1, every=0.5, callback=nested)


def test_ctrl_c_ends_a_run_between_events():
    simulation, other = hb.Simulation(fluid()), hb.Simulation(fluid())
    assert work_after_interrupt(lambda: simulation.run(time=1e9)) < 2
    time_reached = simulation.time
    assert 0 < time_reached < 1e9
    simulation.run(until=time_reached + 1)
    other.run(until=time_reached)
    other.run(until=time_reached + 1)
    assert bits(simulation) == bits(other)


def test_numpys_false_ends_a_start():
    calls = []
    with pytest.raises(RuntimeError, match="progress returned False"):
        fluid(
            progress=lambda packing_fraction: calls.append(packing_fraction) or np.bool_(False),
            number=512,
            packing_fraction=0.5,
        )
    assert len(calls) == 1


def test_ctrl_c_ends_a_start():
    assert work_after_interrupt(lambda: fluid(2000, 0.55, most_compressed=2000)) < 5


def test_other_threads_are_refused_while_it_runs():
    simulation = hb.Simulation(fluid(512, 0.4))
    thread = threading.Thread(target=simulation.run, kwargs={"collisions": 3000})
    thread.start()
    refused = 0
    while thread.is_alive():
        try:
            assert simulation.positions.shape == (512, 3)
        except RuntimeError as error:
            assert "within an event" in str(error)
            refused += 1
            assert repr(simulation).startswith(("Simulation(running)", "Simulation(512 bodies, "))
        time.sleep(0.001)
    thread.join()
    assert refused > 0 and simulation.collisions == 3000


# ---- Numerical trouble


def test_stalls_raise():
    # With a criterion that every run meets.
    simulation = hb.Simulation(fluid(), least_progress=1e9)
    with pytest.raises(hb.NumericalError, match="stalled at time") as caught:
        simulation.run(time=1000)
    error = caught.value
    assert isinstance(error, RuntimeError) and error.failures == []
    assert str(pickle.loads(pickle.dumps(error))) == str(error)
    assert error.stall.time == simulation.stall.time == simulation.time and error.stall.events > 0
    assert error.counters.collisions == simulation.collisions > 0
    # The simulation is whole; after a restore it may go on.
    restored = hb.Simulation.restore(simulation.save())
    assert restored.stall is None and bits(restored) == bits(simulation)
    with pytest.raises(hb.NumericalError):
        simulation.run(collisions=1)


# ---- Memory


def test_arrays_outlive_their_simulation():
    simulation = hb.Simulation(fluid())
    simulation.record_collisions(100)
    simulation.run(collisions=100)
    arrays = [simulation.positions, simulation.orientations, simulation.recorded, simulation.virial_tensor]
    copies = [a.copy() for a in arrays]
    simulation.run(collisions=100)
    del simulation
    gc.collect()
    for array, copy in zip(arrays, copies, strict=True):
        np.testing.assert_array_equal(array, copy)
        array[...] = copy  # writable


def resident_bytes():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_a_thousand_simulations_leave_nothing_behind():
    system = fluid(32, 0.1)

    def make(number):
        for _ in range(number):
            simulation = hb.Simulation(system)
            simulation.measure(duration=1)
            simulation.run(collisions=3)
            hb.Simulation.restore(simulation.save())

    make(100)
    before = resident_bytes()
    make(1000)
    assert resident_bytes() - before < 4e6


def test_bodies_at_rest_never_collide():
    rest = hb.System(20, hb.Ellipsoid([1, 1, 1]), [[0, 0, 0], [5, 0, 0]])
    for call in (lambda s: s.run(collisions=1), lambda s: s.tune_envelopes()):
        with pytest.raises(ValueError, match="all bodies are at rest; accepted.*thermalized"):
            call(hb.Simulation(rest))
    simulation = hb.Simulation(rest)
    simulation.run(time=3)
    assert simulation.time == 3 and simulation.collisions == 0


def test_numpy_false_ends_a_run():
    simulation = hb.Simulation(dimer())
    simulation.run(time=2, every=0.5, callback=lambda s: np.float64(s.time) < 0.9)
    assert simulation.time == 1


def test_names_of_files(tmp_path):
    simulation = hb.Simulation(dimer())
    with pytest.raises(ValueError, match="path is .*; accepted: the name of a file"):
        simulation.save(f"{tmp_path}/a\0b")
    name = os.path.join(tmp_path, os.fsdecode(b"l\xe4"))
    simulation.save(name)
    assert hb.Simulation.restore(name).time == 0
    assert os.listdir(os.fsencode(tmp_path)) == [b"l\xe4"]
