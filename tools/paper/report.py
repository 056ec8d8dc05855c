"""README.md of the study: completeness, the paper's claims one by one, the figures."""

import os

from . import grid
from .definitions import AMPLITUDE_SLACK, COMPONENTS, DISPLACED, LEAST_BETA, MOST_AMPLITUDE, SHORT_DECAY, STEADY_TAU, STEEPEST_TURN, TURNED
from .results import TARGET_ERROR, write_whole
from .table import DECAYED, FROZEN, NEMATIC

TEXT = """# The paper's study, repeated

C. De Michele, R. Schilling and F. Sciortino, *Event-Driven Simulation of the Dynamics of Hard Ellipsoids*, studied 512 hard
ellipsoids of revolution. This page repeats the study: aspect ratios X0 = a/b from 1/5 to 5; packing fractions from 0.1 to the nematic
(up to 0.5, and to 0.54 between X0 = 0.4 and 2.5, where D_trans is slow enough); moments of inertia 2/5 m min(a, b)^2 without spin;
kT = m = (a b^2)^(1/3) = 1.

    tools/reproduce-paper               # continues where points.csv ends; --minutes M stops after M minutes, --jobs N runs N points at a time
    tools/reproduce-paper --results DIR # begins afresh: all points, with this page and the figures, into DIR; continues there, too
    tools/reproduce-paper --figures     # this page and all figures again, from points.csv and curves.csv; see "Dropped values"
    tools/reproduce-paper --quick       # a coarse grid with short runs in about three minutes, in out/paper-quick

| file | content |
|---|---|
| [points.csv]({data}points.csv) | one row per state point: seed, times, every observable with its standard error, the wave number q of F_self, the windows of the fits, whether it was `equilibrated` (docs/configuration.md#auto), `precise` ({target:g} % or better in D_trans and D_rot) and `sound`, collisions, seconds |
| [curves.csv]({data}curves.csv) | C2(t) and F_self(t) at about ten lags per decade |
| [dropped.csv]({data}dropped.csv) | values whose definitions do not hold, see [below](#dropped-values) |

Everything else on this page is computed from these three files.

Runs equilibrate automatically (docs/configuration.md#auto). Production then continues until D_trans and D_rot are known to {target:g} %,
for at least 16 times the longest lag or 30 times the equilibration. At packing fraction 0.1, and close to X0 = 1, where bodies
move or turn freely for long, productions have a fixed length with lags up to 40 instead. Points that are expected to be nematic
equilibrate for at most 60 time units, produce for 400 and are flagged.

The tool first prints the estimated cost of the missing points, from the seconds in `points.csv`, and with every point the remaining
time.

## Notes on the numbers

- **Rows were produced by programs of several arithmetics.** The order of operations, and with it the last bits, changed during the
  study; the column `version` is 0.1.0 throughout. The same seed reproduces a row statistically, within the errors, not bit for bit:
  trajectories diverge after some ten collisions per body.
- **D_trans is about 1 % low at packing fractions near 0.3.** It is the slope of the mean square displacement between lags of 6
  and 15, where velocities are still slightly correlated. One run at X0 = 2, 0.3 gives 0.4749 from lags 6 to 15, 0.4776 from 10 to 25,
  0.4787 from 16 to 40.
- **Near the nematic, where S is 0.12 to 0.3, order relaxes over tens of time units**, and D_rot follows it. Four productions of 400 time
  units at X0 = 4, 0.435 had D_rot 0.02928, 0.03486, 0.03139 and 0.03266: three times the scatter that blocks of 40 suggest. These 11
  points (`SLOW_ORDER` in `tools/paper/grid.py`) therefore produce for 2400, in blocks of 80.
- **F_self is taken at q, not at q_peak**: q is the first peak of S(q) in the last relaxation of the equilibration, q_peak that of the
  whole production. They differ by more than 10 % in {far_q} rows, where the peak is broad and low.
- **C2 of spheres has no error**: collisions do not change their rotation, so all blocks of a run hold the same rotation. From one
  packing fraction to the next t_C2_1overe scatters by 0.004, as expected for 512 random angular velocities.
- **In nematics <|Delta Phi|^2> grows more slowly than t.** X0 = 3.5, 0.49 and X0 = 4, 0.45, run again for 400 time units, had logarithmic
  slopes of 0.83 and 0.77 between lags of 11 and 25, at the edge of what counts as diffusion (1 +- 0.2). Whether a nematic row has a
  D_rot is therefore a matter of chance; lines and verdicts use none of them.

{dropped}## Completeness

{state}

## Claims

Computed by `tools/paper/verdicts.py` from these files; the text of each claim states its criterion.

| claim of the paper | verdict |
|---|---|
{table}

{details}
## Figures

Lines of constant diffusion coefficient at the paper's levels, from equilibrated isotropic points. Dots are the state points; open dots
are not equilibrated or frozen.

![Lines of constant D_trans and D_rot](isodiffusivity.svg)

Lines of constant time at which C2 has fallen to 1/e, with the lines of constant D_rot.

![Isochrones of C2](isochrones.svg)

Fits of A exp[-(t/tau)^beta] to C2, beginning at five mean collision intervals (filled symbols). In the middle, where C2 decays too
early for a fit or A is above {most_amplitude:g}, open symbols show the time at which C2 is 1/e and the exponent of the whole decay from
0.9 to 0.03 with A = 1. An exponent above 1 means a compressed, inertial decay.

![tau_C2 and beta_C2 against X0](c2_fits.svg)

C2 and F_self (at the first peak of S(q)) of the densest isotropic points up to 0.5.

![Correlation functions](correlators.svg)

The plotted numbers: [isodiffusivity.csv]({data}isodiffusivity.csv), [isochrones.csv]({data}isochrones.csv),
[c2_fits.csv]({data}c2_fits.csv), [correlators.csv]({data}correlators.csv).
"""


def state_text(study):
    planned = grid.all_points()
    done = [p for p in planned if p in study.at]
    other = len(study.rows) - len(done)
    flagged = [r for r in study.rows if not r.equilibrated]
    text = f"{len(study.rows)} of {len(planned) + other} points."
    if not study.rows:
        return text
    nematic = [r for r in study.rows if r["S"] > NEMATIC]
    isotropic = [r for r in study.rows if r["S"] <= NEMATIC]
    equilibrated = [r for r in isotropic if r.isotropic]
    frozen = [r for r in isotropic if r.equilibrated and r.frozen]
    hours = sum(r.seconds for r in study.rows) / 3600
    collisions = sum(r.collisions for r in study.rows)
    text += (f" {len(nematic)} of them are nematic (S > {NEMATIC}); {len(equilibrated)} of the {len(isotropic)} others were equilibrated by the "
             f"criterion and stayed fluid. {_frozen_text(frozen)}The study took {hours:.1f} hours of one core of a shared server: {collisions:.2g} collisions in production, "
             f"{collisions / (3600 * hours):,.0f} per second, equilibration included.\n\n")
    text += _imprecise_text(equilibrated)
    if len(done) < len(planned):
        text += "\n\n**The study is incomplete; the verdicts below are based on the points that exist.**"
    slow = [r for r in flagged if r["S"] <= NEMATIC]
    if slow:
        text += "\n\nNot equilibrated although S <= 0.3, and excluded from lines and verdicts: " + _names(slow) + "."
    if study.undecayed:
        text += (f"\n\nEquilibrated, but with so much order that C2 does not decay to {DECAYED:g} within the longest lag; their fits of "
                 f"C2 are excluded: {_names(study.undecayed)}.")
    return text


def _names(rows):
    """"X0 at phi, phi; ..."."""
    of = {}
    for r in rows:
        of.setdefault(r.X0, []).append(f"{r.phi:g}")
    return "; ".join(f"{X0:g} at {', '.join(phis)}" for X0, phis in sorted(of.items()))


def _frozen_text(rows):
    if not rows:
        return ""
    return (f"{len(rows)} froze during production, although it met the equilibration criterion before (X0 = X at phi = ...): "
            f"{_names(rows)}. A state counts as frozen if S_peak, the height of the first peak of S(q), is above {FROZEN:g}; in the fluids it is below "
            "3.3, and spheres freeze at 2.85. Frozen states are excluded from lines and verdicts and are open dots in the first figure. ")


def _imprecise_text(rows):
    """Names the equilibrated isotropic rows that miss the requested precision, and the coefficient that does."""
    spheres = [r for r in rows if r.X0 == 1]
    without = [r for r in rows if r.X0 != 1 and not r.has("D_rot")]
    text = f"D_trans and D_rot of the equilibrated isotropic ones are known to {100 * TARGET_ERROR:g} %, with these exceptions:"
    if without:
        text += (f" {len(without)} points have no D_rot because their rotation is not diffusive within the longest lag (X0 = X at phi = ...): "
                 f"{_names(without)}.")
    for name in ("D_trans", "D_rot"):
        rough = [r for r in rows if r.has(name) and r.errors[name] > TARGET_ERROR * r[name]]
        if rough:
            worst = max(r.errors[name] / r[name] for r in rough)
            text += f" {name} is known to {100 * worst:.1f} % or better at {_names(rough)}."
    if spheres:
        text += f" The {len(spheres)} points of spheres have no D_rot: collisions do not change their rotation."
    return text


DROPPED = """## Dropped values

`points.csv` contains a value only where its definition holds, as the program prints no other (documentation of `ed::Correlations`):

- D_trans: MSD q^2 / 6 >= {displaced:g} at the first lag of the fit, about 0.4 of the longest. For Gaussian displacements F_self is then
  at most 1/e.
- D_rot: <|Delta Phi|^2> >= {turned:.2g} rad^2 at the longest lag; where it is smaller at the first lag of the fit, a logarithmic slope of at
  most {steepest:g}.
- tau and beta: amplitude at most {amplitude:g}, beta at least {beta:g}, tau not below the first fitted lag. A larger amplitude means that C2
  falls faster before the first fitted lag, so that tau and beta describe only the rest of the decay. Where the correlation is still above
  {short:g} at the longest lag, tau fitted without the first third of the lags must agree to {steady:.0%}: C2 of a nematic ends at a plateau,
  which these fits do not have.

Earlier programs required only a slope of 1 +- 0.2 and nothing of fits. `tools/paper/definitions.py` checks their rows with what is
stored: displacements from the coefficients, amplitudes from the curves (to {slack:g} %). One condition belongs to the study alone, because
the program does not detect crystals: D_trans of a state that froze during production is dropped where F_self is above 1/e at the first lag
of the fit.

{state}
"""


def dropped_text(study, changes):
    state = (_dropped_table(study) + "\n\n" + _changes_text(changes) + "\n") if study.dropped else "No value was dropped.\n"
    open_ones = [(row, doubt) for row, doubt in study.doubts if not doubt.certain]
    if open_ones:
        state += ("\nKept, because the stored values do not decide: "
                  + "; ".join(f"{', '.join(d.names)} of X0 = {row.X0:g} at {row.phi:g} ({d.reason})" for row, d in open_ones) + ".\n")
    return DROPPED.format(displaced=DISPLACED, turned=TURNED * COMPONENTS, steepest=STEEPEST_TURN, amplitude=MOST_AMPLITUDE, beta=LEAST_BETA, short=SHORT_DECAY, steady=STEADY_TAU,
                          slack=100 * AMPLITUDE_SLACK, state=state)


def _dropped_table(study):
    """Table of all dropped values; those of one reason share a row."""
    groups = {}
    for d in study.dropped:
        groups.setdefault((float(d["X0"]), float(d["phi"]), d["reason"]), []).append(d)
    lines = [f"| {X0:g} | {phi:g} | {', '.join(d['observable'] + ' ' + d['value'] for d in group)} | {reason} |"
             for (X0, phi, reason), group in sorted(groups.items())]
    points = {(d["X0"], d["phi"]) for d in study.dropped}
    text = f"{len(study.dropped)} values of {len(points)} points were dropped. `dropped.csv` lists them with errors and windows.\n\n"
    return text + "\n".join(["| X0 | phi | values | reason |", "|---|---|---|---|", *lines])


def _changes_text(changes):
    if not changes:
        return "The verdicts below do not depend on them."
    outcomes = [f"{number} ({old.outcome} with them, now {new.outcome})" for number, old, new in changes if old.outcome != new.outcome]
    text = f"Verdicts that change: {'; '.join(outcomes)}." if outcomes else "No verdict below changes without them."
    kept = [str(number) for number, old, new in changes if old.outcome == new.outcome]
    if kept:
        text += f" The figures in the {'text' if len(kept) == 1 else 'texts'} of {_listed(kept)} change because fewer values are compared."
    return text


def _listed(words):
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]


def readme(study, verdicts, changes, data):
    """Text of the page; `data` is the path from it to the results, empty or with a slash at the end."""
    table = "\n".join(f"| {k}. {v.claim} | {v.outcome} |" for k, v in enumerate(verdicts, 1))
    details = "".join(f"{k}. **{v.claim}: {v.outcome}.** {v.text}\n\n" for k, v in enumerate(verdicts, 1))
    far_q = sum(abs(r.q / r["q_peak"] - 1) > 0.1 for r in study.rows if r.has("q_peak"))
    return TEXT.format(data=data, target=100 * TARGET_ERROR, far_q=far_q, state=state_text(study), table=table, details=details,
                       dropped=dropped_text(study, changes), most_amplitude=MOST_AMPLITUDE)


def write_readme(study, verdicts, changes, directory, pages):
    data = "" if directory == pages else os.path.relpath(directory, pages) + "/"
    write_whole(pages / "README.md", readme(study, verdicts, changes, data))
