"""Collisions per second of Simulation.run and of the program, from the same state, and of shapes written in Python.

    .venv/bin/python bench/python_simulation.py build/release/apps/hardbody/hardbody [--rounds 5] [--time 60]

Both measure observables. They take turns; the highest rates of all rounds are compared: other work of the machine
disturbs single ones.
"""

from __future__ import annotations

import argparse
import json
import pathlib
import subprocess
import tempfile
import time

import numpy as np

import hardbody as hb

CONFIG = """seed = 1
[system]
number = {number}
packing_fraction = {packing_fraction}
[shape]
aspect_ratio = {aspect_ratio}
[equilibration]
time = 0
[production]
time = {time}
"""
STATES = [
    dict(number=512, packing_fraction=0.4, aspect_ratio=3.0),
    dict(number=512, packing_fraction=0.3, aspect_ratio=0.5),
]


class Written:
    """Ellipsoid as a shape written in Python."""

    def __init__(self, axes: list[float]) -> None:
        self.axes = np.array(axes)
        self.squares = self.axes**2
        self.bounding_radius = max(axes)
        self.inscribed_radius = min(axes)
        self.min_curvature_radius = min(axes) ** 2 / max(axes)
        self.volume = 4 / 3 * np.pi * self.axes.prod()
        self.symmetry_axis = 2

    def support(self, n: np.ndarray) -> tuple[float, np.ndarray]:
        v = self.squares * n
        height = float(np.sqrt(v @ n))
        return height, v / height

    def inertia(self, mass: float) -> np.ndarray:
        return hb.Ellipsoid(self.axes).inertia(mass)


def program_rate(program: str, directory: pathlib.Path, config: str) -> tuple[float, dict]:
    (directory / "run.toml").write_text(config)
    subprocess.run(
        [program, "run", "run.toml", "--out", "out", "--force"], cwd=directory, check=True, capture_output=True
    )
    summary = json.loads((directory / "out" / "summary.json").read_text())
    return summary["performance"]["collisions_per_second"], summary


def package_rate(start: hb.System, summary: dict, duration: float) -> float:
    simulation = hb.Simulation(start, envelope=summary["neighbours"]["envelope"])
    simulation.measure(duration=duration, wave_numbers=summary["wave_numbers"])
    begin = time.perf_counter()
    simulation.run(time=duration)
    seconds = time.perf_counter() - begin
    assert simulation.collisions == summary["counters"]["collisions"], "not the same run"
    return simulation.collisions / seconds


def compare(program: str, state: dict, rounds: int, duration: float) -> None:
    start = hb.random_start(
        hb.Ellipsoid.spheroid(state["aspect_ratio"]),
        number=state["number"],
        packing_fraction=state["packing_fraction"],
        seed=1,
    )
    there, here = [], []
    with tempfile.TemporaryDirectory() as directory:
        for _ in range(rounds):
            rate, summary = program_rate(program, pathlib.Path(directory), CONFIG.format(**state, time=duration))
            there.append(rate)
            here.append(package_rate(start, summary, duration))
    ratio = max(here) / max(there)
    name = ", ".join(f"{key} {value}" for key, value in state.items())
    print(f"{name}: program {max(there):.0f}/s, Simulation.run {max(here):.0f}/s, ratio {ratio:.3f}")


def written_shape() -> None:
    axes = [0.7, 0.7, 2.0]
    for shape in (hb.Ellipsoid(axes), Written(axes)):
        start = hb.random_start(
            hb.Species(hb.Ellipsoid(axes), inertia="uniform"), number=64, packing_fraction=0.3, seed=1
        )
        own = hb.System(
            start.box,
            hb.Species(shape, inertia="uniform"),
            start.positions,
            start.rotations,
            start.velocities,
            start.angular_velocities,
        )
        simulation = hb.Simulation(own)
        simulation.run(collisions=20)
        begin = time.process_time()
        collisions = 20000 if isinstance(shape, hb.Ellipsoid) else 200
        simulation.run(collisions=collisions)
        seconds = time.process_time() - begin
        print(f"64 x {type(shape).__name__} at 0.3: {collisions / seconds:.0f} collisions/s")
        begin = time.process_time()
        for k in range(200):
            hb.distance(shape, hb.Pose(), shape, hb.Pose([3, 0.01 * k, 1]))
        print(f"a distance of two {type(shape).__name__}: {(time.process_time() - begin) / 200 * 1e6:.1f} us")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--time", type=float, default=60)
    arguments = parser.parse_args()
    for state in STATES:
        compare(str(pathlib.Path(arguments.program).resolve()), state, arguments.rounds, arguments.time)
    written_shape()


if __name__ == "__main__":
    main()
