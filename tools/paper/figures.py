"""The paper's figures from points.csv and curves.csv: SVG, and the numbers that are drawn as CSV."""

import csv
import io
import math
import pathlib
import subprocess
import tempfile

from .plot import BOTTOM, COLOURS, LEFT, RIGHT, TOP, WIDTH, Axis, Panel, drawing
from .results import POINT_COLUMNS, csv_text, point_of, read_rows, write_whole
from .table import NEMATIC, free_rotor_c2, moment_of_inertia

D_TRANS_LEVELS = [0.5, 0.3, 0.2, 0.1, 0.04, 0.02]
D_ROT_LEVELS = [1.5, 0.75, 0.45, 0.3, 0.15, 0.075, 0.045]  # the paper has the last two on the prolate side alone
ISOCHRONES = [0.3, 0.4, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0]  # of t_C2_1overe
FIT_PHIS = [0.40, 0.45, 0.50]  # of the paper's figure of tau_C2 and beta_C2
# Near the isotropic-nematic line on both sides, and nearly round.
CORRELATORS = [0.3448, 1.1, 3.2]


def lines_by_map(program, rows, values):
    """hardbody map over ln X0 and phi: {(value, level): [[(X0, phi), ..], ..]}."""
    with tempfile.TemporaryDirectory() as directory:
        table = pathlib.Path(directory) / "points.csv"
        table.write_text(csv_text(POINT_COLUMNS, rows), encoding="utf-8")
        command = [program, "map", str(table), "--x", "X0", "--y", "phi", "--log-x", "--out", f"{directory}/map.svg",
                   "--csv", f"{directory}/map.csv"]
        for value, levels in values.items():
            command += ["--value", value, "--levels", ",".join(f"{level:g}" for level in levels)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        lines = {}
        for row in read_rows(f"{directory}/map.csv"):
            of_level = lines.setdefault((row["value"], float(row["level"])), {})
            of_level.setdefault(int(row["line"]), []).append((float(row["X0"]), float(row["phi"])))
        return {key: list(of_level.values()) for key, of_level in lines.items()}


class Lines:
    """All lines over the plane that figures and verdicts need."""

    def __init__(self, program, directory):
        rows = read_rows(directory / "points.csv")
        isotropic = [row for row in rows if float(row["S"]) <= NEMATIC and row["equilibrated"] == "true"]
        self.D_trans = self._one(program, isotropic, "D_trans", D_TRANS_LEVELS)
        self.D_rot = self._one(program, isotropic, "D_rot", D_ROT_LEVELS)
        self.C2 = self._one(program, isotropic, "t_C2_1overe", ISOCHRONES)
        self.nematic = self._one(program, rows, "S", [NEMATIC]).get(NEMATIC, [])

    @staticmethod
    def _one(program, rows, value, levels):
        known = [row for row in rows if row[value]]
        if len({point_of(row).X0 for row in known}) < 2:
            return {}
        return {level: lines for (_, level), lines in lines_by_map(program, known, {value: levels}).items()}


def lines_csv(groups):
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["value", "level", "line", "X0", "phi"])
    for value, of_level in groups:
        for level in sorted(of_level, reverse=True):
            for number, line in enumerate(of_level[level], 1):
                writer.writerows([value, f"{level:g}", number, f"{x:.5g}", f"{phi:.5g}"] for x, phi in line)
    return text.getvalue()


def plane(study):
    top = max([0.52, *(p for p in study.phis())]) + 0.02
    return Panel(Axis(0.18, 5.6, log=True), Axis(0.08, top), "X0 = a/b", "packing fraction")


def draw_levels(panel, of_level, colour, dashes=""):
    for level, lines in of_level.items():
        for line in lines:
            panel.line(line, colour, dashes=dashes)
            if len(line) > 3:
                # Where the line is closest to the ends of the axis, prolate or oblate.
                for x, phi in {max(line), min(line)}:
                    panel.label(x, phi, f"{level:g}", colour)


def isodiffusivity(study, lines):
    panel = plane(study)
    for row in study.rows:
        panel.marks([row.point], "#bbbbbb", radius=1.3, filled=row.equilibrated)
    draw_levels(panel, lines.D_trans, COLOURS[0])
    draw_levels(panel, lines.D_rot, COLOURS[1], "6 4")
    for line in lines.nematic:
        panel.line(line, "black", width=2.4, dashes="12 4")
    panel.legend([("D_trans", COLOURS[0], ""), ("D_rot (4t)", COLOURS[1], "6 4"), ("S = 0.3", "black", "12 4")], (0.40, 0.86))
    groups = [("D_trans", lines.D_trans), ("D_rot", lines.D_rot), ("S", {NEMATIC: lines.nematic})]
    return drawing(panel), lines_csv(groups)


def isochrones(study, lines):
    panel = plane(study)
    draw_levels(panel, lines.C2, COLOURS[2])
    for level, group in lines.D_rot.items():
        for line in group:
            panel.line(line, COLOURS[1], width=1.0, dashes="6 4")
    for line in lines.nematic:
        panel.line(line, "black", width=2.4, dashes="12 4")
    panel.legend([("C2(t) = 1/e at t", COLOURS[2], ""), ("D_rot as in the other figure", COLOURS[1], "6 4"),
                  ("S = 0.3", "black", "12 4")], (0.36, 0.86))
    return drawing(panel), lines_csv([("t_C2_1overe", lines.C2)])


def c2_fits(study):
    """tau_C2 and beta_C2 against X0."""
    upper = Panel(Axis(0.18, 5.6, log=True), Axis(0.15, 10, log=True), "", "tau_C2", (LEFT, TOP, WIDTH - RIGHT, 300))
    lower = Panel(Axis(0.18, 5.6, log=True), Axis(0.6, 1.5), "X0 = a/b", "beta_C2", (LEFT, 330, WIDTH - RIGHT, 640 - BOTTOM))
    lower.line([(0.18, 1), (5.6, 1)], "#999999", width=1, dashes="3 3")
    rows = []
    for phi, colour in zip(FIT_PHIS, COLOURS):
        points = study.along_X0(phi, "tau_C2", "beta_C2")
        for panel, name in ((upper, "tau_C2"), (lower, "beta_C2")):
            panel.line([(r.X0, r[name]) for r in points], colour, width=1)
            panel.bars([(r.X0, r[name], r.errors[name]) for r in points if math.isfinite(r.errors[name])], colour)
            panel.marks([(r.X0, r[name]) for r in points], colour)
        rows += [{"phi": f"{phi:g}", "X0": f"{r.X0:g}", "tau_C2": f"{r['tau_C2']:.5g}", "tau_C2_error": f"{r.errors['tau_C2']:.3g}",
                  "beta_C2": f"{r['beta_C2']:.5g}", "beta_C2_error": f"{r.errors['beta_C2']:.3g}"} for r in points]
    upper.legend([(f"packing fraction {phi:.2f}", colour, "") for phi, colour in zip(FIT_PHIS, COLOURS)], (0.36, 0.07))
    return drawing(upper, lower, height=640), csv_text(["phi", "X0", "tau_C2", "tau_C2_error", "beta_C2", "beta_C2_error"], rows)


def densest_isotropic(study, X0, phi_most=0.5):
    """The last isotropic point of a column that has curves."""
    rows = [r for r in study.isotropic if r.X0 == X0 and r.phi <= phi_most + 1e-9 and study.curves.get(r.point)]
    return max(rows, key=lambda r: r.phi, default=None)


def correlators(study):
    """C2 and F_self of the densest isotropic points, with their stretched exponentials and the free rotor."""
    panel = Panel(Axis(0.02, 100, log=True), Axis(0, 1.0), "t", "C2 (lines), F_self (dashed)")
    rows, legend = [], []
    for X0, colour in zip(CORRELATORS, COLOURS):
        row = densest_isotropic(study, X0)
        if row is None:
            continue
        curve = study.curves[row.point]
        panel.line([(c["t"], c["C2"]) for c in curve], colour)
        panel.line([(c["t"], c["F_self"]) for c in curve], colour, dashes="6 4")
        legend.append((f"X0 = {X0:g}, {row.phi:g}", colour, ""))
        rows += [{"X0": f"{X0:g}", "phi": f"{row.phi:g}", "t": f"{c['t']:.4g}", "C2": f"{c['C2']:.4g}", "F_self": f"{c['F_self']:.4g}"}
                 for c in curve]
    times = [0.02 * 10 ** (k / 20) for k in range(75)]
    moment = moment_of_inertia(1)
    panel.line([(t, free_rotor_c2(t, moment)) for t in times], "#888888", width=1, dashes="2 3")
    legend.append(("C2 of a free rotor, X0 = 1", "#888888", "2 3"))
    panel.legend(legend, (0.55, 0.06))
    return drawing(panel), csv_text(["X0", "phi", "t", "C2", "F_self"], rows)


FIGURES = {"isodiffusivity": isodiffusivity, "isochrones": isochrones}
CURVE_FIGURES = {"c2_fits": c2_fits, "correlators": correlators}


def write_figures(study, lines, directory):
    for name, draw in FIGURES.items():
        svg, numbers = draw(study, lines)
        write_whole(directory / f"{name}.svg", svg)
        write_whole(directory / f"{name}.csv", numbers)
    for name, draw in CURVE_FIGURES.items():
        svg, numbers = draw(study)
        write_whole(directory / f"{name}.svg", svg)
        write_whole(directory / f"{name}.csv", numbers)
