"""Grids of runs: what `hardbody sweep` makes of them, and of being killed, short of disk, not alone or given nonsense.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_sweep.py [TestClass[.test]]
"""

import csv
import fcntl
import json
import os
import pty
import random
import resource
import shutil
import signal
import subprocess
import time
import unittest
import xml.dom.minidom

from test_cli import CELLS, HARDBODY, SMALL, Case

TIMING = ["wall_seconds", "collisions_per_second"]

# Runs of some hundredths of a second.
GRID = """
[grid]
shape.aspect_ratio = [0.5, 2]
system.packing_fraction = {from = 0.1, to = 0.2, step = 0.1}
"""

# Twelve runs of half a second, with some tens of checkpoints.
TWELVE = SMALL.replace("time = 1\n", "time = 20\n").replace("time = 5\n", "time = 120\n").replace(
    "events = 500", 'events = 500\ncheckpoint_every = "0.02s"'
) + """
[grid]
shape.aspect_ratio = [0.5, 1.5, 3]
system.packing_fraction = {from = 0.10, to = 0.25, count = 4}
"""


class SweepCase(Case):
    def sweep(self, text, *arguments, out="out", **options):
        self.write("sweep.toml", text)
        return self.hardbody("sweep", "sweep.toml", "--out", out, *arguments, **options)

    def start(self, text, *arguments, out="out", **options):
        self.write("sweep.toml", text)
        process = subprocess.Popen(
            [HARDBODY, "sweep", "sweep.toml", "--out", out, *arguments],
            cwd=self.here, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options
        )
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.kill)
        return process

    def table(self, out="out"):
        with open(self.path(f"{out}/sweep.csv"), newline="") as file:
            return list(csv.DictReader(file))

    def without_timing(self, out="out"):
        """sweep.csv as it stands there, but for its last two columns."""
        with open(self.path(f"{out}/sweep.csv"), newline="") as file:
            rows = list(csv.reader(file))
        self.assertEqual(rows[0][-2:], TIMING)
        return [row[:-2] for row in rows]

    def state(self, name, out="out"):
        return json.loads(self.read(f"{out}/{name}/state.json"))

    def wait_for(self, holds, what):
        deadline = time.monotonic() + 60
        while not holds():
            self.assertLess(time.monotonic(), deadline, f"{what} never came")
            time.sleep(0.005)

    def statuses(self, out="out"):
        return [row["status"] for row in self.table(out)]


class Grids(SweepCase):
    def names(self, text):
        result = self.sweep(text)
        self.assertEqual(result.returncode, 0, result.stderr)
        names = [name for name in os.listdir(self.path("out")) if os.path.isdir(self.path(f"out/{name}"))]
        shutil.rmtree(self.path("out"))
        return sorted(names)

    def test_points_are_runs(self):
        result = self.sweep(SMALL + GRID, "--jobs", "2")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout, "out: 4 points: 4 done, 0 failed\n")
        rows = self.table()
        self.assertEqual([(row["shape.aspect_ratio"], row["system.packing_fraction"]) for row in rows],
                         [("0.5", "0.1"), ("0.5", "0.2"), ("2", "0.1"), ("2", "0.2")])
        self.assertEqual({row["seed"] for row in rows}, {"3"})
        self.assertEqual({row["status"] for row in rows}, {"done"})
        # The last point is the run that hardbody run makes of the same config.
        self.run_small("alone")
        name = "aspect_ratio=2_packing_fraction=0.2"
        self.assertEqual(self.state_of(f"out/{name}"), self.state_of("alone"))
        alone = self.summary("alone")
        for key in ["collision_rate", "Z", "S"]:
            estimate = alone["observables"][key]
            self.assertEqual((rows[-1][key], rows[-1][key + "_error"]), (repr(estimate["value"]), repr(estimate["error"])))
        self.assertEqual(rows[-1]["equilibrated"], str(alone["equilibrated"]).lower())
        # Which values are missing, and why.
        self.assertEqual(rows[-1]["D_trans"], "")
        self.assertIn("D_trans", rows[-1]["message"])
        for key in ["D_trans", "D_rot", "tau_C2"]:
            self.assertIn(f': {alone["observables"][key]["missing"]}', rows[-1]["message"])
        self.assertEqual(float(rows[-1]["production_time"]), 5)
        state = self.state(name)
        self.assertEqual(state["keys"], {"shape.aspect_ratio": 2, "system.packing_fraction": 0.2})
        self.assertEqual((state["status"], state["message"], state["seed"]), ("done", "", 3))

    def test_kinds_of_axes(self):
        base = SMALL + CELLS
        text = base + '[grid]\nshape.aspect_ratio = 1.5\nseed = {from = 1, to = 5, step = 2}\n'
        self.assertEqual(self.names(text), [f"aspect_ratio=1.5_seed={k}" for k in [1, 3, 5]])
        text = SMALL + '[grid.shape]\naspect_ratio = {from = 0.25, to = 4, count = 3, spacing = "log"}\n'
        self.assertEqual(self.names(text), [f"aspect_ratio={x}" for x in ["0.25", "1", "4"]])
        text = base + '[grid]\nseed = [7, 8]\nsystem.number = [64, 100]\nzip = ["seed", "system.number"]\n'
        self.assertEqual(self.names(text), ["seed=7_number=64", "seed=8_number=100"])
        text = base.replace("aspect_ratio = 2\n", "") + '[grid]\nshape.semi_axes = [[1, 1, 2], [1, 1.5, 2]]\n'
        self.assertEqual(self.names(text), ["semi_axes=1x1.5x2", "semi_axes=1x1x2"])
        text = SMALL + '[[grid]]\nseed = 1\ndynamics.neighbours = "cells"\n[[grid]]\nseed = [1, 2]\ndynamics.neighbours = "obp"\n'
        self.assertEqual(self.names(text), ["seed=1_neighbours=cells", "seed=1_neighbours=obp", "seed=2_neighbours=obp"])

    def test_base_in_another_file(self):
        os.makedirs(self.path("configs"))
        self.write("configs/run.toml", SMALL)
        self.write("configs/many.toml", 'base = "run.toml"\n' + GRID)
        result = self.hardbody("sweep", "configs/many.toml")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.sweep(SMALL + GRID, out="inline").returncode, 0)
        self.assertEqual(self.without_timing("out/many"), self.without_timing("inline"))

    def test_template(self):
        self.assertEqual(self.hardbody("init", "many.toml", "--template", "sweep").returncode, 0)
        text = self.read("many.toml").replace("number = 512", "number = 108").replace('time = "auto"', "time = 0.1")
        result = self.sweep(text, timeout=300)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len(self.table()), 20)

    def test_workers_run_side_by_side(self):
        process = self.start(TWELVE.replace("time = 120", "time = 100000"), "--jobs", "3")
        running = lambda: [n for n in os.listdir(self.path("out")) if os.path.exists(self.path(f"out/{n}/log.txt"))]
        self.wait_for(lambda: os.path.exists(self.path("out/sweep.csv")) and len(running()) == 3, "the third run")
        time.sleep(0.5)
        self.assertEqual(len(running()), 3)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=60), 143)
        self.assertEqual(self.statuses(), 3 * ["stopped"] + 9 * ["pending"])


class Resumed(SweepCase):
    def test_three_kills(self):
        """kill -9 of the sweep, or of all it runs, at random moments: the same table as without."""
        begin = time.monotonic()
        result = self.sweep(TWELVE, "--jobs", "2", out="reference")
        self.assertEqual(result.returncode, 0, result.stderr)
        duration = time.monotonic() - begin
        moments = random.Random(5)
        kills = 0
        while kills < 3:
            process = self.start(TWELVE, "--jobs", "2", start_new_session=True)
            time.sleep(moments.uniform(0.1, 0.28) * duration)
            if process.poll() is not None:
                shutil.rmtree(self.path("out"))
                kills = 0
                continue
            if kills == 0:
                process.kill()  # its runs are told, and save their state
            else:
                os.killpg(process.pid, signal.SIGKILL)  # its runs too, at once
            process.wait()
            kills += 1
        result = self.sweep(TWELVE, "--jobs", "2")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.without_timing(), self.without_timing("reference"))
        points = [n for n in os.listdir(self.path("out")) if os.path.exists(self.path(f"out/{n}/log.txt"))]
        self.assertTrue(any(": resumed" in self.read(f"out/{n}/log.txt") for n in points), "no run was cut")
        for row in os.listdir(self.path("reference")):
            if not os.path.isdir(self.path(f"reference/{row}")):
                continue
            self.assertEqual(self.state_of(f"out/{row}"), self.state_of(f"reference/{row}"))
            for name in os.listdir(self.path(f"reference/{row}/observables")):
                self.assertEqual(self.read(f"out/{row}/observables/{name}"), self.read(f"reference/{row}/observables/{name}"))
            self.assertEqual(self.read(f"out/{row}/state.json"), self.read(f"reference/{row}/state.json"))

    def test_done_points_are_kept(self):
        self.assertEqual(self.sweep(SMALL + GRID).returncode, 0)
        before = {n: os.stat(self.path(f"out/{n}/summary.json")).st_mtime_ns for n in os.listdir(self.path("out")) if "=" in n}
        table = self.read("out/sweep.csv")
        shutil.rmtree(self.path("out/aspect_ratio=2_packing_fraction=0.1"))
        self.assertEqual(self.sweep(SMALL + GRID).returncode, 0)
        for name, changed in before.items():
            same = os.stat(self.path(f"out/{name}/summary.json")).st_mtime_ns == changed
            self.assertEqual(same, name != "aspect_ratio=2_packing_fraction=0.1")
        without = lambda text: [line.rsplit(",", 2)[0] for line in text.splitlines()]
        self.assertEqual(without(self.read("out/sweep.csv")), without(table))

    def test_signals_reach_the_runs(self):
        for number, status in [(signal.SIGTERM, 143), (signal.SIGINT, 130)]:
            with self.subTest(number):
                process = self.start(TWELVE.replace("time = 120", "time = 100000"), "--jobs", "2", out=f"out{status}")
                first = f"out{status}/aspect_ratio=0.5_packing_fraction=0.1"
                self.wait_for(lambda: os.path.exists(self.path(f"{first}/checkpoint.bin")), "a checkpoint")
                process.send_signal(number)
                self.assertEqual(process.wait(timeout=60), status)
                self.assertIn("the same command continues", process.stderr.read())
                self.assertTrue(self.summary(first)["interrupted"])
                self.assertEqual(self.statuses(f"out{status}")[:2], ["stopped", "stopped"])
                self.assertEqual(self.state("aspect_ratio=0.5_packing_fraction=0.1", f"out{status}")["status"], "stopped")

    def test_runs_end_with_their_sweep(self):
        process = self.start(TWELVE.replace("time = 120", "time = 100000"), "--jobs", "1")
        checkpoint = self.path("out/aspect_ratio=0.5_packing_fraction=0.1/checkpoint.bin")
        self.wait_for(lambda: os.path.exists(checkpoint), "a checkpoint")
        process.kill()
        process.wait()
        # It saves what it has before it ends: not there before it was told.
        summary = self.path("out/aspect_ratio=0.5_packing_fraction=0.1/summary.json")
        self.wait_for(lambda: os.path.exists(summary), "the end of the run")


class Chains(SweepCase):
    CHAIN = 'chain = "system.packing_fraction"\n' + SMALL.replace("time = 1\n", "time = 10\n").replace("time = 5\n", "time = 60\n").replace(
        "events = 500", 'events = 500\ncheckpoint_every = "0.02s"'
    ) + "[grid]\nsystem.packing_fraction = [0.3, 0.1, 0.2]\nshape.aspect_ratio = [2, 0.5]\n"

    def names(self):
        return [f"packing_fraction={phi}_aspect_ratio={x}" for phi in ["0.1", "0.2", "0.3"] for x in ["2", "0.5"]]

    def test_denser_points_start_from_the_others(self):
        result = self.sweep(self.CHAIN, "--jobs", "3")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([row["system.packing_fraction"] for row in self.table()], ["0.3", "0.3", "0.1", "0.1", "0.2", "0.2"])
        for name in self.names():
            log = self.read(f"out/{name}/log.txt")
            before = {"0.1": None, "0.2": "0.1", "0.3": "0.2"}[name[17:20]]
            if before is None:
                self.assertIn("bodies placed at random", log)
            else:
                self.assertIn(f"start: the last state of {self.here}/out/packing_fraction={before}{name[20:]}, compressed", log)
            self.assertEqual(self.hardbody("check", f"out/{name}").returncode, 0)
        # The first of a chain is the run that it is without one; a run by hand from its end is the second.
        first, second = "packing_fraction=0.1_aspect_ratio=2", "packing_fraction=0.2_aspect_ratio=2"
        self.write("base.toml", self.read("out/base.toml"))
        for out, settings in [("one", ["system.packing_fraction=0.1"]),
                              ("two", ["system.packing_fraction=0.2", f"system.start_from=out/{first}"])]:
            result = self.hardbody("run", "base.toml", "--out", out, "--set", "shape.aspect_ratio=2", *settings)
            self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.bytes_of("one/events.csv"), self.bytes_of(f"out/{first}/events.csv"))
        self.assertEqual(self.bytes_of("two/events.csv"), self.bytes_of(f"out/{second}/events.csv"))

    def test_kills(self):
        self.assertEqual(self.sweep(self.CHAIN, "--jobs", "2", out="reference").returncode, 0)
        moments = random.Random(7)
        for _ in range(4):
            process = self.start(self.CHAIN, "--jobs", "2")
            time.sleep(moments.uniform(0.1, 0.8))
            process.kill()
            process.wait()
        self.assertEqual(self.sweep(self.CHAIN, "--jobs", "2").returncode, 0)
        self.assertEqual(self.without_timing(), self.without_timing("reference"))
        for name in self.names():
            self.assertEqual(self.bytes_of(f"out/{name}/events.csv"), self.bytes_of(f"reference/{name}/events.csv"))

    def test_resumed_without_its_origin(self):
        self.assertEqual(self.sweep(self.CHAIN).returncode, 0)
        # Once it has begun, a run does not need what it started from.
        text = self.read("out/base.toml") + "[output]\ncheckpoint_every = '1h'\n"
        self.write("long.toml", text.replace("time = 60", "time = 100000").replace('[output]\nevents = 500\ncheckpoint_every = "0.02s"\n', ""))
        shutil.copytree(self.path("out/packing_fraction=0.3_aspect_ratio=2"), self.path("origin"))
        process = subprocess.Popen([HARDBODY, "run", "long.toml", "--out", "long", "--set", "system.packing_fraction=0.35",
                                    "system.start_from=origin"], cwd=self.here, stderr=subprocess.DEVNULL)
        self.addCleanup(process.kill)
        self.wait_for(lambda: os.path.exists(self.path("long/checkpoint.bin")), "the checkpoint of the start")
        process.kill()
        process.wait()
        shutil.rmtree(self.path("origin"))
        process = subprocess.Popen([HARDBODY, "resume", "long"], cwd=self.here, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        self.addCleanup(process.kill)
        self.wait_for(lambda: "production: 100000" in self.read("long/log.txt"), "production")
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=60), 143)

    def test_failed_link(self):
        text = self.CHAIN.replace("[0.3, 0.1, 0.2]", "[0.1, 0.75, 0.2]").replace("[2, 0.5]", "2")
        result = self.sweep(text)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(self.statuses(), ["done", "failed", "done"])
        os.remove(self.path("out/packing_fraction=0.2_aspect_ratio=2/summary.json"))
        with open(self.path("out/packing_fraction=0.2_aspect_ratio=2/checkpoint.bin"), "r+b") as file:
            file.truncate(1000)
        text = text.replace("0.75", "0.3")
        shutil.move(self.path("out/packing_fraction=0.2_aspect_ratio=2"), self.path("damaged"))
        self.assert_refused(self.sweep(text), "lacks the point packing_fraction=0.75_aspect_ratio=2")
        self.assertEqual(self.sweep(text, out="new").returncode, 0)
        shutil.rmtree(self.path("new/packing_fraction=0.2_aspect_ratio=2"))
        shutil.rmtree(self.path("new/packing_fraction=0.3_aspect_ratio=2"))
        shutil.move(self.path("damaged"), self.path("new/packing_fraction=0.2_aspect_ratio=2"))
        self.assertEqual(self.sweep(text, out="new").returncode, 1)
        self.assertEqual(self.statuses("new"), ["done", "failed", "failed"])
        self.assertIn("checkpoint.bin", self.table("new")[2]["message"])
        self.assertEqual(self.table("new")[1]["message"], "starts from packing_fraction=0.2_aspect_ratio=2, which failed")

    def test_refused(self):
        for old, new, part in [
            ('"system.packing_fraction"\n', '"shape.aspect_ratio"\n', 'chain is "shape.aspect_ratio"'),
            ('"system.packing_fraction"\n', "3\n", "chain is 3"),
            ("system.packing_fraction = [0.3, 0.1, 0.2]\n", "", "a key of the grid"),
            ("[0.3, 0.1, 0.2]", '[0.3, 0.1, "dense"]', 'system.packing_fraction is "dense"'),
            ("[2, 0.5]\n", '[2, 0.5, 3]\nzip = ["shape.aspect_ratio", "system.packing_fraction"]\n', "no chain along a key that zip"),
        ]:
            with self.subTest(new):
                self.assertIn(old, self.CHAIN)
                self.assert_refused(self.sweep(self.CHAIN.replace(old, new)), part, "accepted")
                self.assertFalse(os.path.exists(self.path("out")))

    def test_origins_of_single_runs(self):
        self.run_small("small")
        self.write("small.toml", SMALL)
        for settings, parts in [
            (["system.start_from=none"], ["none/checkpoint.bin: cannot be read"]),
            (["system.start_from=small", "system.number=65"], ["holds 64 bodies, system.number is 65"]),
            (["system.start_from=small", "shape.aspect_ratio=3"], ["holds bodies of another shape"]),
            (["system.start_from=small", "dynamics.inertia=uniform"], ["holds bodies of other mass or inertia"]),
            (["system.start_from=small", "system.packing_fraction=0.1"], ["has packing fraction 0.2, system.packing_fraction is 0.1"]),
            (["system.start_from=small", "system.start=fcc"], ["no key system.start beside start_from"]),
            (["system.start_from=small", "system.nematic_order=0.3"], ["no key system.nematic_order beside start_from"]),
            (["system.start_from=3"], ["the directory of a run"]),
        ]:
            with self.subTest(settings):
                self.assert_refused(self.hardbody("run", "small.toml", "--out", "out", "--set", *settings), "accepted", *parts)
                self.assertFalse(os.path.exists(self.path("out")))
        self.assert_refused(self.hardbody("run", "small.toml", "--out", "small", "--force", "--set", "system.start_from=small"),
                            "small is the directory of this run")
        self.assertEqual(self.hardbody("check", "small").returncode, 0)
        # At the same packing fraction the state goes on as it is.
        result = self.hardbody("run", "small.toml", "--out", "on", "--set", "system.start_from=small")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.hardbody("check", "on").returncode, 0)


class Files(SweepCase):
    """What points start from is named relative to the file of the sweep, wherever that is called and its points run."""

    BASE = 'seed = 3\n[equilibration]\ntime = 0\n[production]\ntime = 1\n'

    def setUp(self):
        super().setUp()
        os.makedirs(self.path("project/states"))
        os.makedirs(self.path("elsewhere"))
        for name, seed in [("first", 3), ("second", 4)]:
            self.run_small(f"project/{name}", "--set", f"seed={seed}", "--set", 'output.trajectory=["gsd"]')
            shutil.copy(self.path(f"project/{name}/trajectory.gsd"), self.path(f"project/states/{name}.gsd"))

    def call(self, cwd, sweep, *arguments):
        return subprocess.run([HARDBODY, "sweep", sweep, *arguments], cwd=self.path(cwd), capture_output=True, text=True,
                              timeout=120, stdin=subprocess.DEVNULL)

    def assert_all_done(self, result, out="project/out"):
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertEqual(set(self.statuses(out)), {"done"})

    def assert_goes_on(self, out="project/out"):
        """Called from another directory, and with the whole project at another place: the same sweep, the same points."""
        before = self.without_timing(out)
        victim = next(n for n in sorted(os.listdir(self.path(out))) if "=" in n)
        for cwd, place in [("elsewhere", "project"), ("elsewhere", "moved")]:
            if not os.path.exists(self.path(place)):
                os.rename(self.path("project"), self.path(place))
            shutil.rmtree(self.path(f"{place}/out/{victim}"))
            self.assert_all_done(self.call(cwd, f"../{place}/sweep.toml", "--out", f"../{place}/out"), f"{place}/out")
            self.assertEqual(self.without_timing(f"{place}/out"), before)
        # The sweep as it is kept in its directory is one, too.
        self.assert_all_done(self.call(".", "moved/out/sweep.toml", "--out", "moved/out"), "moved/out")

    def log_of(self, name):
        return self.read(f"project/out/{name}/log.txt")

    def test_of_the_base(self):
        self.write("project/sweep.toml", self.BASE + '[start]\nfile = "states/first.gsd"\n[grid]\nstart.frame = [0, 1]\n')
        self.assert_all_done(self.call("project", "sweep.toml", "--out", "out"))
        self.assertIn(self.path("project/states/first.gsd"), self.read("project/out/frame=0/config.toml"))
        self.assert_goes_on()

    def test_of_a_base_in_another_file(self):
        self.write("project/states/run.toml", self.BASE + '[start]\nfile = "first.gsd"\n')
        self.write("project/sweep.toml", 'base = "states/run.toml"\n[grid]\nstart.frame = [0, 1]\n')
        self.assert_all_done(self.call(".", "project/sweep.toml", "--out", "project/out"))
        self.assert_goes_on()

    def test_of_the_grid(self):
        for grid in ['[grid]\nstart.file = ["states/first.gsd", "states/second.gsd"]\n',
                     '[grid.start]\nfile = ["states/first.gsd", "states/second.gsd"]\n']:
            with self.subTest(grid):
                self.write("project/sweep.toml", self.BASE + grid)
                self.assert_all_done(self.call("project", "sweep.toml", "--out", "out"))
                self.assertEqual([row["start.file"] for row in self.table("project/out")], ["states/first.gsd", "states/second.gsd"])
                self.assertIn(self.path("project/states/second.gsd"), self.read("project/out/file=states-second.gsd/config.toml"))
                self.assert_goes_on()
                os.rename(self.path("moved"), self.path("project"))
                shutil.rmtree(self.path("project/out"))

    def test_of_the_first_of_a_chain(self):
        base = SMALL.replace("packing_fraction = 0.2\n", 'start_from = "first"\n')
        chain = 'chain = "system.packing_fraction"\n' + base + "[grid]\nsystem.packing_fraction = [0.2, 0.21]\n"
        self.write("project/sweep.toml", chain)
        self.assert_all_done(self.call("project", "sweep.toml", "--out", "out"))
        self.assertIn(f"start: the last state of {self.path('project/first')}", self.log_of("packing_fraction=0.2"))
        self.assertIn(f"start: the last state of {self.path('project/out/packing_fraction=0.2')}", self.log_of("packing_fraction=0.21"))
        self.assert_goes_on()
        self.write("moved/sweep.toml", 'seed = 3\n' + SMALL.replace("seed = 3\n", "").replace("packing_fraction = 0.2\n", "")
                   + '[grid]\nsystem.packing_fraction = [0.2]\nsystem.start_from = ["first", "second"]\n')
        self.assert_all_done(self.call("moved", "sweep.toml", "--out", "of_the_grid"), "moved/of_the_grid")

    def test_one_file_by_two_names(self):
        self.write("project/sweep.toml", self.BASE + '[grid]\nstart.file = ["states/first.gsd", "./states/first.gsd"]\n')
        self.assert_refused(self.call(".", "project/sweep.toml"), "occurs twice")

    def test_another_file_of_the_same_name(self):
        text = self.BASE + '[start]\nfile = "states/first.gsd"\n[grid]\nstart.frame = [0]\n'
        self.write("project/sweep.toml", text)
        self.assert_all_done(self.call("project", "sweep.toml", "--out", "out"))
        shutil.copytree(self.path("project/states"), self.path("elsewhere/states"))
        self.write("elsewhere/sweep.toml", text)
        self.assert_refused(self.call("elsewhere", "sweep.toml", "--out", "../project/out"), "start.file is", "elsewhere/states/first.gsd")


class Failures(SweepCase):
    TOO_DENSE = SMALL + "[grid]\nsystem.packing_fraction = [0.1, 0.75, 0.2]\n"

    def test_impossible_point(self):
        result = self.sweep(self.TOO_DENSE)
        self.assertEqual(result.returncode, 1)
        self.assertIn("out: 3 points: 2 done, 1 failed\n", result.stdout)
        self.assertIn("failed: packing_fraction=0.75: sweep.toml:14: system.packing_fraction is 0.75", result.stdout)
        rows = self.table()
        self.assertEqual(self.statuses(), ["done", "failed", "done"])
        self.assertIn("accepted: a number from 1e-09 to ", rows[1]["message"])
        self.assertEqual(rows[1]["D_trans"], "")
        self.assertEqual(self.state("packing_fraction=0.75")["message"], rows[1]["message"])
        # Again: nothing is run, and it is still said.
        table = self.read("out/sweep.csv")
        again = self.sweep(self.TOO_DENSE)
        self.assertEqual((again.returncode, again.stdout), (1, result.stdout))
        self.assertEqual(self.read("out/sweep.csv"), table)

    def test_point_whose_start_jams(self):
        """Found out only by compressing: the point fails and says where, the sweep goes on."""
        jamming = "[system]\nnumber = 40\npacking_fraction = 0.62\n[shape]\naspect_ratio = 1\n[equilibration]\ntime = 0\n"
        result = self.sweep(jamming + "[production]\ntime = 0\n[grid]\nseed = [4, 5, 6]\n")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(sorted(self.statuses()), ["done", "done", "failed"])
        message = [row["message"] for row in self.table() if row["status"] == "failed"]
        self.assertRegex(message[0], "the compression got stuck at 0.61[0-9]* of 0.62; a lower value is needed")
        self.assertIn("failed: seed=", result.stdout)

    def test_summary_that_is_none(self):
        """What is to be done about it works."""
        text = SMALL + "[grid]\nseed = [1, 2]\n"
        self.assertEqual(self.sweep(text).returncode, 0)
        before = self.without_timing()
        self.write("out/seed=2/summary.json", "garbage")
        result = self.sweep(text)
        self.assertEqual(result.returncode, 1)
        self.assertIn("seed=2/summary.json was not written by a run; accepted: delete the directory seed=2, and the same "
                      "command runs the point again", self.table()[1]["message"])
        shutil.rmtree(self.path("out/seed=2"))
        self.assertEqual(self.sweep(text).returncode, 0)
        self.assertEqual(self.without_timing(), before)

    def test_full_disk(self):
        """Points whose checkpoint does not fit fail; those that were done stay; with room again all is as it should be."""
        text = SMALL + CELLS + "[grid]\nsystem.number = [64, 256, 65]\n"
        self.assertEqual(self.sweep(text, out="reference").returncode, 0)
        size = (os.stat(self.path("reference/number=65/checkpoint.bin")).st_size
                + os.stat(self.path("reference/number=256/checkpoint.bin")).st_size) // 2
        process = self.start(text, "--jobs", "1", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)))
        self.assertEqual(process.wait(timeout=60), 1)
        self.assertIn("cannot be written: File too large", process.stderr.read())
        self.assertEqual(self.statuses(), ["done", "failed", "done"])
        self.assertIn("checkpoint.bin: cannot be written: File too large", self.table()[1]["message"])
        self.assertEqual(self.state_of("out/number=64"), self.state_of("reference/number=64"))
        result = self.sweep(text)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.without_timing(), self.without_timing("reference"))

    def test_table_that_does_not_fit(self):
        text = SMALL + CELLS + "[grid]\nseed = {from = 1, to = 8, step = 1}\n"
        process = self.start(text, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1500, 1500)))
        self.assertEqual(process.wait(timeout=60), 1)
        result = self.sweep(text)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.statuses(), 8 * ["done"])

    def test_killed_run(self):
        process = self.start(TWELVE.replace("time = 120", "time = 3000"), "--jobs", "1")
        first = "out/aspect_ratio=0.5_packing_fraction=0.1"
        self.wait_for(lambda: os.path.exists(self.path(f"{first}/checkpoint.bin")), "a checkpoint")
        with open(f"/proc/{process.pid}/task/{process.pid}/children") as file:
            child = int(file.read().split()[0])
        os.kill(child, signal.SIGKILL)
        self.wait_for(lambda: self.statuses()[0] == "failed", "the end of the first point")
        self.assertIn("ended by signal 9", self.table()[0]["message"])
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=60), 143)


class Refused(SweepCase):
    def refuse(self, text, *parts, arguments=()):
        result = self.sweep(text, *arguments)
        self.assert_refused(result, "accepted", *parts)
        self.assertFalse(os.path.exists(self.path("out")))

    def test_grids(self):
        axis = "[grid]\nsystem.packing_fraction = "
        self.refuse(SMALL, "sweep.toml: has no [grid]: hardbody run takes the config of one run")
        self.refuse(SMALL + "[grid]\n", "sweep.toml:13: the grid has no keys")
        self.refuse(SMALL + axis + "[0.1, 0.2, 0.1]\n", "packing_fraction = 0.1 occurs twice")
        self.refuse(SMALL + axis + "[0.1, 0.1000000000000001]\n", "packing_fraction = 0.1000000000000001 occurs twice")
        self.refuse(SMALL + "[grid]\nshape.semi_axes = [[1, 1, 0.3], [1, 1.0, 0.30000000000000004]]\n", "occurs twice")
        self.refuse(SMALL + axis + "[]\n", "system.packing_fraction is []", "sweep.toml:14")
        self.refuse(SMALL + axis + "{from = 0.1, to = 0.2}\n", "sweep.toml:14", "{from, to, step}")
        self.refuse(SMALL + axis + "{from = 0.1, to = 0.2, step = -0.1}\n", "sweep.toml:14", "a step that leads")
        self.refuse(SMALL + axis + "{from = 0.1, to = 0.2, step = 0}\n", "sweep.toml:14", "a step that leads")
        self.refuse(SMALL + axis + "{from = 0.1, to = 0.2, step = 1e-9}\n", "sweep.toml:14", "a step that leads")
        self.refuse(SMALL + axis + "{from = 0.1, to = 0.2, step = 0.1, count = 2}\n", "sweep.toml:14")
        self.refuse(SMALL + axis + "{from = 0.1, to = 0.2, number = 2}\n", "sweep.toml:14")
        self.refuse(SMALL + axis + "{from = 0.1, to = 0.2, count = 1}\n", "sweep.toml:14", "a count from 2")
        self.refuse(SMALL + axis + '{from = -0.1, to = 0.2, count = 2, spacing = "log"}\n', "above 0 with spacing")
        self.refuse(SMALL + axis + '{from = 0.1, to = 0.2, count = 2, spacing = "cubic"}\n', '"linear" or "log"')
        self.refuse(SMALL + axis + '{from = "a", to = 0.2, count = 2}\n', "sweep.toml:14")
        self.refuse(SMALL + "[grid]\nseed = {from = 1, to = 99999, step = 1}\nsystem.number = [64, 65, 66]\n", "more than 100000 points")

    def test_names(self):
        self.refuse(SMALL + "[grid]\nsystem.packing_fractoin = [0.1]\n", "sweep.toml:14: unknown key",
                    "did you mean system.packing_fraction?")
        self.refuse(SMALL + "[grid]\nphi = [0.1]\n", "sweep.toml:14: unknown key phi")
        self.refuse(SMALL + "[gird]\nseed = [1]\n", "unknown section [gird], did you mean [grid]?")
        self.refuse("sede = 1\n" + SMALL + GRID, "unknown key sede, did you mean seed?")
        self.refuse(SMALL.replace("[shape]", "[shap]") + GRID, "unknown section [shap], did you mean [shape]?")
        self.refuse("bases = 1\n" + SMALL + GRID, "did you mean base?")
        self.refuse('base = "small.toml"\n' + SMALL + GRID, "cannot be combined with base")
        self.refuse('base = "missing.toml"\n' + GRID, "missing.toml: cannot be read")
        self.refuse(SMALL + GRID + "nonsense", "is not valid TOML")
        self.assert_refused(self.hardbody("sweep", "missing.toml"), "missing.toml: cannot be read")

    def test_zips(self):
        grid = "[grid]\nseed = [1, 2]\nsystem.number = [64, 65, 66]\n"
        self.refuse(SMALL + grid + 'zip = ["seed", "system.number"]\n', "has 3 values and seed has 2")
        self.refuse(SMALL + grid + 'zip = ["seed", "system.numbr"]\n', "zip names system.numbr")
        self.refuse(SMALL + grid + 'zip = ["seed"]\n', "sweep.toml:16: zip is")
        self.refuse(SMALL + grid + 'zip = [["seed", "system.number"], ["seed", "shape.aspect_ratio"]]\n', "zip names seed")

    def test_overlapping_grids(self):
        one = "[[grid]]\nshape.aspect_ratio = [0.5, 2]\nsystem.packing_fraction = [0.1, 0.2]\n"
        two = "[[grid]]\nsystem.packing_fraction = 0.2\nshape.aspect_ratio = [3, 2.0]\n"
        self.refuse(SMALL + one + two, "sweep.toml:16: the point", "system.packing_fraction = 0.2", "occurs twice, also in sweep.toml:13")
        self.refuse(SMALL + one + "[[grid]]\nseed = 1\n", "is a key of one grid and not of another")

    def test_no_point_is_possible(self):
        self.refuse(SMALL + "[grid]\nsystem.packing_fraction = [0.8, 0.9]\n", "sweep.toml:14: system.packing_fraction is 0.8")
        self.refuse(SMALL + '[grid]\nsystem.packing_fraction = ["a"]\n', 'system.packing_fraction is "a"')

    def test_options(self):
        for jobs in ["0", "-1", "2000"]:
            self.refuse(SMALL + GRID, f"--jobs is {jobs}", arguments=["--jobs", jobs])
        self.assert_refused(self.sweep(SMALL + GRID, "--jobs", "two"), "--jobs")
        self.assert_refused(self.sweep(SMALL + GRID, out=""), "--out is empty")

    def test_changed_sweep(self):
        self.assertEqual(self.sweep(SMALL + GRID).returncode, 0)
        table = self.read("out/sweep.csv")
        for old, new, key, was in [
            ("number = 64", "number = 65", "system.number is 65, but 64", "sweep.toml:3"),
            ("[0.5, 2]", "[0.5, 3]", "lacks the point aspect_ratio=2_packing_fraction=0.1", "sweep.toml:14"),
            ("[0.5, 2]", "[0.5, 2]\nseed = 3", "grid.seed is 3, but not there", "sweep.toml:16"),
            ("events = 500", "", "output.events is not there, but 500", "sweep.toml"),
            ("seed = 3", "seed = 3\n[dynamics]\nneighbours = 'obp'", 'dynamics.neighbours is "obp", but not there', "sweep.toml:3"),
        ]:
            with self.subTest(new):
                self.assert_refused(self.sweep((SMALL + GRID).replace(old, new)), key, was, "another directory")
                self.assertEqual(self.read("out/sweep.csv"), table)
        # Comments, blanks, 2 for 2.0 and the order of sections are no change.
        same = (SMALL + GRID).replace("[0.5, 2]", "[0.50,   2.0] # two").replace("events = 500", "events = 500\n\n")
        self.assertEqual(self.sweep(same).returncode, 0)

    def test_more_points(self):
        self.assertEqual(self.sweep(SMALL + GRID).returncode, 0)
        kept = self.state_of("out/aspect_ratio=2_packing_fraction=0.2")
        times = os.stat(self.path("out/aspect_ratio=2_packing_fraction=0.2/summary.json")).st_mtime_ns
        more = (SMALL + GRID).replace("[0.5, 2]", "[0.5, 1.5, 2]").replace("step = 0.1", "step = 0.05")
        result = self.sweep(more, "--jobs", "2")
        self.assertEqual((result.returncode, result.stdout), (0, "out: 9 points: 9 done, 0 failed\n"), result.stderr)
        self.assertEqual(self.state_of("out/aspect_ratio=2_packing_fraction=0.2"), kept)
        self.assertEqual(os.stat(self.path("out/aspect_ratio=2_packing_fraction=0.2/summary.json")).st_mtime_ns, times)
        self.assertEqual(self.sweep(more, out="whole").returncode, 0)
        self.assertEqual(self.without_timing("out"), self.without_timing("whole"))
        self.assertEqual(self.read("out/sweep.toml"), self.read("whole/sweep.toml"))
        # The directory holds the larger sweep now.
        self.assert_refused(self.sweep(SMALL + GRID), "lacks the point", "another directory")

    def test_more_points_of_chains(self):
        chain = 'chain = "system.packing_fraction"\n' + SMALL + "[grid]\nsystem.packing_fraction = [0.1, 0.2]\n"
        self.assertEqual(self.sweep(chain).returncode, 0)
        self.assert_refused(self.sweep(chain.replace("0.1, 0.2", "0.1, 0.15, 0.2")),
                            "packing_fraction=0.2 would start from packing_fraction=0.15", "upper end of chains")
        denser = chain.replace("0.1, 0.2", "0.1, 0.2, 0.25")
        self.assertEqual(self.sweep(denser).returncode, 0)
        self.assertEqual(self.sweep(denser, out="whole").returncode, 0)
        self.assertEqual(self.without_timing("out"), self.without_timing("whole"))

    def test_overrides(self):
        small = ["--set", "production.time=2", "--set", "grid.shape.aspect_ratio=[0.5, 3]", "--set", "grid.seed=[1,2]"]
        self.write("run.toml", SMALL)
        for name, text in [("inline", SMALL + GRID), ("apart", 'base = "run.toml"\n' + GRID)]:
            result = self.sweep(text, *small, out=name)
            self.assertEqual((result.returncode, result.stdout), (0, f"{name}: 8 points: 8 done, 0 failed\n"), result.stderr)
            self.assertIn("aspect_ratio=3_packing_fraction=0.2_seed=2", os.listdir(self.path(name)))
        changed = SMALL.replace("seed = 3\n", "").replace("time = 5", "time = 2") + GRID.replace("2]", "3]") + "seed = [1, 2]\n"
        self.assertEqual(self.sweep(changed, out="written").returncode, 0)
        self.assertEqual(self.without_timing("inline"), self.without_timing("written"))
        self.assertEqual(self.without_timing("apart"), self.without_timing("written"))
        # The same command continues it; without the options it is another sweep.
        self.assertEqual(self.sweep(SMALL + GRID, *small, out="inline").returncode, 0)
        self.assert_refused(self.sweep(SMALL + GRID, out="inline"), "in the sweep that inline holds")
        # A run becomes a sweep.
        result = self.sweep(SMALL, "--set", "grid.seed=[1,2]", out="seeds")
        self.assertEqual(result.stdout, "seeds: 2 points: 2 done, 0 failed\n", result.stderr)

    def test_overrides_that_are_refused(self):
        for value, *parts in [
            ("shape.aspect_ratio=3", "--set shape.aspect_ratio=3: shape.aspect_ratio is a key of the grid", "grid.shape.aspect_ratio"),
            ("grid[2].seed=[1]", "there is no grid[2] in the file; accepted: grid"),
            ("system.numbr=3", "--set system.numbr=3: ", "did you mean system.number?"),
            ("grid.sed=[3]", "--set grid.sed=[3]: unknown key sed"),
            ("sed=3", "unknown key sed, did you mean seed?"),
            ("grid=3", "--set grid=3: grid is 3"),
            ("seed", "--set seed: is not an assignment"),
        ]:
            with self.subTest(value):
                self.refuse(SMALL + GRID, *parts, arguments=["--set", value])

    def test_command_for_the_other_file(self):
        self.write("sweep.toml", SMALL + GRID)
        self.assert_refused(self.hardbody("run", "sweep.toml", "--out", "out"), "sweep.toml:14: [grid]", "hardbody sweep takes it")
        self.write("sweep.toml", 'base = "run.toml"\n')
        self.assert_refused(self.hardbody("run", "sweep.toml", "--out", "out"), "sweep.toml:1: base", "hardbody sweep")
        self.assertFalse(os.path.exists(self.path("out")))

    def test_directories(self):
        self.run_small("out")
        self.assert_refused(self.sweep(SMALL + GRID), "out: holds files, but no sweep")
        self.write("file", "")
        self.assert_refused(self.sweep(SMALL + GRID, out="file"), "file: is not a directory")
        self.assert_refused(self.sweep(SMALL + GRID, out="file/out"), "file/out: cannot be used")

    def test_two_sweeps_at_once(self):
        text = TWELVE.replace("time = 120", "time = 100000")
        process = self.start(text, "--jobs", "1")
        self.wait_for(lambda: os.path.exists(self.path("out/sweep.csv")), "the first sweep")
        self.assert_refused(self.sweep(text), "out: another hardbody process is using it")
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=60), 143)

    def test_a_process_that_is_just_ending_is_waited_for(self):
        os.mkdir(self.path("out"))
        held = os.open(self.path("out"), os.O_RDONLY)
        fcntl.flock(held, fcntl.LOCK_EX)
        process = self.start(SMALL + GRID)
        time.sleep(0.3)
        self.assertIsNone(process.poll())
        os.close(held)
        self.assertEqual(process.wait(timeout=60), 0)


class Shown(SweepCase):
    def test_line_on_a_terminal(self):
        self.write("sweep.toml", TWELVE.replace("time = 120", "time = 20"))
        master, slave = pty.openpty()
        process = subprocess.Popen([HARDBODY, "sweep", "sweep.toml", "--out", "out", "--jobs", "2"], cwd=self.here,
                                   stdout=subprocess.DEVNULL, stderr=slave)
        os.close(slave)
        said = b""
        while True:
            try:
                chunk = os.read(master, 4096)
            except OSError:  # the other end is closed
                break
            if not chunk:
                break
            said += chunk
        os.close(master)
        self.assertEqual(process.wait(timeout=60), 0)
        text = said.decode()
        self.assertRegex(text, r"\r\x1b\[Ksweep: \d+ of 12 points done, 2 running, 0 failed")
        self.assertIn("ETA ", text)
        # The line is cleared at the end.
        self.assertTrue(text.endswith("\r\x1b[K"), repr(text[-60:]))

    def test_quiet_elsewhere(self):
        result = self.sweep(SMALL + GRID)
        self.assertEqual(result.stderr, "")


class Maps(SweepCase):
    """Lines of x^2 + y over a made-up table."""

    def setUp(self):
        super().setUp()
        rows = [(x / 10, y / 10) for x in range(11) for y in range(11) if x + y < 16]
        lines = [f"{x},{y},{seed},{x * x + y + 0.1},{'' if x == 0 else x},true" for x, y in rows for seed in [1, 2]]
        self.write("table.csv", "\n".join(["shape.aspect_ratio,phi,seed,D,E,equilibrated", *lines]) + "\n")

    def map(self, *arguments):
        return self.hardbody("map", "table.csv", "--x", "aspect_ratio", "--y", "phi", *arguments)

    def lines(self, name):
        with open(self.path(name), newline="") as file:
            return list(csv.DictReader(file))

    def test_lines(self):
        result = self.map("--value", "D", "--levels", "0.5,0.8", "--value", "E", "--levels", "0.55", "--out", "a.svg", "--csv", "a.csv")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("D = 0.5: 1 lines", result.stdout)
        lines = self.lines("a.csv")
        self.assertEqual({(row["value"], row["level"]) for row in lines}, {("D", "0.5"), ("D", "0.8"), ("E", "0.55")})
        for row in lines:
            x, y, level = float(row["shape.aspect_ratio"]), float(row["phi"]), float(row["level"])
            self.assertAlmostEqual(x * x + y + 0.1 if row["value"] == "D" else x, level, delta=0.006)
        drawing = self.read("a.svg")
        self.assertTrue(drawing.startswith("<svg ") and drawing.endswith("</svg>\n"))
        self.assertEqual(drawing.count("<path fill="), 3)
        xml.dom.minidom.parseString(drawing)

    def test_defaults(self):
        result = self.map("--value", "D", "--where", "seed=2", "--log-y")
        self.assertEqual(result.returncode, 2)  # phi = 0 has no logarithm
        result = self.map("--value", "D", "--where", "seed=2")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("map_D.svg, map_D.csv written from 106 points", result.stdout)
        # Round numbers between 0.1 and 1.6.
        self.assertEqual({row["level"] for row in self.lines("map_D.csv")}, {"0.15", "0.2", "0.3", "0.5", "0.7", "1", "1.5"})

    def test_points_that_are_not_done(self):
        """An unsound point has values in the table, which are no results; a failed one of no value is not counted."""
        rows = [(x, y, f"{x + y}", "done") for x in range(4) for y in range(4)]
        rows[5] = (1, 1, "1000", "failed")
        rows[6] = (1, 2, "", "failed")
        rows[15] = (3, 3, "-1000", "stopped")
        self.write("states.csv", "\n".join(["x,y,D,status", *(",".join(map(str, row)) for row in rows)]) + "\n")
        result = self.hardbody("map", "states.csv", "--x", "x", "--y", "y", "--value", "D", "--levels", "0.5,3.5", "--csv", "a.csv")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("written from 13 points; 2 left out, whose status is not done\n", result.stdout)
        for row in self.lines("a.csv"):
            self.assertAlmostEqual(float(row["x"]) + float(row["y"]), float(row["level"]), delta=1e-5)
        # A table of something else.
        self.write("states.csv", self.read("states.csv").replace("done", "fine").replace("failed", "bad").replace("stopped", "bad"))
        result = self.hardbody("map", "states.csv", "--x", "x", "--y", "y", "--value", "D", "--levels", "0.5")
        self.assertIn("written from 15 points\n", result.stdout)

    def test_points_on_a_line_are_refused(self):
        """As of a sweep of zipped keys: there is no plane."""
        for rows in [[(x, 2 * x, x) for x in range(5)], [(1, y, y) for y in range(5)], [(x, 1, x) for x in range(5)]]:
            self.write("line.csv", "\n".join(["x,y,D", *(",".join(map(str, row)) for row in rows)]) + "\n")
            result = self.hardbody("map", "line.csv", "--x", "x", "--y", "y", "--value", "D", "--out", "a.svg", "--csv", "a.csv")
            self.assert_refused(result, "line.csv: D is known at 5 points with", "no line can be drawn", "accepted: at least two neighbouring values of x")
            self.assertFalse(os.path.exists(self.path("a.svg")))

    def test_conditions_are_numbers(self):
        text = self.read("table.csv").replace(",seed,", ",mass,")
        self.write("table.csv", "\n".join(line.replace(",2,", ",0.5,", 1) for line in text.splitlines()) + "\n")
        for condition in ["mass=0.5", "mass=0.50", "mass=5e-1", "mass=0.5,equilibrated=true"]:
            with self.subTest(condition):
                options = [option for one in condition.split(",") for option in ("--where", one)]
                result = self.map("--value", "D", *options)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertIn("written from 106 points", result.stdout)
        self.assert_refused(self.map("--value", "D", "--where", "mass=half"), "--where mass=half: no row of table.csv has this value; accepted: ")

    def test_of_a_sweep(self):
        self.assertEqual(self.sweep(SMALL + GRID).returncode, 0)
        result = self.hardbody("map", "out", "--x", "shape.aspect_ratio", "--y", "packing_fraction", "--value", "Z", "--log-x")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue(os.path.exists(self.path("out/map_Z.svg")) and os.path.exists(self.path("out/map_Z.csv")))

    def test_refused(self):
        for arguments, parts in [
            (["--value", "F"], ["table.csv: has no column F", "accepted: shape.aspect_ratio, phi"]),
            (["--value", "D", "--levels", "0.1,x"], ["--levels: x is not a number"]),
            (["--value", "D", "--levels", "0.1,"], ["--levels: is not a number"]),
            (["--value", "D", "--value", "E", "--levels", "0.1"], ["--levels is given 1 times and --value 2 times"]),
            (["--value", "D", "--where", "seed"], ["--where seed"]),
            (["--value", "D", "--where", "seed=5"], ["--where seed=5: no row"]),
            (["--value", "D", "--where", "sed=5"], ["did you mean seed?"]),
            (["--value", "equilibrated"], ["equilibrated of row 1 is true"]),
            (["--value", "D", "--out", "no/such/file.svg"], ["no/such/file.svg: cannot be written"]),
        ]:
            with self.subTest(arguments):
                result = self.map(*arguments)
                self.assertEqual(result.returncode, 1 if "--out" in arguments else 2)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                for part in parts:
                    self.assertIn(part, result.stderr)
        self.assert_refused(self.hardbody("map", "none.csv", "--x", "a", "--y", "b", "--value", "c"), "none.csv: cannot be read")


if __name__ == "__main__":
    unittest.main()
