"""points.csv, one row a state point, curves.csv, C2(t) and F_self(t) of each, and dropped.csv, values whose definition does not
hold: read, extended, written whole."""

import csv
import io
import json
import math
import os
import pathlib

from .definitions import judged
from .grid import Point

TARGET_ERROR = 0.03  # relative, of D_trans and D_rot

# Observables of summary.json; each with its error.
OBSERVABLES = ["D_trans", "D_rot", "D_rot_body", "S", "Z", "collision_rate", "tau_C2", "beta_C2", "t_C2_1overe",
               "tau_F", "beta_F", "t_F_1overe", "q_peak", "S_peak", "kT_trans", "kT_rot"]
POINT_COLUMNS = (["X0", "phi", "seed", "number", "equilibration_time", "production_time"]
                 + [column for name in OBSERVABLES for column in (name, name + "_error")]
                 + ["q", "C2_fit_from", "C2_fit_to", "F_fit_from", "F_fit_to", "equilibrated", "precise", "sound",
                    "collisions", "wall_seconds", "version"])
CURVE_COLUMNS = ["X0", "phi", "t", "C2", "C2_error", "F_self", "F_self_error"]
DROPPED_COLUMNS = ["X0", "phi", "observable", "value", "error", "fit_from", "fit_to", "reason"]

LAGS_A_DECADE = 10
SHORTEST_LAG = 0.02
DECAYED = 0.01  # of both; the curves go on for a few lags beyond


def short(value, digits=6):
    """A number in few characters; empty for null."""
    return "" if value is None or not math.isfinite(value) else f"{value:.{digits}g}"


def _is_precise(observables, point):
    """Whether D_trans and, but for spheres, D_rot are known to TARGET_ERROR."""
    names = ["D_trans"] if point.X0 == 1 else ["D_trans", "D_rot"]
    estimates = [observables[name] for name in names]
    return all(e["value"] is not None and e["error"] is not None and e["error"] <= TARGET_ERROR * e["value"] for e in estimates)


def point_row(summary, point):
    """A row of points.csv from a run's summary.json."""
    row = {"X0": f"{point.X0:g}", "phi": f"{point.phi:g}", "seed": str(summary["seed"]),
           "number": str(summary["state"]["number"]),
           "equilibration_time": short(summary["time"]["equilibration"]),
           "production_time": short(summary["time"]["production"])}
    for name in OBSERVABLES:
        estimate = summary["observables"][name]
        row[name] = short(estimate["value"])
        row[name + "_error"] = short(estimate["error"], 3)
    row["q"] = short(summary["wave_numbers"][0])
    for fit in ("C2", "F"):
        window = summary["fit_windows"][fit] or [None, None]
        row[fit + "_fit_from"], row[fit + "_fit_to"] = short(window[0], 4), short(window[1], 4)
    row["equilibrated"] = str(summary["equilibrated"]).lower()
    row["precise"] = str(_is_precise(summary["observables"], point)).lower()
    row["sound"] = str(summary["sound"]).lower()
    row["collisions"] = str(summary["counters"]["collisions"])
    row["wall_seconds"] = short(summary["performance"]["total_wall_seconds"], 4)
    row["version"] = summary["version"]
    return row


def _columns(path):
    """A file of observables/ by its columns, without their units."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    names = [head.split(" ")[0] for head in rows[0]]
    return [dict(zip(names, row)) for row in rows[1:]]


def curve_rows(directory, point):
    """The curves of a run at about LAGS_A_DECADE lags a decade, until both have decayed."""
    c2 = _columns(directory / "observables" / "c2.csv")
    f_self = _columns(directory / "observables" / "f_self.csv")
    rows, last, decayed = [], 0.0, 0
    for c, f in zip(c2, f_self, strict=True):
        t = float(c["t"])
        if t < SHORTEST_LAG or t < last * 10 ** (0.97 / LAGS_A_DECADE) or decayed > 2 or not c["c2"]:
            continue
        last = t
        values = [float(c["c2"]), float(c["c2_error"] or "nan"), float(f["f_self_q1"]), float(f["f_self_q1_error"] or "nan")]
        decayed += abs(values[0]) < DECAYED and abs(values[2]) < DECAYED
        rows.append({"X0": f"{point.X0:g}", "phi": f"{point.phi:g}", "t": short(t, 4), "C2": short(values[0], 4),
                     "C2_error": short(values[1], 2), "F_self": short(values[2], 4), "F_self_error": short(values[3], 2)})
    return rows


def point_of(row):
    return Point(float(row["X0"]), float(row["phi"]))


def read_rows(path):
    if not pathlib.Path(path).exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write_whole(path, text):
    """Under another name, then renamed: the file is never half there."""
    path = pathlib.Path(path)
    temporary = path.with_name(path.name + ".part")
    with open(temporary, "w", encoding="utf-8", newline="") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    temporary.rename(path)


def csv_text(columns, rows):
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


class Results:
    """The three files of a directory. A point that is in points.csv has its curves and dropped values: those are written first."""

    def __init__(self, directory):
        self.directory = pathlib.Path(directory)
        self.points = {point_of(row): row for row in read_rows(self.directory / "points.csv")}
        self.curves = self._of_points("curves.csv")
        self.dropped = self._of_points("dropped.csv")

    def _of_points(self, name):
        groups = {}
        for row in read_rows(self.directory / name):
            groups.setdefault(point_of(row), []).append(row)
        return groups

    def add(self, point, row, curve):
        self.curves[point] = curve
        self.points[point], self.dropped[point] = judged(row, curve)
        self.write()

    def judge(self):
        """Drops values of all rows whose definition does not hold; their number. Writes only what changes."""
        number = 0
        for point, row in self.points.items():
            self.points[point], dropped = judged(row, self.curves.get(point, []))
            self.dropped.setdefault(point, []).extend(dropped)
            number += len(dropped)
        if number or not (self.directory / "dropped.csv").exists():
            self.write()
        return number

    def write(self):
        self.directory.mkdir(parents=True, exist_ok=True)
        points = sorted(self.points)
        for name, columns, groups in (("curves.csv", CURVE_COLUMNS, self.curves), ("dropped.csv", DROPPED_COLUMNS, self.dropped)):
            write_whole(self.directory / name, csv_text(columns, [row for point in points for row in groups.get(point, [])]))
        write_whole(self.directory / "points.csv", csv_text(POINT_COLUMNS, [self.points[p] for p in points]))

    def take(self, directory, point):
        """The results of a finished run; its summary."""
        summary = json.loads((directory / "summary.json").read_text(encoding="utf-8"))
        self.add(point, point_row(summary, point), curve_rows(directory, point))
        return summary
