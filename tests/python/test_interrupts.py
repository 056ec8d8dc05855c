"""Ctrl-C ends long calls within a second of work, with nothing left behind."""

import numpy as np
import pytest
from conftest import work_after_interrupt

import hardbody as hb

ROD, BOX = hb.Ellipsoid.spheroid(3.0), hb.Superellipsoid([1, 2, 3], 0.5, 0.7)
MANY = 4 * 30**3

# Calls that would take 3 to 60 s.
LONG_CALLS = {
    "lattice_start": lambda: hb.lattice_start(ROD, number=MANY, packing_fraction=0.1, nematic_order=0.5),
    "random_start": lambda: hb.random_start(ROD, number=MANY, packing_fraction=0.3, most_compressed=MANY),
    "placing": lambda: hb.random_start(ROD, number=10**6, packing_fraction=0.03),
    "compressed": lambda: hb.compressed(crowd(), 0.35),
    "Simulation": lambda: hb.Simulation(crowd()),
    "System.audit": lambda: crowd().audit(),
}


def crowd():
    return hb.lattice_start(BOX, number=MANY, packing_fraction=0.3)


@pytest.mark.parametrize("name", sorted(LONG_CALLS))
def test_calls_on_states_stop(name):
    assert work_after_interrupt(LONG_CALLS[name]) < 1


@pytest.fixture(scope="module")
def trajectory(tmp_path_factory):
    """Frames of a thousand spheres, of which analyze takes 5 s and check 3 s."""
    random, size, edge, frames = np.random.default_rng(1), 1000, 40, 600
    places = random.uniform(0, edge, (size, 3))
    path = tmp_path_factory.mktemp("interrupts") / "spheres.lammpstrj"
    with open(path, "w") as file:
        for k in range(frames):
            file.write(f"ITEM: TIMESTEP\n{k}\nITEM: NUMBER OF ATOMS\n{size}\nITEM: BOX BOUNDS pp pp pp\n")
            file.write(3 * f"0 {edge}\n" + "ITEM: ATOMS id type xu yu zu radius\n")
            places += random.normal(0, 0.1, (size, 3))
            file.writelines(f"{i} 1 {x:.4f} {y:.4f} {z:.4f} 2\n" for i, (x, y, z) in enumerate(places))
    return path


@pytest.mark.parametrize("command", ["analyze", "check"])
def test_commands_on_trajectories_stop(command, trajectory):
    call = {"analyze": lambda: hb.analyze(trajectory, time_step=1), "check": lambda: hb.check(trajectory)}[command]
    assert work_after_interrupt(call) < 1
    assert list(trajectory.parent.iterdir()) == [trajectory]
