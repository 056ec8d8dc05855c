"""Runs that go on after their end: `hardbody extend`, keys that `hardbody resume --set` may change, denser starts from files.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_extend.py [TestClass[.test]]

HARDBODY_FULL=1 extends and kills all the runs instead of three.
"""

import json
import os
import random
import shutil
import signal
import time
import tomllib
import unittest

from test_cli import FULL, MIXTURE, SMALL
from test_restart import OFTEN, RUNS, SUPERBALL, Restart, config

# A run, and the length of the longer one.
SIZED = """seed = 5
[system]
number = 64
packing_fraction = 0.2
[[species]]
semi_axes = [1, 1, 1.5]
sizes = "gaussian"
width = 0.1
[equilibration]
time = 3
[production]
time = 3
[output]
""" + OFTEN + "\n"

def with_frames(text, every):
    """Frames at an interval, in all formats."""
    return text.replace("[output]\n", f'[output]\ntrajectory = ["gsd", "lammps", "vtk"]\nframes = 90\nframes_every = {every}\n')


EXTENDED = {
    "prolate": (with_frames(config(equilibration=20, production=25), 0.7), 60),
    "mixture": (with_frames(config(base=MIXTURE, equilibration=3, production=1.3), 0.1), 3),
    "longest lag": (config(equilibration=20, production=21.7).replace("time = 21.7\n", "time = 21.7\nlongest_lag = 0.7\n"), 49),
    "oblate": (config("aspect_ratio = 0.5", 'inertia = "uniform"\nneighbours = "cells"', equilibration=20, production=17), 40),
    "biaxial": (config("semi_axes = [1, 0.8, 0.6]", equilibration=10, production=0.6), 1.5),
    "superballs": (config(SUPERBALL, 'neighbours = "obp"', equilibration=10, production=3), 8),
    "sizes": (SIZED, 8),
    "spheres": (config("aspect_ratio = 1", equilibration=20, production=33), 70),
    "auto": (RUNS["auto"], 1000),
    "until precise": (RUNS["until precise"], 3000),
}


class Extending(Restart):
    def keys(self, out):
        return tomllib.loads(self.read(f"{out}/config.toml"))

    def longer(self, text, out, length, lag):
        """Runs what the extension of a run would have been, planned from the start."""
        before, rest = text.split("[production]\n")
        planned = f"[production]\ntime = {length!r}\nlongest_lag = {lag!r}\n"
        self.run_small(out, config=before + planned + rest[rest.index("["):])

    def extend(self, out, length):
        result = self.hardbody("extend", out, "--time", str(length))
        self.assertEqual(result.returncode, 0, result.stderr)
        return result


class Extended(Extending):
    def test_is_the_longer_run(self):
        """Extended in one go, and killed on the way: the bytes of the run that was planned to be longer."""
        draws = random.Random(3)
        for name in list(EXTENDED)[: None if FULL else 3]:
            text, length = EXTENDED[name]
            with self.subTest(name):
                self.run_small("out", config=text)
                first = self.keys("out")["production"]
                shutil.copytree(self.path("out"), self.path("killed"))
                begin = time.monotonic()
                self.assertIn("production is extended from", self.extend("out", length).stderr)
                seconds = time.monotonic() - begin
                keys = self.keys("out")["production"]
                self.assertEqual(keys["time"], length)
                if name == "longest lag":
                    self.assertEqual(keys["longest_lag"], 0.7)
                elif name not in ("auto", "until precise"):
                    self.assertEqual(keys["longest_lag"], first["time"] / 16)
                self.longer(text, "longer", length, keys["longest_lag"])
                expected = self.results("longer")
                self.assert_same_run("out", expected)
                self.assertEqual(json.loads(expected["summary.json"])["time"]["production"], length)
                self.kill_on_the_way("killed", length, seconds, draws)
                self.assert_same_run("killed", expected)
                for directory in ["out", "longer", "killed"]:
                    shutil.rmtree(self.path(directory))

    def kill_on_the_way(self, out, length, seconds, draws):
        command = ["extend", out, "--time", str(length)]
        for number in [signal.SIGKILL, signal.SIGTERM, signal.SIGKILL]:
            process = self.start(*command)
            time.sleep(draws.uniform(0, seconds))
            self.assertIn(self.stop(process, number), [0, 143, -number], process.stderr.read())
            if f"time = {float(length)}" in self.read(f"{out}/config.toml") or os.path.exists(self.path(f"{out}/config.next.toml")):
                command = ["resume", out]
        if command[0] == "resume":
            self.resume(out)
        # Killed while the extension was being stored, the run may still be the short one.
        if self.keys(out)["production"]["time"] != length:
            self.extend(out, length)

    def test_twice_and_in_pieces(self):
        text = config(equilibration=5, production=5)
        self.run_small("out", config=text)
        self.extend("out", 7.3)
        self.extend("out", 20)
        self.longer(text, "longer", 20, 5 / 16)
        self.assert_same_run("out", self.results("longer"))
        self.assertFalse(os.path.exists(self.path("out/config.next.toml")))

    def test_an_extension_that_was_being_stored(self):
        """A process may end between any two of the files: resume and extend find one run or the other."""
        text = config(equilibration=5, production=5)
        self.run_small("short", config=text)
        shutil.copytree(self.path("short"), self.path("long"))
        self.extend("long", 20)
        self.write("short/config.next.toml", self.read("long/config.toml"))
        result = self.hardbody("resume", "short")
        self.assertIn("the run is finished", result.stdout)
        self.assertFalse(os.path.exists(self.path("short/config.next.toml")))
        # The checkpoint is the longer one already, everything else is not.
        process = self.start("extend", "short", "--time", "20000")
        self.wait_for(lambda: self.log_has("short", "extended") and "time = 20000" in self.read("short/config.toml"), "the extension")
        self.stop(process)
        os.rename(self.path("short/config.toml"), self.path("short/config.next.toml"))
        self.write("short/config.toml", self.read("long/config.toml"))
        shutil.copy(self.path("long/summary.json"), self.path("short/summary.json"))
        process = self.start("resume", "short")
        self.wait_for(lambda: self.log_has("short", "resumed from"), "the run")
        self.assertEqual(self.stop(process, signal.SIGTERM), 143)
        self.assertEqual(self.keys("short")["production"]["time"], 20000)
        self.assertFalse(os.path.exists(self.path("short/config.next.toml")))

    def test_refusals(self):
        def refused(out, *parts, length="20"):
            before = self.everything(out)
            self.assert_refused(self.hardbody("extend", out, "--time", length), "accepted: ", *parts)
            self.assertEqual(self.everything(out), before)

        self.run_small("out")
        refused("out", "--time is 5, production has lasted 5 already; accepted: a longer time", length="5")
        refused("out", "production.time", length="1e300")
        for length in ["0", "-3", "nan", "x"]:
            self.assert_refused(self.hardbody("extend", "out", "--time", length), "--time")
        self.assert_refused(self.hardbody("extend", "none", "--time", "9"), "none: is not there")
        self.assert_refused(self.hardbody("extend", "out"), "hardbody extend --help")
        os.makedirs(self.path("sweep"))
        self.write("sweep/sweep.csv", "")
        refused("sweep", "is the directory of a sweep")
        os.rename(self.path("out/checkpoint.bin"), self.path("checkpoint.bin"))
        refused("out", "checkpoint.bin is missing")
        os.rename(self.path("checkpoint.bin"), self.path("out/checkpoint.bin"))
        summary = self.read("out/summary.json")
        self.write("out/summary.json", summary.replace('"sound": true', '"sound": false'))
        refused("out", "NOT SOUND")
        self.write("out/summary.json", summary.replace('"stalled": null', '"stalled": "here"'))
        refused("out", "stalled")
        os.remove(self.path("out/summary.json"))
        refused("out", "out: the run is not finished; accepted: a finished run: hardbody resume out finishes this one")
        frames = SMALL.replace("[output]\n", '[output]\ntrajectory = ["gsd"]\nframes = 7\n')
        for spacing in ["even", "log"]:
            self.run_small(spacing, config=frames + f'frames_spacing = "{spacing}"\n')
            refused(spacing, "output.frames is 7", "without output.trajectory, or a new run with production.time = 20")
        self.run_small("full", config=frames + "frames_every = 0.9\n")
        refused("full", "output.frames", "frames = 23 at least, with frames_every = 0.9 and production.time = 20")
        self.run_small("nothing", config=SMALL.replace("time = 5", "time = 0"))
        refused("nothing", "production.time is 0")

    def test_a_run_that_is_under_way(self):
        self.write("run.toml", config(production=100000))
        process = self.start("run", "run.toml", "--out", "out")
        self.wait_for(lambda: self.log_has("out", "production: "), "production")
        self.assert_refused(self.hardbody("extend", "out", "--time", "200000"), "another hardbody process is using it")
        self.assertEqual(self.stop(process, signal.SIGTERM), 143)
        self.assert_refused(self.hardbody("extend", "out", "--time", "200000"), "the run is not finished", "hardbody resume out")


class ChangedOnResume(Restart):
    def test_keys_that_change_no_result(self):
        text = config(production=30)
        self.run_small("reference", config=text)
        expected = self.results("reference")
        self.write("run.toml", text)
        process = self.start("run", "run.toml", "--out", "out")
        self.wait_for(lambda: self.log_has("out", "production: "), "production")
        status = self.stop(process)
        for assignment in ["system.number=4", "output.events=3", "production.time=60", "nonsense", "checkpoint_every=9s"]:
            before = self.everything("out")
            result = self.hardbody("resume", "out", "--set", assignment)
            self.assert_refused(result, f"--set {assignment}: ", "accepted: output.checkpoint_every\n")
            self.assertEqual(self.everything("out"), before)
        self.assert_refused(self.hardbody("resume", "out", "--set", "output.checkpoint_every=9"), "output.checkpoint_every")
        self.assertEqual(self.hardbody("resume", "out", "--set", "output.checkpoint_every=9h").returncode, 0)
        if status != 0:
            self.assertIn('checkpoint_every = "9h"', self.read("out/config.toml"))
        results = self.results("out")
        for name in set(expected) - {"config.toml", "checkpoint.bin"}:
            self.assertTrue(results[name] == expected[name], name)
        self.assertIn("the run is finished", self.hardbody("resume", "out").stdout)


class CompressedFiles(Restart):
    def test_a_denser_config_compresses_the_state(self):
        self.run_small("origin", config=SMALL.replace("[output]\n", '[output]\ntrajectory = ["gsd"]\nframes = 2\n'))
        text = SMALL.replace("aspect_ratio = 2", "aspect_ratio = 2\n[start]\nfile = \"origin/trajectory.gsd\"")
        result = self.run_small("denser", config=text.replace("packing_fraction = 0.2", "packing_fraction = 0.35"))
        self.assertIn("at packing fraction 0.2", result.stderr)
        summary = self.summary("denser")
        self.assertAlmostEqual(summary["state"]["packing_fraction"], 0.35, delta=1e-12)
        start = summary["start"]
        self.assertEqual(os.path.basename(start["file"]), "trajectory.gsd")
        self.assertEqual((start["frame"], start["compressed"]), (1, True))
        self.assertAlmostEqual(start["packing_fraction"], 0.2, delta=1e-9)
        self.assertGreater(summary["counters_of_start"]["collisions"], 0)
        self.assertEqual(self.hardbody("check", "denser").returncode, 0)
        self.run_small("same", config=text)
        self.assertFalse(self.summary("same")["start"]["compressed"])
        self.assertIsNone(self.summary("origin")["start"])
        for phi, accepted in [("0.1", "a larger one up to 0.68"), ("0.7", "a larger one up to 0.68")]:
            self.write("bad.toml", text.replace("packing_fraction = 0.2", f"packing_fraction = {phi}"))
            result = self.hardbody("run", "bad.toml", "--out", "bad")
            self.assert_refused(result, "its packing fraction is 0.2", accepted, "or no system.packing_fraction")

    def test_extended_and_started_over(self):
        """A run from a file that was compressed goes on as any other, also without its checkpoint."""
        self.run_small("origin", config=SMALL.replace("[output]\n", '[output]\ntrajectory = ["gsd"]\nframes = 2\n'))
        text = SMALL.replace("aspect_ratio = 2", "aspect_ratio = 2\n[start]\nfile = \"origin/trajectory.gsd\"")
        text = text.replace("packing_fraction = 0.2", "packing_fraction = 0.3")
        self.run_small("out", config=text)
        self.assertEqual(self.hardbody("extend", "out", "--time", "9").returncode, 0)
        self.run_small("longer", config=text.replace("time = 5", "time = 9\nlongest_lag = 0.3125"))
        expected = self.results("longer")
        self.assert_same_run("out", expected)
        os.remove(self.path("out/checkpoint.bin"))
        os.remove(self.path("out/summary.json"))
        self.resume("out")
        self.assert_same_run("out", expected)


if __name__ == "__main__":
    unittest.main()
