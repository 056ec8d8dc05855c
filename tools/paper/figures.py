"""The paper's figures from points.csv and curves.csv: SVG, and the numbers that are drawn as CSV."""

import csv
import io
import math
import pathlib
import subprocess
import tempfile

from .plot import BOTTOM, COLOURS, HEIGHT, LEFT, RIGHT, TOP, WIDTH, Axis, Panel, drawing
from .results import POINT_COLUMNS, csv_text, point_of, read_rows, short, write_whole
from .table import NEMATIC, Row, free_rotor_c2, moment_of_inertia

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
        result = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if result.returncode == 2 and "no line can be drawn" in result.stderr:
            return {}  # too few points as yet
        if result.returncode:
            raise RuntimeError(f"{command}: {result.stderr}")
        lines = {}
        for row in read_rows(f"{directory}/map.csv"):
            of_level = lines.setdefault((row["value"], float(row["level"])), {})
            of_level.setdefault(int(row["line"]), []).append((float(row["X0"]), float(row["phi"])))
        return {key: list(of_level.values()) for key, of_level in lines.items()}


class Lines:
    """All lines over the plane that figures and verdicts need."""

    def __init__(self, program, directory):
        rows = read_rows(directory / "points.csv")
        isotropic = [row for row in rows if Row(row).isotropic]
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
    return Panel(Axis(0.18, 5.6, log=True), Axis(0.08, top), "X0 = a/b", "packing fraction",
                 (LEFT, TOP + 20, WIDTH - RIGHT, HEIGHT - BOTTOM))


LABELLED = 60  # pixels: shorter lines have a label only if they are the longest of their level
STEP = 3  # pixels between places that are tried for a label


def draw_levels(panel, groups, beside=()):
    """Groups of lines of constant value: ({level: lines}, colour, dashes). Each line has its level at the end that is further out, and
    at the other one if there is room; labels keep off the lines `beside`."""
    kept_off = [p for line in beside for p in panel.on_drawing(line, STEP)]
    drawn = []  # (level, colour, points in pixels, whether it is its level's longest)
    for of_level, colour, dashes in groups:
        for level, lines in of_level.items():
            for line in lines:
                panel.line(line, colour, dashes=dashes)
                outwards = sorted((line, line[::-1]), key=lambda points: -abs(math.log(points[0][0])))
                drawn.append((level, colour, panel.on_drawing(outwards[0], STEP), line is max(lines, key=len)))
    for end in ("outer", "inner"):
        for k, (level, colour, points, longest) in enumerate(drawn):
            if len(points) * STEP < LABELLED and not (longest and end == "outer"):
                continue
            others = kept_off + [p for j, other in enumerate(drawn) if j != k for p in other[2]]
            places = (points if end == "outer" else points[::-1])[2:max(3, len(points) // 2)]
            # In the end over other lines: no line is without its level.
            for avoided in (others, kept_off, []) if end == "outer" else (others,):
                if panel.label(places, f"{level:g}", colour, avoided):
                    break


def draw_nematic(panel, lines):
    for line in lines.nematic:
        panel.line(line, "black", width=2.4, dashes="12 4")


def isodiffusivity(study, lines):
    panel = plane(study)
    for row in study.rows:
        panel.marks([row.point], "#bbbbbb", radius=1.3, filled=row.equilibrated and not row.frozen)
    draw_nematic(panel, lines)
    draw_levels(panel, [(lines.D_trans, COLOURS[0], ""), (lines.D_rot, COLOURS[1], "6 4")], lines.nematic)
    panel.legend_above([("D_trans", COLOURS[0], ""), ("D_rot (4t)", COLOURS[1], "6 4"), ("S = 0.3", "black", "12 4")])
    groups = [("D_trans", lines.D_trans), ("D_rot", lines.D_rot), ("S", {NEMATIC: lines.nematic})]
    return drawing(panel), lines_csv(groups)


def isochrones(study, lines):
    panel = plane(study)
    for level, group in lines.D_rot.items():
        for line in group:
            panel.line(line, COLOURS[1], width=1.0, dashes="6 4")
    draw_nematic(panel, lines)
    draw_levels(panel, [(lines.C2, COLOURS[2], "")], lines.nematic)
    panel.legend_above([("C2(t) = 1/e at t", COLOURS[2], ""), ("D_rot, as in the other figure", COLOURS[1], "6 4"),
                        ("S = 0.3", "black", "12 4")], 230)
    return drawing(panel), lines_csv([("t_C2_1overe", lines.C2)])


FIT_COLUMNS = ["phi", "X0", "tau_C2", "tau_C2_error", "beta_C2", "beta_C2_error", "t_C2_1overe", "overall_beta_C2"]


def _runs(rows, names):
    """Neighbours that have them all, apart from those that have not."""
    runs = [[]]
    for row in rows:
        if row.has(*names):
            runs[-1].append(row)
        elif runs[-1]:
            runs.append([])
    return [run for run in runs if run]


def c2_fits(study):
    """tau_C2 and beta_C2 against X0. Where C2 falls too early for a fit: when it is 1/e, and its overall exponent."""
    upper = Panel(Axis(0.18, 5.6, log=True), Axis(0.15, 10, log=True), "", "tau_C2", (LEFT, TOP, WIDTH - RIGHT, 300))
    lower = Panel(Axis(0.18, 5.6, log=True), Axis(0.6, 2.7), "X0 = a/b", "beta_C2", (LEFT, 330, WIDTH - RIGHT, 640 - BOTTOM))
    lower.line([(0.18, 1), (5.6, 1)], "#999999", width=1, dashes="3 3")
    rows = []
    for phi, colour in zip(FIT_PHIS, COLOURS):
        points = study.along_X0(phi, "t_C2_1overe")
        fitted = [r for r in points if r.has("tau_C2", "beta_C2")]
        early = [r for r in points if r not in fitted and r not in study.undecayed]
        exponents = {r: study.overall_exponent(r) for r in points}
        for panel, name in ((upper, "tau_C2"), (lower, "beta_C2")):
            for run in _runs(points, ("tau_C2", "beta_C2")):
                panel.line([(r.X0, r[name]) for r in run], colour, width=1)
            panel.bars([(r.X0, r[name], r.errors[name]) for r in fitted if math.isfinite(r.errors[name])], colour)
            panel.marks([(r.X0, r[name]) for r in fitted], colour)
        upper.marks([(r.X0, r["t_C2_1overe"]) for r in early], colour, filled=False)
        lower.marks([(r.X0, exponents[r]) for r in early if math.isfinite(exponents[r])], colour, filled=False)
        for r in points:
            row = {"phi": f"{phi:g}", "X0": f"{r.X0:g}", "t_C2_1overe": short(r["t_C2_1overe"], 5), "overall_beta_C2": short(exponents[r], 4)}
            if r in fitted:
                row |= {name: short(r[name], 5) for name in ("tau_C2", "beta_C2")}
                row |= {name + "_error": short(r.errors[name], 3) for name in ("tau_C2", "beta_C2")}
            rows.append(row)
    upper.legend([(f"packing fraction {phi:.2f}", colour, "") for phi, colour in zip(FIT_PHIS, COLOURS)]
                 + [("no fit: C2(t) = 1/e at t", "#555555", "open")], (0.34, 0.07))
    lower.legend([("no fit: slope of ln(-ln C2) against ln t", "#555555", "open")], (0.31, 0.07))
    return drawing(upper, lower, height=640), csv_text(FIT_COLUMNS, rows)


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


def write_figures(study, lines, directory, pages):
    """Writes the drawings to `pages` and the numbers drawn to `directory`."""
    figures = {name: draw(study, lines) for name, draw in FIGURES.items()} | {name: draw(study) for name, draw in CURVE_FIGURES.items()}
    for name, (svg, numbers) in figures.items():
        write_whole(pages / f"{name}.svg", svg)
        write_whole(directory / f"{name}.csv", numbers)
