"""Draws docs/images/demo.svg from a run directory: python3 docs/images/demo_plot.py out/demo docs/images/demo.svg

Needs python3-matplotlib.
"""

import csv
import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of the backend)


def columns(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return [[float(row[k]) for row in rows[1:]] for k in range(3)]


def main(run, target):
    run = pathlib.Path(run)
    summary = json.loads((run / "summary.json").read_text())
    value = {name: entry["value"] for name, entry in summary["observables"].items()}
    plt.rcParams.update({"font.size": 9, "svg.hashsalt": "hardbody", "axes.spines.top": False, "axes.spines.right": False})
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2), constrained_layout=True)

    t, msd, _ = columns(run / "observables" / "msd.csv")
    t_rot, rot, _ = columns(run / "observables" / "rotational_msd.csv")
    left.loglog(t, msd, "o", ms=3, color="#1f5fa8", label=r"$\langle|\Delta\mathbf{r}|^2\rangle$")
    left.loglog(t_rot, rot, "s", ms=3, color="#c2571a", label=r"$\langle|\Delta\Phi|^2\rangle$")
    late = [x for x in t if x > 1]
    left.loglog(late, [6 * value["D_trans"] * x for x in late], "-", lw=1, color="#1f5fa8", label=r"$6 D_{trans} t$")
    left.loglog(late, [4 * value["D_rot"] * x for x in late], "-", lw=1, color="#c2571a", label=r"$4 D_{rot} t$")
    left.set_xlabel(r"$t\;[\,l\sqrt{m/kT}\,]$")
    left.set_ylabel("mean square displacement")
    left.legend(frameon=False)

    t, c2, error = columns(run / "observables" / "c2.csv")
    right.errorbar(t, c2, error, fmt="o", ms=3, lw=1, color="#2b7a4b")
    right.set_xscale("log")
    right.axhline(0, lw=0.5, color="0.6")
    right.axhline(0.36788, lw=0.8, ls=":", color="0.4")
    right.annotate("1/e", (t[0], 0.385), color="0.3")
    right.set_xlabel(r"$t\;[\,l\sqrt{m/kT}\,]$")
    right.set_ylabel(r"$C_2(t)$")

    state = summary["state"]
    figure.suptitle(f"{state['number']} hard ellipsoids, $X_0$ = {state['aspect_ratio']:g}, "
                    f"$\\phi$ = {state['packing_fraction']:g}", fontsize=10)
    figure.savefig(target, metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:])
