"""The paper's claims, one by one, against the measured points."""

import math
from typing import NamedTuple

from .figures import CORRELATORS, D_ROT_LEVELS, D_TRANS_LEVELS, FIT_PHIS, densest_isotropic
from .table import DECAYED, NEMATIC, free_rotor_1overe, free_rotor_c2, moment_of_inertia

CONFIRMED, PARTLY, NOT_CONFIRMED, OPEN = "confirmed", "partly confirmed", "not confirmed", "open: points are missing"

LARGE_PHIS = [0.42, 0.45, 0.48, 0.50]
EXPONENTIAL = (0.588, 1.7)  # X0 between which the paper finds C2 exponential
SHOWN_X0 = [0.2, 0.25, 0.3448, 0.5, 2.0, 3.2, 4.0, 5.0]  # of those for which a text has no room
DIFFUSIVE_ROTATION = 0.5  # isochrones from here on are compared with D_rot
GAS = 0.3  # packing fractions below it
EXPONENT_SLACK = 0.05       # |beta - 1| up to which a decay counts as exponential
SLIGHTLY = 0.8              # beta down to which it counts as slightly stretched


class Verdict(NamedTuple):
    claim: str
    outcome: str
    text: str


def _graded(good, all_of_them, share=1.0):
    """By how many of the checks hold: at least that share of them to be confirmed. A single one decides nothing."""
    if all_of_them < 2:
        return OPEN
    if good >= share * all_of_them:
        return CONFIRMED
    return PARTLY if good >= 0.5 * all_of_them else NOT_CONFIRMED


def _estimate(row, name):
    return f"{row[name]:.3g} +- {row.errors[name]:.2g}"


# ---- Translation

def _peak(rows):
    """X0 and D_trans of the maximum, by a parabola in ln X0 through the largest value and its neighbours, and whether it is one:
    the largest value may be the first or the last."""
    best = max(range(len(rows)), key=lambda k: rows[k]["D_trans"], default=None)
    if best is None:
        return None
    if not 0 < best < len(rows) - 1:
        return rows[best].X0, rows[best]["D_trans"], False
    x = [math.log(r.X0) for r in rows[best - 1:best + 2]]
    y = [r["D_trans"] for r in rows[best - 1:best + 2]]
    slope01, slope12 = (y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1])
    bend = (slope12 - slope01) / (x[2] - x[0])
    at = 0.5 * (x[0] + x[1]) - slope01 / (2 * bend)
    return math.exp(at), y[1], True


def swallow(study, _lines):
    claim = "At large fixed packing fraction D_trans is largest near X0 = 0.5 and 2 (swallow shape)"
    parts, good, checks = [], 0, 0
    for phi in LARGE_PHIS:
        rows = study.along_X0(phi, "D_trans")
        sphere = next((r for r in rows if r.X0 == 1), None)
        for side, expected in ((lambda r: r.X0 < 1, 0.5), (lambda r: r.X0 > 1, 2.0)):
            of_side = [r for r in rows if side(r)]
            if sphere is None or len(of_side) < 3:
                continue
            peak = _peak(of_side)
            checks += 1
            near = peak[2] and abs(math.log(peak[0] / expected)) < math.log(1.4) and peak[1] > sphere["D_trans"]
            good += near
            parts.append(f"at {phi:g}: X0 = {peak[0]:.2f}{'' if peak[2] else ', the last isotropic one'}, {peak[1]:.3g} "
                         f"({peak[1] / sphere['D_trans']:.2f} times that of spheres)")
    return Verdict(claim, _graded(good, checks), "; ".join(parts) + ". A maximum counts within a factor of 1.4 of the paper's X0.")


def falls_with_phi(study, _lines):
    claim = "D_trans falls with the packing fraction at every X0"
    steps = rises = 0
    worst = ""
    for X0 in study.X0s():
        rows = study.along_phi(X0, "D_trans")
        for low, high in zip(rows, rows[1:]):
            steps += 1
            rise = high["D_trans"] - low["D_trans"]
            if rise > 2 * math.hypot(low.errors["D_trans"], high.errors["D_trans"]):
                rises += 1
                worst += f" X0 = {X0:g} from {low.phi:g} to {high.phi:g};"
    text = f"{steps - rises} of {steps} steps from one packing fraction to the next fall, or do not rise by more than two standard errors."
    return Verdict(claim, _graded(steps - rises, steps), text + (" Rises:" + worst.rstrip(";") + "." if rises else ""))


# ---- Rotation

def _range(study, name, fixed, values):
    """Factors by which an observable changes along one key while the other is fixed."""
    factors = []
    for value in values:
        rows = study.along_phi(value, name) if fixed == "X0" else study.along_X0(value, name)
        rows = [r for r in rows if 0.3 <= r.phi <= 0.5 and (fixed == "X0" or r.X0 != 1)]
        if len(rows) > 3:
            factors.append(max(r[name] for r in rows) / min(r[name] for r in rows))
    return factors


def _mean(values):
    return sum(values) / len(values)


def _geometric(values):
    return math.exp(_mean([math.log(v) for v in values]))


def rotation_by_X0(study, _lines):
    claim = "D_rot is mostly controlled by X0, D_trans by the packing fraction"
    columns = [x for x in study.X0s() if x <= 0.72 or x >= 1.4]
    rows = [p for p in study.phis() if 0.3 <= p <= 0.5]
    factors = {(name, key): _range(study, name, key, columns if key == "X0" else rows)
               for name in ("D_rot", "D_trans") for key in ("X0", "phi")}
    if not all(factors.values()):
        return Verdict(claim, OPEN, "")
    mean = {key: _geometric(f) for key, f in factors.items()}
    good = (mean["D_rot", "phi"] > mean["D_rot", "X0"]) + (mean["D_trans", "X0"] > mean["D_trans", "phi"])
    return Verdict(claim, _graded(good, 2),
                   f"Over the isotropic points from 0.3 to 0.5, D_rot changes by a factor of {mean['D_rot', 'phi']:.1f} with X0 at one "
                   f"packing fraction and of {mean['D_rot', 'X0']:.1f} with the packing fraction at one X0 (up to 0.72 and from 1.4 on); "
                   f"D_trans by {mean['D_trans', 'phi']:.1f} and {mean['D_trans', 'X0']:.1f} (geometric means).")


def _scaled(point):
    """Of the figure: X0 over the logarithmic width from 1/5 to 5, phi over the height from 0.1 to 0.55."""
    return math.log(point[0]) / (2 * math.log(5)), (point[1] - 0.1) / 0.45


def _crossing(a, b, c, d):
    """The angle, in degrees up to 90, at which the segments a b and c d cross; nothing where they do not."""
    ux, uy, vx, vy = b[0] - a[0], b[1] - a[1], d[0] - c[0], d[1] - c[1]
    cross = ux * vy - uy * vx
    if cross == 0:
        return None
    s = ((c[0] - a[0]) * vy - (c[1] - a[1]) * vx) / cross
    t = ((c[0] - a[0]) * uy - (c[1] - a[1]) * ux) / cross
    if not (0 <= s < 1 and 0 <= t < 1):
        return None
    return math.degrees(math.asin(min(1.0, abs(cross) / (math.hypot(ux, uy) * math.hypot(vx, vy)))))


def crossing_angles(first, second):
    """At all crossings of lines of two groups, in the scaled plane."""
    angles = []
    segments = [[(_scaled(p), _scaled(q)) for lines in group.values() for line in lines for p, q in zip(line, line[1:])]
                for group in (first, second)]
    for a, b in segments[0]:
        for c, d in segments[1]:
            angle = _crossing(a, b, c, d)
            if angle is not None:
                angles.append(angle)
    return angles


def perpendicular(_study, lines):
    claim = "The lines of constant D_trans and of constant D_rot cross almost perpendicularly"
    angles = crossing_angles(lines.D_trans, lines.D_rot)
    if len(angles) < 5:
        return Verdict(claim, OPEN, f"{len(angles)} crossings so far.")
    angles.sort()
    median = angles[len(angles) // 2]
    outcome = CONFIRMED if median > 60 else PARTLY if median > 40 else NOT_CONFIRMED
    return Verdict(claim, outcome,
                   f"{len(angles)} crossings of the paper's levels: the median angle is {median:.0f} degrees, from {angles[0]:.0f} to "
                   f"{angles[-1]:.0f}, on a figure as high (0.1 to 0.55) as it is wide (ln X0 from 1/5 to 5); the angle depends on that.")


def slowing_along_lines(study, lines):
    claim = "Along a line of constant D_trans, away from spheres, rotation slows progressively"
    parts, good, checks = [], 0, 0
    for level in D_TRANS_LEVELS:
        for side, name in ((lambda x: x <= 0.8, "oblate"), (lambda x: x >= 1.25, "prolate")):
            points = [p for line in lines.D_trans.get(level, []) for p in line if side(p[0])]
            points.sort(key=lambda p: abs(math.log(p[0])))
            values = [study.interpolate("D_rot", *p) for p in points]
            values = [v for v in values if math.isfinite(v)]
            if len(values) < 3:
                continue
            falling = sum(b <= a + 0.03 for a, b in zip(values, values[1:]))  # 3 %, what D_rot is known to
            checks += len(values) - 1
            good += falling
            parts.append(f"D_trans = {level:g}, {name}: from {math.exp(values[0]):.3g} to {math.exp(values[-1]):.3g}")
    outcome = OPEN if checks < 2 else CONFIRMED if good >= 0.95 * checks else PARTLY if good >= 0.75 * checks else NOT_CONFIRMED
    return Verdict(claim, outcome, f"D_rot falls, or rises by less than 3 %, in {good} of {checks} steps. " + "; ".join(parts) + ".")


# ---- Orientational correlations

def _fits(study, phi, inside):
    return [r for r in study.along_X0(phi, "tau_C2", "beta_C2") if _is_inside(r) == inside]


def _is_inside(row):
    return EXPONENTIAL[0] + 1e-9 < row.X0 < EXPONENTIAL[1] - 1e-9


def _rest_of_decay(study, row):
    """beta and A of A exp[-(t/tau)^beta], fitted by weighted least squares of ln C2 to what is left of C2 after five mean
    collision intervals, down to 0.03; nothing if that is fewer than 8 lags, begins below 0.3 or
    is no such curve (bodies turn back)."""
    rest = []
    for c in study.curves[row.point]:
        if c["t"] < 5 / row.rate:
            continue
        if c["C2"] <= DECAYED:
            break
        rest.append((c["t"], math.log(c["C2"]), (c["C2"] / max(c["C2_error"], 1e-4)) ** 2))
    if len(rest) < 8 or rest[0][1] < math.log(0.3):
        return None
    best = None
    betas = [0.01 * k for k in range(30, 250)]
    for beta in betas:
        sums = [0.0] * 5
        for t, y, w in rest:
            x = t ** beta
            sums = [s + w * term for s, term in zip(sums, (1, x, y, x * x, x * y))]
        n, x, y, xx, xy = sums
        slope = (n * xy - x * y) / (n * xx - x * x)
        start = (y - slope * x) / n
        misfit = sum(w * (start + slope * t ** beta - y) ** 2 for t, y, w in rest)
        if best is None or misfit < best[0]:
            best = (misfit, beta, math.exp(start))
    return best[1:] if betas[0] < best[1] < betas[-1] else None


def _is_exponential(row):
    error = row.errors["beta_C2"]
    return abs(row["beta_C2"] - 1) <= EXPONENT_SLACK + (2 * error if math.isfinite(error) else 0)


def exponential_inside(study, _lines):
    claim = "C2 is exponential for 0.588 < X0 < 1.7"
    rows = [r for phi in FIT_PHIS for r in study.along_X0(phi, "t_C2_1overe") if r.X0 != 1 and (_is_inside(r) or r.X0 == EXPONENTIAL[0])]
    overall = [(study.overall_exponent(r), r) for r in rows]
    overall = [(beta, r) for beta, r in overall if math.isfinite(beta)]
    if not overall:
        return Verdict(claim, OPEN, "")
    fits = [r for r in rows if r.has("beta_C2")]
    good = sum(abs(beta - 1) <= EXPONENT_SLACK for beta, _ in overall) + sum(map(_is_exponential, fits))
    parts = []
    for phi in FIT_PHIS:
        at_phi = [(beta, r.X0) for beta, r in overall if r.phi == phi]
        if at_phi:
            parts.append(f"at {phi:g}: from {min(at_phi)[0]:.2f} (X0 = {min(at_phi)[1]:g}) to {max(at_phi)[0]:.2f} (X0 = {max(at_phi)[1]:g})")
    text = (f"The exponent of the whole decay, the slope of ln(-ln C2) against ln t while C2 falls from 0.9 to {DECAYED:g}, for 0.588 <= X0 < 1.7 "
            "without spheres: " + "; ".join(parts) + ". An exponential has 1; above it C2 is compressed, as it is where bodies turn freely "
            "(inertial: 2 at first) before collisions turn them. ")
    unfitted = [r for r in rows if not r.has("beta_C2")]
    intervals = [r["t_C2_1overe"] * r.rate for r in unfitted]
    if unfitted:
        text += (f"{len(unfitted)} of these {len(rows)} points have no fit, for the program asks that C2 takes 15 mean collision intervals to "
                 f"fall to 1/e, three times those that are left out, and here it takes {min(intervals):.1f} to {max(intervals):.1f}. ")
    rests = [(r, rest) for r in unfitted if (rest := _rest_of_decay(study, r))]
    if rests:
        text += ("What is left of C2 after five intervals is no exponential that began at 1 either, where it can be fitted: "
                 + "; ".join(f"X0 = {r.X0:g}, {r.phi:g}: beta {rest[0]:.2f}, A {rest[1]:.1f}" for r, rest in rests) + ". ")
    if fits:
        text += (f"{sum(map(_is_exponential, fits))} of {len(fits)} fits to it give 1 to within {EXPONENT_SLACK} and two standard errors: "
                 + "; ".join(f"X0 = {r.X0:g}, {r.phi:g}: {_estimate(r, 'beta_C2')}" for r in fits) + ".")
    return Verdict(claim, _graded(good, len(overall) + len(fits)), text.strip())


def stretched_outside(study, _lines):
    claim = "Outside of that range C2 is stretched"
    parts, good, checks = [], 0, 0
    for phi in FIT_PHIS:
        rows = _fits(study, phi, False)
        checks += len(rows)
        good += sum(r["beta_C2"] < 1 - EXPONENT_SLACK for r in rows)
        if rows:
            least = min(rows, key=lambda r: r["beta_C2"])
            parts.append(f"at {phi:g}: beta from {least['beta_C2']:.2f} (X0 = {least.X0:g}) to {max(r['beta_C2'] for r in rows):.2f}")
    return Verdict(claim, _graded(good, checks), "; ".join(parts) + f". {good} of {checks} are below {1 - EXPONENT_SLACK:g}.")


def more_stretched_towards_nematic(study, _lines):
    claim = "C2 is the more stretched, and slower, the closer the nematic is"
    good = checks = 0
    parts = []
    for X0 in [x for x in study.X0s() if not EXPONENTIAL[0] <= x <= EXPONENTIAL[1]]:
        rows = [r for r in study.along_phi(X0, "tau_C2", "beta_C2") if r.phi >= 0.7 * max(q.phi for q in study.along_phi(X0, "S"))]
        if len(rows) < 3:
            continue
        checks += 2
        good += rows[-1]["tau_C2"] > rows[0]["tau_C2"]
        good += rows[-1]["beta_C2"] < rows[0]["beta_C2"]
        if X0 in SHOWN_X0:
            parts.append(f"X0 = {X0:g}: beta {rows[0]['beta_C2']:.2f} at {rows[0].phi:g}, {rows[-1]['beta_C2']:.2f} at {rows[-1].phi:g}")
    return Verdict(claim, _graded(good, checks),
                   f"{good} of {checks} comparisons of the last isotropic point with one at 0.7 of its packing fraction. " + "; ".join(parts) + ".")


def slow_at_the_ends(study, _lines):
    claim = "tau_C2 grows from X0 = 1 towards both ends, at 0.40, 0.45 and 0.50"
    parts, good, checks = [], 0, 0
    for phi in FIT_PHIS:
        rows = study.along_X0(phi, "tau_C2")
        for side in ([r for r in rows if r.X0 >= 1.5], [r for r in reversed(rows) if r.X0 <= 0.66]):
            steps = list(zip(side, side[1:]))
            checks += len(steps)
            good += sum(b["tau_C2"] > a["tau_C2"] * 0.98 for a, b in steps)
            if len(side) > 1:
                parts.append(f"at {phi:g}: {side[0]['tau_C2']:.2g} at X0 = {side[0].X0:g}, {side[-1]['tau_C2']:.2g} at {side[-1].X0:g}")
    return Verdict(claim, _graded(good, checks, 0.95), f"{good} of {checks} steps outwards grow (or fall by less than 2 %). " + "; ".join(parts) + ".")


def isochrones_like_d_rot(study, lines):
    claim = "The isochrones of C2 resemble the lines of constant D_rot"
    parts, spreads = [], []
    for time, group in sorted(lines.C2.items()):
        values = [study.interpolate("D_rot", *p) for line in group for p in line if p[0] <= 0.8 or p[0] >= 1.25]
        values = [v for v in values if math.isfinite(v)]
        if len(values) < 5:
            continue
        mean = _mean(values)
        spread = math.sqrt(_mean([(v - mean) ** 2 for v in values]))
        if time >= DIFFUSIVE_ROTATION:
            spreads.append(spread)
        parts.append(f"t = {time:g}: {math.exp(mean):.3g}, {100 * spread:.0f} %")
    if len(spreads) < 2:
        return Verdict(claim, OPEN, "")
    worst = max(spreads)
    outcome = CONFIRMED if worst < 0.25 else PARTLY if worst < 0.5 else NOT_CONFIRMED
    return Verdict(claim, outcome, "D_rot along the line on which C2 has fallen to 1/e, geometric mean and spread: " + "; ".join(parts)
                   + f". Before t = {DIFFUSIVE_ROTATION:g} rotation is inertial (a free sphere's C2 takes 0.34) and does not count. "
                   "Over the plane D_rot changes by a factor of a hundred.")


def free_rotor(study, _lines):
    claim = "Close to X0 = 1, C2 is that of a free rotor and decays within the microscopic time"
    parts, good, checks = [], 0, 0
    for X0 in (0.9, 1.0, 1.1):
        moment = moment_of_inertia(X0)
        for phi in (0.3, 0.4, 0.5):
            # Up to the free rotor's minimum. 512 rotors that nothing turns scatter by 0.02 to 0.03 about their mean.
            early = [c for c in study.curves.get((X0, phi), []) if c["t"] <= 1.4 * math.sqrt(moment)]
            if not early:
                continue
            off = math.sqrt(_mean([(c["C2"] - free_rotor_c2(c["t"], moment)) ** 2 for c in early]))
            checks += 1
            good += off < 0.03
            parts.append(f"X0 = {X0:g}, {phi:g}: {off:.3f}, C2 then {early[-1]['C2']:.2f}")
    return Verdict(claim, _graded(good, checks),
                   "Root mean square difference of C2(t) from the free rotor's with the same moment of inertia, up to that one's minimum "
                   "(0.02): " + "; ".join(parts) + ".")


# ---- Intermediate scattering

def f_self_exponential(study, _lines):
    claim = "Near the isotropic-nematic line F_self is exponential (X0 = 0.3448 and 3.2)"
    parts, good, checks = [], 0, 0
    for X0 in (CORRELATORS[0], CORRELATORS[-1]):
        rows = [r for r in study.along_phi(X0, "beta_F") if r.phi >= 0.45]
        for row in rows[-2:]:
            checks += 1
            good += abs(row["beta_F"] - 1) <= EXPONENT_SLACK + 2 * row.errors["beta_F"]
            parts.append(f"X0 = {X0:g}, {row.phi:g}: beta_F = {_estimate(row, 'beta_F')}, S = {row['S']:.2f}")
    return Verdict(claim, _graded(good, checks), "; ".join(parts) + f". Exponential: within {EXPONENT_SLACK} and two standard errors of 1.")


def f_self_stretched(study, _lines):
    claim = "F_self is slightly stretched at X0 near 1 and large packing fraction, and only there"
    near = [r for r in study.along_X0(0.5, "beta_F") if 0.8 <= r.X0 <= 1.25]
    far = [r for r in study.along_X0(0.5, "beta_F") if not 0.5 <= r.X0 <= 2]
    if len(near) < 2 or len(far) < 2:
        return Verdict(claim, OPEN, "")
    least, mean_far = min(near, key=lambda r: r["beta_F"]), _mean([r["beta_F"] for r in far])
    good = (least["beta_F"] < 1 - 2 * least.errors["beta_F"]) + (_mean([r["beta_F"] for r in near]) < mean_far)
    good += least["beta_F"] >= SLIGHTLY
    return Verdict(claim, _graded(good, 3),
                   f"At 0.50: beta_F {', '.join(_estimate(r, 'beta_F') + f' (X0 = {r.X0:g})' for r in near)}; "
                   f"beyond 0.5 and 2 on average {mean_far:.3f}. Counted are: stretched, more so than far from 1, and slightly, beta_F >= "
                   f"{SLIGHTLY:g}.")


def _dips(curve, name):
    """Whether the decay on a logarithmic axis of time slows down and then speeds up again, by more than its errors: the
    second step of a two-step relaxation."""
    points = [(math.log(c["t"]), c[name], c[name + "_error"]) for c in curve if c[name] > 0.02]
    rates = []
    for (x0, y0, e0), (x1, y1, e1) in zip(points, points[1:]):
        error = math.hypot(e0, e1) if math.isfinite(e0) and math.isfinite(e1) else 0.0
        rates.append(((y0 - y1) / (x1 - x0), error / (x1 - x0)))
    for k in range(1, len(rates) - 1):
        before, after = max(rates[:k], default=None), max(rates[k + 1:], default=None)
        depth = min(before[0], after[0]) - rates[k][0]
        if depth > 0.1 * min(before[0], after[0]) and depth > 3 * math.hypot(rates[k][1], before[1], after[1]):
            return True
    return False


def _turns_freely(row):
    """Whether C2 falls nearly as fast as a free rotor's, which ends at 1/4, or bodies are far between."""
    return row.phi < GAS or not row["t_C2_1overe"] > 1.5 * free_rotor_1overe(moment_of_inertia(row.X0))


def no_two_steps(study, _lines):
    claim = "No two-step decay of C2 or F_self anywhere"
    isotropic = [r for r in study.isotropic if study.curves.get(r.point)]
    found = [(name, r) for r in isotropic for name in ("C2", "F_self") if _dips(study.curves[r.point], name)]
    caged = [(name, r) for name, r in found if name == "F_self" or not _turns_freely(r)]
    checks = 2 * len(isotropic)
    where = "; ".join(f"{name} at X0 = {r.X0:g}, {r.phi:g}" for name, r in caged[:12]) + ("; .." if len(caged) > 12 else "")
    outcome = OPEN if len(isotropic) < 2 else CONFIRMED if not caged else PARTLY if len(caged) < 0.05 * checks else NOT_CONFIRMED
    return Verdict(claim, outcome,
                   f"{checks} curves of isotropic points as functions of ln t: the decay slows down and speeds up again, by a tenth and by "
                   f"more than three standard errors, in {len(caged)}{': ' + where if caged else ''}. Not counted are {len(found) - len(caged)} C2 "
                   f"of bodies that turn nearly freely (packing fractions below {GAS:g}, or 1/e within 1.5 times the free rotor's time): "
                   "a free rotor's C2 falls below 1/4, comes back to it, and goes on when collisions do.")


# ---- Nematic

def nematic_line(study, lines):
    claim = "Nematic beyond S = 0.3, at both ends of the plane"
    if not lines.nematic or sum(r["S"] > NEMATIC for r in study.rows) < 2:
        return Verdict(claim, OPEN, f"{sum(r['S'] > NEMATIC for r in study.rows)} points with S > {NEMATIC}.")
    points = sorted(p for line in lines.nematic for p in line)
    beyond = [r for r in study.rows if r["S"] > NEMATIC]
    sides = any(p[0] < 1 for p in points) + any(p[0] > 1 for p in points)
    middle = [r for r in beyond if 0.4 < r.X0 < 2.5]
    floor = [r["S"] for r in study.rows if 0.5 <= r.X0 <= 2 and r.phi <= 0.5]
    text = (f"{len(beyond)} points with S > {NEMATIC}, none" if not middle else f"{len(beyond)} points with S > {NEMATIC}, {len(middle)}")
    text += " of them between X0 = 0.4 and 2.5. S = 0.3 at "
    text += "; ".join(f"X0 = {x:.3g}: {phi:.3f}" for x, phi in points)
    if floor:
        text += f". In isotropic fluids of 512 bodies S is {_mean(floor):.3f} on average, not 0."
    return Verdict(claim, _graded(sides if not middle else 0, 2), text)


# ---- Which D_rot

def convention(study, _lines):
    claim = "The convention of the paper's D_rot: <|Delta Phi|^2> / 4t, or / 6t as in the author's scripts"
    rows = [r for r in study.isotropic if r.has("D_rot") and r.phi <= 0.5]
    sides = {"oblate": [r for r in rows if r.X0 < 1], "prolate": [r for r in rows if r.X0 > 1]}
    if any(len(of_side) < 2 for of_side in sides.values()):
        return Verdict(claim, OPEN, "")
    paper = {"oblate": 0.15, "prolate": 0.045}
    fits, parts = {}, []
    for divisor in (4, 6):
        reached = {}
        for side, of_side in sides.items():
            least = min(r["D_rot"] for r in of_side) * 4 / divisor
            reached[side] = min((level for level in D_ROT_LEVELS if level >= least), default=math.nan)
        fits[divisor] = sum(abs(math.log(reached[side] / paper[side])) for side in paper)
        parts.append(f"/ {divisor}t: {reached['oblate']:g} on the oblate side, {reached['prolate']:g} on the prolate one")
    if fits[4] == fits[6]:
        outcome = "both agree"
    else:
        outcome = f"{4 if fits[4] < fits[6] else 6}t agrees better"
    lowest = {side: min(of_side, key=lambda r: r["D_rot"]) for side, of_side in sides.items()}
    return Verdict(claim, outcome,
                   "The paper draws levels down to 0.15 on the oblate side and 0.045 on the prolate one. The lowest of its levels that the "
                   "isotropic points reach here: " + "; ".join(parts) + ". Smallest D_rot (/ 4t): "
                   + "; ".join(f"{_estimate(r, 'D_rot')} at X0 = {r.X0:g}, {r.phi:g}" for r in lowest.values())
                   + ". The paper's equation says 4t, and points.csv has that; two thirds of it are the 6t values.")


CLAIMS = [swallow, falls_with_phi, rotation_by_X0, perpendicular, slowing_along_lines, exponential_inside, stretched_outside,
          more_stretched_towards_nematic, slow_at_the_ends, isochrones_like_d_rot, free_rotor, f_self_exponential,
          f_self_stretched, no_two_steps, nematic_line, convention]


def verdicts(study, lines):
    return [claim(study, lines) for claim in CLAIMS]


def changed_claims(after, before):
    """Numbers of claims, from 1 on, whose outcomes or texts differ: [(number, before, after), ..]."""
    return [(number, old, new) for number, (old, new) in enumerate(zip(before, after), 1) if old != new]
