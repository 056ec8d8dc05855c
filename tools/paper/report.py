"""README.md of the study: how far it is, the paper's claims one by one, the figures."""

from . import grid
from .results import TARGET_ERROR, write_whole
from .table import NEMATIC

TEXT = """# The paper's study, again

C. De Michele, R. Schilling and F. Sciortino, *Event-Driven Simulation of the Dynamics of Hard Ellipsoids*: 512 hard ellipsoids
of revolution, aspect ratios X0 = a/b from 1/5 to 5, packing fractions from 0.1 to the nematic (up to 0.5, and to 0.54 between
X0 = 0.4 and 2.5, where D_trans is slow enough), moments of inertia 2/5 m min(a, b)^2 without spin, kT = m = (a b^2)^(1/3) = 1.

    tools/reproduce-paper               # goes on where points.csv ends; --minutes M stops after so many, --jobs N
    tools/reproduce-paper --figures     # this page and all figures again, from points.csv and curves.csv
    tools/reproduce-paper --quick       # a coarse grid with short runs, in about ten minutes, in out/paper-quick

`points.csv` has one row a state point: seed, times, every observable with its standard error, the wave number q of F_self, the
windows of the fits, whether it was `equilibrated` (docs/configuration.md#auto), `precise` ({target:g} % or better in D_trans and D_rot)
and `sound`, collisions, seconds. `curves.csv` has C2(t) and F_self(t) at about ten lags a decade. Everything else here is made
from these two.

Runs equilibrate by themselves and then produce at least 30 times as long, until D_trans and D_rot are known to {target:g} %. At
packing fraction 0.1, and close to X0 = 1, where bodies fly or turn freely for long, productions have a fixed length with lags
up to 40 instead. Points that are expected to be nematic equilibrate for at most 60 time units
and produce for 400, and are flagged.

## How far it is

{state}

## Claims

Computed by `tools/paper/verdicts.py` from the two files, with the criteria that stand in the text.

| claim of the paper | |
|---|---|
{table}

{details}
## Figures

Isodiffusivity lines at the paper's levels, of equilibrated isotropic points; dots are the state points, open ones not equilibrated.

![Lines of constant D_trans and D_rot](isodiffusivity.svg)

When C2 has fallen to 1/e, with the lines of constant D_rot.

![Isochrones of C2](isochrones.svg)

Fits of A exp[-(t/tau)^beta] to C2, from five mean collision intervals on.

![tau_C2 and beta_C2 against X0](c2_fits.svg)

C2 and F_self (at the first peak of S(q)) of the densest isotropic points.

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
    text += (f" {len(nematic)} of them are nematic (S > {NEMATIC}), {len(flagged)} were not equilibrated by the criterion, {len([r for r in study.rows if r.isotropic and not r.precise])} isotropic ones are less precise than "
             f"{100 * TARGET_ERROR:g} % or have no D_rot (too close to X0 = 1).")
    if len(done) < len(planned):
        text += " **The study is not complete: the verdicts below are those of the points that are there.**"
    slow = [r for r in flagged if r["S"] <= NEMATIC]
    if slow:
        text += " Not equilibrated though S <= 0.3, and left out of lines and verdicts: " + ", ".join(f"{r.X0:g} at {r.phi:g}" for r in slow[:40]) + "."
    return text


def readme(study, verdicts):
    table = "\n".join(f"| {k}. {v.claim} | {v.outcome} |" for k, v in enumerate(verdicts, 1))
    details = "".join(f"{k}. **{v.claim}: {v.outcome}.** {v.text}\n\n" for k, v in enumerate(verdicts, 1))
    return TEXT.format(target=100 * TARGET_ERROR, state=state_text(study), table=table, details=details)


def write_readme(study, verdicts, directory):
    write_whole(directory / "README.md", readme(study, verdicts))
