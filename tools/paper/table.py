"""points.csv and curves.csv as numbers, and what figures and verdicts ask of them."""

import math
from collections import defaultdict

from .results import OBSERVABLES, point_of, read_rows

NEMATIC = 0.3  # S above it, the paper's criterion
DECAYED = 0.03  # C2 must have come down to it for a fit: with little order left it ends at S^2


def _number(text):
    return float(text) if text else math.nan


class Row:
    """A state point; observables that were not measured are NaN."""

    def __init__(self, row):
        self.point = point_of(row)
        self.X0, self.phi = self.point
        self.values = {name: _number(row[name]) for name in OBSERVABLES}
        self.errors = {name: _number(row[name + "_error"]) for name in OBSERVABLES}
        self.equilibrated = row["equilibrated"] == "true"
        self.precise = row["precise"] == "true"
        self.collisions = _number(row["collisions"])
        self.seconds = _number(row["wall_seconds"])
        self.rate = self.values["collision_rate"]

    def __getitem__(self, name):
        return self.values[name]

    def has(self, *names):
        return all(math.isfinite(self.values[name]) for name in names)

    @property
    def isotropic(self):
        """A fluid: neither nematic nor, as crystals and glasses, unable to forget where it was."""
        return self.values["S"] <= NEMATIC and self.equilibrated


class Study:
    def __init__(self, directory):
        self.rows = [Row(row) for row in read_rows(directory / "points.csv")]
        self.at = {row.point: row for row in self.rows}
        self.curves = defaultdict(list)
        for row in read_rows(directory / "curves.csv"):
            self.curves[point_of(row)].append({key: _number(row[key]) for key in ("t", "C2", "C2_error", "F_self", "F_self_error")})
        self.undecayed = [r for r in self.isotropic
                          if r.has("tau_C2") and not any(c["C2"] <= DECAYED for c in self.curves[r.point])]
        for row in self.undecayed:
            row.values.update(tau_C2=math.nan, beta_C2=math.nan)

    @property
    def isotropic(self):
        return [row for row in self.rows if row.isotropic]

    def X0s(self):
        return sorted({row.X0 for row in self.rows})

    def phis(self):
        return sorted({row.phi for row in self.rows})

    def along_phi(self, X0, *names):
        """Isotropic rows of one X0 that have these, by phi."""
        return sorted((r for r in self.isotropic if r.X0 == X0 and r.has(*names)), key=lambda r: r.phi)

    def along_X0(self, phi, *names):
        return sorted((r for r in self.isotropic if r.phi == phi and r.has(*names)), key=lambda r: r.X0)

    def interpolate(self, name, X0, phi):
        """ln of an observable, linear in phi and in ln X0 between the nearest columns; NaN outside of them."""
        columns = [x for x in self.X0s() if len(self.along_phi(x, name)) > 1]
        below = max((x for x in columns if x <= X0 * (1 + 1e-9)), default=None)
        above = min((x for x in columns if x >= X0 * (1 - 1e-9)), default=None)
        if below is None or above is None:
            return math.nan
        values = [self._in_column(name, x, phi) for x in (below, above)]
        if below == above:
            return values[0]
        share = math.log(X0 / below) / math.log(above / below)
        return values[0] + share * (values[1] - values[0])

    def _in_column(self, name, X0, phi):
        rows = self.along_phi(X0, name)
        for low, high in zip(rows, rows[1:]):
            if low.phi - 1e-9 <= phi <= high.phi + 1e-9:
                share = (phi - low.phi) / (high.phi - low.phi)
                return math.log(low[name]) + share * math.log(high[name] / low[name])
        return math.nan


def moment_of_inertia(X0):
    """The paper's, 2/5 m min(a, b)^2, at (a b^2)^(1/3) = 1."""
    return 0.4 * min(X0 ** (2 / 3), X0 ** (-1 / 3)) ** 2


def free_rotor_c2(t, moment):
    """<P2(u(t).u(0))> of a linear rotor at kT = 1 that nothing turns: u turns by w t, and e = I w^2 / 2 is distributed as
    exp(-e), so that it is 1/4 + 3/4 <cos 2 w t>, here by quadrature over e."""
    steps, longest = 4000, 40.0
    total = weights = 0.0
    for k in range(steps):
        e = (k + 0.5) * longest / steps
        weight = math.exp(-e)
        total += weight * (0.25 + 0.75 * math.cos(2 * math.sqrt(2 * e / moment) * t))
        weights += weight
    return total / weights


def free_rotor_1overe(moment):
    """When the free rotor's C2 has fallen to 1/e."""
    low, high = 0.0, math.sqrt(moment)
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if free_rotor_c2(middle, moment) > math.exp(-1) else (low, middle)
    return 0.5 * (low + high)
