"""Fits how long fluids of ellipsoids equilibrate, for the expected costs of runs (apps/hardbody/sweep/tasks/cost_model.cpp).

usage: python3 -m paper.equilibration_fit [points.csv], in tools; needs NumPy and SciPy
"""

import csv
import math
import pathlib
import sys

import numpy as np
from scipy.optimize import least_squares

POINTS = pathlib.Path(__file__).resolve().parents[2] / "data/paper/points.csv"
RATE = [1.920, 1.288, -0.1665]  # kRate of the cost model
LEAST, MOST, SHARPNESS, ELONGATED = 8, 60, 8, 0.5
BEGIN = [1, 0.92, 0.35, 2, 10, 25, 0.5]


def collision_rate(elongation, phi):
    x = min(elongation**2, 2.6)
    return phi * (1 - phi / 2) / (1 - phi) ** 3 * math.exp(RATE[0] + RATE[1] * x + RATE[2] * x * x)


def relaxation(p, elongation, phi):
    """Thermal times, with the parameters in the order of the cost model's constants."""
    turns = collision_rate(elongation, phi) * elongation**2
    terms = [
        LEAST,
        p[0] / turns if turns > 0 else 0,
        p[3] / max(1 - phi / (p[1] - p[2] * elongation), 0.02) if elongation > ELONGATED else 0,
        p[4] * math.exp(p[5] * (phi - 0.5) - p[6] * elongation),
    ]
    return min(sum(t**SHARPNESS for t in terms) ** (1 / SHARPNESS), MOST)


def isotropic(path):
    """Elongation, packing fraction and equilibration time of points that equilibrated and did not order."""
    with open(path, newline="") as file:
        rows = [r for r in csv.DictReader(file) if r["equilibrated"] == "true" and float(r["S"]) < 0.35]
    found = [(abs(math.log(float(r["X0"]))), float(r["phi"]), float(r["equilibration_time"])) for r in rows]
    return [f for f in found if f[2] < 500]


def main():
    points = isotropic(sys.argv[1] if len(sys.argv) > 1 else POINTS)

    def off(p):
        return np.array([math.log(relaxation(p, l, phi) / time) for l, phi, time in points])

    fit = least_squares(off, BEGIN, loss="soft_l1", f_scale=0.2)
    left = off(fit.x)
    print("parameters", *(f"{x:.4g}" for x in fit.x))
    print(f"{len(points)} points: {np.sqrt(np.mean(left**2)):.3f} off (root mean square of ln), at most {abs(left).max():.2f}")


if __name__ == "__main__":
    main()
