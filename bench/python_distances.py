#!/usr/bin/env python3
"""Speed of hardbody.distance_many beside the C++ batch on the same pairs, and with two threads beside one.

usage: python_distances.py BENCH_PAIRS [--pairs N] [--rounds N]

BENCH_PAIRS is the program of bench/bench_pairs.cpp, built with the flags that the package was built with. Pairs are of
spheroids, a/b = 3, apart or overlapping by less than their curvature. "shared" has bodies in 20 pairs each, as in a
fluid; "own" has two bodies for each pair. Both methods take turns, and the least times of all rounds are compared:
the machine's other work disturbs single times, hardly the ratios.
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


def random_bodies(random, bodies, pairs):
    """Positions, quaternions and pairs of bodies that are near each other, a few of which overlap."""
    quaternions = random.normal(size=(bodies, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    if bodies == 2 * pairs:
        indices = np.arange(bodies).reshape(pairs, 2)
        positions = np.repeat(random.uniform(0, 100, (pairs, 3)), 2, axis=0)
        direction = random.normal(size=(pairs, 3))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        positions[1::2] += direction * random.uniform(3.5, 8, (pairs, 1))
        return positions, quaternions, indices
    # A line of bodies, each paired with the next ones.
    positions = np.zeros((bodies, 3))
    positions[:, 0] = 4 * np.arange(bodies)
    positions[:, 1:] = random.uniform(-3, 3, (bodies, 2))
    first = random.integers(0, bodies - 3, pairs)
    return positions, quaternions, np.sort(np.stack([first, first + random.integers(1, 3, pairs)], axis=1), axis=1)


def write(path, positions, quaternions, pairs):
    with open(path, "wb") as file:
        for array in (np.array([len(positions), len(pairs)]), np.array(AXES), positions, quaternions, pairs):
            file.write(np.ascontiguousarray(array).tobytes())


def least_times(bench, positions, quaternions, pairs, rounds):
    """ns a pair: C++ with spans, C++ by reference, Python with one thread, with two."""
    shape = hb.Ellipsoid(AXES)
    times = {"C++ spans": [], "C++ references": [], 1: [], 2: []}
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "pairs.bin"
        write(path, positions, quaternions, pairs)
        for _ in range(rounds):
            line = subprocess.run([bench, path, "3"], check=True, capture_output=True, text=True).stdout
            spans, references, total = (float(word) for word in line.split())
            times["C++ spans"].append(spans)
            times["C++ references"].append(references)
            for threads in (1, 2):
                for _ in range(3):
                    begin = time.perf_counter()
                    result = hb.distance_many(shape, positions, quaternions, pairs, threads=threads)
                    times[threads].append(1e9 * (time.perf_counter() - begin) / len(pairs))
            assert np.isclose(result.distance.sum(), total, rtol=1e-9), "other answers than C++"
    return {name: min(values) for name, values in times.items()}, result.redone


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("bench", help="path of the program bench_pairs")
    parser.add_argument("--pairs", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    random = np.random.default_rng(1)
    print("ns a pair            |  C++ spans | C++ refs | Python 1 | Python 2 | C++ spans / Python 1 | Python 1 / Python 2")
    for name, bodies in {"shared": options.pairs // 20, "own": 2 * options.pairs}.items():
        data = random_bodies(random, bodies, options.pairs)
        t, redone = least_times(options.bench, *data, options.rounds)
        print(f"{name:8} {bodies:>8} bodies | {t['C++ spans']:>9.1f} | {t['C++ references']:>8.1f} | {t[1]:>8.1f} | {t[2]:>8.1f} "
              f"| {t['C++ spans'] / t[1]:>20.2f} | {t[1] / t[2]:>18.2f}   ({redone} redone)")
    return 0


if __name__ == "__main__":
    sys.exit(main())
