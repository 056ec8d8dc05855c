#!/usr/bin/env python3
"""Recomputes the order of a run from its stored frames by numpy, and compares it with the run and with hardbody analyze.

usage: order_by_numpy.py RUN_DIRECTORY

The run needs [output] trajectory = ["gsd"], and `hardbody analyze RUN_DIRECTORY` done. Prints one line a quantity: what
the run measured (its own frames, many more), what analyze finds in the stored frames, and what numpy finds in the same.
Nothing of the program is used but its files. Needs numpy and gsd.
"""

import csv
import json
import pathlib
import sys

import gsd.hoomd
import numpy as np


def read_frames(path):
    """Edge, the first row of species, times, unwrapped positions and rotations of all frames, in double precision."""
    with gsd.hoomd.open(str(path), "rb") as file:
        frames = list(file)
    box = frames[0].log["hardbody/box"].flat[0]
    species = frames[0].log["hardbody/species"][0]
    time = np.array([f.log["hardbody/time"][0] for f in frames])
    position = np.array([f.log["particles/hardbody/position"] for f in frames])
    rotation = np.array([f.log["particles/hardbody/rotation"] for f in frames]).reshape(len(frames), -1, 3, 3)
    near = np.array([f.particles.position + f.particles.image * box for f in frames], dtype=float)
    return box, species, time, position + box * np.round((near - position) / box), rotation


def table(path):
    with open(path) as file:
        rows = list(csv.reader(file))
    names = [name.split(" ")[0] for name in rows[0]]
    return {n: np.array([float(r[k] or "nan") for r in rows[1:]]) for k, n in enumerate(names)}


def tensor(axes):
    return 1.5 * np.einsum("ni,nj->ij", axes, axes) / len(axes) - 0.5 * np.eye(3)


def slope(t, y):
    return np.polyfit(t, y, 1)[0]


def steinhardt(position, box, neighbours):
    """Means over bodies of q_4 and q_6, from Legendre polynomials of the angles between bonds."""
    r = position[:, None] - position[None]
    r -= box * np.round(r / box)
    d2 = (r**2).sum(axis=2)
    np.fill_diagonal(d2, np.inf)
    nearest = np.argsort(d2, axis=1)[:, :neighbours]
    bonds = np.take_along_axis(r, nearest[:, :, None], axis=1)
    bonds /= np.linalg.norm(bonds, axis=2)[:, :, None]
    cosine = np.einsum("nai,nbi->nab", bonds, bonds)
    return [np.sqrt(np.polynomial.legendre.legval(cosine, [0] * l + [1]).mean(axis=(1, 2))).mean() for l in (4, 6)]


def hexatic(position, box, director, reach, neighbours=6):
    """|mean of psi_6| and mean of |psi_6| over bodies: neighbours within `reach` along the director, nearest across it."""
    across = np.linalg.svd(director[None])[2][1:]  # two unit vectors
    own = []
    for i, centre in enumerate(position):
        r = np.delete(position, i, axis=0) - centre
        r -= box * np.round(r / box)
        flat = r[abs(r @ director) <= reach] @ across.T
        flat = flat[np.argsort((flat**2).sum(axis=1))[:neighbours]]
        angle = np.arctan2(flat[:, 1], flat[:, 0])
        own.append(np.exp(6j * angle).mean() if len(flat) else 0)
    return abs(np.mean(own)), abs(np.array(own)).mean()


def axial_length(species):
    """Length along their axes of bodies of one shape, from a row of log/hardbody/species."""
    a = species[1:4]
    alike = [k for k in range(3) if np.isclose(a[(k + 1) % 3], a[(k + 2) % 3], rtol=1e-12)]
    return 2 * a[alike[0] if species[0] == 0 and alike else 2]


def cubatic(rotation, directions):
    """The largest of many directions, refined once about the best."""
    def value(n):
        x2 = np.einsum("nia,ki->kna", rotation, n) ** 2
        return (2.5 * (x2**2).sum(axis=2) - 1.5).mean(axis=1)

    best = directions[value(directions).argmax()]
    for spread in (0.1, 0.02, 0.004):
        near = best + spread * directions[:400]
        near /= np.linalg.norm(near, axis=1)[:, None]
        near = np.vstack([near, best])
        best = near[value(near).argmax()]
    return value(best[None])[0]


def main(directory):
    box, species, time, r, rotation = read_frames(directory / "trajectory.gsd")
    run = json.loads((directory / "summary.json").read_text())["observables"]
    found = json.loads((directory / "analysis/analysis.json").read_text())["observables"]
    rows = []

    def add(key, value):
        rows.append((key, run.get(key), found.get(key), value))

    axes = rotation[:, :, :, 2]
    Q = np.array([tensor(u) for u in axes])
    S, vectors = np.linalg.eigh(Q)
    add("S", S[:, 2].mean())
    n = vectors[:, :, 2]
    lags = table(directory / "analysis/msd_directions.csv")
    step = time[1] - time[0]
    along, across, edges = [], [], []
    for t in lags["t"]:
        k = round(t / step)
        moved = r[k:] - r[:-k]
        parallel = np.einsum("tni,ti->tn", moved, n[: len(moved)]) ** 2
        along.append(parallel.mean())
        across.append(((moved**2).sum(axis=2) - parallel).mean())
        edges.append((moved**2).mean(axis=(0, 1)))
    window = lags["t"] >= 0.4 * lags["t"][-1] * (1 - 1e-9)
    edges = np.array(edges)
    fit = lambda y, c: slope(lags["t"][window], np.array(y)[window]) / (2 * c)
    add("D_parallel", fit(along, 1))
    add("D_perp", fit(across, 2))
    for axis, name in enumerate("xyz"):
        of = lambda o: o["D_box"][axis] if o.get("D_box") else None
        rows.append((f"D_box {name}", of(run), of(found), fit(edges[:, axis], 1)))
    peaks = table(directory / "analysis/bragg.csv")
    first = np.array([peaks[k][0] for k in ("n_x", "n_y", "n_z")])
    add("bragg_peak", (abs(np.exp(2j * np.pi / box * (r @ first)).mean(axis=1)) ** 2).mean())
    if "cubatic_order" in found:
        directions = np.random.default_rng(1).normal(size=(2000, 3))
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        add("cubatic_order", np.mean([cubatic(R, directions) for R in rotation]))
    if "value" in found.get("psi6", {}):
        reach = 2 / 3 * axial_length(species)
        hexagons = np.mean([hexatic(p, box, axis, reach) for p, axis in zip(r, n)], axis=0)
        add("psi6", hexagons[0])
        add("psi6_local", hexagons[1])
    bonds = np.mean([steinhardt(p, box, 12) for p in r], axis=0)
    add("q4", bonds[0])
    add("q6", bonds[1])

    def shown(estimate):
        if estimate is None:
            return "not asked for"
        if estimate["value"] is None:
            return estimate["missing"][:40]
        error = "" if estimate["error"] is None else f" +- {estimate['error']:.2g}"
        return f"{estimate['value']:.6g}{error}"

    print("| quantity | run | analyze | numpy |\n|---|---|---|---|")
    for key, own, of_frames, value in rows:
        print(f"| {key} | {shown(own)} | {shown(of_frames)} | {value:.6g} |")
    for name, values in (("msd_parallel", along), ("msd_perp", across)):
        both = np.isfinite(lags[name])
        if both.any():
            print(f"{name}: largest relative difference {np.max(abs(np.array(values)[both] / lags[name][both] - 1)):.1e}")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
