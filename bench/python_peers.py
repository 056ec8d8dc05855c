"""Times and errors of other programs' distances of ellipsoids, from Python, against distance_many.

    tools/peers --table

Pairs are random and apart, each body a shape of its own with semi-axes from 0.3 to 3. Others are called in a loop, as
their users do, with their default tolerance and a tighter one; the loop and its calls take some of their time. MuJoCo
has its default limit of iterations, or 200. Errors are against the true distances, which a proof of a few lines of
NumPy encloses within 1e-13 (tests/peers/certificate.py).
"""

from __future__ import annotations

import argparse
import pathlib
import sys
import time
from collections.abc import Callable

import coal
import eigenpy
import fcl
import mujoco
import numpy as np

import hardbody as hb

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "peers"))
from certificate import Ellipsoids  # noqa: E402

Answer = Callable[[int, int], float]


def by_coal(bodies: Ellipsoids, tolerance: float) -> Answer:
    shapes = [coal.Ellipsoid(*axes) for axes in bodies.axes]
    poses = [
        coal.Transform3s(eigenpy.Quaternion(*q), p) for q, p in zip(bodies.quaternions, bodies.positions, strict=True)
    ]
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    request.gjk_tolerance = tolerance

    def answer(i: int, j: int) -> float:
        result.clear()
        return coal.distance(shapes[i], poses[i], shapes[j], poses[j], request, result)

    return answer


def by_mujoco(bodies: Ellipsoids, tolerance: float, iterations: int | None) -> Answer:
    def numbers(values: np.ndarray) -> str:
        return " ".join(repr(float(value)) for value in values)

    geoms = "".join(
        f'<body pos="{numbers(p)}" quat="{numbers(q)}"><geom type="ellipsoid" size="{numbers(axes)}"/></body>'
        for p, q, axes in zip(bodies.positions, bodies.quaternions, bodies.axes, strict=True)
    )
    limit = "" if iterations is None else f'ccd_iterations="{iterations}"'
    option = f'<option {limit} ccd_tolerance="{tolerance}"/>'
    model = mujoco.MjModel.from_xml_string(f"<mujoco>{option}<worldbody>{geoms}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return lambda i, j: mujoco.mj_geomDistance(model, data, i, j, 100.0, None)


def by_fcl(bodies: Ellipsoids) -> Answer:
    objects = [
        fcl.CollisionObject(fcl.Ellipsoid(*axes), fcl.Transform(q, p))
        for axes, q, p in zip(bodies.axes, bodies.quaternions, bodies.positions, strict=True)
    ]
    request = fcl.DistanceRequest()
    return lambda i, j: fcl.distance(objects[i], objects[j], request, fcl.DistanceResult())


def by_hardbody(bodies: Ellipsoids) -> Answer:
    poses = [hb.Pose(p, q) for p, q in zip(bodies.positions, bodies.quaternions, strict=True)]
    shapes = bodies.shapes
    return lambda i, j: hb.distance(shapes[i], poses[i], shapes[j], poses[j]).distance


def measured(answer: Answer, pairs: list[tuple[int, int]], rounds: int) -> tuple[np.ndarray, float]:
    """Distances and the least time of all rounds, in ns a pair."""
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        distances = [answer(i, j) for i, j in pairs]
        times.append((time.perf_counter() - begin) / len(pairs) * 1e9)
    return np.array(distances), min(times)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--pairs", type=int, default=2000)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()

    bodies = Ellipsoids(options.pairs, seed=1)
    found = bodies.distances()
    apart = found.status == "separated"
    lower, upper = (bounds[apart] for bounds in bodies.interval(found))
    true = (lower + upper) / 2
    kept = bodies.pairs[apart]
    pairs = [(int(i), int(j)) for i, j in kept]

    print(f"{len(pairs)} pairs; the proof encloses their distances within {(upper - lower).max():.0e}\n")
    print("| distance of two ellipsoids | ns a pair | median error | largest error | within 1e-6 |")
    print("|---|---|---|---|---|")

    def row(name: str, distances: np.ndarray, nanoseconds: float) -> None:
        error = np.abs(distances - true)
        within = 100 * (error < 1e-6).mean()
        print(f"| {name} | {nanoseconds:.0f} | {np.median(error):.0e} | {error.max():.0e} | {within:.1f} % |")

    times = []
    for _ in range(20 * options.rounds):
        begin = time.perf_counter()
        answers = hb.distance_many(bodies.shapes, bodies.positions, bodies.quaternions, kept)
        times.append((time.perf_counter() - begin) / len(pairs) * 1e9)
    row("hardbody, distance_many, one thread", answers.distance, min(times))
    row("hardbody, distance in a loop", *measured(by_hardbody(bodies), pairs, options.rounds))
    for tolerance in (1e-6, 1e-9):
        row(
            f"coal {coal.__version__}, gjk_tolerance {tolerance:.0e}",
            *measured(by_coal(bodies, tolerance), pairs, options.rounds),
        )
    for tolerance, iterations in ((1e-6, None), (1e-6, 200), (1e-12, 200)):
        row(
            f"MuJoCo {mujoco.__version__}, ccd_tolerance {tolerance:.0e}, ccd_iterations {iterations or 'default'}",
            *measured(by_mujoco(bodies, tolerance, iterations), pairs, options.rounds),
        )
    row("python-fcl, defaults", *measured(by_fcl(bodies), pairs, options.rounds))
    return 0


if __name__ == "__main__":
    sys.exit(main())
