#!/usr/bin/env python3
"""Scans the thresholds by which ordered states count as equilibrated over short runs of fluids, nematics and crystals.

usage: stationarity_scan.py DIRECTORY [--time T] [--judge]

Runs each state for T thermal times (240) and stores Z, S, its octants' mean, the strongest S(q) / N and F_self of each
in DIRECTORY/series.npz, from which a second call goes on (--judge: runs no more). Then judges all of them again as libed's stationarity.cpp
does, for each set of thresholds: a verdict is *wrong* if Z, S or S(q) / N of the last third of the run differ from
those of the judged samples by more than twice the documented limits (and more than three standard errors), or if the
end of the run shows domains; a state is *missed* if it has no verdict, though the last two thirds of its run meet the
documented limits. Writes DIRECTORY/states.csv and DIRECTORY/thresholds.csv. Needs the Python package and numpy; one core.
"""

import argparse
import csv
import dataclasses
import pathlib
import re

import hardbody as hb
import numpy as np


@dataclasses.dataclass
class Thresholds:
    """Those of libed/src/observables/order/stationarity.cpp."""

    Z: float = 0.01
    order: float = 0.05
    errors: float = 2.0
    least: int = 48
    uniform: float = 0.1
    crystal: float = 0.2
    left_out: float = 1 / 3


def spheroid(ratio):
    return hb.Ellipsoid([ratio ** (-1 / 3)] * 2 + [ratio ** (2 / 3)])


def superball(p):
    """A superball of volume 4 pi / 3."""
    shape = hb.Superellipsoid([1, 1, 1], 2 / p, 2 / p)
    a = (4 * np.pi / 3 / shape.volume) ** (1 / 3)
    return hb.Superellipsoid([a] * 3, 2 / p, 2 / p)


def states():
    """Names and how each is made: shape, lattice or None, number, packing fraction."""
    for phi in (0.50, 0.52, 0.545, 0.58, 0.64):
        yield f"spheres fcc {phi}", hb.Ellipsoid([1, 1, 1]), "fcc", 256, phi
    for phi in (0.30, 0.49, 0.54):
        yield f"spheres random {phi}", hb.Ellipsoid([1, 1, 1]), None, 256, phi
    for ratio, number, phis in (
        (4, 200, (0.38, 0.42, 0.46, 0.50, 0.55)),
        (3, 128, (0.46, 0.50, 0.54, 0.60)),
        (2, 128, (0.52, 0.58, 0.64)),
        (0.25, 176, (0.38, 0.42, 0.46, 0.52)),
        (0.5, 112, (0.52, 0.60)),
    ):
        for phi in phis:
            yield f"X0 = {ratio} fcc {phi}", spheroid(ratio), "fcc", number, phi
    for ratio, phi in ((4, 0.40), (4, 0.46), (4, 0.52), (0.25, 0.44), (0.25, 0.48), (1.25, 0.50)):
        yield f"X0 = {ratio} random {phi}", spheroid(ratio), None, 200, phi
    for phi in (0.46, 0.50, 0.54, 0.58, 0.64):
        yield f"superballs p = 6 cubic {phi}", superball(6), "cubic", 216, phi
    yield "superballs p = 6 random 0.48", superball(6), None, 216, 0.48


def start_of(shape, lattice, number, phi):
    """The start with this number of bodies or, on a lattice, one that fills it."""
    if lattice is None:
        return hb.random_start(shape, number, packing_fraction=phi, seed=3)
    for _ in range(4):
        try:
            return hb.lattice_start(shape, number, packing_fraction=phi, lattice=lattice, seed=3)
        except ValueError as error:
            offered = re.search(r"number of (\d+)", str(error))
            if offered is None:
                raise
            number = int(offered[1])
    raise ValueError("no number fills the lattice")


def largest(axes):
    Q = 1.5 * axes.T @ axes / max(1, len(axes)) - 0.5 * np.eye(3)
    return np.linalg.eigvalsh(Q)[-1]


def octants(positions, axes):
    of = ((positions >= 0) * [1, 2, 4]).sum(axis=1)
    return sum(largest(axes[of == k]) * (of == k).sum() for k in range(8) if (of == k).any()) / len(axes)


class Peaks:
    """The largest S(q) / N of the 12 strongest wave vectors, looked for at 16, 32, 64, .. samples."""

    def __init__(self, box):
        self.box, self.vectors = box, None
        most = int(4.5 * box / (2 * np.pi))
        grid = np.array(list(np.ndindex(*[2 * most + 1] * 3))) - most
        first = np.array([next((c for c in n if c), 0) for n in grid])
        self.all = grid[(first > 0) & ((grid**2).sum(axis=1) <= (4.5 * box / (2 * np.pi)) ** 2)]

    def strongest(self, positions, sample):
        intensity = lambda n: abs(np.exp(2j * np.pi / self.box * (positions @ n.T)).mean(axis=0)) ** 2
        if sample >= 16 and sample & (sample - 1) == 0:
            found = intensity(self.all)
            self.vectors = self.all[np.argsort(-found)[:12]]
        return 0.0 if self.vectors is None else intensity(self.vectors).max()


def series_of(start, time):
    """Rows of Z, S, S of octants, S(q) / N and F_self, one a thermal time; all bodies have the volume 4 pi / 3."""
    simulation = hb.Simulation(start)
    number, box = len(simulation), simulation.box
    origin, before, moved = simulation.positions, simulation.positions, np.zeros((number, 3))
    peaks, rows, virial = Peaks(box), [], 0.0
    for sample in range(1, time + 1):
        simulation.run(until=float(sample))
        positions = simulation.positions
        step = positions - before
        moved += step - box * np.round(step / box)
        before = positions
        total = (simulation.Z - 1) * sample
        w, x, y, z = simulation.orientations.T
        axes = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1)
        qr = 3.6 * np.linalg.norm(moved, axis=1)
        rows.append([1 + total - virial, largest(axes), octants(positions, axes), peaks.strongest(positions, sample),
                     np.sinc(qr / np.pi).mean()])
        virial = total
    return np.array(rows)


def mean_of_series(values):
    def error(blocks):
        edges = [b * len(values) // blocks for b in range(blocks + 1)]
        means = [values[a:b].mean() for a, b in zip(edges, edges[1:])]
        return np.std(means, ddof=1) / np.sqrt(blocks)

    return values.mean(), max(error(4), error(8))


def change(values):
    first, second = mean_of_series(values[: len(values) // 2]), mean_of_series(values[len(values) - len(values) // 2 :])
    return second[0] - first[0], np.hypot(first[1], second[1])


def steady(window, turning, crystal, t):
    def none(column, allowed):
        value, error = change(window[:, column])
        return error <= allowed and abs(value) <= max(allowed, t.errors * error)

    Z, order = none(0, t.Z * window[:, 0].mean()), not turning or none(1, t.order)
    return Z and order and (not crystal or none(3, t.order))


def kinds(window, number, turning, t):
    S, S8, peak = window[:, 1].mean(), window[:, 2].mean(), window[:, 3].mean()
    nematic = turning and S >= max(0.3, 4 * 0.81 / np.sqrt(number))
    return nematic, peak >= t.crystal, not nematic or S8 - S <= t.uniform + 8 / number


def verdict(rows, number, turning, t):
    """The first sample at which the state counts as stationary, or None."""
    decayed = np.flatnonzero(rows[:, 4] < 0.05)
    for m in range(max(8, t.least), len(rows) + 1):
        if m % 8:
            continue
        window = rows[int(m * t.left_out) : m]
        nematic, crystal, uniform = kinds(window, number, turning, t)
        forgotten = len(decayed) > 0 and rows[m - 1, 4] < 0.05 and m >= 2 * (decayed[0] + 1)
        if (crystal or (nematic and forgotten)) and uniform and steady(window, turning, crystal, t):
            return m
    return None


def judged_right(rows, m, number, turning, t):
    """Whether the end of the run is as the samples judged at m."""
    window, end = rows[int(m * t.left_out) : m], rows[2 * len(rows) // 3 :]
    standard = Thresholds()
    for column, limit in ((0, 2 * standard.Z * end[:, 0].mean()), (1, 2 * standard.order), (3, 2 * standard.order)):
        if column == 1 and not turning:
            continue
        a, b = mean_of_series(window[:, column]), mean_of_series(end[:, column])
        if abs(a[0] - b[0]) > max(limit, 3 * np.hypot(a[1], b[1])):
            return False
    return kinds(end, number, turning, standard)[2]


def judge_all(stored, t):
    """Verdict, or None, of each state; those that are wrong; those that are missed."""
    found, wrong, missed = {}, [], []
    for name, (rows, number, turning) in stored.items():
        m = found[name] = verdict(rows, number, turning, t)
        if m is not None and not judged_right(rows, m, number, turning, t):
            wrong.append(name)
        if m is None:
            standard = Thresholds()
            window = rows[len(rows) // 3 :]
            nematic, crystal, uniform = kinds(window, number, turning, standard)
            fluid = rows[-1, 4] < 0.05 or crystal
            if (nematic or crystal) and uniform and fluid and steady(window, turning, crystal, standard):
                missed.append(name)
    return found, wrong, missed


def scanned():
    yield "as built", Thresholds()
    for name, values in {
        "Z": (0.003, 0.005, 0.02, 0.04),
        "order": (0.0125, 0.025, 0.1, 0.2),
        "errors": (1.0, 3.0),
        "least": (16, 24, 96),
        "uniform": (0.05, 0.2, 1.0),
        "crystal": (0.1, 0.3, 0.4),
        "left_out": (0.0, 0.5),
    }.items():
        for value in values:
            yield f"{name} = {value:.4g}", dataclasses.replace(Thresholds(), **{name: value})


def run_states(file, time, only_stored):
    stored = {}
    if file.exists():
        with np.load(file) as data:
            stored = {name: data[name] for name in data.files}
    for name, shape, lattice, number, phi in states():
        if name in stored or only_stored:
            continue
        try:
            start = start_of(shape, lattice, number, phi)
            rows = series_of(start, time)
        except (ValueError, RuntimeError) as error:
            print(f"{name}: {error}", flush=True)
            continue
        turning = not name.startswith("spheres")
        stored[name] = np.vstack([rows, [len(start), turning, 0, 0, 0]])
        np.savez(file, **stored)
        print(name, len(start), rows[-1].round(3), flush=True)
    return {name: (rows[:-1][:time], int(rows[-1, 0]), bool(rows[-1, 1])) for name, rows in stored.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--time", type=int, default=240)
    parser.add_argument("--judge", action="store_true")
    asked = parser.parse_args()
    asked.directory.mkdir(parents=True, exist_ok=True)
    stored = run_states(asked.directory / "series.npz", asked.time, asked.judge)
    found, wrong, missed = judge_all(stored, Thresholds())
    with open(asked.directory / "states.csv", "w", newline="") as file:
        out = csv.writer(file)
        out.writerow(["state", "number", "verdict [thermal times]", "judged", "S at the end", "S(q)/N at the end"])
        for name, (rows, number, _) in stored.items():
            end = rows[2 * len(rows) // 3 :].mean(axis=0)
            judged = "wrong" if name in wrong else "missed" if name in missed else "right"
            out.writerow([name, number, found[name] or "", judged, f"{end[1]:.3f}", f"{end[3]:.3f}"])
    with open(asked.directory / "thresholds.csv", "w", newline="") as file:
        out = csv.writer(file)
        out.writerow(["thresholds", "verdicts", "wrong", "missed", "mean time", "wrong states", "missed states"])
        for label, t in scanned():
            found, wrong, missed = judge_all(stored, t)
            times = [m for m in found.values() if m is not None]
            mean = f"{np.mean(times):.0f}" if times else ""
            out.writerow([label, len(times), len(wrong), len(missed), mean, "; ".join(wrong), "; ".join(missed)])
            print(label, len(times), len(wrong), len(missed), mean, wrong, missed)


if __name__ == "__main__":
    main()
