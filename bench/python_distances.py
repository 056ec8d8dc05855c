#!/usr/bin/env python3
"""Speed of hardbody.distance_many beside the C++ batch on the same pairs, and with two threads beside one.

usage: python_distances.py BENCH_PAIRS [--pairs N] [--rounds N]

BENCH_PAIRS is the program of bench/bench_pairs.cpp, built with the flags that the package was built with. Pairs are of
spheroids, a/b = 3. "shared" has bodies in 40 pairs each, as in a fluid; "own" has two bodies for each pair, apart or
in shallow overlap. C++ is given the poses, or computes them from the same arrays as Python ("arrays"). Both take turns,
and the least times of all rounds are compared.
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

import hardbody as hb

AXES = (1.0, 1.0, 3.0)


def unit_rows(random, rows, columns):
    v = random.normal(size=(rows, columns))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def own_bodies(random, pairs):
    """Two bodies a pair, at distances that are known: a quarter of the pairs at each of four gaps."""
    quaternions = unit_rows(random, 2 * pairs, 4)
    w, x, y, z = quaternions.T
    axis = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1)  # of revolution
    normal = np.repeat(unit_rows(random, pairs, 3), 2, axis=0)
    normal[1::2] *= -1
    along = np.sum(axis * normal, axis=1, keepdims=True)
    squares = AXES[0] ** 2 * normal + (AXES[2] ** 2 - AXES[0] ** 2) * along * axis
    support = squares / np.sqrt(np.sum(squares * normal, axis=1, keepdims=True))
    gap = np.resize([1.0, 1e-1, 1e-6, -1e-3], pairs)[:, None]
    positions = np.repeat(random.uniform(0, 100, (pairs, 3)), 2, axis=0)
    positions[1::2] += support[0::2] - support[1::2] + gap * normal[0::2]
    return positions, quaternions, np.arange(2 * pairs).reshape(pairs, 2)


def shared_bodies(random, bodies, pairs):
    """A line of bodies that do not overlap, each paired with the next ones."""
    positions = np.zeros((bodies, 3))
    positions[:, 0] = 6.05 * np.arange(bodies)
    positions[:, 1:] = random.uniform(-3, 3, (bodies, 2))
    first = np.sort(random.integers(0, bodies - 2, pairs))
    return positions, unit_rows(random, bodies, 4), np.stack([first, first + random.integers(1, 3, pairs)], axis=1)


def write(path, positions, quaternions, pairs):
    with open(path, "wb") as file:
        for array in (np.array([len(positions), len(pairs)]), np.array(AXES), positions, quaternions, pairs):
            file.write(np.ascontiguousarray(array).tobytes())


def least_times(bench, positions, quaternions, pairs, rounds):
    """ns a pair: C++ with spans, by reference and from the same arrays, Python with one thread, with two."""
    shape = hb.Ellipsoid(AXES)
    times = {"C++ spans": [], "C++ references": [], "C++ arrays": [], 1: [], 2: []}
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "pairs.bin"
        write(path, positions, quaternions, pairs)
        for _ in range(rounds):
            line = subprocess.run([bench, path, "3"], check=True, capture_output=True, text=True).stdout
            spans, references, arrays, total = (float(word) for word in line.split())
            times["C++ spans"].append(spans)
            times["C++ references"].append(references)
            times["C++ arrays"].append(arrays)
            for threads in (1, 2):
                for _ in range(3):
                    begin = time.perf_counter()
                    result = hb.distance_many(shape, positions, quaternions, pairs, threads=threads)
                    times[threads].append(1e9 * (time.perf_counter() - begin) / len(pairs))
                    total_here = result.distance.sum()
                    redone = result.redone
                    del result
            assert np.isclose(total_here, total, rtol=1e-9), "other answers than C++"
    return {name: min(values) for name, values in times.items()}, redone


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("bench", help="path of the program bench_pairs")
    parser.add_argument("--pairs", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    random = np.random.default_rng(1)
    cases = {
        "shared": shared_bodies(random, options.pairs // 20, options.pairs),
        "own": own_bodies(random, options.pairs),
    }
    print(
        "ns a pair               C++ spans  C++ refs  C++ arrays  Python 1  Python 2 "
        "| Python 1 is .. of C++: spans  refs  arrays | two threads"
    )
    for name, data in cases.items():
        t, redone = least_times(options.bench, *data, options.rounds)
        spans, references, arrays = (t[kind] for kind in ("C++ spans", "C++ references", "C++ arrays"))
        print(
            f"{name:8}{len(data[0]):>8} bodies {spans:>9.1f} {references:>9.1f} {arrays:>11.1f} "
            f"{t[1]:>9.1f} {t[2]:>9.1f} | {spans / t[1]:>27.2f} {references / t[1]:>5.2f} {arrays / t[1]:>7.2f}"
            f" | {t[1] / t[2]:.2f} ({redone} redone)"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
