"""Which state points are run, and in which order."""

import bisect
from typing import NamedTuple

# Aspect ratios that stand in the paper: 0.3448 and 3.2 (close to the isotropic-nematic line), 0.588 and 1.7 (the limits of
# exponential C2).
X0 = [0.2, 0.225, 0.25, 0.28, 0.3125, 0.3448, 0.38, 0.42, 0.46, 0.5, 0.544, 0.588, 0.65, 0.72, 0.8, 0.9, 1.0,
      1.1, 1.25, 1.4, 1.55, 1.7, 1.85, 2.0, 2.2, 2.4, 2.7, 3.0, 3.2, 3.5, 4.0, 4.5, 5.0]
PHI = [0.10, 0.15, 0.20, 0.25, 0.275, 0.30, 0.325, 0.35, 0.375, 0.40, 0.42, 0.435, 0.45, 0.465, 0.48, 0.49, 0.50]

# Where diffusion is so slow that the lines 0.04 and 0.02 of D_trans pass: fluids that could crystallise, but do not
# as fast as they flow.
DENSE_X0 = (0.4, 2.5)
DENSE_PHI = [0.51, 0.52, 0.53, 0.54]

# A grid over the whole plane that is run first, so that there are maps early.
COARSE_X0 = [0.2, 0.25, 0.3448, 0.5, 0.65, 0.8, 1.0, 1.25, 1.55, 2.0, 2.4, 3.2, 4.0, 5.0]
COARSE_PHI = [0.10, 0.20, 0.30, 0.40, 0.45, 0.50]

# What --quick runs.
QUICK_X0 = [0.25, 0.3448, 0.5, 0.65, 0.8, 1.0, 1.25, 1.55, 2.0, 2.4, 3.2, 4.0]
QUICK_PHI = [0.20, 0.30, 0.40, 0.45]

# About where the nematic begins: packing fractions by elongation (a/b, or b/a of discs). Only decides which points are
# left out and which of them get a lower cap; what is nematic is told by S.
NEMATIC = [(2.75, 0.55), (3.0, 0.51), (3.5, 0.47), (4.0, 0.435), (4.5, 0.40), (5.0, 0.37)]
# Where discs are nematic, which is earlier: these get the lower cap, too.
NEMATIC_DISCS = [(2.75, 0.55), (3.2, 0.505), (3.47, 0.468), (3.55, 0.455), (4.0, 0.411), (4.5, 0.385), (5.0, 0.361)]
# Isotropic, but so close to the nematic that S of 512 bodies comes to 0.12 or more, and relaxes over tens of time units:
# diffusion coefficients follow it, and blocks have to be longer than that for honest errors.
SLOW_ORDER = {(0.2, 0.325), (0.225, 0.35), (0.25, 0.4), (0.28, 0.435), (0.3125, 0.465), (0.3448, 0.5), (3.2, 0.5), (3.5, 0.465),
              (3.5, 0.48), (4.0, 0.435), (4.5, 0.4)}
LATE_PRODUCTION = 400  # beyond the nematic's beginning, where precision would take hours
SLOW_ORDER_PRODUCTION = 2400
BEYOND = 0.035  # so far into the nematic points are run: the line S = 0.3 lies between them


class Point(NamedTuple):
    X0: float
    phi: float

    @property
    def name(self):
        return f"X0_{self.X0:g}_phi_{self.phi:g}"

    @property
    def seed(self):
        """Another one for every point, the same on every machine."""
        return round(self.X0 * 10000) * 1000 + round(self.phi * 1000)


def nematic_packing(X0, table=NEMATIC):
    """By the table, straight between its rows; 1 where there is no nematic below phi = 0.55."""
    elongation = max(X0, 1 / X0)
    at = bisect.bisect_left([x for x, _ in table], elongation)
    if at == 0:
        return 1.0
    if at == len(table):
        return table[-1][1]
    (x0, phi0), (x1, phi1) = table[at - 1], table[at]
    return phi0 + (phi1 - phi0) * (elongation - x0) / (x1 - x0)


def is_late(point):
    """Expected to be nematic: C2 does not decay to zero there."""
    return point.phi >= nematic_packing(point.X0, NEMATIC_DISCS if point.X0 < 1 else NEMATIC)


def fixed_time(point):
    """Length of production where it is fixed: where velocities or angular velocities stay correlated for so long that the lags of an
    "auto" production, 15 time units where equilibration is quick, are too short for diffusion (lags then reach 40); where precision
    would take hours; where order is slow. None elsewhere."""
    if point in SLOW_ORDER:
        return SLOW_ORDER_PRODUCTION
    turns_freely = point.X0 != 1 and (0.85 < point.X0 < 1.18 or (0.75 < point.X0 < 1.3 and point.phi < 0.35)
                                      or (0.62 < point.X0 < 1.45 and point.phi <= 0.2))
    if is_late(point):
        return LATE_PRODUCTION
    if point.phi > 0.1 and not turns_freely:
        return None
    return 800 if point.phi < 0.42 else 1200 if point.phi <= 0.5 else 3000


def all_points():
    points = [Point(x, phi) for x in X0 for phi in PHI]
    points += [Point(x, phi) for x in X0 if DENSE_X0[0] < x < DENSE_X0[1] for phi in DENSE_PHI]
    return [p for p in points if p.phi <= nematic_packing(p.X0) + BEYOND]


def ordered_points():
    """Coarse points first, then the rest of the paper's window, then the densest fluids."""
    def stage(point):
        if point.X0 in COARSE_X0 and point.phi in COARSE_PHI:
            return 0
        if point.X0 in COARSE_X0 and point.phi in PHI[::2] + [0.5]:
            return 1
        return 2 if point.phi in PHI else 3

    return sorted(all_points(), key=lambda p: (stage(p), p))


def quick_points():
    return [p for p in (Point(x, phi) for x in QUICK_X0 for phi in QUICK_PHI) if not is_late(p)]
