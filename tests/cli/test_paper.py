"""The paper's study: the committed results, what is made of them, and the tool that runs it.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_paper.py [TestClass[.test]]
"""

import csv
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import xml.dom.minidom

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
HARDBODY = os.path.abspath(os.environ.get("HARDBODY", "build/release/apps/hardbody/hardbody"))
DATA = ROOT / "data" / "paper"
PAGES = ROOT / "docs" / "paper"
FIGURES = ["isodiffusivity", "isochrones", "c2_fits", "correlators"]

sys.path.insert(0, str(ROOT / "tools"))


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def committed(name):
    """Text of a committed file as it reads in a directory that holds data, page and drawings."""
    if name.endswith(".csv"):
        return (DATA / name).read_text(encoding="utf-8")
    return (PAGES / name).read_text(encoding="utf-8").replace("](../../data/paper/", "](")


def tool(*arguments, **options):
    return subprocess.run([sys.executable, ROOT / "tools" / "reproduce_paper.py", "--hardbody", HARDBODY, *map(str, arguments)],
                          capture_output=True, text=True, timeout=300, **options)


class Here(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.addCleanup(self.directory.cleanup)
        self.here = pathlib.Path(self.directory.name)


class Results(Here):
    def test_points(self):
        rows = read(DATA / "points.csv")
        points = [(float(row["X0"]), float(row["phi"])) for row in rows]
        self.assertGreaterEqual(len(rows), 500)
        self.assertEqual(points, sorted(set(points)), "distinct, and in order")
        for row, (X0, phi) in zip(rows, points):
            with self.subTest(X0=X0, phi=phi):
                self.assertTrue(0.2 <= X0 <= 5 and 0.1 <= phi <= 0.55)
                self.assertEqual(row["number"], "512")
                self.assertEqual(row["sound"], "true")
                self.assertGreater(float(row["production_time"]), 0)
                for name in ["Z", "collision_rate", "S", "q"]:
                    self.assertGreater(float(row[name]), 0)
                if row["precise"] == "true":
                    for name in ["D_trans", "D_rot"] if X0 != 1 else ["D_trans"]:
                        self.assertLessEqual(float(row[f"{name}_error"]), 0.03 * float(row[name]) * (1 + 1e-5))

    def test_isotropic_points_are_equilibrated_and_precise(self):
        isotropic = [row for row in read(DATA / "points.csv") if float(row["S"]) <= 0.3]
        equilibrated = [row for row in isotropic if row["equilibrated"] == "true"]
        self.assertGreaterEqual(len(equilibrated), 0.95 * len(isotropic))
        for row in equilibrated:
            X0 = float(row["X0"])
            with self.subTest(X0=X0, phi=row["phi"]):
                if row["S_peak"] and float(row["S_peak"]) > 4:  # froze; without a clear peak it did not
                    self.assertEqual((X0, row["phi"], row["precise"]), (1, "0.54", "false"))
                    continue
                self.assertLessEqual(float(row["D_trans_error"]), 0.03 * float(row["D_trans"]) * (1 + 1e-5))
                if row["D_rot"]:
                    self.assertLessEqual(float(row["D_rot_error"]), 0.03 * float(row["D_rot"]) * (1 + 1e-5))
                else:
                    # Rotation is ballistic: spheres, and bodies that are nearly so.
                    self.assertTrue((0.7 < X0 < 1.5 and row["phi"] == "0.1") or (0.75 < X0 < 1.3 and float(row["phi"]) <= 0.2)
                                    or 0.85 < X0 < 1.15)

    def test_every_point_has_its_curves(self):
        curves = read(DATA / "curves.csv")
        with_curves = {(row["X0"], row["phi"]) for row in curves}
        self.assertEqual(with_curves, {(row["X0"], row["phi"]) for row in read(DATA / "points.csv")})
        for row in curves:
            self.assertLess(abs(float(row["C2"])), 1.01)
            self.assertLess(abs(float(row["F_self"])), 1.01)

    def test_figures_and_verdicts_are_those_of_the_results(self):
        for name in ["points.csv", "curves.csv", "dropped.csv"]:
            shutil.copy(DATA / name, self.here)
        result = tool("--figures", "--results", self.here)
        self.assertEqual(result.returncode, 0, result.stderr)
        names = sorted(path.name for path in self.here.iterdir())
        self.assertEqual(names, sorted(path.name for folder in (DATA, PAGES) for path in folder.iterdir()))
        for name in names:
            self.assertEqual((self.here / name).read_text(), committed(name),
                             f"{name}: tools/reproduce-paper --figures makes another one")
        for name in FIGURES:
            xml.dom.minidom.parse(str(PAGES / f"{name}.svg"))
        text = (PAGES / "README.md").read_text()
        for number in range(1, 17):
            self.assertIn(f"\n{number}. **", text)


class Definitions(Here):
    """What stands in points.csv is what it is called."""

    WINDOWS = {"tau_C2": "C2", "tau_F": "F"}

    def test_thresholds_are_those_of_the_program(self):
        from paper import definitions

        text = (ROOT / "libed" / "src" / "observables" / "curves.h").read_text()
        for name, here in [("FitFrom", definitions.FIT_FROM), ("Linearity", definitions.LINEARITY), ("Displaced", definitions.DISPLACED),
                           ("Turned", definitions.TURNED), ("MostAmplitude", definitions.MOST_AMPLITUDE),
                           ("LeastBeta", definitions.LEAST_BETA), ("ShortDecay", definitions.SHORT_DECAY),
                           ("SteadyTau", definitions.STEADY_TAU), ("FreeTurning", definitions.STEEPEST_TURN - 1)]:
            with self.subTest(name):
                numerator, _, denominator = re.search(rf"k{name} = ([^;]+);", text)[1].partition("/")
                self.assertAlmostEqual(float(numerator) / float(denominator or 1), here, delta=1e-12)

    @staticmethod
    def row(**values):
        """A fluid whose longest lag is 15 and that has only these values."""
        from paper.results import POINT_COLUMNS

        row = dict.fromkeys(POINT_COLUMNS, "") | {"X0": "2", "phi": "0.4", "equilibration_time": "8", "production_time": "240",
                                                  "q": "3", "S_peak": "2", "precise": "true"}
        return row | {key: str(value) for key, value in values.items()}

    @staticmethod
    def curve(amplitude=1.0, tau=1.0, beta=1.0):
        lags = [0.02 * 10 ** (k / 10) for k in range(29)]
        decay = [amplitude * math.exp(-((t / tau) ** beta)) for t in lags]
        return [{"t": f"{t:.4g}", "C2": f"{y:.4g}", "F_self": f"{y:.4g}"} for t, y in zip(lags, decay)]

    def dropped(self, row, curve):
        """Names of the values that fall out; what else the row has stays."""
        from paper.definitions import judged

        kept, dropped = judged(row, curve)
        names = [d["observable"] for d in dropped]
        for d in dropped:
            self.assertEqual(d["value"], row[d["observable"]])
            self.assertEqual((kept[d["observable"]], kept[d["observable"] + "_error"]), ("", ""))
        gone = {*names, *(name + "_error" for name in names)}
        gone |= {f"{self.WINDOWS[name]}_fit_{end}" for name in names if name in self.WINDOWS for end in ("from", "to")}
        gone |= {"precise"} if {"D_trans", "D_rot"} & set(names) else set()
        self.assertEqual({key for key in row if kept[key] != row[key]} - gone, set())
        self.assertEqual(judged(kept, curve), (kept, []))
        return names

    def test_translation(self):
        # MSD q^2 / 6 is D q^2 t: at 3^2 and t = 6.7, 1 for D = 0.0166; from 0.76 to 1.32 of it in a window of slope 1 +- 0.2.
        for D, names in [(0.02, []), (0.014, []), (0.0120, ["D_trans"]), (0.001, ["D_trans"])]:
            with self.subTest(D):
                self.assertEqual(self.dropped(self.row(D_trans=D, D_trans_error=1e-4), self.curve(tau=6)), names)
        frozen = self.row(D_trans=0.1, S_peak=12)
        self.assertEqual(self.dropped(frozen, self.curve(tau=40)), ["D_trans"])
        self.assertEqual(self.dropped(frozen, self.curve(tau=2)), [])

    def test_peaks(self):
        # Above 1 by more than five standard errors.
        for S, error, names in [(1.1, 0.019, []), (1.1, 0.021, ["S_peak", "q_peak"])]:
            row = self.row(q_peak=3, q_peak_error=0.2, S_peak=S, S_peak_error=error)
            self.assertEqual(sorted(self.dropped(row, self.curve())), names)

    def test_rotation(self):
        # <|Delta Phi|^2> = 4 D t: 2/3 rad^2 at lag 15 for D = 0.0111.
        for D, names in [(0.02, []), (0.011, []), (0.009, ["D_rot"])]:
            with self.subTest(D):
                self.assertEqual(self.dropped(self.row(D_rot=D, D_rot_error=1e-4), self.curve()), names)
        self.assertEqual(self.dropped(self.row(D_rot_body=0.009), self.curve()), ["D_rot_body"])

    def test_fits(self):
        def fit(curve, name="C2", **values):
            row = self.row(**{f"{key}_{name}": value for key, value in ({"tau": 1, "beta": 0.8} | values).items()})
            return self.dropped(row | {f"{name}_fit_from": "0.2", f"{name}_fit_to": "4"}, curve)

        for name in ("C2", "F"):
            gone = [f"tau_{name}", f"beta_{name}"]
            for amplitude, names in [(1, []), (1.29, []), (1.32, gone), (6, gone)]:
                with self.subTest(fit=name, amplitude=amplitude):
                    self.assertEqual(fit(self.curve(amplitude, 1, 0.8), name), names)
            self.assertEqual(fit(self.curve(1, 1, 0.31), name, beta=0.31), [])
            self.assertEqual(fit(self.curve(1, 1, 0.29), name, beta=0.29), gone)
            self.assertEqual(fit(self.curve(1, 0.19, 0.8), name, tau=0.19), gone)

    def test_fits_of_plateaus(self):
        """A correlation that ends above 1/4: one decay, and one with a plateau."""
        lags = [0.02 * 10 ** (k / 10) for k in range(27)]
        for plateau, names in [(0, []), (0.3, ["tau_C2", "beta_C2"])]:
            with self.subTest(plateau):
                decay = [(1 - plateau) * math.exp(-((t / (2 if plateau else 7)) ** 0.7)) + plateau for t in lags]
                curve = [{"t": f"{t:.4g}", "C2": f"{y:.4g}", "F_self": ""} for t, y in zip(lags, decay)]
                row = self.row(tau_C2=4.75 if plateau else 7, beta_C2=0.42 if plateau else 0.7)
                self.assertEqual(self.dropped(row | {"C2_fit_from": "0.1262", "C2_fit_to": curve[-1]["t"]}, curve), names)

    def test_longest_lag(self):
        """Those of runs; curves that have not decayed end at it."""
        from paper.definitions import longest_lag

        self.assertEqual(longest_lag(self.row(), self.curve()), 15)
        self.assertEqual(longest_lag(self.row(production_time=60), []), 3.75)
        self.assertEqual(longest_lag(self.row(X0="3.5", phi="0.49", production_time=400, equilibration_time=60), []), 25)
        self.assertEqual(longest_lag(self.row(X0="4", phi="0.435", production_time=2400, equilibration_time=106), []), 40)
        self.assertEqual(longest_lag(self.row(X0="0.3125", phi="0.48", production_time=2120, equilibration_time=106), []), 106)

    def test_committed_values_hold(self):
        from paper.definitions import judged

        curves = {}
        for row in read(DATA / "curves.csv"):
            curves.setdefault((row["X0"], row["phi"]), []).append(row)
        for row in read(DATA / "points.csv"):
            self.assertEqual(judged(row, curves[row["X0"], row["phi"]]), (row, []))

    def test_what_fell_out_is_listed(self):
        dropped = read(DATA / "dropped.csv")
        self.assertGreater(len(dropped), 30)
        points = {(row["X0"], row["phi"]): row for row in read(DATA / "points.csv")}
        text = (PAGES / "README.md").read_text()
        for d in dropped:
            with self.subTest(X0=d["X0"], phi=d["phi"], observable=d["observable"]):
                self.assertEqual(points[d["X0"], d["phi"]][d["observable"]], "")
                lines = [line for line in text.splitlines() if line.startswith(f"| {d['X0']} | {d['phi']} |")]
                self.assertTrue(any(f"{d['observable']} {d['value']}" in line and d["reason"] in line for line in lines))

    def test_stored_rows_are_judged_again(self):
        """--figures on rows as older programs wrote them: the same files."""
        from paper.results import POINT_COLUMNS, csv_text

        points = {(row["X0"], row["phi"]): row for row in read(DATA / "points.csv")}
        for d in read(DATA / "dropped.csv"):
            row = points[d["X0"], d["phi"]]
            row |= {d["observable"]: d["value"], d["observable"] + "_error": d["error"]}
            if window := self.WINDOWS.get(d["observable"]):
                row |= {f"{window}_fit_from": d["fit_from"], f"{window}_fit_to": d["fit_to"]}
        (self.here / "points.csv").write_text(csv_text(POINT_COLUMNS, points.values()))
        shutil.copy(DATA / "curves.csv", self.here)
        result = tool("--figures", "--results", self.here)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("the definitions of 77 values do not hold", result.stdout)
        for name in ["points.csv", "dropped.csv", "README.md"]:
            self.assertEqual((self.here / name).read_text(), committed(name), name)


class Verdicts(Here):
    def study(self, points):
        """A study of some of the committed points."""
        for name in ["points.csv", "curves.csv"]:
            rows = [row for row in read(DATA / name) if (row["X0"], row["phi"]) in points]
            with open(self.here / name, "w", newline="") as file:
                writer = csv.DictWriter(file, rows[0])
                writer.writeheader()
                writer.writerows(rows)
        from paper import figures, table, verdicts

        study = table.Study(self.here)
        return verdicts.verdicts(study, figures.Lines(HARDBODY, self.here))

    def test_one_point_decides_nothing(self):
        for point in [("2", "0.3"), ("1.1", "0.5"), ("0.3448", "0.5"), ("5", "0.4")]:
            for verdict in self.study({point}):
                with self.subTest(point=point, claim=verdict.claim):
                    self.assertTrue(verdict.outcome.startswith("open"), verdict.outcome)

    def test_overall_exponents(self):
        from paper.table import Row, Study

        for name in ["points.csv", "curves.csv"]:
            shutil.copy(DATA / name, self.here)
        study = Study(self.here)
        row = Row(read(DATA / "points.csv")[0])
        times = [0.02 * 1.25 ** k for k in range(40)]
        for beta in [0.7, 1, 2]:
            study.curves[row.point] = [{"t": t, "C2": 2.718281828 ** -((t / 0.3) ** beta)} for t in times]
            self.assertAlmostEqual(study.overall_exponent(row), beta, delta=1e-6)

    def test_frozen_points_do_not_count(self):
        from paper.table import Study

        for name in ["points.csv", "curves.csv"]:
            shutil.copy(DATA / name, self.here)
        study = Study(self.here)
        self.assertEqual([r.point for r in study.rows if r.frozen], [(1.0, 0.54)])
        self.assertNotIn((1.0, 0.54), [r.point for r in study.isotropic])
        self.assertIn("froze during production", (PAGES / "README.md").read_text())


class Drawings(unittest.TestCase):
    def test_labels_do_not_overlap(self):
        """By rectangles a little smaller than the texts are."""
        for name in ["isodiffusivity", "isochrones"]:
            tree = xml.dom.minidom.parse(str(PAGES / f"{name}.svg"))
            labels = [(float(t.getAttribute("x")), float(t.getAttribute("y")), len(t.firstChild.data))
                      for t in tree.getElementsByTagName("text") if t.getAttribute("font-size") == "11"]
            self.assertGreater(len(labels), 15)
            for k, (x, y, n) in enumerate(labels):
                for u, v, m in labels[k + 1:]:
                    self.assertTrue(abs(x - u) > 2.9 * (n + m) or abs(y - v) > 10, f"{name}: {x}, {y} and {u}, {v}")

    def test_every_level_has_its_label(self):
        for name in ["isodiffusivity", "isochrones"]:
            tree = xml.dom.minidom.parse(str(PAGES / f"{name}.svg"))
            labels = {t.firstChild.data for t in tree.getElementsByTagName("text") if t.getAttribute("font-size") == "11"}
            self.assertEqual(labels, {row["level"] for row in read(DATA / f"{name}.csv") if row["value"] != "S"})

    def test_no_line_crosses_the_gap_of_fits(self):
        """Between the last fit of discs and the first of rods."""
        tree = xml.dom.minidom.parse(str(PAGES / "c2_fits.svg"))
        for path in tree.getElementsByTagName("path"):
            points = [float(p.split()[0]) for p in path.getAttribute("d").replace("L", "M").split("M")[1:] if "h" not in p and "V" not in p]
            if path.getAttribute("stroke") == "#999999" or len(points) < 2:
                continue  # beta = 1
            self.assertLess(max(b - a for a, b in zip(points, points[1:])), 60)


class Tool(Here):
    POINTS = ["2,0.05", "0.5,0.05", "3,0.06"]

    def arguments(self):
        return ["--quick", "--out", self.here / "out", "--results", self.here / "results", "--points", *self.POINTS]

    @classmethod
    def setUpClass(cls):
        """The study in one go, which tests copy and compare with."""
        directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(directory.cleanup)
        cls.whole = pathlib.Path(directory.name)
        cls.result = tool("--quick", "--out", cls.whole / "out", "--results", cls.whole / "results", "--points", *cls.POINTS,
                          "--jobs", 2)

    def reference(self):
        self.assertEqual(self.result.returncode, 0, self.result.stderr)
        return self.rows(self.whole / "results" / "points.csv")

    def rows(self, name):
        return [{k: v for k, v in row.items() if k != "wall_seconds"} for row in read(name)]

    def test_points_are_merged_and_not_run_again(self):
        self.reference()
        for name in os.listdir(self.whole):
            shutil.copytree(self.whole / name, self.here / name)
        rows = read(self.here / "results" / "points.csv")
        self.assertEqual([(row["X0"], row["phi"]) for row in rows], [("0.5", "0.05"), ("2", "0.05"), ("3", "0.06")])
        self.assertEqual({row["production_time"] for row in rows}, {"60"})
        before = (self.here / "results" / "points.csv").read_bytes()
        again = tool(*self.arguments())
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn("0 of 3 points to run", again.stdout)
        self.assertEqual((self.here / "results" / "points.csv").read_bytes(), before)

    def test_refused(self):
        for arguments, part in [(["--points", "x"], "'x' is no point; accepted: X0,PHI"), (["--points", "2"], "'2' is no point"),
                                (["--points", "2,0.3", "2,nan"], "'2,nan' is no point"), (["--points", "0,0.3"], "both above 0"),
                                (["--jobs", "0"], "'0' is no number of processes"), (["--minutes", "-1"], "accepted: a number from 0"),
                                (["--figures", "--results", self.here / "none"], "has no points.csv")]:
            with self.subTest(arguments):
                result = tool(*arguments)
                self.assertEqual(result.returncode, 2)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                self.assertIn(part, result.stderr)

    def test_what_it_will_cost(self):
        result = tool("--out", self.here / "out", "--results", self.here / "new", "--minutes", "0.0001")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("607 of 607 points to run, 1 at a time", result.stdout)
        self.assertRegex(result.stdout, r"they cost about [78]\.\d h of one core, here about [78]\.\d h")
        self.assertRegex(self.result.stdout, r"X0_2_phi_0.05: D_trans .* s")
        left = re.findall(r"X0_\S+: D_trans .* s; (\d+) points left, ETA \d+ s", self.result.stdout)
        self.assertEqual(left, ["2", "1"])

    def test_help_says_how_to_begin_afresh(self):
        help_text = " ".join(tool("--help").stdout.split())
        self.assertIn("to begin afresh name another directory", help_text)
        self.assertIn("--results out/my-paper", help_text)

    def test_slices(self):
        """Stopped after two seconds, again and again: in the end the same results as in one go."""
        for _ in range(100):
            result = tool(*self.arguments(), "--minutes", 0.04)
            self.assertEqual(result.returncode, 0, result.stderr)
            if "0 of 3 points are left" in result.stdout:
                break
            self.assertIn("the same command continues", result.stdout)
        self.assertEqual(self.rows(self.here / "results" / "points.csv"), self.reference())

    def test_one_at_a_time_and_signals(self):
        command = [sys.executable, ROOT / "tools" / "reproduce_paper.py", "--hardbody", HARDBODY, *self.arguments()[:5],
                   "--points", "5,0.3"]
        process = subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.kill)
        directory = self.here / "out-quick" / "X0_5_phi_0.3"
        deadline = time.monotonic() + 60
        while not (directory / "log.txt").exists():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)
        second = tool(*self.arguments())
        self.assertEqual(second.returncode, 1)
        self.assertIn("another study is at work in it", second.stderr)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=60), 143)
        self.assertIn("stopped by SIGTERM", (directory / "log.txt").read_text())

    def test_kill(self):
        """kill -9 of the tool: its runs save their state and end, and the next call goes on with them."""
        command = [sys.executable, ROOT / "tools" / "reproduce_paper.py", "--hardbody", HARDBODY, *self.arguments()]
        process = subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        log = self.here / "out-quick" / "X0_0.5_phi_0.05" / "log.txt"
        deadline = time.monotonic() + 60
        while not (log.exists() and "production: " in log.read_text()):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        process.kill()
        process.wait()
        result = tool(*self.arguments())
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertEqual(self.rows(self.here / "results" / "points.csv"), self.reference())


class Grid(unittest.TestCase):
    def test_points(self):
        from paper import grid

        points = grid.ordered_points()
        self.assertGreaterEqual(len(points), 500)
        self.assertEqual(len(set(points)), len(points))
        self.assertEqual(len({p.seed for p in points}), len(points))
        self.assertEqual(sorted(points), sorted(grid.all_points()))
        coarse = [p for p in points if p.X0 in grid.COARSE_X0 and p.phi in grid.COARSE_PHI]
        self.assertEqual(points[:len(coarse)], coarse)
        self.assertEqual({p.X0 for p in points}, set(grid.X0))

    def test_free_rotor(self):
        """The reference is in units of sqrt(I/kT)."""
        from paper.table import free_rotor_c2

        with open(ROOT / "tests" / "reference" / "free_rotor_c2.csv", newline="") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        for row in rows[::10]:
            t = float(row["tau=t*sqrt(kT/I)"])
            # The reference has six digits.
            self.assertAlmostEqual(free_rotor_c2(t * 0.4 ** 0.5, 0.4), float(row["C2_linear_rotor"]), delta=1e-6)
        # At late times 1/4, from below by 3/8 x^-2.
        for t in [10, 100, 1000]:
            self.assertAlmostEqual((0.25 - free_rotor_c2(t, 1)) * t * t, 3 / 16, delta=0.01)


if __name__ == "__main__":
    unittest.main()
