"""README.md of the study: how far it is, the paper's claims one by one, the figures."""

from . import grid
from .definitions import AMPLITUDE_SLACK, COMPONENTS, DISPLACED, LEAST_BETA, MOST_AMPLITUDE, SHORT_DECAY, STEADY_TAU, STEEPEST_TURN, TURNED
from .results import TARGET_ERROR, write_whole
from .table import DECAYED, FROZEN, NEMATIC

TEXT = """# The paper's study, again

C. De Michele, R. Schilling and F. Sciortino, *Event-Driven Simulation of the Dynamics of Hard Ellipsoids*: 512 hard ellipsoids
of revolution, aspect ratios X0 = a/b from 1/5 to 5, packing fractions from 0.1 to the nematic (up to 0.5, and to 0.54 between
X0 = 0.4 and 2.5, where D_trans is slow enough), moments of inertia 2/5 m min(a, b)^2 without spin, kT = m = (a b^2)^(1/3) = 1.

    tools/reproduce-paper               # goes on where points.csv ends; --minutes M stops after so many, --jobs N
    tools/reproduce-paper --results DIR # afresh: all points, into DIR instead, with this page and the figures; goes on there, too
    tools/reproduce-paper --figures     # this page and all figures again, from points.csv and curves.csv; see "Values that fell out"
    tools/reproduce-paper --quick       # a coarse grid with short runs, in some three minutes, in out/paper-quick

`points.csv` has one row a state point: seed, times, every observable with its standard error, the wave number q of F_self, the
windows of the fits, whether it was `equilibrated` (docs/configuration.md#auto), `precise` ({target:g} % or better in D_trans and D_rot)
and `sound`, collisions, seconds. `curves.csv` has C2(t) and F_self(t) at about ten lags a decade. `dropped.csv` has values
whose definitions do not hold, see [below](#values-that-fell-out). Everything else here is made
from these three.

Runs equilibrate by themselves (docs/configuration.md#auto) and then produce until D_trans and D_rot are known to {target:g} %,
for 16 longest lags at least, or 30 times as long. At packing fraction 0.1, and close to X0 = 1, where bodies fly or turn
freely for long, productions have a fixed length with lags up to 40 instead. Points that are expected to be nematic
equilibrate for at most 60 time units and produce for 400, and are flagged.

The tool says first what the points that are missing will cost, by the seconds that stand in `points.csv`, and with every
point how long the rest will take.

## What to know of the numbers

- **Rows were made by programs of several arithmetics**: the orders of operations, and so the last bits, changed while the
  study ran; the column `version` says 0.1.0 of all. The same seed gives the same row again statistically, within the errors,
  not bit for bit: trajectories part after some ten collisions a body.
- **D_trans is about 1 % low at packing fractions near 0.3.** It is the slope of the mean square displacement between lags of 6
  and 15, where velocities are still correlated a little. From one run at X0 = 2, 0.3: 0.4749 from lags 6 to 15, 0.4776 from 10 to 25,
  0.4787 from 16 to 40.
- **Near the nematic, where S is 0.12 to 0.3, order relaxes over tens of time units**, and D_rot follows it: four productions of 400 time
  units at X0 = 4, 0.435 had D_rot 0.02928, 0.03486, 0.03139 and 0.03266, three times as far apart as blocks of 40 made believe. These 11
  points (`SLOW_ORDER` in `tools/paper/grid.py`) therefore produce for 2400, in blocks of 80.
- **F_self is at q, not at q_peak**: q is the first peak of S(q) in the last relaxation of the equilibration, q_peak that of the whole
  production. They are more than 10 % apart in {far_q} rows, where the peak is broad and low.
- **C2 of spheres has no error**: nothing turns them, so that all blocks of a run hold the same rotation. From one packing fraction to
  the next t_C2_1overe scatters by 0.004, as 512 random angular velocities do.
- **In nematics <|Delta Phi|^2> grows more slowly than t**: X0 = 3.5, 0.49 and X0 = 4, 0.45, run again for 400 time units, had logarithmic
  slopes of 0.83 and 0.77 between lags of 11 and 25, at the edge of what counts as diffusion (1 +- 0.2). Whether a nematic row has a
  D_rot is therefore a matter of chance; lines and verdicts use none of them.

{dropped}## How far it is

{state}

## Claims

Computed by `tools/paper/verdicts.py` from these files, with the criteria that stand in the text.

| claim of the paper | |
|---|---|
{table}

{details}
## Figures

Isodiffusivity lines at the paper's levels, of equilibrated isotropic points; dots are the state points, open ones not equilibrated
or frozen.

![Lines of constant D_trans and D_rot](isodiffusivity.svg)

When C2 has fallen to 1/e, with the lines of constant D_rot.

![Isochrones of C2](isochrones.svg)

Fits of A exp[-(t/tau)^beta] to C2, from five mean collision intervals on (filled). Where C2 falls too early for that, or A is above
{most_amplitude:g}, in the middle, open symbols: the time at which it is 1/e, and the exponent of the whole decay from 0.9 to 0.03, A being 1. Above 1: compressed, inertial.

![tau_C2 and beta_C2 against X0](c2_fits.svg)

C2 and F_self (at the first peak of S(q)) of the densest isotropic points up to 0.5.

![Correlation functions](correlators.svg)

The numbers drawn are in the CSV files of the same names.
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
             f"criterion and stayed fluid. {_frozen_text(frozen)}All together took {hours:.1f} hours of one core of a shared server: {collisions:.2g} collisions in production, "
             f"{collisions / (3600 * hours):,.0f} a second, equilibration included.\n\n")
    text += _imprecise_text(equilibrated)
    if len(done) < len(planned):
        text += "\n\n**The study is not complete: the verdicts below are those of the points that are there.**"
    slow = [r for r in flagged if r["S"] <= NEMATIC]
    if slow:
        text += "\n\nNot equilibrated though S <= 0.3, and left out of lines and verdicts: " + _names(slow) + "."
    if study.undecayed:
        text += (f"\n\nEquilibrated, but with so much order left that C2 does not come down to {DECAYED:g} within the longest lag: their fits of "
                 f"C2 are left out. {_names(study.undecayed)}.")
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
    return (f"{len(rows)} froze during production, though the criterion, met before, counts it as equilibrated (X0 = X at phi = ...): "
            f"{_names(rows)}. Frozen is what has S_peak, the height of S(q)'s first peak, above {FROZEN:g}; in the fluids it is below 3.3, and "
            "spheres freeze at 2.85. It is left out of lines and verdicts, and an open dot in the first figure. ")


def _imprecise_text(rows):
    """Which of the equilibrated isotropic rows are not as precise as was asked for, and in what."""
    spheres = [r for r in rows if r.X0 == 1]
    without = [r for r in rows if r.X0 != 1 and not r.has("D_rot")]
    text = f"D_trans and D_rot of the equilibrated isotropic ones are known to {100 * TARGET_ERROR:g} % but for these:"
    if without:
        text += (f" {len(without)} points have no D_rot, their rotation is not diffusive within the longest lag (X0 = X at phi = ...): "
                 f"{_names(without)}.")
    for name in ("D_trans", "D_rot"):
        rough = [r for r in rows if r.has(name) and r.errors[name] > TARGET_ERROR * r[name]]
        if rough:
            worst = max(r.errors[name] / r[name] for r in rough)
            text += f" {name} is known to {100 * worst:.1f} % or better at {_names(rough)}."
    if spheres:
        text += f" The {len(spheres)} points of spheres have no D_rot: nothing turns them."
    return text


DROPPED = """## Values that fell out

`points.csv` has values only where their definitions hold; the program prints no others (doc of `ed::Correlations`):

- D_trans: MSD q^2 / 6 >= {displaced:g} at the first lag of the fit, about 0.4 of the longest. Where displacements are Gaussian, F_self is then
  at or below 1/e.
- D_rot: <|Delta Phi|^2> >= {turned:.2g} rad^2 at the longest lag; where it is smaller at the first lag of the fit, a logarithmic slope of at
  most {steepest:g}.
- tau and beta: amplitude at most {amplitude:g}, beta at least {beta:g}, tau not below the first fitted lag. A larger amplitude means that C2 falls
  faster before the first fitted lag: tau and beta describe the rest of a decay. Where the correlation is still above {short:g} at the longest
  lag, tau of the lags without their first third is the same to {steady:.0%}: a nematic's C2 ends at a plateau that these fits do not have.

Programs that wrote rows before wanted a slope of 1 +- 0.2 and nothing of fits. `tools/paper/definitions.py` judges their rows by what is
stored: displacements by the coefficients, amplitudes by the curves (to {slack:g} %). One condition is the study's own, for the program
does not see crystals: D_trans of a state that froze during production is dropped where F_self is above 1/e at the first lag of the fit.

{state}
"""


def dropped_text(study, changes):
    state = (_dropped_table(study) + "\n\n" + _changes_text(changes) + "\n") if study.dropped else "No value has fallen out.\n"
    open_ones = [(row, doubt) for row, doubt in study.doubts if not doubt.certain]
    if open_ones:
        state += ("\nKept, because what is stored does not decide: "
                  + "; ".join(f"{', '.join(d.names)} of X0 = {row.X0:g} at {row.phi:g} ({d.reason})" for row, d in open_ones) + ".\n")
    return DROPPED.format(displaced=DISPLACED, turned=TURNED * COMPONENTS, steepest=STEEPEST_TURN, amplitude=MOST_AMPLITUDE, beta=LEAST_BETA, short=SHORT_DECAY, steady=STEADY_TAU,
                          slack=100 * AMPLITUDE_SLACK, state=state)


def _dropped_table(study):
    """All values that fell out, those of one reason in one row."""
    groups = {}
    for d in study.dropped:
        groups.setdefault((float(d["X0"]), float(d["phi"]), d["reason"]), []).append(d)
    lines = [f"| {X0:g} | {phi:g} | {', '.join(d['observable'] + ' ' + d['value'] for d in group)} | {reason} |"
             for (X0, phi, reason), group in sorted(groups.items())]
    points = {(d["X0"], d["phi"]) for d in study.dropped}
    text = f"{len(study.dropped)} values of {len(points)} points have fallen out. `dropped.csv` has them with errors and windows.\n\n"
    return text + "\n".join(["| X0 | phi | values | why |", "|---|---|---|---|", *lines])


def _changes_text(changes):
    if not changes:
        return "The claims below do not depend on them."
    outcomes = [f"{number} ({old.outcome} with them, now {new.outcome})" for number, old, new in changes if old.outcome != new.outcome]
    text = f"Outcomes that change: {'; '.join(outcomes)}." if outcomes else "No claim below has another outcome without them."
    kept = [str(number) for number, old, new in changes if old.outcome == new.outcome]
    if kept:
        text += f" The figures in the {'text' if len(kept) == 1 else 'texts'} of {_listed(kept)} change, since fewer values are compared."
    return text


def _listed(words):
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]


def readme(study, verdicts, changes):
    table = "\n".join(f"| {k}. {v.claim} | {v.outcome} |" for k, v in enumerate(verdicts, 1))
    details = "".join(f"{k}. **{v.claim}: {v.outcome}.** {v.text}\n\n" for k, v in enumerate(verdicts, 1))
    far_q = sum(abs(r.q / r["q_peak"] - 1) > 0.1 for r in study.rows if r.has("q_peak"))
    return TEXT.format(target=100 * TARGET_ERROR, far_q=far_q, state=state_text(study), table=table, details=details,
                       dropped=dropped_text(study, changes), most_amplitude=MOST_AMPLITUDE)


def write_readme(study, verdicts, changes, directory):
    write_whole(directory / "README.md", readme(study, verdicts, changes))
