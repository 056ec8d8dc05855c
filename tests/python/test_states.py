"""Saved states: the same bits, observables included; damaged ones are refused."""

import pathlib

import numpy as np
import pytest
from test_simulation import bits, fluid

import hardbody as hb


def test_restored_simulations_go_on_with_the_same_bits(tmp_path):
    simulation = hb.Simulation(fluid(), envelope=0.3)
    simulation.record_collisions(10**5)
    simulation.measure(duration=2)
    simulation.run(until=0.7)
    state = simulation.save()
    assert simulation.save(tmp_path / "state.bin") is None
    assert (tmp_path / "state.bin").read_bytes() == state
    simulation.run(until=2)
    for source in (state, bytearray(state), tmp_path / "state.bin", str(tmp_path / "state.bin")):
        restored = hb.Simulation.restore(source)
        assert restored.time == 0.7 and restored.envelope == 0.3 and restored.save() == state
        restored.run(until=2)
        assert bits(restored) == bits(simulation) and restored.counters.asdict() == simulation.counters.asdict()
        np.testing.assert_array_equal(restored.recorded, simulation.recorded)
        one, other = simulation.observables[0].results(), restored.observables[0].results()
        assert one["D_trans"] == other["D_trans"] or np.isnan(one["D_trans"].value)
        for name, curve in one.curves.items():
            assert curve.tobytes() == other.curves[name].tobytes()


def test_mixtures_keep_their_options_and_groups():
    rods = hb.Polydisperse(hb.Ellipsoid([0.8, 0.8, 1.6]), 20, 0.1, "lognormal", seed=3)
    boxes = hb.Species(hb.Superellipsoid([1.0, 0.9, 0.8], 0.8, 0.9), mass=2.0)
    start = hb.random_start([(boxes, 12), rods], packing_fraction=0.06)
    simulation = hb.Simulation(start, neighbours="obp", instruction_set=None)
    simulation.run(collisions=200)
    restored = hb.Simulation.restore(simulation.save())
    assert restored.neighbours == "obp" and restored.system.groups == [12, 20]
    restored.run(collisions=200)
    simulation.run(collisions=200)
    assert bits(restored) == bits(simulation)


def test_damaged_states_are_refused(tmp_path):
    simulation = hb.Simulation(fluid(8, 0.05))
    simulation.run(collisions=5)
    state = simulation.save()
    for k in range(0, len(state), 97):
        damaged = bytearray(state)
        damaged[k] ^= 0x10
        with pytest.raises(ValueError, match="state: "):
            hb.Simulation.restore(damaged)
    for length in (0, 5, 30, len(state) - 1):
        with pytest.raises(ValueError, match="state: "):
            hb.Simulation.restore(state[:length])
    with pytest.raises(FileNotFoundError):
        hb.Simulation.restore(tmp_path / "nowhere")
    with pytest.raises(TypeError, match="accepted: "):
        hb.Simulation.restore(3)
    with pytest.raises(OSError):
        simulation.save(tmp_path / "no" / "such" / "directory")
    assert list(pathlib.Path(tmp_path).iterdir()) == []
