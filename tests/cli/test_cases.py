"""Small trajectories whose right answers are known: tests/reference/cases/README.md.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_cases.py [TestClass[.test]]
"""

import csv
import json
import math
import os
import re
import shutil
import subprocess
import sys
import unittest
import warnings

import numpy

warnings.simplefilter("ignore")
import gsd.hoomd

from test_cli import Case

CASES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "reference", "cases")

# A run that writes its start and ends.
START = '[start]\nfile = "{}"\n[equilibration]\ntime = 0\n[production]\ntime = 0\n[output]\ntrajectory = ["gsd"]\n'


class Analyses(Case):
    """What `hardbody analyze` and `hardbody check` say of a file."""

    def analyze(self, name, *arguments, time_step="1"):
        """The result of the command; its files are in the directory `analysis`."""
        shutil.rmtree(self.path("analysis"), ignore_errors=True)
        step = ["--time-step", time_step] if time_step else []
        result = self.hardbody("analyze", name, "--out", "analysis", *step, *arguments)
        self.assertIn(result.returncode, (0, 2), result.stderr)
        if result.returncode == 2:
            self.assert_refused(result)
        return result

    def column(self, file, column):
        """Argument -> value; None where a field is empty, nothing at all where there is no such file or column."""
        path = self.path(f"analysis/{file}.csv")
        if not os.path.exists(path):
            return {}
        with open(path) as text:
            rows = list(csv.reader(text))
        names = [n.split(" [")[0] for n in rows[0]]
        if column not in names:
            return {}
        values = [(float(r[0]), r[names.index(column)]) for r in rows[1:]]
        return {x: float(y) if y not in ("", "nan") else None for x, y in values}

    def at(self, file, column, lag):
        near = [v for t, v in self.column(file, column).items() if abs(t - lag) < 1e-9 * max(1, lag)]
        return near[0] if near else None

    def assert_absent(self, file, column):
        """No number, at no argument; of correlations of velocities lag 0 may stand."""
        for x, y in self.column(file, column).items():
            self.assertTrue(y is None or (x == 0 and column == "vacf"), f"{file}.csv: {column} {y} at {x}")

    def observable(self, name):
        return json.loads(self.read("analysis/analysis.json"))["observables"].get(name, {}).get("value")

    def said(self, result):
        """All that a command says, for a reason to be sought in."""
        more = self.read("analysis/analysis.json") if os.path.exists(self.path("analysis/analysis.json")) else ""
        return result.stdout + result.stderr + more

    def started(self, name, *settings, config="", frame=0):
        """The first frame of a run from a file, and what the run said."""
        self.write("start.toml", config + START.format(name))
        arguments = ["--set", *settings] if settings else []
        result = self.hardbody("run", "start.toml", "--out", "out", "--force", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        with gsd.hoomd.open(self.path("out/trajectory.gsd"), "rb") as file:
            return file[frame], result.stderr


class SmallFiles(Analyses):
    """Each file of the directory, by its name."""

    def setUp(self):
        super().setUp()
        for name in os.listdir(CASES):
            if name.endswith((".gsd", ".lammpstrj")):
                shutil.copy(os.path.join(CASES, name), self.path(name))

    def msd(self, name, *arguments, **lags):
        result = self.analyze(name, *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        for lag, right in lags.items():
            self.assertAlmostEqual(self.at("msd", "msd", int(lag[3:])) or math.nan, right, delta=1e-5 * right)
        return self.said(result)

    def test_image_of_frame_0_is_of_no_other_frame(self):
        self.msd("m1_image_of_frame_0.gsd", lag1=0.02)

    def test_images(self):
        self.msd("m1b_images.gsd", lag1=0.02)

    def test_image_that_is_left_out_where_it_is_that_of_frame_0(self):
        self.msd("m1c_same_image_left_out.gsd", "--longest-lag", "2", lag1=10.1025, lag2=32.805)

    def test_velocity_of_frame_0_only(self):
        result = self.analyze("m2_velocity_of_frame_0.gsd", "--longest-lag", "2")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assert_absent("velocity", "vacf")
        self.assertAlmostEqual(self.at("msd", "msd", 1), 0.5, delta=1e-6)
        frame, said = self.started("m2_velocity_of_frame_0.gsd", "start.frame=1")
        self.assertIn("velocities drawn", said)
        frame, said = self.started("m2_velocity_of_frame_0.gsd", "start.frame=0")
        self.assertNotIn("velocities drawn", said)
        numpy.testing.assert_allclose(frame.particles.velocity, [[1.5**0.5, 0, 0], [-(1.5**0.5), 0, 0]], atol=1e-6)

    def test_orientation_of_frame_0_only(self):
        result = self.analyze("m3_orientation_of_frame_0.gsd", "--longest-lag", "2")
        self.assertEqual(result.returncode, 0, result.stderr)
        for file, column in [("c1", "c1"), ("c2", "c2"), ("g_r", "g2")]:
            self.assert_absent(file, column)
        # Of frame 0 alone S is known; it is none of the trajectory.
        self.assertTrue(all(v is None for t, v in self.column("order", "S").items() if t > 0))
        self.assertIsNone(self.observable("S"))
        self.assertAlmostEqual(self.at("msd", "msd", 1), 0.005, delta=1e-6)
        self.assertIn("orientation", self.said(result))

    def test_frames_without_positions_are_none(self):
        said = self.msd("m4_log_only.gsd", "--longest-lag", "4", lag2=0.02)
        self.assertIsNone(self.at("msd", "msd", 1))
        self.assertIn("frames without positions are left out: 2 of 5", said)
        self.assertEqual(json.loads(self.read("analysis/analysis.json"))["frames"]["used"], 3)

    def test_unwrapped_columns(self):
        self.msd("m5_xu.lammpstrj", lag1=32)

    def test_image_columns(self):
        self.msd("m5_x_ix.lammpstrj", lag1=32)

    def test_positions_outside_the_box(self):
        self.msd("m5_outside_the_box.gsd", lag1=32)

    def test_steps_beyond_a_quarter_of_the_box(self):
        result = self.analyze("m5_wrapped.lammpstrj")
        self.assert_absent("msd", "msd")
        self.assert_absent("f_self", "f_self_q1")
        self.assertIn("of the box's edge between frames", self.said(result))

    def test_no_ids(self):
        result = self.analyze("m6_no_ids.lammpstrj")
        self.assert_absent("msd", "msd")
        self.assertRegex(self.said(result), r"\bids?\b")

    def test_tilts_of_zero(self):
        result = self.analyze("m7_zero_tilt.lammpstrj")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sum(v > 0 for v in self.column("g_r", "g").values()), 1)

    def test_velocities_of_a_dump(self):
        frame, said = self.started("m8_velocities.lammpstrj")
        self.assertNotIn("velocities drawn", said)
        numpy.testing.assert_allclose(frame.particles.velocity, [[1.5**0.5, 0, 0], [-(1.5**0.5), 0, 0]], atol=1e-6)

    def test_check_of_an_oblong_box(self):
        self.not_sound("m9_oblong_overlap.gsd", r"^ *overlaps +1, more than", r"^ *minimum distance +-0.9 \(unit of the file\), frame 0, bodies 0 and 1$")

    def test_check_of_diameters(self):
        self.not_sound("m10_diameter_overlap.gsd", "^not tested: overlaps: bodies of type A have no shape in the file$")

    def not_sound(self, name, *lines):
        result = self.hardbody("check", name)
        self.assertIsNone(re.search(r"^sound$", result.stdout, re.M), result.stdout)
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        for line in lines:
            self.assertRegex(result.stdout, re.compile(line, re.M))

    def test_the_script_writes_these_files(self):
        subprocess.run([sys.executable, "-W", "ignore", os.path.join(CASES, "make_cases.py"), self.path("made")], check=True)
        for name in os.listdir(self.path("made")):
            if name.endswith(".lammpstrj"):
                self.assertEqual(self.bytes_of(f"made/{name}"), self.bytes_of(name), name)
                continue
            with gsd.hoomd.open(self.path(f"made/{name}"), "rb") as made, gsd.hoomd.open(self.path(name), "rb") as here:
                self.assertEqual(len(made), len(here), name)
                for a, b in zip(made, here):
                    numpy.testing.assert_array_equal(a.particles.position, b.particles.position, name)


if __name__ == "__main__":
    unittest.main()
