"""The program from outside: exit statuses, files, messages.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_cli.py [TestClass[.test]]
"""

import csv
import json
import math
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

HARDBODY = os.path.abspath(os.environ.get("HARDBODY", "build/release/apps/hardbody/hardbody"))
DEMO = os.environ.get(
    "HARDBODY_DEMO", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "apps", "demo.toml")
)

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
    "rotational_msd.csv": [
        "t [l sqrt(m/kT)]",
        "rot_msd [rad^2]",
        "rot_msd_error [rad^2]",
        "rot_msd_body [rad^2]",
        "rot_msd_body_error [rad^2]",
    ],
    "c2.csv": ["t [l sqrt(m/kT)]", "c2 [1]", "c2_error [1]"],
    "blocks.csv": [
        "begin [l sqrt(m/kT)]",
        "end [l sqrt(m/kT)]",
        "collision_rate [sqrt(kT/m)/l]",
        "Z [1]",
        "kT_trans [kT]",
        "kT_rot [kT]",
        "S [1]",
    ],
}

OBSERVABLES = [
    "collision_rate",
    "Z",
    "D_trans",
    "D_rot",
    "D_rot_body",
    "S",
    "tau_C2",
    "beta_C2",
    "t_C2_1overe",
    "kT_trans",
    "kT_rot",
]


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

    def hardbody(self, *arguments, timeout=120):
        return subprocess.run(
            [HARDBODY, *arguments], cwd=self.here, capture_output=True, text=True, timeout=timeout, stdin=subprocess.DEVNULL
        )

    def run_small(self, out, *arguments, config=SMALL):
        self.write("small.toml", config)
        result = self.hardbody("run", "small.toml", "--out", out, *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
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
            self.assertEqual(sorted(summary["observables"][key]), ["error", "value"], key)
        # Far too short for the diffusion: null, not a number made up.
        self.assertIsNone(summary["observables"]["D_trans"]["value"])
        self.assertFalse(summary["interrupted"])
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

    def test_same_seed_same_numbers(self):
        self.run_small("one")
        self.run_small("two")
        self.run_small("three", "--set", "seed=4")
        for name in ["events.csv", "checkpoint.bin", "config.toml"] + [f"observables/{f}" for f in OBSERVABLE_FILES]:
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

    def test_every_finder_and_list_gives_the_same_collisions(self):
        config = SMALL.replace("time = 1\n", "time = 0\n").replace("time = 5", "time = 1")
        runs = {
            f"{finder}_{neighbours}_{distance}": [
                "--set", f"dynamics.finder={finder}", "--set", f"dynamics.neighbours={neighbours}",
                "--set", f"dynamics.distance={distance}",
            ]
            for finder, distances in [("certified", ["dual"]), ("bracketing", ["dual", "newton8", "newton5"])]
            for neighbours in ["dilated", "obp", "cells"]
            for distance in distances
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

    def test_axes_in_any_order_are_one_shape(self):
        base = SMALL.replace("number = 64", "number = 128")
        for name, axes in {"z": "[1, 1, 3]", "x": "[3, 1, 1]", "y": "[0.5, 1.5, 0.5]"}.items():
            self.run_small(name, config=base.replace("aspect_ratio = 2", f"semi_axes = {axes}"))
        self.run_small("ratio", config=base.replace("aspect_ratio = 2", "aspect_ratio = 3"))
        for name in ["x", "y", "ratio"]:
            self.assertEqual(self.summary(name)["state"], self.summary("z")["state"])
            self.assertEqual(self.read(f"{name}/events.csv"), self.read("z/events.csv"))

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


class Init(Case):
    def test_writes_a_config_that_runs(self):
        self.assertEqual(self.hardbody("init", "new.toml").returncode, 0)
        self.assertEqual(self.read("new.toml"), self.hardbody("init").stdout)
        result = self.hardbody(
            "run", "new.toml", "--set", "equilibration.time=0.1", "production.time=0.1", "system.packing_fraction=0.3"
        )
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_never_overwrites(self):
        self.write("mine.toml", "precious")
        self.assert_refused(self.hardbody("init", "mine.toml"), "mine.toml", "exists")
        self.assertEqual(self.read("mine.toml"), "precious")
        self.assert_refused(self.hardbody("init", "no/such/directory.toml"), "no/such/directory.toml")


class BadConfig(Case):
    """Every one: status 2, one line `file:line: what; accepted: ...`, nothing created, at once."""

    def refuse(self, config, *parts, arguments=()):
        self.write("bad.toml", config)
        begin = time.monotonic()
        result = self.hardbody("run", "bad.toml", *arguments)
        self.assertLess(time.monotonic() - begin, 1)
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
            ("time = 5", "time = 0", "production.time"),
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
        ]
        for old, new, *parts in cases:
            with self.subTest(new):
                self.refuse_line(old, new, *parts)

    def test_dynamics(self):
        cases = [
            ('inertia = "papers"', "dynamics.inertia", "papers"),
            ("inertia = [1, 1, 3]", "dynamics.inertia", "sum"),
            ("inertia = [1, 1, 0]", "dynamics.inertia"),
            ("inertia = [1, 1, -1]", "dynamics.inertia"),
            ("inertia = [1, 1]", "dynamics.inertia"),
            ("inertia = 3", "dynamics.inertia"),
            ("inertia = [1, 1.5, 1]", "dynamics.inertia", "not available yet"),
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

    def test_not_available_yet(self):
        cases = [
            ("aspect_ratio = 2", 'kind = "superellipsoid"\naspect_ratio = 2', "shape.kind"),
            ("aspect_ratio = 2", "semi_axes = [1, 2, 3]", "shape.semi_axes"),
            ("aspect_ratio = 2", "exponents = [1, 1]\naspect_ratio = 2", "shape.exponents"),
            ("events = 500", 'trajectory = ["gsd"]', "output.trajectory"),
            ("events = 500", 'trajectory = ["lammps", "vtk"]', "output.trajectory"),
            ("events = 500", "frames = 10", "output.frames"),
            ("[shape]", "[[species]]\naspect_ratio = 1\n[shape]", "species"),
        ]
        for old, new, key in cases:
            with self.subTest(new):
                self.refuse_line(old, new, key, "not available yet")

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


class BadPaths(Case):
    def test_config(self):
        self.assert_refused(self.hardbody("run", "none.toml"), "none.toml", "No such file")
        self.assert_refused(self.hardbody("run", self.here), "directory")
        self.assert_refused(self.hardbody("run", "/dev/zero"), "/dev/zero", "longer")
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
        for part in ["hardbody 0.", "BSD-3-Clause", "Eigen", "built with"]:
            self.assertIn(part, result.stdout)
        for command in [[], ["init"], ["run"], ["check"], ["replay"]]:
            result = self.hardbody(*command, "--help")
            self.assertEqual(result.returncode, 0)
            self.assertIn("Usage", result.stdout)
            self.assertNotIn("sweep", result.stdout)

    def test_bad_command_lines(self):
        for arguments in [[], ["runn"], ["run"], ["run", "a.toml", "--frce"], ["run", "a", "b"], ["check"], ["replay"]]:
            with self.subTest(arguments):
                self.assert_refused(self.hardbody(*arguments), "hardbody --help")

    def test_later_commands(self):
        for arguments in [["resume", "out"], ["analyze", "out"], ["report", "out", "-o", "x.html"], ["sweep", "--help"]]:
            with self.subTest(arguments):
                self.assert_refused(self.hardbody(*arguments), arguments[0], "not available yet")
        self.assert_refused(self.hardbody("distance"), "not available yet")


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
        self.assert_refused(self.hardbody("check", "run.gsd"), "not available yet")

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

    def test_least_that_is_needed(self):
        shape = {"kind": "ellipsoid", "semi_axes": [1, 1, 2]}
        a = {"shape": shape, "position": [0, 0, 0], "orientation": [1, 0, 0, 0]}
        b = {"shape": shape, "position": [0, 0, 5], "orientation": [0, 1, 0, 0]}
        result = self.replay({"format": "hardbody pair", "a": a, "b": b})
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"distance at that time: 1 \(separated")

    def test_bad_files(self):
        self.assert_refused(self.hardbody("replay", "none.json"), "none.json")
        self.assert_refused(self.replay("{\n\n]"), "pair.json:3: ", "JSON")
        self.assert_refused(self.replay("[]"), "format")
        self.assert_refused(self.replay("{}"), "format")
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
            ({"b": body([3, 0, 0], shape={"semi_axes": [1, 2, 3]})}, "pair.json"),
            ({"b": body([3, 0, 0], inertia=[1, 1, 5])}, "pair.json"),
            ({"b": body([3, 0, 0], inertia=[1, 1.5, 1.2])}, "pair.json"),
            ({"b": body([3, 0, 0], time="now")}, "b.time"),
            ({"i": -1}, "i is -1"),
        ]
        for change, *parts in cases:
            with self.subTest(change):
                self.assert_refused(self.replay(self.pair(**change)), *parts)


if __name__ == "__main__":
    sys.exit(0 if unittest.main(exit=False, verbosity=1).result.wasSuccessful() else 1)
