"""points.csv and curves.csv as numbers, and what figures and verdicts ask of them."""

import math
from collections import defaultdict

from .definitions import FROZEN, doubts, number
from .results import OBSERVABLES, point_of, read_rows

NEMATIC = 0.3  # S above it, the paper's criterion
DECAYED = 0.03  # C2 must have come down to it for a fit: with little order left it ends at S^2


class Row:
    """A state point; observables that were not measured are NaN."""

    def __init__(self, row):
        self.point = point_of(row)
        self.X0, self.phi = self.point
        self.values = {name: number(row[name]) for name in OBSERVABLES}
        self.errors = {name: number(row[name + "_error"]) for name in OBSERVABLES}
        self.equilibrated = row["equilibrated"] == "true"
        self.precise = row["precise"] == "true"
        self.collisions = number(row["collisions"])
        self.seconds = number(row["wall_seconds"])
        self.q = number(row["q"])
        self.rate = self.values["collision_rate"]

    def __getitem__(self, name):
        return self.values[name]

    def has(self, *names):
        return all(math.isfinite(self.values[name]) for name in names)

    @property
    def frozen(self):
        """Crystalline, if not at the end of equilibration, which sees nothing of that, then during production."""
        return self.values["S_peak"] > FROZEN

    @property
    def isotropic(self):
        """A fluid: neither nematic nor, as crystals and glasses, unable to forget where it was."""
        return self.values["S"] <= NEMATIC and self.equilibrated and not self.frozen


class Study:
    """All rows; with the values in dropped.csv, if `restored`."""

    def __init__(self, directory, restored=False):
        rows, curves = read_rows(directory / "points.csv"), defaultdict(list)
        for row in read_rows(directory / "curves.csv"):
            curves[point_of(row)].append(row)
        self.rows = [Row(row) for row in rows]
        self.at = {row.point: row for row in self.rows}
        self.curves = defaultdict(list)
        for point, curve in curves.items():
            self.curves[point] = [{key: number(c[key]) for key in ("t", "C2", "C2_error", "F_self", "F_self_error")} for c in curve]
        self.dropped = read_rows(directory / "dropped.csv")
        self.doubts = [(self.at[point_of(row)], doubt) for row in rows for doubt in doubts(row, curves[point_of(row)])]
        if restored:
            self._restore()
        self.undecayed = [r for r in self.isotropic
                          if r.has("tau_C2") and not any(c["C2"] <= DECAYED for c in self.curves[r.point])]
        for row in self.undecayed:
            row.values.update(tau_C2=math.nan, beta_C2=math.nan)

    def _restore(self):
        for d in self.dropped:
            row = self.at[point_of(d)]
            row.values[d["observable"]], row.errors[d["observable"]] = number(d["value"]), number(d["error"])

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

    def overall_exponent(self, row):
        """Of the whole decay, as if C2 were exp[-(t/tau)^beta] from 1 on: the slope of ln(-ln C2) against ln t by least squares, for C2
        from 0.9 down to DECAYED or, of bodies that turn back, to where it rises. NaN for fewer than four lags."""
        x, y, before = [], [], 1.0
        for c in self.curves[row.point]:
            if c["C2"] < DECAYED or c["C2"] > before:
                break
            before = c["C2"]
            if c["C2"] <= 0.9:
                x.append(math.log(c["t"]))
                y.append(math.log(-math.log(c["C2"])))
        if len(x) < 4:
            return math.nan
        mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
        return (sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x))

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


def dawson(x):
    """Dawson's integral exp(-x^2) int_0^x exp(y^2) dy for x >= 0: Rybicki's sum of Gaussians, a step of 0.4 apart; from 15 on the asymptotic
    series; relatively to 4e-7."""
    if x > 15:
        s = 1 / (2 * x * x)
        return (1 + s * (1 + s * (3 + s * 15))) / (2 * x)
    step = 0.4
    nearest = 2 * round(x / (2 * step))  # even, so that the odd terms about it are symmetric
    rest = x - nearest * step
    total = sum(math.exp(-(rest - n * step) ** 2) / (n + nearest) for n in range(-13, 14, 2))
    return total / math.sqrt(math.pi)


def free_rotor_c2(t, moment):
    """<P2(u(t).u(0))> of a linear rotor at kT = 1 that nothing turns: u turns by w t, and e = I w^2 / 2 is distributed as
    exp(-e), so that it is 1/4 + 3/4 <cos 2 w t> = 1 - 3/2 z F(z) with z = sqrt(2/I) t and Dawson's F."""
    z = math.sqrt(2 / moment) * t
    return 1 - 1.5 * z * dawson(z)


def free_rotor_1overe(moment):
    """When the free rotor's C2 has fallen to 1/e."""
    low, high = 0.0, math.sqrt(moment)
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if free_rotor_c2(middle, moment) > math.exp(-1) else (low, middle)
    return 0.5 * (low + high)
