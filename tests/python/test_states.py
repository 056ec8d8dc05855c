"""Saved states: the same bits, observables included; damaged ones are refused."""

import errno
import pathlib
import signal
import struct

import numpy as np
import pytest
import xxhash
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
    with pytest.raises(
        TypeError, match=r"^state is of type ndarray; accepted: bytes, a bytearray or a memoryview; or a s"
    ):
        hb.Simulation.restore(np.zeros(9, np.uint8))
    assert list(pathlib.Path(tmp_path).iterdir()) == []


def test_errors_of_files_have_number_and_name(tmp_path):
    simulation = hb.Simulation(fluid(8, 0.05))
    nowhere = tmp_path / "no" / "such" / "file"
    cases = [
        (FileNotFoundError, errno.ENOENT, nowhere, simulation.save),
        (IsADirectoryError, errno.EISDIR, tmp_path, simulation.save),
        (OSError, errno.EINVAL, "/dev/full", simulation.save),
        (FileNotFoundError, errno.ENOENT, nowhere, hb.Simulation.restore),
        (IsADirectoryError, errno.EISDIR, tmp_path, hb.Simulation.restore),
        (FileNotFoundError, errno.ENOENT, nowhere, hb.from_gsd),
    ]
    for kind, number, path, function in cases:
        with pytest.raises(kind) as caught:
            function(path)
        assert (caught.value.errno, caught.value.filename) == (number, str(path))
        assert str(path) in str(caught.value)


def sealed(content):
    """The state with these contents, whose checksum is right."""
    return content + struct.pack("<Q", xxhash.xxh3_64_intdigest(content))


def forged(content, random):
    """Contents of which a few bytes are others, or missing."""
    bytes_ = bytearray(content)
    at = int(random.integers(12, len(bytes_)))
    wrong = [
        bytes([random.integers(256)]),
        struct.pack("<d", random.choice([np.nan, np.inf, -1.0, 1e300, 0.0, 1e-300])),
        struct.pack("<i", random.choice([-1, 2**31 - 1, -(2**31), 1000, 0])),
        struct.pack("<Q", int(random.choice(np.array([0, 1, 10**6, 2**63, 2**64 - 1], np.uint64)))),
        b"",
    ][random.integers(5)]
    bytes_[at : at + (len(wrong) or int(random.integers(1, 64)))] = wrong
    return bytes(bytes_)


def little_fluids():
    measured = hb.Simulation(fluid(8, 0.01))
    measured.measure(duration=2, wave_numbers=[1.0])
    mixture = [(hb.Superellipsoid([1, 1.2, 1.5], 0.7, 0.7), 8), (hb.Ellipsoid([1, 1, 1]), 8)]
    return {
        "measured": measured,
        "mixture": hb.Simulation(hb.random_start(mixture, packing_fraction=0.01), neighbours="obp"),
        "bracketing": hb.Simulation(fluid(16, 0.01), neighbours="cells", finder="bracketing"),
    }


@pytest.fixture
def ended_after_a_second():
    """Ends what runs for long: a forged event may stop a run, which can be interrupted."""
    before = signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGINT))
    yield lambda seconds=1: signal.setitimer(signal.ITIMER_REAL, seconds)
    signal.setitimer(signal.ITIMER_REAL, 0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("name", ["measured", "mixture", "bracketing"])
def test_forged_states_are_refused_or_sound(name, random, ended_after_a_second):
    simulation = little_fluids()[name]
    simulation.run(time=0.5)
    content = simulation.save()[:-8]
    assert sealed(content) == simulation.save()
    refused = 0
    for _ in range(350):
        state = sealed(forged(content, random))
        try:
            restored = hb.Simulation.restore(state)
        except ValueError as error:
            assert str(error).startswith("state: ") and "\n" not in str(error)
            refused += 1
            continue
        arrays = (restored.positions, restored.orientations, restored.velocities, restored.angular_velocities)
        more = (restored.unwrapped_positions, restored.angular_displacements, restored.virial_tensor)
        assert all(np.isfinite(numbers).all() for numbers in arrays + more), name
        assert restored.save() and repr(restored) and all(o.results() for o in restored.observables)
        try:
            ended_after_a_second()
            restored.run(time=0.01)
            ended_after_a_second(0)
        except (hb.NumericalError, ValueError, KeyboardInterrupt):
            pass
    assert 50 < refused < 300


def test_states_of_other_versions_are_refused():
    content = hb.Simulation(fluid(8, 0.01)).save()[:-8]
    version = hb.__version__.encode()
    other = content.replace(version, b"9" * len(version), 1)
    with pytest.raises(ValueError, match=f'state: was saved by hardbody "9+", here "{hb.__version__}"'):
        hb.Simulation.restore(sealed(other))
    with pytest.raises(ValueError, match="state: has format 7, known is"):
        hb.Simulation.restore(sealed(content[:12] + struct.pack("<I", 7) + content[16:]))
