"""The program from outside: exit statuses, files, messages.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_cli.py [TestClass[.test]]
"""

import atexit
import contextlib
import csv
import functools
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

HARDBODY = os.path.abspath(os.environ.get("HARDBODY", "build/release/apps/hardbody/hardbody"))
DEMO = os.environ.get(
    "HARDBODY_DEMO", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "apps", "demo.toml")
)

FULL = os.environ.get("HARDBODY_FULL") == "1"

# A run of a tenth of a second.
SMALL = """seed = 3
[system]
number = 64
packing_fraction = 0.2
[shape]
aspect_ratio = 2
[equilibration]
time = 1
[production]
time = 5
[output]
events = 500
"""

OBSERVABLE_FILES = {
    "msd.csv": ["t [l sqrt(m/kT)]", "msd [l^2]", "msd_error [l^2]"],
    "msd_directions.csv": ["t [l sqrt(m/kT)]"]
    + [f"msd_{d}{e} [l^2]" for d in ["parallel", "perp", "x", "y", "z"] for e in ["", "_error"]],
    "bragg.csv": ["q [1/l]", "n_x [1]", "n_y [1]", "n_z [1]", "intensity [1]", "intensity_error [1]", "angle [rad]"],
    "rotational_msd.csv": [
        "t [l sqrt(m/kT)]",
        "rot_msd [rad^2]",
        "rot_msd_error [rad^2]",
        "rot_msd_body [rad^2]",
        "rot_msd_body_error [rad^2]",
    ],
    "alpha2.csv": ["t [l sqrt(m/kT)]", "alpha2 [1]", "alpha2_error [1]"],
    "velocity.csv": [
        "t [l sqrt(m/kT)]",
        "vacf [kT/m]",
        "vacf_error [kT/m]",
        "wacf [kT/(m l^2)]",
        "wacf_error [kT/(m l^2)]",
    ],
    "c1.csv": ["t [l sqrt(m/kT)]", "c1 [1]", "c1_error [1]"],
    "c2.csv": ["t [l sqrt(m/kT)]", "c2 [1]", "c2_error [1]"],
    "f_self.csv": ["t [l sqrt(m/kT)]"] + [f"f_self_q{k}{e} [1]" for k in range(1, 5) for e in ["", "_error"]],
    "overlap.csv": ["t [l sqrt(m/kT)]", "overlap [1]", "overlap_error [1]", "chi4 [1]", "chi4_error [1]"],
    "van_hove.csv": ["r [l]"] + [f"G_s_t{k}{e} [1/l^3]" for k in range(1, 13) for e in ["", "_error"]],
    "g_r.csv": ["r [l]", "g [1]", "g_error [1]", "g2 [1]", "g2_error [1]"],
    "s_q.csv": ["q [1/l]", "S [1]", "S_error [1]"],
    "blocks.csv": [
        "begin [l sqrt(m/kT)]",
        "end [l sqrt(m/kT)]",
        "collision_rate [sqrt(kT/m)/l]",
        "Z [1]",
        "kT_trans [kT]",
        "kT_rot [kT]",
        "S [1]",
        "director_x [1]",
        "director_y [1]",
        "director_z [1]",
        "Z_xx [1]",
        "Z_yy [1]",
        "Z_zz [1]",
        "Z_yz [1]",
        "Z_xz [1]",
        "Z_xy [1]",
    ],
}

OBSERVABLES = [
    "collision_rate",
    "Z",
    "D_trans",
    "D_parallel",
    "D_perp",
    "D_rot",
    "D_rot_body",
    "S",
    "director",
    "bragg_peak",
    "smectic_order",
    "columnar_order",
    "pressure_tensor",
    "tau_C2",
    "beta_C2",
    "t_C2_1overe",
    "tau_F",
    "beta_F",
    "t_F_1overe",
    "msd_plateau",
    "chi4_peak",
    "t_chi4",
    "q_peak",
    "S_peak",
    "kT_trans",
    "kT_rot",
]


# Runs that tests of this process have made, by name, arguments and config: the result, and the directory that keeps the
# run. The same config, run under the same name, is the same run, as tests of SameRun show.
MADE = {}


@functools.cache
def directory_of_made():
    directory = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, directory, ignore_errors=True)
    return directory


class Case(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.addCleanup(self.directory.cleanup)
        self.here = self.directory.name

    def path(self, name):
        return os.path.join(self.here, name)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)
        return name

    def read(self, name):
        with open(self.path(name)) as file:
            return file.read()

    def bytes_of(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def hardbody(self, *arguments, timeout=120, **options):
        return subprocess.run(
            [HARDBODY, *arguments], cwd=self.here, capture_output=True, text=True, timeout=timeout, stdin=subprocess.DEVNULL, **options
        )

    def state_of(self, out):
        """checkpoint.bin without its end: what the run has taken, and the checksum."""
        return self.bytes_of(f"{out}/checkpoint.bin")[:-48]

    def run_small(self, out, *arguments, config=SMALL):
        self.write("small.toml", config)
        return self.run_config("small.toml", out, *arguments)

    def run_config(self, name, out, *arguments):
        """Runs a config, which must end well; the result has the `seconds` that it took. A run that has been made before is
        copied, unless it continues what is in `out` or reads further files."""
        text = self.read(name)
        key = (name, out, arguments, text)
        reads_files = re.search(r"\b(start_from|file) *=", "\n".join([*arguments, text]))
        may_copy = not reads_files and not os.path.exists(self.path(out))
        if may_copy and key in MADE:
            result, kept = MADE[key]
            shutil.copytree(kept, self.path(out))
            return result
        begin = time.monotonic()
        result = self.hardbody("run", name, "--out", out, *arguments)
        result.seconds = time.monotonic() - begin
        self.assertEqual(result.returncode, 0, result.stderr)
        if may_copy:
            kept = os.path.join(directory_of_made(), str(len(MADE)))
            shutil.copytree(self.path(out), kept)
            MADE[key] = result, kept
        return result

    def summary(self, out):
        def refuse(constant):
            raise ValueError(f"{constant} in summary.json")

        return json.loads(self.read(f"{out}/summary.json"), parse_constant=refuse)

    def assert_refused(self, result, *parts):
        """Exit status 2 and one line on stderr that has all the parts."""
        self.assertEqual(result.returncode, 2, f"stdout: {result.stdout}\nstderr: {result.stderr}")
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertEqual(result.stdout, "")
        for part in parts:
            self.assertIn(part, result.stderr)


class Methods(Case):
    """Finders, distances and neighbour lists."""

    def test_every_finder_and_list_gives_the_same_collisions(self):
        """HARDBODY_FULL=1: all combinations; otherwise newton8 and newton5 have two lists each."""
        left_out = [] if FULL else ["bracketing_obp_newton8", "bracketing_dilated_newton5"]
        config = SMALL.replace("time = 1\n", "time = 0\n").replace("time = 5", "time = 1")
        runs = {
            f"{finder}_{neighbours}_{distance}": [
                "--set", f"dynamics.finder={finder}", "--set", f"dynamics.neighbours={neighbours}",
                "--set", f"dynamics.distance={distance}",
            ]
            for finder, distances in [("certified", ["dual"]), ("bracketing", ["dual", "newton8", "newton5"])]
            for neighbours in ["dilated", "obp", "cells"]
            for distance in distances
            if f"{finder}_{neighbours}_{distance}" not in left_out
        }
        first = None
        for name, arguments in runs.items():
            self.run_small(name, *arguments, config=config)
            rows = [line.split(",") for line in self.read(f"{name}/events.csv").splitlines()[1:]]
            first = first or rows
            self.assertGreater(len(rows), 50)
            self.assertEqual([r[1:] for r in rows], [r[1:] for r in first], name)
            self.assertLess(max(abs(float(a[0]) - float(b[0])) for a, b in zip(rows, first)), 1e-9, name)
        summary = self.summary("bracketing_obp_newton5")
        self.assertEqual(summary["finder"], {"kind": "bracketing", "distance": "newton5", "eps_d": 1e-6})
        self.assertEqual(summary["neighbours"]["kind"], "obp")
        self.assertIn("bracketing; neighbours: obp", self.read("bracketing_obp_newton5/log.txt"))

    def test_auto_says_what_it_chose(self):
        self.run_small("out")
        self.assertIn('neighbours: dilated (chosen by "auto")', self.read("out/log.txt"))
        self.run_small("dilute", "--set", "system.packing_fraction=0.02", "--set", "system.number=512")
        self.assertIn('neighbours: cells (chosen by "auto")', self.read("dilute/log.txt"))
        self.assertIn('neighbours = "cells"', self.read("dilute/config.toml"))


class Run(Case):
    def test_writes_every_file(self):
        result = self.run_small("out")
        for name in ["config.toml", "summary.json", "checkpoint.bin", "events.csv", "log.txt"]:
            self.assertTrue(os.path.isfile(self.path(f"out/{name}")), name)
        self.assertEqual([f for f in os.listdir(self.path("out")) if f.endswith(".part")], [])
        self.assertEqual(sorted(os.listdir(self.path("out/observables"))), sorted(OBSERVABLE_FILES))
        for word in ["collision rate", "D_trans", "D_rot_body", "+-", "energy drift", "minimum distance", "out/summary.json"]:
            self.assertIn(word, result.stdout)
        self.assertTrue(result.stdout.isascii())

    def test_summary_has_every_key(self):
        self.run_small("out")
        summary = self.summary("out")
        self.assertEqual(summary["seed"], 3)
        self.assertRegex(summary["version"], r"^\d+\.\d+\.\d+$")
        state = summary["state"]
        self.assertEqual(
            list(state), ["number", "packing_fraction", "kind", "aspect_ratio", "semi_axes", "exponents"]
        )
        self.assertEqual((state["number"], state["packing_fraction"], state["kind"]), (64, 0.2, "ellipsoid"))
        self.assertEqual((state["aspect_ratio"], state["exponents"]), (2, None))
        self.assertAlmostEqual(math.prod(state["semi_axes"]), 1, 12)
        self.assertEqual(summary["time"], {"equilibration": 1, "production": 5})
        counters = summary["counters"]
        for key in ["collisions", "predictions", "evaluations", "refinements", "rescues", "neighbour_rebuilds"]:
            self.assertIsInstance(counters[key], int)
        self.assertGreater(counters["collisions"], 300)
        self.assertEqual(counters["overlaps"], 0)
        performance = summary["performance"]
        self.assertAlmostEqual(
            performance["collisions_per_second"] * performance["wall_seconds"] / counters["collisions"], 1, 6
        )
        self.assertGreater(performance["peak_memory_bytes"], 1e5)
        audit = summary["audit"]
        self.assertGreater(audit["minimum_distance"], -1e-12)
        self.assertLess(abs(audit["energy_relative_drift"]), 1e-11)
        self.assertLess(abs(audit["momentum_drift"]), 1e-11)
        for key in OBSERVABLES:
            estimate = summary["observables"][key]
            reason = ["missing"] if estimate["value"] is None else []
            self.assertEqual(sorted(estimate), sorted(["error", "value"] + reason), key)
        # Far too short for the diffusion: null, not a number made up, and the reason.
        missing = summary["observables"]["D_trans"].get("missing", "")
        self.assertRegex(missing, r"^displacements grow as t\^(1\.[2-9]|2)\d* up to the longest lag: still in part ballistic; production\.longest_lag or a longer run helps$")
        self.assertEqual(summary["observables"]["D_trans"],
                         {"value": None, "error": None,
                          "missing": missing})
        self.assertEqual(summary["observables"]["tau_C2"]["missing"],
                         "decayed before motion is diffusive: no longer run helps")
        self.assertFalse(summary["interrupted"])
        tensor = summary["observables"]["pressure_tensor"]
        self.assertEqual([len(row) for row in tensor["value"] + tensor["error"]], [3] * 6)
        trace = sum(tensor["value"][k][k] for k in range(3))
        self.assertAlmostEqual(trace / 3, summary["observables"]["Z"]["value"], 12)
        self.assertAlmostEqual(sum(x * x for x in summary["observables"]["director"]["value"]), 1, 12)
        # F_self is measured at the first peak of S(q), and about it.
        q = summary["wave_numbers"]
        self.assertEqual(q, [q[0], q[0] / 4, q[0] / 2, 2 * q[0]])
        self.assertTrue(1.5 < q[0] < 7.5)
        # From 0.4 of the longest lag on, a sixteenth of the run; no C2 has decayed.
        self.assertEqual(summary["fit_windows"]["D"], [0.4 * 5 / 16, 5 / 16])
        self.assertIsNone(summary["fit_windows"]["C2"])
        # 2 N_coll / (N t)
        self.assertAlmostEqual(
            summary["observables"]["collision_rate"]["value"], 2 * counters["collisions"] / (64 * 5), 9
        )

    def test_csv_files(self):
        self.run_small("out")
        for name, header in OBSERVABLE_FILES.items():
            with open(self.path(f"out/observables/{name}"), newline="") as file:
                rows = list(csv.reader(file))
            self.assertEqual(rows[0], header)
            self.assertGreater(len(rows), 3, name)
            for row in rows[1:]:
                self.assertEqual(len(row), len(header))
                for field in row:
                    self.assertTrue(field == "" or math.isfinite(float(field)))
        with open(self.path("out/events.csv"), newline="") as file:
            events = list(csv.DictReader(file))
        self.assertEqual(len(events), 500)
        times = [float(e["time"]) for e in events]
        self.assertEqual(times, sorted(times))
        self.assertTrue(all(0 <= int(e["i"]) < int(e["j"]) < 64 for e in events))
        self.assertTrue(all(repr(float(e["time"])) == repr(float(f"{t:.17g}")) for e, t in zip(events, times)))

    def test_no_events_file_unless_asked(self):
        self.run_small("out", "--set", "output.events=0")
        self.assertFalse(os.path.exists(self.path("out/events.csv")))

    def test_inertia_is_used(self):
        self.run_small("paper")
        self.run_small("uniform", "--set", "dynamics.inertia=uniform")
        self.run_small("moments", "--set", "dynamics.inertia=[0.5, 0.5, 0.25]")
        files = {self.read(f"{name}/events.csv") for name in ["paper", "uniform", "moments"]}
        self.assertEqual(len(files), 3)
        # kT = 1 for each of the degrees of freedom that there are.
        check = self.hardbody("check", "uniform").stdout
        self.assertRegex(check, r"spin 3[0-9.]+\)")

    def test_integers_for_reals_and_auto(self):
        config = SMALL.replace("time = 1\n", 'time = "auto"\n').replace("time = 5", 'time = "auto"')
        self.run_small("out", config=config)
        summary = self.summary("out")
        equilibration = summary["time"]["equilibration"]
        self.assertEqual(equilibration, round(equilibration))
        self.assertEqual(summary["time"]["production"], max(30, 30 * equilibration))
        self.assertTrue(summary["equilibrated"])
        self.assertEqual(summary["equilibrated_by"], "decay")
        how = summary["equilibration"]
        self.assertGreaterEqual(how["relaxations"], 2)
        self.assertGreaterEqual(equilibration, 4 * how["relaxations"])
        self.assertTrue(how["C2"] < 0.05 and how["F_self"] < 0.05)
        self.assertEqual(how["q"], summary["wave_numbers"][0])
        self.assertTrue(abs(how["S_change"]) < 0.3 and abs(how["Z_change"]) < 0.3)

    def test_not_equilibrated_at_the_cap(self):
        config = SMALL.replace("time = 1\n", 'time = "auto"\ncap = 3\n')
        result = self.run_small("out", config=config)
        summary = self.summary("out")
        self.assertFalse(summary["equilibrated"])
        self.assertEqual(summary["time"]["equilibration"], 3)
        self.assertEqual(summary["equilibration"]["relaxations"], 0)
        self.assertIsNone(summary["equilibration"]["relaxation_time"])
        self.assertIn("not equilibrated after 3 time units", result.stderr)
        self.assertIn("\n  *** NOT EQUILIBRATED: ", result.stdout)
        self.assertIsNone(summary["equilibrated_by"])

    def test_a_crystal_is_judged_by_its_order(self):
        config = SMALL.replace("time = 1\n", 'time = "auto"\ncap = 160\n').replace("aspect_ratio = 2", "aspect_ratio = 1")
        config = config.replace("number = 64", "number = 108").replace("fraction = 0.2", 'fraction = 0.6\nstart = "fcc"')
        result = self.run_small("out", config=config)
        summary = self.summary("out")
        self.assertTrue(summary["equilibrated"])
        self.assertEqual(summary["equilibrated_by"], "stationarity")
        self.assertEqual(summary["time"]["equilibration"] % 8, 0)
        self.assertGreater(summary["equilibration"]["order"]["bragg"], 0.2)
        self.assertGreater(summary["observables"]["bragg_peak"]["value"], 0.5)
        self.assertIn("\n  Bragg peak ", result.stdout)
        self.assertNotIn("NOT EQUILIBRATED", result.stdout)

    def test_production_until_the_error_asked_for(self):
        times = {}
        for target in [0.1, 0.02]:
            config = SMALL.replace("time = 1\n", 'time = "auto"\n').replace("time = 5", f'time = "auto"\ntarget_error = {target}')
            self.run_small(str(target), config=config)
            summary = self.summary(str(target))
            self.assertEqual(summary["target_error"], {"asked": target, "reached": True})
            for key in ["D_trans", "D_rot"]:
                estimate = summary["observables"][key]
                self.assertLessEqual(estimate["error"], target * estimate["value"])
            times[target] = summary["time"]["production"]
        self.assertLess(times[0.02], 5000)
        self.assertLess(times[0.1], times[0.02])
        # The first look is when it would have ended without a target, at the earliest.
        self.assertGreaterEqual(times[0.1], 30)

    def test_what_has_no_diffusion_coefficient_is_not_waited_for(self):
        """Nearly a sphere: collisions hardly turn it, and rotation is ballistic up to the longest lag."""
        config = SMALL.replace("time = 1\n", 'time = "auto"\n').replace("time = 5", 'time = "auto"\ntarget_error = 0.1')
        self.run_small("out", "--set", "shape.aspect_ratio=1.05", "--set", "system.packing_fraction=0.4", config=config)
        summary = self.summary("out")
        self.assertTrue(summary["equilibrated"])
        self.assertEqual(summary["target_error"], {"asked": 0.1, "reached": False})
        self.assertIsNone(summary["observables"]["D_rot"]["value"])
        D_trans = summary["observables"]["D_trans"]
        self.assertLessEqual(D_trans["error"], 0.1 * D_trans["value"])
        self.assertLess(summary["time"]["production"], 1000)
        self.assertIn("no D_rot at lags up to", self.read("out/log.txt"))

    def test_numbers_only_where_their_definition_holds(self):
        """Caged spheres, whose MSD has the slope 1 on its way to the cage; a fluid whose motion is diffusive."""
        caged = ["--set", "shape.aspect_ratio=1", "--set", "system.packing_fraction=0.55", "--set", "production.time=7"]
        result = self.run_small("caged", *caged)
        observables = self.summary("caged")["observables"]
        self.assertIsNone(observables["D_trans"]["value"])
        self.assertRegex(observables["D_trans"]["missing"],
                         r"^bodies have moved 0\.\d+ l by lag 0\.\d+, where the fit begins: no diffusion yet; production\.longest_lag or a longer run helps$")
        self.assertRegex(result.stdout, r"  D_trans         - \(bodies have moved 0\.\d+ l by lag 0\.\d+, where the fit begins: no diffusion yet\)\n")
        self.assertIn("  (longer lags: production.longest_lag or a longer run helps)\n", result.stdout)
        for key in ["S", "D_rot", "D_rot_body", "t_C2_1overe", "tau_C2", "beta_C2"]:
            self.assertEqual(observables[key], {"value": None, "error": None, "missing": "spheres have no orientation"})
        self.assertNotRegex(result.stdout, r"\n  (S|director|D_rot|D_rot_body|.*_C2|t_C2.*|kT_rot) ")
        self.assertLessEqual(max(len(line) for line in result.stdout.splitlines()), 120)
        fluid = ["--set", "shape.aspect_ratio=3", "--set", "system.packing_fraction=0.4", "--set", "production.time=100"]
        result = self.run_small("fluid", *fluid)
        for key in ["D_trans", "D_rot", "D_rot_body", "t_C2_1overe", "t_F_1overe"]:
            estimate = self.summary("fluid")["observables"][key]
            self.assertEqual(sorted(estimate), ["error", "value"], key)
            self.assertGreater(estimate["value"], 0, key)

    def test_longest_lag(self):
        """By default a sixteenth of the production; one that is asked for is kept, and shorter runs do not cap it."""
        self.run_small("long", "--set", "production.longest_lag=2.5")
        self.assertEqual(self.summary("long")["fit_windows"]["D"], [0.4 * 2.5, 2.5])
        self.assertEqual(float(self.read("long/observables/msd.csv").splitlines()[-1].split(",")[0]), 2.5)
        self.run_small("all", "--set", "production.longest_lag=5")
        missing = self.summary("all")["observables"]["D_trans"].get("missing", "a longer run helps")
        self.assertRegex(missing, "(^|; )a longer run helps$")
        self.run_small("uncapped", "--set", "production.time=800", "system.number=16")
        self.assertEqual(self.summary("uncapped")["fit_windows"]["D"], [0.4 * 50, 50])

    def test_wave_numbers(self):
        self.run_small("out", "--set", "production.wave_numbers=[1.5, 3]")
        self.assertEqual(self.summary("out")["wave_numbers"], [1.5, 3])
        header = self.read("out/observables/f_self.csv").splitlines()[0]
        self.assertIn("f_self_q2", header)
        self.assertNotIn("f_self_q3", header)

    def test_bond_order(self):
        self.run_small("out", "--set", 'production.order=["steinhardt"]', "production.order_neighbours=8")
        summary = self.summary("out")
        self.assertEqual(summary["order_neighbours"], 8)
        for key in ["q4", "q6"]:
            self.assertTrue(0 < summary["observables"][key]["value"] < 1)
        self.assertNotIn("psi6", summary["observables"])
        self.run_small("plain")
        self.assertFalse({"q6", "psi6"} & set(self.summary("plain")["observables"]))

    def test_hexatic_order(self):
        """Of a state with a director; of another one the reason is said."""
        asked = ["--set", 'production.order=["hexatic"]', "--set", "equilibration.time=0"]
        self.run_small("fluid", *asked)
        summary = self.summary("fluid")
        self.assertNotIn("order_neighbours", summary)
        for key in ["psi6", "psi6_local"]:
            self.assertRegex(summary["observables"][key]["missing"], "director")
        crystal = ["--set", 'system.start="fcc"', "system.packing_fraction=0.6", "system.number=72"]
        result = self.run_small("crystal", *asked, *crystal)
        for key in ["psi6", "psi6_local"]:
            self.assertTrue(0 < self.summary("crystal")["observables"][key]["value"] < 1)
            self.assertIn(key.replace("_", " ") + " ", result.stdout)

    def test_a_gas_is_measured_until_its_velocities_are_forgotten(self):
        config = SMALL.replace("time = 1\n", 'time = "auto"\n').replace("time = 5", 'time = "auto"\ntarget_error = 0.03')
        self.run_small("out", "--set", "shape.aspect_ratio=1", "--set", "system.packing_fraction=0.03", config=config)
        summary = self.summary("out")
        self.assertTrue(summary["target_error"]["reached"])
        # Enskog's D of spheres of radius 1 in the first approximation, with Carnahan and Starling's value at contact.
        phi = 0.03
        enskog = math.sqrt(math.pi) / (8 * phi * (1 - phi / 2) / (1 - phi) ** 3)
        self.assertLess(abs(summary["observables"]["D_trans"]["value"] / enskog - 1), 0.12)

    def test_spheres(self):
        self.run_small("out", "--set", "shape.aspect_ratio=1", "--set", "equilibration.time=auto")
        self.assertTrue(self.summary("out")["equilibrated"])

    def test_set_takes_several_values_and_the_last_wins(self):
        self.run_small("out", "--set", "seed=8", "system.number=70", "--set", "seed=9")
        summary = self.summary("out")
        self.assertEqual((summary["seed"], summary["state"]["number"]), (9, 70))
        self.write("small.toml", SMALL)
        result = self.hardbody("run", "--set", "seed=8", "small.toml")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.summary("out/small")["seed"], 8)

    def test_default_directory(self):
        self.write("small.toml", SMALL)
        self.assertEqual(self.hardbody("run", "small.toml").returncode, 0)
        self.assertTrue(os.path.isfile(self.path("out/small/summary.json")))

    def test_no_equilibration(self):
        self.run_small("out", "--set", "equilibration.time=0")
        summary = self.summary("out")
        self.assertEqual(summary["time"]["equilibration"], 0)
        self.assertFalse(summary["equilibrated"])

    def test_shortest_and_dilute(self):
        self.run_small("short", "--set", "production.time=1e-6")
        self.assertIsNone(self.summary("short")["observables"]["D_trans"]["value"])
        self.run_small("dilute", "--set", "system.packing_fraction=0.0001")
        self.assertEqual(self.summary("dilute")["counters"]["overlaps"], 0)

    def test_demo_config_is_valid(self):
        with open(DEMO) as demo:
            config = self.write("short.toml", demo.read())
        result = self.hardbody("run", config, "--set", "equilibration.time=0.1", "--set", "production.time=0.1")
        self.assertEqual(result.returncode, 0, result.stderr)
        state = self.summary("out/short")["state"]
        self.assertEqual((state["number"], state["aspect_ratio"], state["packing_fraction"]), (512, 3, 0.4))


class SameRun(Case):
    """Runs that must not differ."""

    def test_same_seed_same_numbers(self):
        self.run_small("one")
        self.run_small("two")
        self.run_small("three", "--set", "seed=4")
        self.assertEqual(self.state_of("one"), self.state_of("two"))
        for name in ["events.csv", "config.toml"] + [f"observables/{f}" for f in OBSERVABLE_FILES]:
            self.assertEqual(self.bytes_of(f"one/{name}"), self.bytes_of(f"two/{name}"), name)
            self.assertNotEqual(self.bytes_of(f"one/{name}"), self.bytes_of(f"three/{name}"), name)
        one, two = self.summary("one"), self.summary("two")
        for key in ["state", "time", "counters", "audit", "observables", "neighbours"]:
            self.assertEqual(one[key], two[key])

    def test_resolved_config_gives_the_same_run(self):
        shapes = {
            "aspect_ratio": "aspect_ratio = 2",
            "axes": "semi_axes = [5.1, 1.7, 1.7]",
            "moments": 'semi_axes = [1.0, 3.3, 1.0]\n[dynamics]\ninertia = [0.3, 0.2, 0.3]\nneighbours = "auto"',
        }
        for name, shape in shapes.items():
            with self.subTest(name):
                self.run_small(name, config=SMALL.replace("aspect_ratio = 2", shape).replace("number = 64", "number = 128"))
                again = self.hardbody("run", f"{name}/config.toml", "--out", f"{name}2")
                self.assertEqual(again.returncode, 0, again.stderr)
                self.assertEqual(self.read(f"{name}/events.csv"), self.read(f"{name}2/events.csv"))
                self.assertEqual(self.read(f"{name}/config.toml"), self.read(f"{name}2/config.toml"))

    def test_axes_in_any_order_are_one_shape(self):
        base = SMALL.replace("number = 64", "number = 128")
        for name, axes in {"z": "[1, 1, 3]", "x": "[3, 1, 1]", "y": "[0.5, 1.5, 0.5]"}.items():
            self.run_small(name, config=base.replace("aspect_ratio = 2", f"semi_axes = {axes}"))
        self.run_small("ratio", config=base.replace("aspect_ratio = 2", "aspect_ratio = 3"))
        for name in ["x", "y", "ratio"]:
            self.assertEqual(self.summary(name)["state"], self.summary("z")["state"])
            self.assertEqual(self.read(f"{name}/events.csv"), self.read("z/events.csv"))


class Init(Case):
    def test_writes_a_config_that_runs(self):
        self.assertEqual(self.hardbody("init", "new.toml").returncode, 0)
        self.assertEqual(self.read("new.toml"), self.hardbody("init").stdout)
        result = self.hardbody(
            "run", "new.toml", "--set", "equilibration.time=0.1", "production.time=0.1", "system.packing_fraction=0.3",
            "system.number=108",
        )
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_templates(self):
        for name, kind in [("ellipsoid", "ellipsoid"), ("superball", "superellipsoid"), ("mixture", "mixture")]:
            with self.subTest(name):
                self.assertEqual(self.hardbody("init", f"{name}.toml", "--template", name).returncode, 0)
                result = self.hardbody(
                    "run", f"{name}.toml", "--set", "equilibration.time=0.1", "production.time=0.1", "system.number=200"
                )
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertEqual(self.summary(f"out/{name}")["state"]["kind"], kind)
        self.assertEqual(self.read("ellipsoid.toml"), self.hardbody("init").stdout)
        result = self.hardbody("init", "x.toml", "--template", "cube")
        self.assert_refused(result, "--template cube", "accepted: ellipsoid, superball, capsule, polyhedron, mixture, sweep")
        self.assertFalse(os.path.exists(self.path("x.toml")))

    def test_never_overwrites(self):
        self.write("mine.toml", "precious")
        self.assert_refused(self.hardbody("init", "mine.toml"), "mine.toml", "exists")
        self.assertEqual(self.read("mine.toml"), "precious")
        self.assert_refused(self.hardbody("init", "no/such/directory.toml"), "no/such/directory.toml")


class BadConfig(Case):
    """Every one: status 2, one line `file:line: what; accepted: ...`, nothing created."""

    def refuse(self, config, *parts, arguments=()):
        self.write("bad.toml", config)
        result = self.hardbody("run", "bad.toml", *arguments)
        self.assert_refused(result, "accepted", *parts)
        self.assertEqual(os.listdir(self.here), ["bad.toml"])
        return result.stderr

    def refuse_line(self, old, new, *parts):
        """SMALL with one line replaced; the message names that line."""
        config = SMALL.replace(old, new)
        self.assertNotEqual(config, SMALL)
        line = SMALL[: SMALL.index(old)].count("\n") + 1
        message = self.refuse(config, *parts)
        self.assertTrue(message.startswith(f"bad.toml:{line}: "), message)

    def test_values(self):
        cases = [
            ("seed = 3", "seed = -1", "seed", "-1"),
            ("seed = 3", "seed = 1.5", "seed", "1.5"),
            ("number = 64", "number = 1", "system.number", "1"),
            ("number = 64", "number = -5", "system.number", "-5"),
            ("number = 64", "number = 64.0", "system.number", "64.0", "integer"),
            ("number = 64", 'number = "64"', "system.number", '"64"'),
            ("number = 64", "number = true", "system.number", "true"),
            ("number = 64", "number = 100000000000", "system.number"),
            ("number = 64", "number = [64]", "system.number"),
            ("packing_fraction = 0.2", "packing_fraction = 0", "system.packing_fraction"),
            ("packing_fraction = 0.2", "packing_fraction = -0.1", "system.packing_fraction"),
            ("packing_fraction = 0.2", "packing_fraction = 0.71", "system.packing_fraction", "0.71", "0.6800"),
            ("packing_fraction = 0.2", "packing_fraction = nan", "system.packing_fraction"),
            ("packing_fraction = 0.2", "packing_fraction = inf", "system.packing_fraction"),
            ("packing_fraction = 0.2", 'packing_fraction = "0.2"', "system.packing_fraction"),
            ("packing_fraction = 0.2", 'start = "bcc"', "system.start", '"random", "cubic", "fcc"'),
            ("packing_fraction = 0.2", "start = 1", "system.start"),
            ("packing_fraction = 0.2", "nematic_order = 1.0", "system.nematic_order", "below 1"),
            ("packing_fraction = 0.2", "nematic_order = -0.1", "system.nematic_order"),
            ("packing_fraction = 0.2", "nematic_order = nan", "system.nematic_order"),
            ("aspect_ratio = 2", "aspect_ratio = 0", "shape.aspect_ratio"),
            ("aspect_ratio = 2", "aspect_ratio = -2", "shape.aspect_ratio"),
            ("aspect_ratio = 2", "aspect_ratio = nan", "shape.aspect_ratio"),
            ("aspect_ratio = 2", "aspect_ratio = 1000", "shape.aspect_ratio", "0.01 to 100"),
            ("aspect_ratio = 2", "semi_axes = [1, 2]", "shape.semi_axes"),
            ("aspect_ratio = 2", "semi_axes = [1, 1, -2]", "shape.semi_axes"),
            ("aspect_ratio = 2", "semi_axes = [1, 1, 0]", "shape.semi_axes"),
            ("aspect_ratio = 2", "semi_axes = [1, 1, inf]", "shape.semi_axes"),
            ("aspect_ratio = 2", "semi_axes = [1, 1, nan]", "shape.semi_axes"),
            ("aspect_ratio = 2", 'semi_axes = [1, 1, "2"]', "shape.semi_axes"),
            ("aspect_ratio = 2", "semi_axes = [1, 1, 1000]", "shape.semi_axes"),
            ("aspect_ratio = 2", "semi_axes = 2", "shape.semi_axes"),
            ("time = 1\n", "time = -1\n", "equilibration.time"),
            ("time = 1\n", 'time = "long"\n', "equilibration.time"),
            ("time = 1\n", "cap = 0\n", "equilibration.cap"),
            ("time = 5\n", 'target_error = 0.1\ntime = 5\n', "production.target_error"),
            ("time = 5\n", 'target_error = 0\n', "production.target_error"),
            ("time = 5\n", 'target_error = "small"\n', "production.target_error"),
            ("time = 5\n", "longest_lag = 6\ntime = 5\n", "production.longest_lag", '"auto" or a number from 0.01 to production.time, 5'),
            ("time = 5\n", "longest_lag = 1\ntime = 0\n", "production.longest_lag", "since production.time is 0"),
            ("time = 5\n", "longest_lag = 5001\n", "production.longest_lag", "the longest production, 5000"),
            ("time = 5\n", 'longest_lag = "long"\ntime = 5\n', "production.longest_lag"),
            ("events = 500", 'frames_spacing = "linear"', "output.frames_spacing", '"even", "log"'),
            ("events = 500", "frames_every = 0", "output.frames_every", "a number from 1e-09"),
            ("events = 500", 'frames_every = 1\nframes_spacing = "log"', "output.frames_every", 'frames_spacing = "even"'),
            ("events = 500", 'frames_every = 0.01\ntrajectory = ["gsd"]', "output.frames_every", "frames = 501 at least"),
            ("events = 500", 'frames_spacing = "log"\ntrajectory = ["lammps"]', "output.frames_spacing", "have no times"),
            ("time = 5\n", "wave_numbers = 3\n", "production.wave_numbers", "a list of at most 8"),
            ("time = 5\n", 'order = ["nematic"]\n', "production.order", '"steinhardt" and "hexatic", each at most once'),
            ("time = 5\n", 'order = ["hexatic", "hexatic"]\n', "production.order"),
            ("time = 5\n", "order_neighbours = 3\n", "production.order_neighbours", "an integer from 4 to 50"),
            ("time = 5\n", "wave_numbers = [1, 0]\n", "production.wave_numbers", "above 0"),
            ("time = 5\n", "wave_numbers = [nan]\n", "production.wave_numbers"),
            ("time = 5\n", 'wave_numbers = ["1"]\n', "production.wave_numbers"),
            ("time = 5\n", f"wave_numbers = {[1.0] * 9}\n", "production.wave_numbers"),
            ("time = 5", "time = -1", "production.time"),
            ("time = 5", "time = inf", "production.time"),
            ("events = 500", "events = -1", "output.events"),
            ("events = 500", "events = 1.0", "output.events"),
            ("events = 500", "events = 1000000000000", "output.events"),
            ("events = 500", "checkpoint_every = 60", "output.checkpoint_every"),
            ("events = 500", 'checkpoint_every = "60"', "output.checkpoint_every"),
            ("events = 500", 'checkpoint_every = "-1s"', "output.checkpoint_every"),
            ("events = 500", 'checkpoint_every = "0s"', "output.checkpoint_every"),
            ("events = 500", "trajectory = 1", "output.trajectory"),
            ("events = 500", 'trajectory = ["pdf"]', "output.trajectory"),
            ("events = 500", 'trajectory = ["gsd", 3]', "output.trajectory"),
            ("events = 500", 'trajectory = ["gsd", "vtk", "gsd"]', "output.trajectory", "at most once"),
            ("events = 500", "frames = 1", "output.frames", "2 to"),
            ("events = 500", "frames = 1000000", "output.frames"),
        ]
        for old, new, *parts in cases:
            with self.subTest(new):
                self.refuse_line(old, new, *parts)

    def test_dynamics(self):
        cases = [
            ('inertia = "papers"', "dynamics.inertia", "papers"),
            ("inertia = [1, 1, 3]", "dynamics.inertia", "sum"),
            ("inertia = [1, 1, 0]", "dynamics.inertia"),
            ("inertia = [1e-9, 1e-9, 1e-9]", "dynamics.inertia", "moment"),
            ("inertia = [1e9, 1e9, 1e9]", "dynamics.inertia", "moment"),
            ("inertia = [1, 1, -1]", "dynamics.inertia"),
            ("inertia = [1, 1]", "dynamics.inertia"),
            ("inertia = 3", "dynamics.inertia"),
            ('finder = "best"', "dynamics.finder", "certified"),
            ('distance = "newton8"', "dynamics.distance", "bracketing"),
            ('distance = "newton6"', "dynamics.distance", "newton5", "dual"),
            ('neighbours = "none"', "dynamics.neighbours", "dilated"),
            ("eps_d = 0", "dynamics.eps_d"),
            ("eps_d = -1e-6", "dynamics.eps_d"),
            ("eps_d = 0.9", "dynamics.eps_d", "0.7937"),
            ('eps_d = "1e-6"', "dynamics.eps_d"),
        ]
        for text, *parts in cases:
            with self.subTest(text):
                message = self.refuse(SMALL + "[dynamics]\n" + text + "\n", *parts)
                self.assertTrue(message.startswith("bad.toml:14: "), message)

    def test_shape(self):
        superball = 'kind = "superellipsoid"\nsemi_axes = [1, 1, 1]\n'
        cases = [
            ("kind = 3\naspect_ratio = 2", 6, "shape.kind", '"ellipsoid", "superellipsoid"'),
            ('kind = "cube"\naspect_ratio = 2', 6, "shape.kind", '"cube"'),
            ("exponents = [1, 1]\naspect_ratio = 2", 6, "shape.exponents", 'kind = "superellipsoid"'),
            (superball, 5, "shape.exponents", "missing", "0.25 to 1.6"),
            (superball + "exponents = 0.5", 8, "shape.exponents", "two numbers"),
            (superball + "exponents = [0.5]", 8, "shape.exponents", "two numbers"),
            (superball + "exponents = [0.2, 0.5]", 8, "shape.exponents", "[0.2, 0.5]", "0.25 to 1.6"),
            (superball + "exponents = [0.5, 1.7]", 8, "shape.exponents", "0.25 to 1.6"),
            (superball + "exponents = [0.5, nan]", 8, "shape.exponents"),
            (superball + "exponents = [0.5, -1]", 8, "shape.exponents"),
            ("semi_axes = [1, 5, 101]", 6, "shape.semi_axes", "none is more than 100 times another"),
            ("semi_axes = [1, 2, 3]\naspect_ratio = 2", 7, "shape.aspect_ratio", "shape.semi_axes", "only one"),
            ("aspect_ratio = 2\nmass = 2", 7, "unknown key shape.mass", "species.mass"),
        ]
        for shape, line, *parts in cases:
            with self.subTest(shape):
                message = self.refuse(SMALL.replace("aspect_ratio = 2", shape), *parts)
                self.assertTrue(message.startswith(f"bad.toml:{line}: "), message)

    def test_inertia_of_other_shapes(self):
        superball = 'kind = "superellipsoid"\nsemi_axes = [1, 1, 1]\nexponents = [0.5, 0.5]'
        for shape in ["semi_axes = [1, 2, 3]", superball]:
            for inertia, *parts in [
                ('"paper"', "ellipsoids of revolution", '"uniform"'),
                ('"round"', '"round"', '"uniform"'),
                ("[1, 2, 3.1]", "sum"),
                ("[1, 2, 0]", "positive"),
                ("[0.001, 1.2, 1.2]", "I2 + I3 - I1 at most"),
                ("[9, 9, 9]", "mass at the bounding radius"),
            ]:
                with self.subTest(shape=shape, inertia=inertia):
                    config = SMALL.replace("aspect_ratio = 2", shape) + f"[dynamics]\ninertia = {inertia}\n"
                    self.refuse(config, "dynamics.inertia", *parts)

    def test_unknown_names(self):
        cases = [
            ("number = 64", "numbr = 64", "numbr", "did you mean system.number?"),
            ("packing_fraction = 0.2", "packing_fracton = 0.2", "did you mean system.packing_fraction?"),
            ("seed = 3", "sede = 3", "did you mean seed?"),
            ("seed = 3", "number = 64", "did you mean system.number?"),
            ("aspect_ratio = 2", "aspectratio = 2", "did you mean shape.aspect_ratio?"),
            ("events = 500", "checkpoint_evry = 1", "did you mean output.checkpoint_every?"),
            ("seed = 3", "colour = 3", "unknown key colour"),
            ("[output]", "[ouput]", "unknown section", "did you mean [output]?"),
            ("[output]", "[out.put]", "unknown section [out]"),
            ("events = 500", "[output.more]\nevents = 500", "output.more"),
            ("events = 500", "[output.events]", "output.events"),
        ]
        for old, new, *parts in cases:
            with self.subTest(new):
                self.refuse_line(old, new, *parts)
        self.refuse("system = 3\n[shape]\naspect_ratio = 2\n", "bad.toml:1: ", "system is 3", "a section [system]")
        # A key of another section: what this one takes.
        self.refuse(SMALL.replace("aspect_ratio = 2", "aspect_ratio = 2\nsizes = 'gaussian'"),
                    "did you mean species.sizes?; accepted: shape.kind,")
        # A section is also unknown when it is empty.
        self.refuse(SMALL + "[prodcution]\n", "bad.toml:13: ", "did you mean [production]?")

    def test_missing(self):
        self.refuse(SMALL.replace("packing_fraction = 0.2\n", ""), "bad.toml:2: ", "packing_fraction")
        self.refuse(SMALL.replace("aspect_ratio = 2\n", ""), "bad.toml:5: ", "aspect_ratio", "semi_axes")
        self.refuse("", "bad.toml:1: ", "[shape]")
        self.refuse("[shape]\naspect_ratio = 2\n", "bad.toml:1: ", "packing_fraction")

    def test_both_shapes(self):
        config = SMALL.replace("aspect_ratio = 2", "aspect_ratio = 2\nsemi_axes = [1, 1, 2]")
        self.refuse(config, "bad.toml:7: ", "shape.aspect_ratio", "shape.semi_axes")
        self.refuse(SMALL, "--set ", "only one", arguments=["--set", "shape.semi_axes=[1,1,2]"])

    def test_not_toml(self):
        self.refuse(SMALL.replace("number = 64", "number = = 64"), "bad.toml:3: ")
        self.refuse(SMALL.replace("number = 64", "number = 64\nnumber = 65"), "bad.toml:4: ", "number")
        self.refuse(SMALL + "[system]\n", "bad.toml:13: ", "system")
        self.refuse("\x00\x01\x02", "bad.toml:1: ")

    def test_small_box_names_box_and_number(self):
        message = self.refuse(SMALL.replace("number = 64", "number = 8"), "bad.toml:3: ", "box", "system.number")
        least = int(re.search(r"at least (\d+)", message)[1])
        self.refuse(SMALL.replace("number = 64", f"number = {least - 1}"), "box")
        self.run_small("least", "--set", f"system.number={least}", "--set", "production.time=1")

    def test_the_number_named_is_accepted(self):
        sizes = '[[species]]\nsemi_axes = [1, 1, 2]\nsizes = "lognormal"\nwidth = 0.2\n'
        base = SMALL.replace("number = 64", "number = 8")
        drawn = base[: base.index("[shape]")] + sizes + base[base.index("[equilibration]") :]
        mixture = MIXTURE.replace("number = 100", "number = 10").replace("[0.5, 0.5, 1.0]", "[1, 1, 2]")
        several = mixture.replace("number = 10\n", "").replace("fraction = 0.6", "number = 5").replace("fraction = 0.4", "number = 5")
        def least_number(config, pattern):
            self.write("few.toml", config)
            result = self.hardbody("run", "few.toml", "--out", "few")
            self.assert_refused(result, "few.toml:", "box")
            return int(re.search(pattern, result.stderr)[1])

        for name, config in [("sizes", drawn), ("fractions", mixture), ("numbers", several)]:
            for phi in [0.1, 0.2, 0.3]:
                with self.subTest(name=name, phi=phi):
                    dense = re.sub("packing_fraction = .*", f"packing_fraction = {phi}", config)
                    least = least_number(dense, r"(?:at least|for instance) (\d+) in these proportions, or bodies")
                    if name == "numbers":
                        more = dense.replace("number = 5", f"number = {math.ceil(least / 2)}")
                    else:
                        more = re.sub("number = .*", f"number = {least}", dense)
                    self.write("more.toml", more)
                    result = self.hardbody("run", "more.toml", "--out", f"{name}{phi}", "--set", "production.time=0", "equilibration.time=0")
                    self.assertEqual(result.returncode, 0, result.stderr)
        fcc = SMALL.replace("number = 64", 'number = 8\nstart = "fcc"')
        self.assertEqual(least_number(fcc, r"at least (\d+)\n") % 4, 0)
        one_among_many = several.replace("number = 5", "number = 1", 1).replace("number = 5", "number = 900000")
        self.write("few.toml", one_among_many.replace("[1, 1, 2]", "[300, 300, 300]"))
        many = self.hardbody("run", "few.toml", "--out", "few")
        self.assert_refused(many, "bounding radius 300", "a lower packing fraction, or bodies of less unequal sizes")
        self.assertNotIn("at least", many.stderr)

    def test_boxes_that_bodies_turn_in_need_room(self):
        octahedra = SMALL.replace("aspect_ratio = 2", 'kind = "superellipsoid"\nsemi_axes = [1, 1, 1]\nexponents = [1.6, 1.6]')
        octahedra = octahedra.replace("= 0.2", "= 0.3") + '[dynamics]\nneighbours = "obp"\n'
        message = self.refuse(octahedra, "bad.toml:3: ", "system.number", '"obp" needs room for boxes that a body can turn in')
        least = int(re.search(r"at least (\d+)", message)[1])
        self.assertGreater(least, 64)
        self.run_small("least", "--set", f"system.number={least}", "production.time=1", "equilibration.time=0", config=octahedra)

    def test_densest_packing_named_is_accepted(self):
        config = SMALL.replace("aspect_ratio = 2", "aspect_ratio = 1.05")
        message = self.refuse(config.replace("= 0.2", "= 0.9"), "system.packing_fraction")
        densest = float(re.search(r"to ([0-9.]+) for", message)[1])
        # Accepted as a packing fraction; refused for another reason, so that nothing has to be compressed.
        self.refuse(config.replace("= 0.2", f"= {densest}").replace("number = 64", "number = 2"), "box")
        self.refuse(config.replace("= 0.2", f"= {densest + 1e-3}"), "system.packing_fraction")

    def test_overrides(self):
        cases = {
            "system.number=1": ["system.number is 1"],
            "system.numbr=64": ["did you mean system.number?"],
            "numbr=64": ["did you mean system.number?"],
            "system.number=many": ['"many"'],
            "production.time=-1": ["production.time"],
            "system.number": ["section.key=value"],
            "=3": ["section.key=value"],
            "system.number=": ["section.key=value"],
            "system={number=64}": ["system", "section"],
            "seed=1\nsystem.number=70": ["seed"],
        }
        for override, parts in cases.items():
            with self.subTest(override):
                message = self.refuse(SMALL, *parts, arguments=["--set", override])
                self.assertTrue(message.startswith("--set " + override.replace("\n", " ")), message)


# Rods and superballs, with the lines of SMALL but for [shape].
MIXTURE = """seed = 3
[system]
number = 100
packing_fraction = 0.2
[[species]]
semi_axes = [0.5, 0.5, 1.0]
fraction = 0.6
[[species]]
kind = "superellipsoid"
semi_axes = [0.6, 0.6, 0.6]
exponents = [0.5, 0.5]
fraction = 0.4
mass = 2
[equilibration]
time = 1
[production]
time = 5
[output]
events = 500
"""


class BadSpecies(Case):
    """Of [[species]]: as BadConfig."""

    def refuse(self, config, where, *parts, arguments=()):
        self.write("bad.toml", config)
        result = self.hardbody("run", "bad.toml", *arguments)
        self.assert_refused(result, "accepted", *parts)
        self.assertTrue(result.stderr.startswith(where), result.stderr)
        self.assertEqual(os.listdir(self.here), ["bad.toml"])

    def refuse_line(self, old, new, *parts):
        config = MIXTURE.replace(old, new)
        self.assertNotEqual(config, MIXTURE)
        self.refuse(config, f"bad.toml:{MIXTURE[: MIXTURE.index(old)].count(chr(10)) + 1}: ", *parts)

    def test_values(self):
        cases = [
            ("fraction = 0.4", "fraction = 0", "species[2].fraction", "above 0"),
            ("fraction = 0.4", "fraction = -0.4", "species[2].fraction"),
            ("fraction = 0.4", "fraction = nan", "species[2].fraction"),
            ("fraction = 0.4", 'fraction = "half"', "species[2].fraction"),
            ("fraction = 0.4", "fraction = 0.3", "species[2].fraction", "add up to 0.9", "add up to 1"),
            ("fraction = 0.4", "fraction = 0.5", "add up to 1.1"),
            ("mass = 2", "mass = 0", "species[2].mass"),
            ("mass = 2", "mass = -1", "species[2].mass"),
            ("mass = 2", "mass = 1e9", "species[2].mass", "1e-06 to 1e+06"),
            ("mass = 2", 'inertia = "paper"', "species[2].inertia", "ellipsoids of revolution", "species[2] is none"),
            ("mass = 2", "inertia = [1, 1, 2.1]", "species[2].inertia", "sum"),
            ("mass = 2", 'sizes = "gauss"', "species[2].sizes", '"gaussian"'),
            ("mass = 2", 'sizes = "gaussian"', "species[2].width", "missing", "0.3"),
            ("mass = 2", "width = 0.1", "species[2].width", "sizes"),
            ("mass = 2", "size_seed = 1", "species[2].size_seed", "sizes"),
            ("mass = 2", "exponent = 1", "unknown key species[2].exponent", "did you mean species[2].exponents?"),
            ("exponents = [0.5, 0.5]", "exponents = [0.5, 1.61]", "species[2].exponents", "0.25 to 1.6"),
            ("semi_axes = [0.6, 0.6, 0.6]", "semi_axes = [0.6, 0.6]", "species[2].semi_axes", "three"),
            ("semi_axes = [0.6, 0.6, 0.6]", "semi_axes = [6000, 6000, 6000]", "species[2].semi_axes", "0.001 to 1000"),
        ]
        for old, new, *parts in cases:
            with self.subTest(new):
                self.refuse_line(old, new, *parts)

    def test_sizes(self):
        for sizes, width, *parts in [
            ("gaussian", "0.31", "at most 0.3"), ("uniform", "0.51", "at most 0.5"), ("lognormal", "0.6", "at most 0.5"),
            ("uniform", "0", "above 0"), ("uniform", "-0.1", "above 0"), ("uniform", '"wide"', "above 0"),
        ]:
            with self.subTest(sizes=sizes, width=width):
                config = MIXTURE.replace("mass = 2", f'sizes = "{sizes}"\nwidth = {width}')
                self.refuse(config, "bad.toml:14: ", "species[2].width", *parts)
        config = MIXTURE.replace("mass = 2", 'sizes = "uniform"\nwidth = 0.1\nsize_seed = -1')
        self.refuse(config, "bad.toml:15: ", "species[2].size_seed")

    def test_numbers(self):
        self.refuse(MIXTURE.replace("fraction = 0.4\n", ""), "bad.toml:8: ", "species[2]", "fraction of each")
        both = MIXTURE.replace("fraction = 0.6", "number = 60")
        self.refuse(both, "bad.toml:12: ", "species[2].fraction is 0.4", "species have a number")
        self.refuse(both.replace("fraction = 0.4\n", ""), "bad.toml:8: ", "species[2].number is missing")
        self.refuse(both.replace("fraction = 0.4", "fraction = 0.4\nnumber = 40"), "bad.toml:12: ", "it also has a number")
        numbers = both.replace("fraction = 0.4", "number = 41")
        self.refuse(numbers, "bad.toml:3: ", "system.number is 100", "101")
        self.refuse(numbers.replace("= 41", "= 0"), "bad.toml:12: ", "species[2].number is 0", "1 to")
        self.refuse(numbers.replace("= 41", "= 40.0"), "bad.toml:12: ", "integer")
        few = MIXTURE.replace("0.6\n[[", "0.999\n[[").replace("fraction = 0.4", "fraction = 0.001")
        self.refuse(few, "bad.toml:12: ", "species[2].fraction", "none of 100 bodies")

    def test_sections(self):
        self.refuse(MIXTURE + "[shape]\naspect_ratio = 2\n", "bad.toml:21: ", "shape.aspect_ratio", "[[species]] are both")
        self.refuse(MIXTURE, "--set shape", "both given", arguments=["--set", "shape.aspect_ratio=2"])
        self.refuse(SMALL.replace("[shape]", "[species]"), "bad.toml:5: ", "[species] is one section", "[[species]]")
        self.refuse(SMALL.replace("[output]", "[[output]]"), "bad.toml:11: ", "[output]", "once")
        self.refuse('["species[1]"]\naspect_ratio = 2\n', "bad.toml:1: ", "unknown section")
        self.refuse("species = 3\n", "bad.toml:1: ", "species is 3", "[[species]]")
        self.refuse("species = []\n", "bad.toml:1: ", "species is []", "[[species]]")
        self.refuse(MIXTURE, "--set ", "species[3]", "species[1] to species[2]", arguments=["--set", "species[3].mass=2"])
        self.refuse(MIXTURE, "--set ", "species", arguments=["--set", "species.mass=2"])
        self.refuse(SMALL, "--set ", "needs sections [[species]]", arguments=["--set", "species[1].mass=2"])

    def test_dynamics(self):
        self.refuse(MIXTURE + '[dynamics]\ninertia = "paper"\n', "bad.toml:21: ", "dynamics.inertia", "species[2] is none")
        self.refuse(MIXTURE + "[dynamics]\ninertia = [1, 1, 1]\n", "bad.toml:21: ", "moments in each [[species]]")

    def test_inertia_that_no_species_takes(self):
        own = MIXTURE.replace("\nfraction", '\ninertia = "uniform"\nfraction')
        for value in ["uniform", "paper", "foo"]:
            with self.subTest(value):
                parts = [f'dynamics.inertia is "{value}"', "none where every [[species]] has its own inertia"]
                self.refuse(own + f'[dynamics]\ninertia = "{value}"\n', "bad.toml:23: ", *parts)
        self.refuse(own, "--set dynamics.inertia", arguments=["--set", "dynamics.inertia=uniform"])
        one = MIXTURE.replace("\nfraction", '\ninertia = "uniform"\nfraction', 1)
        self.refuse(one + '[dynamics]\ninertia = "foo"\n', "bad.toml:22: ", 'dynamics.inertia is "foo"')
        os.remove(self.path("bad.toml"))
        self.hardbody("init", "bad.toml", "--template", "mixture")
        self.refuse(self.read("bad.toml"), "--set dynamics.inertia", arguments=["--set", "dynamics.inertia=uniform"])

    def test_moments_are_named_as_they_are_given(self):
        """Though the axis of revolution becomes body z."""
        for axes, moments, what, axis in [
            ("[3, 1, 1]", "[2.5, 1, 2]", "I3 + I1 - I2", "y"),
            ("[1, 3, 1]", "[2, 2.5, 1]", "I2 + I3 - I1", "x"),
            ("[1, 3, 1]", "[1, 2.5, 2]", "I2 + I3 - I1", "x"),
            ("[1, 1, 3]", "[2, 1, 2.5]", "I2 + I3 - I1", "x"),
        ]:
            with self.subTest(axes=axes, moments=moments):
                bodies = MIXTURE.replace("semi_axes = [0.6, 0.6, 0.6]\nexponents = [0.5, 0.5]", f"semi_axes = {axes}")
                bodies = bodies.replace('kind = "superellipsoid"\n', "").replace("mass = 2", f"mass = 0.5\ninertia = {moments}")
                words = f"bad.toml:12: species[2].inertia is {moments}; accepted: {what} at most 1, twice the mass"
                self.refuse(bodies, words, f"along body {axis}")

    def test_unequal_sizes(self):
        # So few large bodies do not fit into the box, and the message says what would.
        large = MIXTURE.replace("semi_axes = [0.6, 0.6, 0.6]", "semi_axes = [6, 6, 6]").replace("0.6\n[[", "0.98\n[[")
        large = large.replace("fraction = 0.4", "fraction = 0.02")
        self.refuse(large, "bad.toml:3: ", "box", "the largest", "less unequal sizes")


BIAXIAL = SMALL.replace("aspect_ratio = 2", "semi_axes = [1, 1.5, 0.7]")
# For runs whose neighbour lists do not matter: cells need no tuning of envelopes, which takes longer than such a run.
CELLS = '[dynamics]\nneighbours = "cells"\n'


class Shapes(Case):
    """Superellipsoids, bodies with three different axes, mixtures, sizes: whole runs."""

    AXES = ["kT_axes", "D_rot_axes", "t_C2_1overe_axes"]

    def run_shape(self, out, config, *arguments):
        self.run_small(out, *arguments, config=config)
        check = self.hardbody("check", out)
        self.assertEqual(check.returncode, 0, check.stdout)
        summary = self.summary(out)
        self.assertEqual(summary["counters"]["overlaps"], 0)
        self.assertGreater(summary["counters"]["collisions"], 300)
        self.assertLess(summary["audit"]["energy_relative_drift"], 1e-11)
        self.assertTrue(summary["sound"])
        self.run_config(f"{out}/config.toml", f"{out}_again")
        self.assertEqual(self.state_of(out), self.state_of(f"{out}_again"))
        for name in ["config.toml", "events.csv", "observables/rotational_msd.csv"]:
            self.assertEqual(self.bytes_of(f"{out}/{name}"), self.bytes_of(f"{out}_again/{name}"), name)
        return summary

    def columns(self, name):
        return self.read(name).splitlines()[0].split(",")

    def test_superball(self):
        shape = 'kind = "superellipsoid"\nsemi_axes = [2, 2, 2]\nexponents = [0.5, 0.5]'
        summary = self.run_shape("out", SMALL.replace("aspect_ratio = 2", shape))
        state = summary["state"]
        self.assertEqual((state["kind"], state["exponents"]), ("superellipsoid", [0.5, 0.5]))
        self.assertEqual((state["semi_axes"], state["aspect_ratio"]), ([1, 1, 1], 1))
        self.assertNotIn("species", summary)
        for key in self.AXES:
            for e in summary["observables"][key]:
                self.assertEqual(sorted(e), sorted(["error", "value"] + (["missing"] if e["value"] is None else [])))
        # Every axis has N degrees of freedom, and what is on all of them is their mean.
        kT = [e["value"] for e in summary["observables"]["kT_axes"]]
        self.assertAlmostEqual(sum(kT) / 3, summary["observables"]["kT_rot"]["value"], 12)
        self.assertIn("/ 6, three components", summary["units"]["D_rot"])
        self.assertIn("c2_y [1]", self.columns("out/observables/c2.csv"))
        self.assertIn("rot_msd_body_z_error [rad^2]", self.columns("out/observables/rotational_msd.csv"))

    def test_body_axes_add_up(self):
        self.run_shape("out", BIAXIAL)
        with open(self.path("out/observables/rotational_msd.csv"), newline="") as file:
            for row in csv.DictReader(file):
                parts = sum(float(row[f"rot_msd_body_{axis} [rad^2]"]) for axis in "xyz")
                self.assertAlmostEqual(parts / float(row["rot_msd_body [rad^2]"]), 1, 12)
        with open(self.path("out/observables/c2.csv"), newline="") as file:
            for row in csv.DictReader(file):
                self.assertEqual(row["c2 [1]"], row["c2_z [1]"])

    def test_biaxial(self):
        summary = self.run_shape("out", BIAXIAL)
        self.assertIsNone(summary["state"]["aspect_ratio"])
        self.assertAlmostEqual(math.prod(summary["state"]["semi_axes"]), 1, 12)
        self.assertAlmostEqual(summary["state"]["semi_axes"][1] / summary["state"]["semi_axes"][0], 1.5, 12)
        self.assertRegex(self.hardbody("check", "out").stdout, r"rotational temperature +\S+ on 3N\n")

    def test_moments_across_the_axis_may_differ(self):
        config = SMALL + "[dynamics]\ninertia = [0.3, 0.4, 0.2]\n"
        summary = self.run_shape("out", config)
        self.assertEqual(summary["state"]["aspect_ratio"], 2)
        self.assertIn("kT_axes", summary["observables"])

    def test_of_revolution_about_z(self):
        # A superellipsoid, but with two rotation axes and a spin that stays.
        shape = 'kind = "superellipsoid"\naspect_ratio = 1.5\nexponents = [0.6, 1]'
        summary = self.run_shape("out", SMALL.replace("aspect_ratio = 2", shape))
        self.assertNotIn("kT_axes", summary["observables"])
        self.assertIn("two components", summary["units"]["D_rot"])

    def test_binary_mixture(self):
        summary = self.run_shape("out", MIXTURE)
        self.assertEqual(summary["state"]["kind"], "mixture")
        self.assertEqual([summary["state"][k] for k in ["semi_axes", "exponents", "aspect_ratio"]], [None] * 3)
        rods, balls = summary["species"]
        self.assertEqual((rods["number"], balls["number"]), (60, 40))
        self.assertEqual((rods["semi_axes"], rods["exponents"], rods["aspect_ratio"]), ([0.5, 0.5, 1.0], None, 2))
        self.assertEqual((balls["semi_axes"], balls["exponents"], balls["mass"]), ([0.6] * 3, [0.5, 0.5], 2))
        self.assertEqual((rods["spins"], balls["spins"], rods["sizes"]), (False, True, None))
        self.assertNotIn("kT_axes", rods["observables"])
        for key in self.AXES:
            self.assertEqual(len(balls["observables"][key]), 3)
        # The mean of the species, by their shares of the degrees of freedom.
        kT = [s["observables"]["kT_trans"]["value"] for s in summary["species"]]
        share = [3 * (60 - 60 / 140), 3 * (40 - 80 / 140)]
        mean = sum(a * b for a, b in zip(share, kT)) / sum(share)
        self.assertAlmostEqual(mean, summary["observables"]["kT_trans"]["value"], 12)
        for name, key in [("msd", "msd"), ("c1", "c1"), ("c2", "c2"), ("velocity", "vacf")]:
            with open(self.path(f"out/observables/{name}.csv"), newline="") as file:
                for row in csv.DictReader(file):
                    value = lambda suffix: next(float(row[c]) for c in row if c.startswith(f"{key}{suffix} ["))
                    self.assertAlmostEqual(value(""), 0.6 * value("_1") + 0.4 * value("_2"), 12)
        self.assertIn("c2_2_x [1]", self.columns("out/observables/c2.csv"))
        self.assertIn("c1_2_x [1]", self.columns("out/observables/c1.csv"))
        self.assertIn("f_self_2_q4 [1]", self.columns("out/observables/f_self.csv"))
        self.assertIn("g2_1_error [1]", self.columns("out/observables/g_r.csv"))
        self.assertIn("S_2 [1]", self.columns("out/observables/s_q.csv"))
        self.assertNotIn("c2_1_x [1]", self.columns("out/observables/c2.csv"))

    def test_polydisperse(self):
        ellipsoid = "[[species]]\nsemi_axes = [1, 1, 1.5]\nsizes = {}\nwidth = 0.1\n"
        base = SMALL[: SMALL.index("[shape]")] + "{}" + SMALL[SMALL.index("[equilibration]") :]
        for sizes in ["uniform", "gaussian", "lognormal"]:
            with self.subTest(sizes):
                config = base.format(ellipsoid.format(f'"{sizes}"'))
                summary = self.run_shape(sizes, config)
                drawn = summary["species"][0]["sizes"]
                self.assertEqual((drawn["distribution"], drawn["width"]), (sizes, 0.1))
                self.assertLess(abs(drawn["mean"] - 1), 4 * 0.1 / math.sqrt(64))
                self.assertTrue(0.06 < drawn["standard_deviation"] < 0.14)
                self.assertTrue(0.6 < drawn["smallest"] < 0.95 and 1.05 < drawn["largest"] < 1.4)
        # A seed of its own: the same bodies in another start.
        config = base.format(ellipsoid.format('"uniform"\nsize_seed = 7'))
        one = self.run_shape("one", config)
        two = self.run_shape("two", config, "--set", "seed=4")
        self.assertEqual(one["species"][0]["sizes"], two["species"][0]["sizes"])
        self.assertNotEqual(self.read("one/events.csv"), self.read("two/events.csv"))
        self.assertNotEqual(one["species"][0]["sizes"], self.summary("uniform")["species"][0]["sizes"])

    def test_one_species_is_the_shape(self):
        # semi_axes of product 1 are the same bodies either way.
        config = SMALL.replace("aspect_ratio = 2", "semi_axes = [0.5, 2, 1]").replace("number = 64", "number = 90") + CELLS
        self.run_small("shape", config=config)
        self.run_small("species", config=config.replace("[shape]", "[[species]]"))
        self.assertEqual(self.read("shape/events.csv"), self.read("species/events.csv"))
        self.assertEqual(self.read("shape/observables/c2.csv"), self.read("species/observables/c2.csv"))
        table = self.read("species/summary.json")
        self.assertIn("lengths are taken as they are given", table)

    def test_numbers_and_fractions_are_the_same(self):
        mixture = MIXTURE + CELLS
        self.run_small("fractions", config=mixture)
        numbers = mixture.replace("fraction = 0.6", "number = 60").replace("fraction = 0.4", "number = 40")
        self.run_small("numbers", config=numbers.replace("number = 100\n", ""))
        self.assertEqual(self.read("fractions/events.csv"), self.read("numbers/events.csv"))

    def test_equilibration_waits_for_the_slowest_species(self):
        config = MIXTURE.replace("time = 1\n", 'time = "auto"\n')
        self.run_small("out", config=config)
        self.assertTrue(self.summary("out")["equilibrated"])
        self.assertIn("of the slowest species", self.read("out/log.txt"))

    def test_unequal_sizes_run(self):
        # One to eight in length: slow per body, and right.
        config = MIXTURE.replace("number = 100", "number = 300").replace("[0.5, 0.5, 1.0]", "[0.2, 0.2, 0.3]")
        config = config.replace("fraction = 0.6", "fraction = 0.98").replace("fraction = 0.4", "fraction = 0.02")
        config = config.replace("[0.6, 0.6, 0.6]", "[1.6, 1.6, 1.6]").replace("time = 5", "time = 2")
        self.run_shape("out", config.replace("time = 1\n", "time = 0.1\n"))

    def test_any_unit_of_length_and_mass_gives_the_same_physics(self):
        """"auto" in both phases, and the coefficients that come out, in the units of the bodies."""
        bodies = "[[species]]\nsemi_axes = [{0}, {0}, {1}]\nmass = {2}\n"
        auto = '[equilibration]\ntime = "auto"\n[production]\ntime = "auto"\n'
        base = SMALL[: SMALL.index("[shape]")] + bodies + auto
        results = {}
        for length, mass in [(1, 1), (0.005, 1), (300, 1), (1, 1e-5), (1, 1e5), (0.01, 1e5)]:
            unit = length * math.sqrt(mass)
            name = f"{length}_{mass}"
            run = self.run_small(name, config=base.format(length, 1.7 * length, mass))
            summary = self.summary(name)
            self.assertTrue(summary["equilibrated"], name)
            self.assertNotIn("nan", run.stdout + run.stderr + self.read(f"{name}/log.txt"))
            self.assertLess(0.5, summary["time"]["equilibration"] / unit / 8)
            self.assertGreater(30, summary["time"]["equilibration"] / unit / 8)
            scales = {"D_trans": length**2 / unit, "D_rot": 1 / unit, "collision_rate": 1 / unit, "t_C2_1overe": unit, "Z": 1}
            for key, scale in scales.items():
                estimate = summary["observables"][key]
                value, error = estimate["value"] / scale, estimate["error"] / scale
                one, its_error = results.setdefault(key, (value, error))
                self.assertLess(abs(value - one), 5 * math.hypot(error, its_error), (name, key))
                self.assertLess(error, 0.15 * value, (name, key))

    def test_neighbour_lists_give_the_same_collisions(self):
        config = MIXTURE.replace("time = 1\n", "time = 0\n").replace("time = 5", "time = 1")
        for neighbours in ["dilated", "obp", "cells"]:
            self.run_small(neighbours, "--set", f"dynamics.neighbours={neighbours}", config=config)
        rows = {n: [line.split(",") for line in self.read(f"{n}/events.csv").splitlines()[1:]] for n in ["dilated", "obp", "cells"]}
        self.assertGreater(len(rows["dilated"]), 100)
        for name in ["obp", "cells"]:
            self.assertEqual([r[1:] for r in rows[name]], [r[1:] for r in rows["dilated"]])
            self.assertLess(max(abs(float(a[0]) - float(b[0])) for a, b in zip(rows[name], rows["dilated"])), 1e-9)


class Starts(Case):
    """On lattices, and with a nematic order."""

    ROD = SMALL.replace("aspect_ratio = 2", "aspect_ratio = 3").replace("number = 64", "number = 288")

    def run_start(self, out, config, *lines, said=False):
        """The summary, or what was said on the console."""
        config = config.replace("[system]\n", "[system]\n" + "".join(line + "\n" for line in lines))
        result = self.run_small(out, "--set", "equilibration.time=0.2", "production.time=0.5", config=config)
        self.assertEqual(self.hardbody("check", out).returncode, 0)
        text = self.read(f"{out}/config.toml")
        for line in lines:
            self.assertIn(line + " ", text)
        self.run_config(f"{out}/config.toml", f"{out}_again")
        self.assertEqual(self.state_of(out), self.state_of(f"{out}_again"))
        summary = self.summary(out)
        self.assertTrue(summary["sound"])
        return result.stderr if said else summary

    def test_compressions_are_counted(self):
        summary = self.run_start("compressed", self.ROD)
        counters = summary["counters_of_start"]
        self.assertGreater(counters["collisions"], 288)
        self.assertGreater(counters["predictions"], counters["collisions"])
        self.assertEqual([counters[key] for key in ("overlaps", "declined", "parting_contacts")], [0, 0, 0])
        tuning = summary["counters_of_tuning"]
        self.assertGreater(tuning["predictions"], 0)
        self.assertEqual(tuning["overlaps"] + tuning["declined"], 0)
        lattice = self.run_start("lattice", self.ROD, 'start = "fcc"')["counters_of_start"]
        self.assertEqual(set(lattice.values()), {0})

    def test_ellipsoids_on_fcc(self):
        summary = self.run_start("out", self.ROD.replace("0.2", "0.6"), 'start = "fcc"')
        # Each has a share of less than 1/0.6 of its volume to turn in: it stays aligned.
        self.assertGreater(summary["observables"]["S"]["value"], 0.9)

    def test_superballs_on_cubic(self):
        shape = 'kind = "superellipsoid"\nsemi_axes = [1, 1, 1]\nexponents = [0.5, 0.5]'
        self.run_start("out", SMALL.replace("aspect_ratio = 2", shape).replace("0.2", "0.6"), 'start = "cubic"')

    def test_nematic(self):
        said = self.run_start("compressed", self.ROD, "nematic_order = 0.8", said=True)
        # In a fluid that would rather be isotropic, compression loses what it began with; on the way to a gas it does not.
        gas = self.run_start("gas", self.ROD.replace("0.2", "0.002"), "nematic_order = 0.8", said=True)
        reached = [re.search(r"start: S = ([-0-9.]+)$", self.read(f"{out}/log.txt"), re.MULTILINE)[1]
                   for out in ("compressed", "gas")]
        lost = f'start: S = {float(reached[0]):.2f} about z after the compression, not nematic_order = 0.8; start = "fcc"'
        self.assertIn(lost, said)
        self.assertIn(lost, self.read("compressed/log.txt"))
        self.assertNotIn("nematic_order", gas)
        self.assertLess(float(reached[0]), 0.4)
        self.assertAlmostEqual(float(reached[1]), 0.8, delta=0.1)
        dense = self.ROD.replace("0.2", "0.4")
        summary = self.run_start("lattice", dense, 'start = "fcc"', "nematic_order = 0.8")
        # Seven tenths of a time unit are too short to lose much of it.
        self.assertGreater(summary["observables"]["S"]["value"], 0.6)
        config = self.ROD.replace("0.2", "0.6").replace("[system]", '[system]\nstart = "fcc"\nnematic_order = 0.5')
        self.write("tight.toml", config)
        self.assert_refused(self.hardbody("run", "tight.toml"), "tight.toml:4: system.nematic_order is 0.5", "accepted: at least")

    def test_mixture(self):
        self.run_start("out", MIXTURE.replace("number = 100", "number = 192"), 'start = "fcc"')

    def test_very_unequal_sizes(self):
        """Small bodies are inserted between large ones, and only where they are too dense for that is all compressed together."""
        for sizes, together in [([(1, 0.003), (0.1, 0.997)], False), ([(1, 0.01), (0.2, 0.99)], True)]:
            with self.subTest(sizes=sizes):
                species = "".join(f"[[species]]\nsemi_axes = [{a}, {a}, {a}]\nfraction = {x}\n" for a, x in sizes)
                config = SMALL.replace("[shape]\naspect_ratio = 2\n", species).replace("64", "1200").replace("0.2", "0.25")
                out = f"together_{together}"
                result = self.run_small(out, "--set", "equilibration.time=0.01", "production.time=0.01", config=config)
                self.assertEqual("1200 of 1200 bodies are compressed together" in result.stderr, together)
                self.assertEqual("compressed together" in self.read(f"{out}/log.txt"), together)

    def test_numbers_of_species_on_fcc(self):
        bodies = MIXTURE.replace("number = 100\n", 'start = "fcc"\n').replace("fraction = 0.6", "number = 101")
        self.write("bad.toml", bodies.replace("fraction = 0.4", "number = 100"))
        words = "bad.toml:7: the numbers of all [[species]] add up to 201: the fcc lattice has 4 bodies in a cell; accepted: a multiple of 4"
        self.assert_refused(self.hardbody("run", "bad.toml"), words)

    def test_awkward_large_numbers_on_a_lattice(self):
        """A prime number has but one way to fill a cube, in slices: it is refused at once."""
        shape = 'kind = "superellipsoid"\nsemi_axes = [1, 1, 1]\nexponents = [0.5, 0.5]'
        config = SMALL.replace("aspect_ratio = 2", shape).replace("number = 64", 'number = 999983\nstart = "cubic"')
        self.write("bad.toml", config)
        result = self.hardbody("run", "bad.toml", timeout=60)
        self.assert_refused(result, "system.packing_fraction is 0.2 and number is 999983: bodies in ", "accepted: at most", "or a number of 9999")

    def test_too_dense(self):
        config = self.ROD.replace("number = 288", 'number = 512\nstart = "fcc"').replace("0.2", "0.6")
        self.write("bad.toml", config)
        result = self.hardbody("run", "bad.toml")
        self.assert_refused(result, "bad.toml:5: system.packing_fraction is 0.6", "fcc lattice", "accepted: at most")
        number = re.search(r"or a number of (\d+)", result.stderr)[1]
        self.run_small("out", "--set", f"system.number={number}", "production.time=0.1", config=config)
        self.write("odd.toml", config.replace("512", "511"))
        self.assert_refused(self.hardbody("run", "odd.toml"), "odd.toml:3: system.number is 511", "accepted: ")
        most = re.search(r"at most ([0-9.]+)", result.stderr)[1]
        self.run_small("most", "--set", f"system.packing_fraction={most}", "production.time=0.1", config=config)
        self.assertEqual(sorted(n for n in os.listdir(self.here) if n.startswith("out")), ["out"])


class BadPaths(Case):
    def test_config(self):
        self.assert_refused(self.hardbody("run", "none.toml"), "none.toml", "No such file", "accepted: a readable file")
        self.assert_refused(self.hardbody("run", self.here), "directory")
        self.assert_refused(self.hardbody("run", "/dev/zero"), "/dev/zero: cannot be read: it is not a file")
        self.assertEqual(os.listdir(self.here), [])

    def test_existing_run_is_kept(self):
        self.run_small("out")
        before = {name: self.bytes_of(f"out/{name}") for name in ["config.toml", "summary.json", "events.csv", "log.txt"]}
        self.assert_refused(self.hardbody("run", "small.toml", "--out", "out"), "out", "--force", "holds a run")
        for name, content in before.items():
            self.assertEqual(self.bytes_of(f"out/{name}"), content, name)
        # A bad config with --force touches nothing either.
        result = self.hardbody("run", "small.toml", "--out", "out", "--force", "--set", "system.number=1")
        self.assert_refused(result, "system.number")
        for name, content in before.items():
            self.assertEqual(self.bytes_of(f"out/{name}"), content, name)

    def test_part_of_a_run_counts(self):
        for name in ["config.toml", "summary.json", "checkpoint.bin"]:
            os.makedirs(self.path("old_" + name))
            self.write(f"old_{name}/{name}", "precious")
            self.write("small.toml", SMALL)
            self.assert_refused(self.hardbody("run", "small.toml", "--out", "old_" + name), "holds a run", name)
            self.assertEqual(self.read(f"old_{name}/{name}"), "precious")

    def test_force_leaves_no_file_of_the_old_run(self):
        self.run_small("out")
        os.makedirs(self.path("out/failures"))
        self.write("out/failures/pair_01.json", "{}")
        self.write("out/notes.txt", "mine")
        self.run_small("out", "--force", "--set", "output.events=0", "--set", "seed=5")
        self.assertEqual(self.summary("out")["seed"], 5)
        self.assertFalse(os.path.exists(self.path("out/events.csv")))
        self.assertEqual(os.listdir(self.path("out/failures")), [])
        self.assertEqual(self.read("out/notes.txt"), "mine")

    def test_force_never_deletes_the_config_of_the_run(self):
        self.write("config.toml", SMALL)
        self.write("summary.json", "old")
        os.makedirs(self.path("linked"))
        os.link(self.path("config.toml"), self.path("linked/log.txt"))
        for out in [".", self.here, "linked"]:
            with self.subTest(out):
                result = self.hardbody("run", "config.toml", "--out", out, "--force")
                self.assert_refused(result, "--force would delete config.toml", "accepted: another directory")
                self.assertEqual(self.read("config.toml"), SMALL)
                self.assertEqual(self.read("summary.json"), "old")

    def test_empty_directory_name(self):
        self.write("small.toml", SMALL)
        self.assert_refused(self.hardbody("run", "small.toml", "--out", ""), "--out is empty", "accepted")
        self.assertEqual(os.listdir(self.here), ["small.toml"])

    def test_directory_with_other_files_is_fine(self):
        os.makedirs(self.path("out"))
        self.write("out/notes.txt", "mine")
        self.run_small("out")
        self.assertEqual(self.read("out/notes.txt"), "mine")

    def test_unusable_directories(self):
        self.write("small.toml", SMALL)
        self.write("file", "precious")
        for out in ["file", "file/below", "/proc/no/such", "/dev/null"]:
            with self.subTest(out):
                self.assert_refused(self.hardbody("run", "small.toml", "--out", out), out)
        self.assertEqual(self.read("file"), "precious")

    @unittest.skipIf(os.geteuid() == 0, "root may write anywhere")
    def test_permissions(self):
        self.write("small.toml", SMALL)
        os.makedirs(self.path("locked"), mode=0o555)
        self.assert_refused(self.hardbody("run", "small.toml", "--out", "locked/out"), "locked/out")
        os.chmod(self.path("small.toml"), 0)
        self.assert_refused(self.hardbody("run", "small.toml", "--out", "out"), "small.toml")


class CommandLine(Case):
    def test_version_and_help(self):
        result = self.hardbody("--version")
        self.assertEqual(result.returncode, 0)
        for part in ["hardbody 0.", "BSD-3-Clause", "Eigen", "MPL-2.0", "built with", "FCL", "libccd", "CGAL"]:
            self.assertIn(part, result.stdout)
        self.assertRegex(result.stdout, "\nreports: (interactive|static, built without npm)\n")
        # A binary with CGAL in it says so where it names its licence.
        licence = re.search("^licence: (.*)$", result.stdout, re.M)[1]
        self.assertEqual("GPL-3.0-or-later" in licence, "CGAL is not built in" not in result.stdout, result.stdout)
        for command in [[], ["init"], ["run"], ["resume"], ["sweep"], ["map"], ["check"], ["analyze"], ["replay"], ["report"], ["distance"]]:
            result = self.hardbody(*command, "--help")
            self.assertEqual(result.returncode, 0)
            self.assertIn("Usage", result.stdout)

    def test_bad_command_lines(self):
        for arguments in [[], ["runn"]]:
            with self.subTest(arguments):
                self.assert_refused(self.hardbody(*arguments), "hardbody --help")
        for arguments in [["run"], ["run", "a.toml", "--frce"], ["run", "a", "b"], ["check"], ["replay"], ["report", "a", "--out", "b"]]:
            with self.subTest(arguments):
                self.assert_refused(self.hardbody(*arguments), f"hardbody {arguments[0]} --help")
        for option in ["--fit-from", "--longest-lag", "--time-step"]:
            for value in ["inf", "nan", "0", "-1", "1e999", "x"]:
                refusal = self.hardbody("analyze", "out", f"{option}={value}")
                self.assert_refused(refusal, f"{option}: {value} is not a positive finite number")


class Signals(Case):
    LONG = SMALL.replace("time = 5", "time = 100000")

    def start(self, config, phase):
        """Starts a run and waits until its log names the phase."""
        self.write("long.toml", config)
        process = subprocess.Popen(
            [HARDBODY, "run", "long.toml", "--out", "out"],
            cwd=self.here,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.addCleanup(process.kill)
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline:
            log = self.path("out/log.txt")
            if os.path.exists(log) and phase in self.read("out/log.txt"):
                return process
            time.sleep(0.02)
        self.fail("the phase never came")

    def test_production(self):
        for number, status in [(signal.SIGTERM, 143), (signal.SIGINT, 130)]:
            with self.subTest(number):
                process = self.start(self.LONG, "production: 100000")
                time.sleep(0.5)
                process.send_signal(number)
                stdout, stderr = process.communicate(timeout=30)
                self.assertEqual(process.returncode, status, stderr)
                self.assertIn(number.name, stderr)
                self.assertIn("stopped", stdout)
                summary = self.summary("out")
                self.assertTrue(summary["interrupted"])
                reached = summary["time"]["production"]
                self.assertTrue(0 < reached < 100000)
                self.assertGreater(summary["observables"]["collision_rate"]["value"], 0)
                self.assertEqual(len(self.read("out/events.csv").splitlines()), 501)
                check = self.hardbody("check", "out")
                self.assertEqual(check.returncode, 0, check.stdout)
                os.rename(self.path("out"), self.path(f"out_{number.name}"))

    def test_equilibration(self):
        process = self.start(SMALL.replace("time = 1\n", "time = 100000\n"), "envelope thickness")
        time.sleep(0.3)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=30)
        self.assertEqual(process.returncode, 143)
        summary = self.summary("out")
        self.assertTrue(summary["interrupted"])
        self.assertEqual(summary["time"]["production"], 0)
        self.assertTrue(all(o["value"] is None for o in summary["observables"].values()))
        self.assertEqual(self.hardbody("check", "out").returncode, 0)

    def test_slowest_finder(self):
        # Some hundred collisions a second: a look at signals must not wait for a fixed number of them, once 20,000.
        slow = (
            self.LONG.replace("number = 64", "number = 512").replace("ratio = 2", "ratio = 3")
            + '[dynamics]\nfinder = "bracketing"\ndistance = "newton8"\nneighbours = "{}"\n'
        )
        endless = slow.replace("time = 1\n", "time = 1000\n")
        for config, neighbours, phase, number, status in [
            (endless, "cells", "equilibration: 1000", signal.SIGTERM, 143),
            (slow.replace("time = 1\n", "time = 0\n"), "cells", "production: 100000", signal.SIGINT, 130),
            (endless, "obp", "finder: bracketing", signal.SIGINT, 130),  # while envelopes are tuned
        ]:
            with self.subTest(phase=phase, neighbours=neighbours):
                process = self.start(config.format(neighbours), phase)
                time.sleep(1)
                process.send_signal(number)
                _, stderr = process.communicate(timeout=120)
                self.assertEqual(process.returncode, status, stderr)
                summary = self.summary("out")
                self.assertTrue(summary["interrupted"])
                self.assertLess(summary["counters"]["collisions"], 20000, phase)
                os.rename(self.path("out"), self.path(f"out_{phase[:5]}_{neighbours}"))

    def test_start(self):
        # Dense spheres: the compression takes a while.
        config = SMALL.replace("number = 64", "number = 4000").replace("0.2", "0.6").replace("ratio = 2", "ratio = 1")
        process = self.start(config, "start: ")
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        _, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.assertIn("nothing was measured", stderr)
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["config.toml", "log.txt"])
        self.assertIn("SIGINT", self.read("out/log.txt"))

    def test_killed(self):
        config = self.LONG.replace("events = 500", 'events = 500\ncheckpoint_every = "0.1s"')
        process = self.start(config, "production: 100000")
        time.sleep(1)
        process.kill()
        process.communicate(timeout=30)
        # No summary, but a sound state of about when it was killed.
        self.assertFalse(os.path.exists(self.path("out/summary.json")))
        check = self.hardbody("check", "out")
        self.assertEqual(check.returncode, 0, check.stdout)
        self.assertIn("of production", check.stdout)


class Check(Case):
    def test_sound(self):
        self.run_small("out")
        result = self.hardbody("check", "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        for part in ["minimum distance", "momentum", "temperature", "packing fraction", "overlaps"]:
            self.assertIn(part, result.stdout)
        # It found the same as the run itself.
        distance = float(re.search(r"minimum distance +([0-9.e+-]+)", result.stdout)[1])
        self.assertAlmostEqual(distance / self.summary("out")["audit"]["minimum_distance"], 1, 4)

    def test_unreadable(self):
        self.assert_refused(self.hardbody("check", "none"), "none")
        os.makedirs(self.path("empty"))
        self.assert_refused(self.hardbody("check", "empty"), "empty/checkpoint.bin", "No such file")
        self.write("file", "x")
        self.assert_refused(self.hardbody("check", "file"), "file")
        self.assert_refused(self.hardbody("check", "run.gsd"), "run.gsd: cannot be read: No such file", "accepted: ")

    def check_bytes(self, content):
        with open(self.path("out/checkpoint.bin"), "wb") as file:
            file.write(content)
        return self.hardbody("check", "out")

    def test_damaged(self):
        self.run_small("out")
        good = self.bytes_of("out/checkpoint.bin")
        self.assertEqual(self.check_bytes(good).returncode, 0)
        for length in [0, 4, 8, 20, 100, len(good) // 2, len(good) - 1]:
            with self.subTest(length=length):
                self.assert_refused(self.check_bytes(good[:length]), "out/checkpoint.bin")
        self.assert_refused(self.check_bytes(good + b"x"), "out/checkpoint.bin")
        for position in [0, 9, 13, 17, 30, 200, len(good) // 2, len(good) - 3]:
            with self.subTest(position=position):
                flipped = bytearray(good)
                flipped[position] ^= 0x10
                self.assert_refused(self.check_bytes(bytes(flipped)), "out/checkpoint.bin")
        self.assert_refused(self.check_bytes(b"x" * len(good)), "not a hardbody checkpoint")
        other_version = bytearray(good)
        other_version[12] = 99
        self.assert_refused(self.check_bytes(bytes(other_version)), "version 99")
        other_order = good[:8] + good[8:12][::-1] + good[12:]
        self.assert_refused(self.check_bytes(other_order), "byte order")


def body(position, velocity=(0, 0, 0), omega=(0, 0, 0), **more):
    return {
        "shape": {"kind": "ellipsoid", "semi_axes": [1, 1, 2]},
        "position": list(position),
        "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        "velocity": list(velocity),
        "angular_velocity": list(omega),
        "inertia": [1, 1, 0.4],
        "time": 3.5,
        **more,
    }


class Replay(Case):
    def pair(self, **changes):
        return {
            "format": "hardbody pair",
            "reason": "made by hand",
            "time": 3.5,
            "i": 4,
            "j": 7,
            "a": body([0, 0, 0]),
            "b": body([3, 0, 0], [-1, 0, 0]),
            **changes,
        }

    def replay(self, content):
        self.write("pair.json", content if isinstance(content, str) else json.dumps(content))
        return self.hardbody("replay", "pair.json")

    def test_hit(self):
        result = self.replay(self.pair())
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("made by hand", result.stdout)
        self.assertRegex(result.stdout, r"distance at that time: 1 \(separated")
        self.assertIn("hit", result.stdout)
        self.assertRegex(result.stdout, r"they touch after (1|0\.99999999\d+|1\.00000000\d+)\n")
        course = result.stdout.split("step 3")[1]
        self.assertEqual(len(re.findall(r"^ +\S+ +\S+ +\S+  (?:separated|overlapping|not_converged)", course, re.M)), 21)

    def test_separated_and_overlapping(self):
        away = self.replay(self.pair(b=body([3, 0, 0], [1, 0, 0])))
        self.assertEqual(away.returncode, 0)
        self.assertIn("separated", away.stdout)
        inside = self.replay(self.pair(b=body([1.9, 0, 0], [-1, 0, 0], [0, 1, 0])))
        self.assertEqual(inside.returncode, 0)
        self.assertIn("overlapping", inside.stdout)

    def test_superellipsoids(self):
        brick = {"kind": "superellipsoid", "semi_axes": [1, 2, 1], "exponents": [0.25, 0.25]}
        ball = {"kind": "ellipsoid", "semi_axes": [1, 1.5, 1]}
        pair = self.pair(a={**body([0, 0, 0]), "shape": brick}, b={**body([3, 0, 0], [-1, 0, 0]), "shape": ball})
        result = self.replay(pair)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("superellipsoid, semi-axes (1, 2, 1), exponents (0.25, 0.25)", result.stdout)
        self.assertRegex(result.stdout, r"distance at that time: (1|0\.9{14}\d*|1\.0{14}\d*) \(separated")
        self.assertRegex(result.stdout, r"they touch after (1|0\.99999999\d+|1\.00000000\d+)\n")
        self.assertEqual(result.stdout.count("newton8 from the"), 2)
        # Without its own: the inertia of uniform density.
        del pair["a"]["inertia"]
        self.assertEqual(self.replay(pair).returncode, 0)
        for exponents, *parts in [([0.25], "a.shape.exponents"), ([0.1, 1], "a.shape.exponents", "0.2 to 1.6")]:
            wrong = {**pair, "a": {**pair["a"], "shape": {**brick, "exponents": exponents}}}
            self.assert_refused(self.replay(wrong), "pair.json: ", *parts)
        # Distances have a wider range than motion.
        wrong = {**pair, "a": {**pair["a"], "shape": {**brick, "exponents": [0.2, 1]}}}
        self.assert_refused(self.replay(wrong), "pair.json: ", "0.25 to 1.6")

    # Bodies with a face point inside as seed: a call that fails.
    NEWTON = {
        "method": "newton5",
        "status": "not_converged",
        "point_a": [1, 0, 0],
        "point_b": [2, 0, 0],
        "a": {key: body([0, 0, 0])[key] for key in ["shape", "position", "rotation"]},
        "b": {key: body([3, 0, 0])[key] for key in ["shape", "position", "rotation"]},
    }

    def test_repeats_the_call_that_failed(self):
        result = self.replay(self.pair(eps_d=1e-4, newton=self.NEWTON))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(
            result.stdout,
            r"the call that failed, newton5 from \(1, 0, 0\) and \(2, 0, 0\): (?:1|0\.9{15}\d*) \(separated, \d+ iterations; in the run: not_c",
        )
        self.assertIn("by bracketing, eps_d = 0.0001: hit", result.stdout)
        none = self.replay(self.pair(newton={**self.NEWTON, "point_a": None, "point_b": None}))
        self.assertIn("newton5 from no points: no answer (not_converged, 0 iterations", none.stdout)

    def test_extreme_pairs(self):
        # Newton's seeds do not reach the surface here; each method says so by its status.
        for axes, x in [
            ([1e-2, 1e-2, 1e2], 1e-6), ([1, 1, 1e-4], 1e-9), ([1e50, 1e50, 1e49], 1e60), ([1, 1, 2], 0),
            ([1, 1, 2], 1e16), ([1, 1, 2], 1e100),
        ]:
            with self.subTest(axes=axes, x=x):
                shape = {"kind": "ellipsoid", "semi_axes": axes}
                at_rest = {"orientation": [1, 0, 0, 0], "shape": shape}
                pair = {
                    "format": "hardbody pair",
                    "a": {**at_rest, "position": [0, 0, 0]},
                    "b": {**at_rest, "position": [x, 0.3 * x, 0.2 * x]},
                }
                result = self.replay(pair)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertEqual(result.stdout.count("newton8 from the"), 2)

    def test_least_that_is_needed(self):
        shape = {"kind": "ellipsoid", "semi_axes": [1, 1, 2]}
        a = {"shape": shape, "position": [0, 0, 0], "orientation": [1, 0, 0, 0]}
        b = {"shape": shape, "position": [0, 0, 5], "orientation": [0, 1, 0, 0]}
        result = self.replay({"format": "hardbody pair", "a": a, "b": b})
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"distance at that time: 1 \(separated")

    def test_bad_files(self):
        self.assert_refused(self.hardbody("replay", "none.json"), "none.json", "accepted: a readable file")
        self.assert_refused(self.replay("{\n\n]"), "pair.json:3: ", "JSON")
        self.assert_refused(self.replay("[]"), "format")
        self.assert_refused(self.replay("{}"), "format")
        self.assert_refused(self.replay('{"format": "hardbody pair", "time": 1e999}'), "pair.json", "range of a double")
        self.assert_refused(self.replay('{"format": 1, "format": 2}'), "pair.json", '"format" twice')
        self.assert_refused(self.replay("[" * 100000), "pair.json", "nested")
        without = self.pair()
        del without["b"]
        self.assert_refused(self.replay(without), "b is missing")
        cases = [
            ({"format": "other"}, "format"),
            ({"b": 3}, "b.shape"),
            ({"b": body([0, 0])}, "b.position"),
            ({"b": body([0, 0, "x"])}, "b.position"),
            ({"b": body([3, 0, 0], [None, 0, 0])}, "b.velocity"),
            ({"b": body([3, 0, 0], rotation=[[1, 0, 0], [0, 1, 0]])}, "b.rotation"),
            ({"b": body([3, 0, 0], rotation=[[1, 0, 0], [0, 1, 0], [0, 0, 2]])}, "b.rotation"),
            ({"b": body([3, 0, 0], orientation=[1, 1, 0, 0])}, "b.orientation"),
            ({"b": body([3, 0, 0], shape={"kind": "brick", "semi_axes": [1, 1, 1]})}, "b.shape.kind"),
            ({"b": body([3, 0, 0], shape={"semi_axes": [1, 1, -1]})}, "b.shape.semi_axes"),
            ({"b": body([3, 0, 0], inertia=[1, 1, 5])}, "pair.json"),
            ({"b": body([3, 0, 0], time="now")}, "b.time"),
            ({"i": -1}, "i is -1"),
            ({"eps_d": 0}, "eps_d"),
            ({"newton": {**self.NEWTON, "method": "newton9"}}, "newton.method", "newton8"),
            ({"newton": {**self.NEWTON, "status": "bad"}}, "newton.status"),
            ({"newton": {**self.NEWTON, "point_a": None}}, "newton.point_a"),
            ({"newton": {**self.NEWTON, "b": 1}}, "newton.b"),
        ]
        for change, *parts in cases:
            with self.subTest(change):
                self.assert_refused(self.replay(self.pair(**change)), *parts)


def placed(semi_axes, position, orientation=None):
    """A body of a query."""
    more = {} if orientation is None else {"orientation": orientation}
    return {"shape": {"kind": "ellipsoid", "semi_axes": semi_axes}, "position": position, **more}


def turned(angle, axis):
    """The quaternion w, x, y, z of a turn about an axis (any length)."""
    length = math.hypot(*axis)
    return [math.cos(angle / 2)] + [math.sin(angle / 2) * x / length for x in axis]


class Distance(Case):
    NEEDLE = placed([1, 1, 3], [0, 0, 0])
    README_PAIR = {"a": NEEDLE, "b": placed([2, 2, 0.5], [4, 0, 2.4])}
    METHODS = ["newton8", "newton5"]
    SEEDS = ["dual", "centres", "fcl", "ccd", "cgal"]

    def distance(self, text, *arguments):
        """The process that has read `text` on stdin."""
        text = text if isinstance(text, bytes) else text.encode()
        result = subprocess.run([HARDBODY, "distance", *arguments], cwd=self.here, input=text, capture_output=True, timeout=120)
        result.stdout = result.stdout.decode()
        result.stderr = result.stderr.decode()
        return result

    def parse(self, stdout):
        def refuse(constant):
            raise ValueError(f"{constant} in {stdout}")

        return [json.loads(line, parse_constant=refuse) for line in stdout.splitlines()]

    def answers(self, *queries):
        """Of good lines."""
        result = self.distance("".join(json.dumps(q) + "\n" for q in queries))
        self.assertEqual((result.returncode, result.stderr), (0, ""), result.stdout)
        answers = self.parse(result.stdout)
        self.assertEqual(len(answers), len(queries))
        return answers

    def built_in(self, seed):
        result = self.distance(json.dumps({**self.README_PAIR, "method": "newton8", "seed": seed}))
        if result.returncode == 0:
            return True
        error = self.parse(result.stdout)[0]["error"]
        self.assertIn(f'line 1: seed "{seed}" is not built in', error)
        self.assertIn('accepted: "dual", "centres"', error)
        return False

    def assert_consistent(self, answer):
        """point_b - point_a = distance * normal, of length 1."""
        self.assertAlmostEqual(math.hypot(*answer["normal"]), 1, 14)
        for a, b, n in zip(answer["point_a"], answer["point_b"], answer["normal"]):
            self.assertAlmostEqual(b - a, answer["distance"] * n, 14)

    def assert_declined(self, answer):
        for key in ["distance", "point_a", "point_b", "normal"]:
            self.assertIsNone(answer[key])
        self.assertIn(answer["status"], ["not_converged", "singular"])
        self.assertIsInstance(answer["iterations"], int)

    def test_known_answers(self):
        quarter = turned(math.pi / 2, [1, 0, 0])  # body z goes to world -y
        cases = [
            (placed([1, 1, 1], [1, 2, 3]), placed([2, 2, 2], [1, 2, 9]), 3, [0, 0, 1], [1, 2, 4]),
            (placed([1, 1, 1], [0, 0, 0]), placed([2, 2, 2], [-1.5, 2, 0]), -0.5, [-0.6, 0.8, 0], [-0.6, 0.8, 0]),
            (self.NEEDLE, placed([2, 2, 0.5], [0, 0, 5]), 1.5, [0, 0, 1], [0, 0, 3]),
            (self.NEEDLE, placed([2, 3, 0.5], [-7, 0, 0]), 4, [-1, 0, 0], [-1, 0, 0]),
            (self.NEEDLE, placed([0.5, 2, 3], [0, 6, 0]), 3, [0, 1, 0], [0, 1, 0]),
            (placed([1, 1, 3], [0, 0, 0], quarter), placed([1, 1, 1], [0, 5, 0]), 1, [0, 1, 0], [0, 3, 0]),
            (placed([1, 1, 3], [0, 0, 0], [-q for q in quarter]), placed([1, 1, 1], [0, 0, 5]), 3, [0, 0, 1], [0, 0, 1]),
        ]
        for (a, b, distance, normal, point_a), answer in zip(cases, self.answers(*({"a": c[0], "b": c[1]} for c in cases))):
            self.assertEqual(list(answer), ["distance", "point_a", "point_b", "normal", "status", "iterations", "error_bound"])
            self.assertLess(answer["error_bound"], 1e-12)
            self.assertAlmostEqual(answer["distance"], distance, 14)
            self.assertEqual(answer["status"], "separated" if distance > 0 else "overlapping")
            for k in range(3):
                self.assertAlmostEqual(answer["normal"][k], normal[k], 14)
                self.assertAlmostEqual(answer["point_a"][k], point_a[k], 14)
            self.assert_consistent(answer)

    def test_default_orientation(self):
        spelt = {"a": {**self.NEEDLE, "orientation": [1, 0, 0, 0]}, "b": self.README_PAIR["b"], "method": "dual", "seed": "dual"}
        short, full = self.answers(self.README_PAIR, spelt)
        self.assertEqual(short, full)

    def test_example_of_the_documentation(self):
        with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "docs", "distance.md")) as page:
            example = re.search(r"^\$ pair='(.*)'\n\$ echo \"\$pair\" \| hardbody distance\n(.*)$", page.read(), re.M)
        self.assertEqual(json.loads(example[1])["b"]["position"], [4, 0, 2.4])
        answer, printed = self.answers(json.loads(example[1]))[0], json.loads(example[2])
        self.assertEqual(list(answer), list(printed))
        self.assertEqual(answer["status"], printed["status"])
        self.assertAlmostEqual(answer["distance"], printed["distance"], 14)
        self.assert_consistent(answer)
        # The normals of both surfaces where they are closest.
        for body, point, sign in [("a", "point_a", 1), ("b", "point_b", -1)]:
            body = json.loads(example[1])[body]
            x = [p - c for p, c in zip(answer[point], body["position"])]
            axes = body["shape"]["semi_axes"]
            self.assertAlmostEqual(sum((u / s) ** 2 for u, s in zip(x, axes)), 1, 13)
            gradient = [u / s**2 for u, s in zip(x, axes)]
            for g, n in zip(gradient, answer["normal"]):
                self.assertAlmostEqual(g / math.hypot(*gradient), sign * n, 12)

    def test_every_method_and_seed_agrees(self):
        pairs = [
            self.README_PAIR,
            {"a": placed([1, 1, 3], [0, 0, 0], turned(0.7, [1, 2, 3])), "b": placed([1, 1, 3], [4, 3, -1], turned(2, [1, 0, -1]))},
            {"a": placed([1, 2, 3], [5, 5, 5], turned(1.1, [0, 1, 1])), "b": placed([0.5, 1.5, 1], [8, 9, 4], turned(0.3, [3, 1, 1]))},
            {"a": placed([1, 1, 1], [0, 0, 0]), "b": placed([1, 1, 1], [0, 3, 4])},
        ]
        queries = [
            {**pair, "method": method, "seed": seed}
            for pair in pairs
            for seed in self.SEEDS
            if self.built_in(seed)
            for method in self.METHODS
        ]
        dual = self.answers(*pairs)
        per_pair = len(queries) // len(pairs)
        for k, answer in enumerate(self.answers(*queries)):
            with self.subTest(queries[k]):
                self.assertEqual(answer["status"], "separated")
                self.assertLess(abs(answer["distance"] - dual[k // per_pair]["distance"]), 1e-12)
                self.assert_consistent(answer)
        # The seed that nobody names is the dual's.
        newton, named = self.answers({**pairs[1], "method": "newton8"}, {**pairs[1], "method": "newton8", "seed": "dual"})
        self.assertEqual(newton, named)

    def test_superellipsoids(self):
        barr = lambda axes, exponents, position, *turn: {
            **placed(axes, position, *turn),
            "shape": {"kind": "superellipsoid", "semi_axes": axes, "exponents": exponents},
        }
        diagonal = 3**-0.5
        brick = barr([1, 1, 1], [0.5, 0.5], [0, 0, 0])
        reach = 3**0.25  # of the brick along (1,1,1): x^4 + y^4 + z^4 = 1 at the length 3^(1/4)
        pairs = [
            ({"a": brick, "b": placed([1, 1, 1], [0, 0, 3])}, 1),
            ({"a": brick, "b": barr([1, 2, 3], [0.3, 1.2], [4, 0, 0])}, 2),
            ({"a": placed([0.5, 0.5, 0.5], [3 * diagonal] * 3), "b": brick}, 3 - 0.5 - reach),
            ({"a": barr([1, 2, 3], [1, 1], [0, 0, 0], turned(0.7, [1, 2, 3])), "b": brick | {"position": [4, 3, -2]}}, None),
            ({"a": placed([1, 2, 3], [0, 0, 0], turned(0.7, [1, 2, 3])), "b": brick | {"position": [4, 3, -2]}}, None),
        ]
        dual = self.answers(*(pair for pair, _ in pairs))
        self.assertAlmostEqual(dual[3]["distance"], dual[4]["distance"], 12)
        seeds = [seed for seed in self.SEEDS if self.built_in(seed)]
        ways = [{"method": method, "seed": seed} for method in self.METHODS for seed in seeds]
        answers = self.answers(*({**pair, **way} for pair, _ in pairs for way in ways))
        for k, (_, distance) in enumerate(pairs):
            of_pair = [dual[k], *answers[k * len(ways) : (k + 1) * len(ways)]]
            for answer in of_pair:
                if answer["distance"] is None:
                    self.assert_declined(answer)  # a seed too crude
                    continue
                self.assertEqual(answer["status"], "separated")
                self.assertAlmostEqual(answer["distance"], dual[k]["distance"], 12)
                self.assertLess(answer["error_bound"], 1e-11)
                self.assert_consistent(answer)
            self.assertEqual(dual[k]["status"], "separated")
            if distance is not None:
                self.assertAlmostEqual(dual[k]["distance"], distance, 13)
            self.assertGreaterEqual(sum(answer["distance"] is not None for answer in of_pair), 0.9 * len(of_pair))

    def test_penetration(self):
        deep = {"a": self.NEEDLE, "b": placed([2, 2, 0.5], [0, 0, 0.1])}
        best, named, local = self.answers(deep, {**deep, "penetration": "global"}, {**deep, "penetration": "local"})
        self.assertEqual(best, named)
        for answer in [best, local]:
            self.assertEqual(answer["status"], "overlapping")
            self.assert_consistent(answer)
        self.assertLess(best["error_bound"], 1e-3 * 10)
        self.assertTrue(local["error_bound"] is None or local["error_bound"] >= 0)
        self.assertLessEqual(local["distance"], best["distance"] + best["error_bound"])

    def test_both_readers(self):
        # An escape in the id, and the line goes to the slower reader; the answer is the same.
        for more in [{}, {"method": "newton5"}, {"method": "newton8", "seed": "centres"}, {"penetration": "local"}]:
            fast, slow = self.answers({**self.README_PAIR, **more, "id": "x"}, {**self.README_PAIR, **more, "id": "\n"})
            self.assertEqual({**fast, "id": "\n"}, slow)
        pretty = json.dumps(self.README_PAIR, indent=1).replace("\n", "\t ")
        self.assertEqual(self.parse(self.distance(pretty).stdout), self.answers(self.README_PAIR))

    def test_shallow_overlap(self):
        pair = {"a": self.NEEDLE, "b": placed([1, 1, 3], [1.9, 0, 0])}
        for answer in self.answers(pair, {**pair, "method": "newton8"}, {**pair, "method": "newton5"}):
            self.assertEqual(answer["status"], "overlapping")
            self.assertAlmostEqual(answer["distance"], -0.1, 13)
            self.assert_consistent(answer)

    def test_declined(self):
        deep = {"a": placed([1, 1, 3], [0, 0, 0]), "b": placed([2, 2, 0.5], [0, 0, 0.1])}
        same = {"a": self.NEEDLE, "b": self.NEEDLE}
        answers = self.answers({**deep, "method": "newton8"}, {**same, "method": "newton5", "seed": "centres"})
        for answer in answers:
            self.assert_declined(answer)
        self.assertNotIn("seed_status", answers[0])  # the dual has points; so deep no solution is certified
        self.assertEqual(answers[1]["seed_status"], "declined")
        # FCL and CGAL have no points for bodies that overlap.
        for seed in ["fcl", "cgal"]:
            if self.built_in(seed):
                answer = self.answers({**deep, "method": "newton8", "seed": seed})[0]
                self.assert_declined(answer)
                self.assertEqual((answer["status"], answer["seed_status"]), ("not_converged", "overlapping"))

    def test_extreme_bodies(self):
        # Whatever a seed makes of them, there is an answer or none.
        pairs = [
            {"a": placed([s, s, s], [0, 0, 0]), "b": placed([t, 1e3 * t, 1e4 * t], [x, x / 3, 0], turned(1, [1, 2, 3]))}
            for s, t, x in [(1, 1, 1e100), (1e-50, 1e46, 1e49), (1e50, 1e46, 1e99), (1, 1e-4, 1), (1e-9, 1e-9, 1e-30), (1, 1, 0)]
        ]
        methods = [{"method": m, "seed": s} for s in self.SEEDS if self.built_in(s) for m in self.METHODS]
        for answer in self.answers(*({**pair, **method} for pair in pairs for method in [{}, *methods])):
            if answer["distance"] is None:
                self.assert_declined(answer)
            else:
                self.assertIn(answer["status"], ["separated", "overlapping"])

    def bad(self, change=(), a=None, shape=None):
        """The pair of the README with something else in it, as a line."""
        body = {**self.NEEDLE, **(a or {}), "shape": {**self.NEEDLE["shape"], **(shape or {})}}
        return json.dumps({**self.README_PAIR, "a": body, **dict(change)})

    def test_bad_lines(self):
        flat = lambda text: self.bad().replace("[0, 0, 0]", text, 1)
        cases = [
            ("{", "not valid JSON", "column"),
            ("not JSON at all", "not valid JSON", "column 2"),
            (self.bad() + self.bad(), "not valid JSON"),
            ("\x00", "not valid JSON"),
            (b'{"id": "\xff"}', "not valid JSON"),
            (flat("[0, 0, NaN]"), "not valid JSON", "finite"),
            (flat("[0, 0, -Infinity]"), "not valid JSON", "finite"),
            (flat("[0, 0, 1e999]"), "range of a double"),
            ("[" * 100000, "nested"),
            ('{"id":' * 1000 + "1" + "}" * 1000, "nested"),
            (self.bad().replace('"b":', '"a":'), '"a" twice'),
            ("17", "is 17", "an object with a, b, method, seed, penetration, id"),
            ("null", "is null"),
            ("{}", "a is missing"),
            (json.dumps({"a": self.NEEDLE}), "b is missing"),
            (self.bad({"b": 3}), "b is 3", "shape, position, orientation"),
            (self.bad({"b": {"position": [0, 0, 0]}}), "b.shape is missing"),
            (self.bad({"methd": "dual"}), "unknown key methd, did you mean method?"),
            (self.bad({"velocity": 1}), "unknown key velocity;"),
            (self.bad(a={"positon": [0, 0, 0]}), "unknown key a.positon, did you mean a.position?"),
            (self.bad(a={"orientaton": [1, 0, 0, 0]}), "unknown key a.orientaton, did you mean a.orientation?"),
            (self.bad(shape={"semi_axis": 1}), "unknown key a.shape.semi_axis, did you mean a.shape.semi_axes?"),
            (self.bad(shape={"exponents": [1, 1]}), "unknown key a.shape.exponents"),
            (self.bad({"method": "newton6"}), 'method is "newton6"', '"dual", "newton8", "newton5"'),
            (self.bad({"method": 8}), "method is 8"),
            (self.bad({"seed": "gjk", "method": "newton8"}), 'seed is "gjk"', '"centres"'),
            (self.bad({"seed": None}), "seed is null"),
            (self.bad({"seed": "centres"}), 'seed is "centres"', "newton8"),
            (self.bad({"seed": "centres", "method": "dual"}), 'seed is "centres"', "newton8"),
            (self.bad(a={"position": [0, 0]}), "a.position is [0,0]", "three finite numbers"),
            (self.bad(a={"position": [0, 0, "1"]}), "a.position is", "three finite numbers"),
            (self.bad(a={"position": [0, 0, True]}), "a.position is [0,0,true]"),
            (self.bad(a={"position": None}), "a.position is null"),
            (self.bad(a={"position": [0, 0, 1e101]}), "a.position is [0,0,1e+101]", "too far", "none beyond +-1e100"),
            (self.bad(a={"position": [0, -1e300, 0], "orientation": [1, 0, 0, 0]}), "a.position is", "none beyond +-1e100"),
            (self.bad(a={"position": {"x": 1}}), "a.position is"),
            (self.bad(a={"orientation": [1, 1, 0, 0]}), "a.orientation is [1,1,0,0]", "length 1", "1 within 0.001"),
            (self.bad(a={"orientation": [1 + 1.1e-3, 0, 0, 0]}), "a.orientation is"),
            (self.bad(a={"orientation": [0, 0, 0, 0]}), "a.orientation is"),
            (self.bad(a={"orientation": [1, 0, 0]}), "a.orientation is [1,0,0]", "unit quaternion"),
            (self.bad(a={"shape": "sphere"}).replace("}}", "}"), "not valid JSON"),
            (json.dumps({"a": {"shape": "sphere", "position": [0, 0, 0]}}), 'a.shape is "sphere"', '"ellipsoid"'),
            (self.bad(shape={"kind": "pyramid"}), 'a.shape.kind is "pyramid"', '"ellipsoid"'),
            (self.bad(shape={"kind": "superellipsoid"}), "a.shape.exponents is missing", "two numbers [e1, e2]"),
            (self.bad(shape={"kind": "superellipsoid", "exponents": [1]}), "a.shape.exponents is [1]", "two numbers"),
            (self.bad(shape={"kind": "superellipsoid", "exponents": [1, 0.1]}), "a.shape.exponents is [1,0.1]", "0.2 to 1.6"),
            (self.bad(shape={"kind": "superellipsoid", "exponents": [1, 1], "semi_axes": [1, 0, 1]}), "a.shape.semi_axes is [1,0,1]"),
            (self.bad(shape={"kind": "superellipsoid", "exponent": 1}), "did you mean a.shape.exponents?"),
            (self.bad({"penetration": "deep"}), 'penetration is "deep"', '"global", "local"'),
            (self.bad({"penetration": "local", "method": "newton8"}), "penetration is for the method"),
            (self.bad({"method": ""}), 'method is ""'),
            (self.bad().replace("1, 1, 3", "1, 1, 03"), "not valid JSON"),
            (self.bad().replace("1, 1, 3", "1, 1, +3"), "not valid JSON"),
            (self.bad().replace("1, 1, 3", "1, 1, 3."), "not valid JSON"),
            (self.bad().replace("1, 1, 3", "1, 1, 3,"), "not valid JSON"),
            (self.bad() + "x", "not valid JSON"),
            (json.dumps({"a": {"shape": {"semi_axes": [1, 1, 1]}, "position": [0, 0, 0]}}), "a.shape.kind is missing"),
            (json.dumps({"a": {"shape": {"kind": "ellipsoid"}, "position": [0, 0, 0]}}), "a.shape.semi_axes is missing"),
            (self.bad(shape={"semi_axes": [1, 1]}), "a.shape.semi_axes is [1,1]"),
            (self.bad(shape={"semi_axes": [1, -1, 1]}), "a.shape.semi_axes is [1,-1,1]", "semi-axis y is -1"),
            (self.bad(shape={"semi_axes": [1, 0, 1]}), "a.shape.semi_axes is [1,0,1]"),
            (self.bad(shape={"semi_axes": [1, 1, 1e60]}), "a.shape.semi_axes is"),
            (self.bad(shape={"semi_axes": [1, 1, 20000]}), "a.shape.semi_axes is [1,1,20000]", "ratio", "10000"),
            (self.bad(shape={"semi_axes": "1,1,1"}), "a.shape.semi_axes is"),
            (self.bad({"\u00e9" * 500: 1}), "unknown key"),
        ]
        good = json.dumps(self.README_PAIR).encode()
        lines = [good]
        for line, *_ in cases:
            lines += [line if isinstance(line, bytes) else line.encode(), good]
        result = self.distance(b"\n".join(lines))
        self.assertEqual((result.returncode, result.stderr), (2, ""))
        replies = self.parse(result.stdout)
        self.assertEqual(len(replies), len(lines))
        for number, reply in enumerate(replies, 1):
            if number % 2 == 1:
                self.assertEqual(reply, replies[0])
                continue
            line, *parts = cases[number // 2 - 1]
            with self.subTest(line[:100]):
                self.assertEqual(list(reply), ["error"])
                self.assertTrue(reply["error"].startswith(f"line {number}: "), reply)
                self.assertLess(len(reply["error"]), 500)
                for part in ["; accepted: ", *parts]:
                    self.assertIn(part, reply["error"])

    def test_orientation_within_tolerance(self):
        query = {**self.README_PAIR, "a": {**self.NEEDLE, "orientation": [1 + 5e-7, 0, 0, 0]}}
        self.assertEqual(*self.answers(self.README_PAIR, query))

    def test_id_is_echoed(self):
        ids = [7, -1.5, "text", "\u00e9 \"\n\\", "", None, True, [], [1, [2, {}]], {"k": [None], "a": ""}, 2**63, 1e300]
        for identity, answer in zip(ids, self.answers(*({**self.README_PAIR, "id": i} for i in ids))):
            self.assertEqual((answer["id"], type(answer["id"])), (identity, type(identity)))
            self.assertEqual(answer["status"], "separated")
        result = self.distance("".join(json.dumps({"id": i, "b": 3}) + "\n" for i in ids))
        self.assertEqual(result.returncode, 2)
        self.assertEqual([(r["id"], "error" in r) for r in self.parse(result.stdout)], [(i, True) for i in ids])

    def test_as_many_digits_as_it_takes(self):
        query = json.dumps({**self.README_PAIR, "a": placed([1, 1, 1], [0, 0, 0]), "b": placed([1, 1, 1], [0.1, 0, 2.3])})
        text = self.distance(query).stdout
        numbers = re.findall(r"-?\d+\.\d+(?:e-?\d+)?", text)
        self.assertTrue(numbers)
        for number in numbers:
            self.assertLessEqual(len(number), len(repr(float(number))))
        self.assertGreaterEqual(max(len(number.lstrip("-0.").split("e")[0]) for number in numbers), 17)  # with its point
        # As good as the digits: 2 and a rounding error from the exact square root.
        self.assertAlmostEqual(self.parse(text)[0]["distance"], math.hypot(0.1, 2.3) - 2, 15)

    def test_file_and_stdin(self):
        text = json.dumps(self.README_PAIR) + "\n" + json.dumps({"id": 2}) + "\n"
        self.write("pairs.jsonl", text)
        results = [self.distance("", "pairs.jsonl"), self.distance(text, "-"), self.distance(text)]
        for result in results:
            self.assertEqual((result.returncode, result.stderr), (2, ""))
            self.assertEqual(result.stdout, results[0].stdout)
        self.assertEqual(len(self.parse(results[0].stdout)), 2)

    def test_blank_lines_and_line_ends(self):
        line = json.dumps(self.README_PAIR)
        result = self.distance(f"\n{line}\r\n  \t\n\r\n{line}\n\n3\n{line}")
        replies = self.parse(result.stdout)
        self.assertEqual([r.get("status") for r in replies], ["separated", "separated", None, "separated"])
        self.assertTrue(replies[2]["error"].startswith("line 7: "))
        for nothing in ["", "\n", " \n\n "]:
            result = self.distance(nothing)
            self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def test_long_lines(self):
        line = json.dumps(self.README_PAIR)
        longest = line + " " * (2**20 - len(line))
        result = self.distance("\n".join([longest, longest + " ", line, "x" * 5_000_000, line, " " * 2**21]))
        self.assertEqual(result.returncode, 2)
        replies = self.parse(result.stdout)
        self.assertEqual(["error" in r for r in replies], [False, True, False, True, False, True])
        self.assertIn("line 4: is too long", replies[3]["error"])

    def test_unreadable(self):
        self.assert_refused(self.hardbody("distance", "none.jsonl"), "none.jsonl", "No such file", "accepted")
        self.assert_refused(self.hardbody("distance", "."), "directory", "accepted")
        closed = subprocess.run(f"{HARDBODY} distance <&-", shell=True, capture_output=True, text=True, timeout=60)
        self.assert_refused(closed, "standard input")
        self.assert_refused(self.hardbody("distance", "one", "two"), "hardbody distance --help")

    @contextlib.contextmanager
    def started(self, stdout=subprocess.PIPE, **more):
        """A process that reads a pipe; killed after a minute, so that an answer kept back is not waited for."""
        with subprocess.Popen(
            [HARDBODY, "distance"], stdin=subprocess.PIPE, stdout=stdout, stderr=subprocess.PIPE, text=True, **more
        ) as process:
            timer = threading.Timer(60, process.kill)
            timer.start()
            try:
                yield process
            finally:
                process.kill()
                timer.cancel()

    def test_talks_line_by_line(self):
        with self.started() as process:
            for k in range(5):
                # In two pieces, as a pipe may deliver it.
                text = json.dumps({**self.README_PAIR, "id": k}) + "\n"
                for piece in [text[:20], text[20:]]:
                    process.stdin.write(piece)
                    process.stdin.flush()
                self.assertEqual(json.loads(process.stdout.readline())["id"], k)
            process.stdin.close()
            self.assertEqual(process.wait(), 0)

    def status_after_feeding(self, process):
        """Lines for ever: the program has to end by itself."""
        line = json.dumps(self.README_PAIR) + "\n"
        with self.assertRaises(BrokenPipeError):
            for _ in range(1_000_000):
                process.stdin.write(line)
        with contextlib.suppress(BrokenPipeError):
            process.stdin.close()
        return process.wait()

    def test_nobody_reads_the_answers(self):
        for ignored, status in [(False, -signal.SIGPIPE), (True, 1)]:
            # Python ignores SIGPIPE itself; restored: the default action.
            with self.subTest(ignored=ignored), self.started(restore_signals=not ignored) as process:
                process.stdout.close()
                self.assertEqual(self.status_after_feeding(process), status)
                self.assertEqual(process.stderr.read().count("\n"), 1 if ignored else 0)

    @unittest.skipUnless(os.path.exists("/dev/full"), "no /dev/full")
    def test_full_disk(self):
        with open("/dev/full", "w") as full, self.started(stdout=full) as process:
            self.assertEqual(self.status_after_feeding(process), 1)
            self.assertIn("standard output: cannot be written: No space left", process.stderr.read())
        # From a file the answers are written later, and still not lost in silence.
        self.write("pair.jsonl", json.dumps(self.README_PAIR))
        result = subprocess.run(
            f"{HARDBODY} distance pair.jsonl >/dev/full", shell=True, cwd=self.here, capture_output=True, text=True, timeout=60
        )
        self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 1))

    def test_ten_thousand_lines(self):
        pair = lambda k: {
            "a": placed([1, 1, 3], [0, 0, 0], turned(k, [1, 2, 3])),
            "b": placed([1, 2, 0.5], [6, math.sin(k), 0], turned(k, [3, -1, 0])),
        }
        answers = self.answers(*({**pair(k), "id": k} for k in range(10_000)))
        self.assertEqual([a["id"] for a in answers], list(range(10_000)))
        self.assertEqual({a["status"] for a in answers}, {"separated"})


if __name__ == "__main__":
    sys.exit(0 if unittest.main(exit=False, verbosity=1).result.wasSuccessful() else 1)
