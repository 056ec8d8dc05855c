"""Where the definitions of diffusion coefficients and fits hold in a row of points.csv.

The program decides this itself, from mean square displacements at all lags (libed/src/observables/curves.h). This module judges rows that older
programs wrote, from points.csv and curves.csv. It drops only what certainly does not hold, so that it never drops what the program
prints today, except D_trans of states that froze.
"""

import math
from typing import NamedTuple

from . import grid
from .decay_fit import stretched_exponential

# Thresholds of libed/src/observables/curves.h, under the names that they have there.
FIT_FROM = 0.4  # diffusion is fitted from this share of the longest lag on
LINEARITY = 0.2  # logarithmic slope there: 1 +- LINEARITY
DISPLACED = 1  # MSD q^2 / 6 at the first of these lags, at least
TURNED = 1 / 3  # <|Delta Phi|^2> / components at the longest lag, in rad^2, at least
MOST_AMPLITUDE = 1.3
LEAST_BETA = 0.3
SHORT_DECAY = 0.25
STEADY_TAU = 0.25

# Rotation: where <|Delta Phi|^2> at the first lag is below TURNED times the components, the slope may be this, at most.
STEEPEST_TURN = 1.1

# First of these lags, in units of the longest: there are 20 a decade.
FIRST_LAG = 10 ** (-math.floor(20 * math.log10(1 / FIT_FROM)) / 20)
COMPONENTS = 2  # of rotation: bodies of revolution
FROZEN = 4  # S_peak, the mean over production, above it: a crystal; of these fluids it is below 3.3
# Amplitudes are fitted here to half of the lags that the program fits.
AMPLITUDE_SLACK = 0.005
# The same of tau of the later lags: twice the share is certain, half of it may be too much.
TAU_SLACK = 2
FEWEST_LAGS = 4
CLEAR_PEAK = 5  # standard errors by which a peak of S(q) has to be above 1
FITS = {"C2": "C2", "F": "F_self"}  # suffixes of tau and beta, columns of curves.csv


class Doubt(NamedTuple):
    """Values of a row whose definition does not hold, or, if not `certain`, may not hold."""

    names: tuple
    reason: str
    certain: bool = True


def number(text):
    return float(text) if text else math.nan


# ---- Quantities that are not stored

def longest_lag(row, curve):
    """Longest lag of a run, by the rules of the program (apps/hardbody/run/phases/production.cpp) and of study.production_text."""
    production, equilibration = number(row["production_time"]), number(row["equilibration_time"])
    if production == grid.fixed_time(grid.Point(number(row["X0"]), number(row["phi"]))):
        lag = 40
    else:
        lag = min(min(30 * equilibration, 5000) / 16, max(40, equilibration))
    # Longest lags of gases are some mean collision intervals. Curves never go beyond the longest lag.
    return max(min(lag, production / 16), number(curve[-1]["t"]) if curve else 0)


def spread(share):
    """Least and largest displacement at a share of the longest lag, in units of slope times lag, of power laws t^(1 +- LINEARITY)."""
    values = []
    for exponent in (1 + LINEARITY, 1 - LINEARITY):
        slope = (1 - FIRST_LAG ** exponent) / (1 - FIRST_LAG)
        values.append(share ** exponent / (slope * share))
    return values


def amplitude(row, curve, fit):
    """A of A exp[-(t/tau)^beta] by least squares, with tau, beta and lags of the row; NaN for fewer than FEWEST_LAGS."""
    tau, beta, first, last = (number(row[name]) for name in (f"tau_{fit}", f"beta_{fit}", f"{fit}_fit_from", f"{fit}_fit_to"))
    # Lags have four digits.
    lags = [(t, number(c[FITS[fit]])) for c in curve if first * 0.999 <= (t := number(c["t"])) <= last * 1.001]
    if len(lags) < FEWEST_LAGS:
        return math.nan
    decays = [math.exp(-((t / tau) ** beta)) for t, _ in lags]
    return sum(g * y for g, (_, y) in zip(decays, lags)) / sum(g * g for g in decays)


def tau_without_first_third(row, curve, fit):
    """tau of the lags that were fitted but for the first third of them, in units of that of all; NaN if they have no fit. 1 where the
    correlation has come down to SHORT_DECAY or the noise."""
    first, last = (number(row[f"{fit}_fit_{end}"]) for end in ("from", "to"))
    lags = [(t, number(c[FITS[fit]])) for c in curve if first * 0.999 <= (t := number(c["t"])) <= last * 1.001]
    if len(lags) < FEWEST_LAGS or lags[-1][1] <= SHORT_DECAY or last < number(curve[-1]["t"]) * 0.999:
        return 1
    all_lags, late = stretched_exponential(lags), stretched_exponential(lags[len(lags) // 3:])
    return late[1] / all_lags[1] if all_lags and late else math.nan


def f_self_at(curve, lag):
    """F_self, linear in ln t between two lags; NaN beyond the last one, where both curves have decayed."""
    for before, after in zip(curve, curve[1:]):
        t0, t1 = number(before["t"]), number(after["t"])
        if t0 <= lag <= t1:
            y0, y1 = number(before["F_self"]), number(after["F_self"])
            return y0 + (y1 - y0) * math.log(lag / t0) / math.log(t1 / t0)
    return math.nan


# ---- Judgement

def translation(row, curve):
    """Doubts about D_trans."""
    D, lag = number(row["D_trans"]), longest_lag(row, curve)
    if math.isnan(D):
        return
    at_start = D * FIRST_LAG * lag * number(row["q"]) ** 2
    least, most = (at_start * s for s in spread(FIRST_LAG))
    left = f_self_at(curve, FIRST_LAG * lag)
    if number(row["S_peak"]) > FROZEN and left > math.exp(-1):
        yield Doubt(("D_trans",), f"froze during production, a mean over fluid and crystal; F_self still {left:.2f} at lag "
                                  f"{FIRST_LAG * lag:.3g}")
    elif least < DISPLACED:
        yield Doubt(("D_trans",), f"MSD q^2 / 6 between {least:.2g} and {most:.2g} at lag {FIRST_LAG * lag:.3g}, at least {DISPLACED:g} "
                                  "wanted", most < DISPLACED)


def rotation(row, curve):
    """Doubts about D_rot and D_rot_body."""
    wanted = TURNED * COMPONENTS
    lag = longest_lag(row, curve)
    for name in ("D_rot", "D_rot_body"):
        turned = 2 * COMPONENTS * number(row[name]) * lag
        if math.isnan(turned):
            continue
        least, most = (turned * s for s in spread(1))
        if least < wanted:
            yield Doubt((name,), f"<|Delta Phi|^2> between {least:.2g} and {most:.2g} rad^2 at lag {lag:.3g}, at least {wanted:.2g} wanted",
                        most < wanted)
            continue
        least, most = (turned * FIRST_LAG * s for s in spread(FIRST_LAG))
        if least < wanted:
            yield Doubt((name,), f"<|Delta Phi|^2> between {least:.2g} and {most:.2g} rad^2 at lag {FIRST_LAG * lag:.3g}; below {wanted:.2g} "
                                 f"a logarithmic slope of at most {STEEPEST_TURN:g} is wanted", False)


def fits(row, curve):
    """Doubts about tau and beta."""
    for fit in FITS:
        tau, beta = number(row[f"tau_{fit}"]), number(row[f"beta_{fit}"])
        if math.isnan(tau):
            continue
        A = amplitude(row, curve, fit)
        reasons = []
        if A > MOST_AMPLITUDE * (1 + AMPLITUDE_SLACK):
            reasons.append(f"amplitude {A:.3g}, at most {MOST_AMPLITUDE:g} wanted")
        if beta < LEAST_BETA:
            reasons.append(f"beta {beta:.3g}, at least {LEAST_BETA:g} wanted")
        if tau < number(row[f"{fit}_fit_from"]):
            reasons.append(f"tau {tau:.3g} is before the first fitted lag, {row[f'{fit}_fit_from']}")
        change = abs(tau_without_first_third(row, curve, fit) - 1)
        wanted = f"without the first third of the lags, at most {STEADY_TAU:.0%} wanted, with {FITS[fit]} above {SHORT_DECAY:g} at the longest"
        if math.isnan(change):
            reasons.append(f"no fit {wanted.partition(',')[0]}, with {FITS[fit]} above {SHORT_DECAY:g} at the longest")
        elif change > STEADY_TAU * TAU_SLACK:
            reasons.append(f"tau changes by {change:.0%} {wanted}")
        if reasons:
            yield Doubt((f"tau_{fit}", f"beta_{fit}"), "; ".join(reasons))
        elif change > STEADY_TAU / TAU_SLACK:
            yield Doubt((f"tau_{fit}", f"beta_{fit}"), f"tau changes by {change:.0%} {wanted}", False)
        elif A > MOST_AMPLITUDE * (1 - AMPLITUDE_SLACK):
            yield Doubt((f"tau_{fit}", f"beta_{fit}"), f"amplitude {A:.4g}, at most {MOST_AMPLITUDE:g} wanted", False)


def peak(row):
    """Doubts about q_peak and S_peak."""
    errors = (number(row["S_peak"]) - 1) / number(row["S_peak_error"])
    if errors <= CLEAR_PEAK:
        yield Doubt(("q_peak", "S_peak"), f"S(q) is above 1 by {errors:.1f} of its standard errors at its highest, more than {CLEAR_PEAK:g} "
                                          "wanted")


def doubts(row, curve):
    return [*translation(row, curve), *rotation(row, curve), *fits(row, curve), *peak(row)]


def judged(row, curve):
    """The row without the values whose definition does not hold, and these values, as rows of dropped.csv."""
    kept, dropped = dict(row), []
    for doubt in doubts(row, curve):
        if not doubt.certain:
            continue
        fit = doubt.names[0].removeprefix("tau_")
        window = [f"{fit}_fit_from", f"{fit}_fit_to"] if fit in FITS else []
        for name in doubt.names:
            dropped.append({"X0": row["X0"], "phi": row["phi"], "observable": name, "value": row[name], "error": row[name + "_error"],
                            **dict(zip(("fit_from", "fit_to"), [row[column] for column in window] or ["", ""])), "reason": doubt.reason})
            kept[name] = kept[name + "_error"] = ""
            if name in ("D_trans", "D_rot"):
                kept["precise"] = "false"
        kept |= dict.fromkeys(window, "")
    return kept, dropped
