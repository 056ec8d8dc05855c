"""Replicas of the points of a sweep, and sweeps as tasks of a cluster.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_replicas.py [TestClass[.test]]
"""

import concurrent.futures
import csv
import glob
import json
import math
import os
import resource
import signal
import socket
import subprocess
import time

import unittest

from test_cli import HARDBODY, SMALL
from test_sweep import GRID, SweepCase

ONE_KEY = "[grid]\nshape.aspect_ratio = [0.5, 2]\n"
REPLICAS = "replicas = 3\n" + SMALL + ONE_KEY
LONG = SMALL.replace("time = 5\n", "time = 100000\n").replace("events = 500", 'events = 500\ncheckpoint_every = "0.05s"')


class Replicas(SweepCase):
    def rows(self, name):
        with open(self.path(name), newline="") as file:
            return list(csv.DictReader(file))

    def test_pooled(self):
        self.assertEqual(self.sweep(SMALL + ONE_KEY, out="plain").returncode, 0)
        result = self.sweep(REPLICAS)
        self.assertEqual((result.returncode, result.stdout), (0, "out: 2 points of 3 replicas: 2 done, 0 failed\n"), result.stderr)
        names = [f"aspect_ratio={x}{r}" for x in ["0.5", "2"] for r in ["", "_replica=1", "_replica=2"]]
        self.assertEqual(sorted(n for n in os.listdir(self.path("out")) if "=" in n), sorted(names))
        runs = self.rows("out/replicas.csv")
        self.assertEqual([row["replica"] for row in runs], ["0", "1", "2"] * 2)
        self.assertEqual([row["seed"] for row in runs], ["3", "7344122643203664", "3918936048356100"] * 2)
        # Replica 0 is the run of a sweep without replicas.
        for row, plain in zip(runs[::3], self.table("plain")):
            self.assertEqual({k: v for k, v in row.items() if k not in ["replica", "wall_seconds", "collisions_per_second"]},
                             {k: v for k, v in plain.items() if k not in ["wall_seconds", "collisions_per_second"]})
        pooled = self.table()
        self.assertEqual([(row["seed"], row["replicas"], row["status"]) for row in pooled], [("3", "3", "done")] * 2)
        agreement = {(row["shape.aspect_ratio"], row["observable"]): row for row in self.rows("out/agreement.csv")}
        for point, row in enumerate(pooled):
            own = runs[3 * point : 3 * point + 3]
            for key in ["Z", "collision_rate"]:
                values, errors = [float(r[key]) for r in own], [float(r[key + "_error"]) for r in own]
                mean = sum(values) / 3
                self.assertAlmostEqual(float(row[key]), mean, delta=1e-12 * mean)
                within = math.sqrt(sum(e * e for e in errors)) / 3
                between = math.sqrt(sum((v - mean) ** 2 for v in values) / 6)
                self.assertAlmostEqual(float(row[key + "_error"]), max(within, 1.3210 * between), delta=1e-4 * mean)
                agree = agreement[row["shape.aspect_ratio"], key]
                self.assertAlmostEqual(float(agree["chi_square"]), 2 * (between / within) ** 2, delta=1e-6)
                self.assertEqual((agree["replicas"], agree["degrees_of_freedom"]), ("3", "2"))
                self.assertEqual((agree["value"], agree["error"]), (row[key], row[key + "_error"]))
            self.assertIn("D_trans" if row["D_trans"] == "" else "", row["message"])
        self.assertEqual(self.state("aspect_ratio=2_replica=1")["replica"], 1)
        # More replicas keep those that are there.
        before = {n: os.stat(self.path(f"out/{n}/summary.json")).st_mtime_ns for n in names}
        result = self.sweep(REPLICAS, "--set", "replicas=4")
        self.assertEqual(result.stdout, "out: 2 points of 4 replicas: 2 done, 0 failed\n", result.stderr)
        self.assertEqual(before, {n: os.stat(self.path(f"out/{n}/summary.json")).st_mtime_ns for n in names})
        self.assert_refused(self.sweep(REPLICAS), "sweep.toml:1: replicas is 3, but 4 in the sweep that out holds; accepted: as many or more")
        self.assertEqual(self.hardbody("report", "out").returncode, 0)
        self.assertEqual(self.hardbody("map", "out/replicas.csv", "--x", "replica", "--y", "aspect_ratio", "--value", "Z").returncode, 0)

    def test_one_state_point(self):
        self.write("run.toml", SMALL)
        result = self.hardbody("run", "run.toml", "--replicas", "2", "--out", "two")
        self.assertEqual((result.returncode, result.stdout), (0, "two: 1 points of 2 replicas: 1 done, 0 failed\n"), result.stderr)
        self.run_small("alone")
        self.assertEqual(self.state_of("two/replica=0"), self.state_of("alone"))
        self.assertEqual(self.table("two")[0]["replicas"], "2")
        self.assertEqual(self.hardbody("run", "run.toml", "--replicas", "2", "--out", "two").returncode, 0)
        self.assertEqual(self.hardbody("report", "two").returncode, 0)
        self.assert_refused(self.hardbody("run", "run.toml", "--replicas", "2", "--out", "two", "--force"), "--force cannot be combined")
        self.assert_refused(self.hardbody("run", "run.toml", "--replicas", "0"), "--replicas")
        self.write("many.toml", SMALL + GRID)
        self.assert_refused(self.hardbody("run", "many.toml", "--replicas", "2"), "many.toml:14: [grid] makes this a sweep")
        self.write("many.toml", REPLICAS)
        self.assert_refused(self.hardbody("run", "many.toml"), "hardbody sweep takes")

    def test_refused(self):
        for value in ["0", "1001", "2.0", '"8"']:
            with self.subTest(value):
                self.assert_refused(self.sweep(f"replicas = {value}\n" + SMALL + ONE_KEY), f"sweep.toml:1: replicas is {value}",
                                    "accepted: an integer from 1 to 1000")
        self.assert_refused(self.sweep("replica = 2\n" + SMALL + ONE_KEY), "unknown key replica, did you mean replicas?")

    def test_chains(self):
        text = 'chain = "system.packing_fraction"\nreplicas = 2\n' + SMALL + "[grid]\nsystem.packing_fraction = [0.1, 0.2]\n"
        result = self.sweep(text)
        self.assertEqual(result.returncode, 0, result.stderr)
        for end in ["", "_replica=1"]:
            self.assertIn(f"start: the last state of {self.here}/out/packing_fraction=0.1{end}, compressed",
                          self.read(f"out/packing_fraction=0.2{end}/log.txt"))


class Tasks(SweepCase):
    def task(self, action, *ids, out="out", **options):
        return self.hardbody("sweep", action, "sweep.toml", *ids, "--out", out, **options)

    def plan(self, text, *options, out="out"):
        self.write("sweep.toml", text)
        result = self.hardbody("sweep", "plan", "sweep.toml", "--out", out, *options)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(result.stdout, self.read(f"{out}/plan.json"))
        return json.loads(result.stdout)

    def begin(self, *ids):
        process = subprocess.Popen([HARDBODY, "sweep", "point", "sweep.toml", *ids, "--out", "out"], cwd=self.here,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.kill)
        return process

    def test_the_same_table(self):
        text = "replicas = 2\n" + SMALL + GRID
        self.assertEqual(self.sweep(text, out="whole").returncode, 0)
        plan = self.plan(text)
        self.assertEqual([task["runs"] for task in plan["tasks"]], [[run["id"] for run in plan["runs"]]])
        plan = self.plan(text, "--task-time", "1e-9")
        self.assertEqual([task["runs"] for task in plan["tasks"]], [[run["id"]] for run in plan["runs"]])
        self.assertEqual([task["id"] for task in plan["tasks"]], list(range(1, 9)))
        self.assertEqual(plan["runs"][3]["id"], "aspect_ratio=0.5_packing_fraction=0.2_replica=1")
        # By the configs alone: denser runs take longer, replicas as long as each other.
        costs = [run["expected_seconds"] for run in plan["runs"]]
        self.assertEqual(costs[::2], costs[1::2])
        self.assertGreater(costs[2], costs[0])
        self.assertTrue(all(0.01 < cost < 10 for cost in costs), costs)
        self.assertEqual(plan["expected_within_factor"], 1.3)
        self.assertEqual(self.task("collect").returncode, 75)
        # By number and by name, several at once, one of them twice.
        ids = ["8", "1", "2", "3", "1", plan["runs"][3]["id"], "5", "6", "7"]
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            statuses = list(pool.map(lambda k: self.task("point", k).returncode, ids))
        self.assertTrue(set(statuses) <= {0, 75}, statuses)
        result = self.task("point", *ids)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        result = self.task("collect")
        self.assertEqual((result.returncode, result.stdout), (0, "out: 4 points of 2 replicas: 4 done, 0 failed\n"), result.stderr)
        self.assertEqual(self.without_timing(), self.without_timing("whole"))
        self.assertEqual(self.read("out/agreement.csv"), self.read("whole/agreement.csv"))
        self.assertEqual(glob.glob(self.path("out/*/task.lock*")), [])
        # hardbody sweep takes it from there.
        self.assertEqual(self.sweep(text).returncode, 0)

    def test_bundles(self):
        text = SMALL + GRID
        names = [run["id"] for run in self.plan(text)["runs"]]
        self.assertEqual(self.task("point", *names[:3]).returncode, 0)
        larger = text.replace("to = 0.2", "to = 0.3")
        plan = self.plan(larger)
        left = [run["id"] for run in plan["runs"] if run["status"] != "done"]
        self.assertEqual([task["runs"] for task in plan["tasks"]], [left])
        self.assertGreater(plan["tasks"][0]["expected_seconds"], 0)
        self.assertGreater(plan["tasks"][0]["memory_bytes"], 1e6)
        self.assertGreaterEqual(plan["expected_within_factor"], 1)
        self.assertEqual(len(self.plan(larger, "--task-time", "1e-9")["tasks"]), 3)
        chain = 'chain = "system.packing_fraction"\n' + SMALL + "[grid]\nsystem.packing_fraction = [0.1, 0.2]\n"
        self.assertEqual([task["after"] for task in self.plan(chain, out="chain")["tasks"]], [[]])
        plan = self.plan(chain, "--task-time", "1e-9", out="chain")
        self.assertEqual([task["after"] for task in plan["tasks"]], [[], [1]])
        result = self.task("point", "2", out="chain")
        self.assertEqual(result.returncode, 75)
        self.assertEqual(result.stderr, "packing_fraction=0.2: starts from packing_fraction=0.1, which is not done\n")
        self.assertEqual(self.task("point", "1", "2", out="chain").returncode, 0)

    def test_signals_and_locks(self):
        text = LONG + ONE_KEY
        self.plan(text, "--task-time", "1e-9")
        first = "aspect_ratio=0.5"
        process = self.begin(first)
        self.wait_for(lambda: os.path.exists(self.path(f"out/{first}/checkpoint.bin")), "a checkpoint")
        result = self.task("point", "1")
        self.assertEqual(result.returncode, 75)
        self.assertRegex(result.stderr, rf"^{first}: process {process.pid} on .* works on it\n$")
        # The directory is shared by tasks; a sweep wants it alone.
        self.assert_refused(self.sweep(text), "out: another hardbody process is using it")
        self.assert_refused(self.task("plan"), "out: another hardbody process is using it")
        self.assertEqual(self.task("collect").returncode, 75)
        self.assertEqual(self.statuses(), ["running", "pending"])
        process.send_signal(signal.SIGUSR1)
        self.assertEqual(process.wait(timeout=60), 138)
        self.assertTrue(self.summary(f"out/{first}")["interrupted"])
        self.task("collect")
        self.assertEqual(self.statuses(), ["stopped", "pending"])
        # Killed: its run saves its state and ends; the lock is that of a process which is no more.
        process = self.begin(first)
        self.wait_for(lambda: not os.path.exists(self.path(f"out/{first}/summary.json")), "the run")
        process.kill()
        process.wait()
        self.assertTrue(os.path.exists(self.path(f"out/{first}/task.lock")))
        deadline = time.monotonic() + 60
        while True:
            process = self.begin(first)
            time.sleep(0.5)
            if process.poll() is None:
                break
            self.assertEqual(process.returncode, 75)
            self.assertLess(time.monotonic(), deadline)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=60), 143)
        self.assertFalse(os.path.exists(self.path(f"out/{first}/task.lock")))
        self.assertGreaterEqual(self.read(f"out/{first}/log.txt").count(": resumed"), 2)

    def test_locks_of_other_hosts(self):
        self.plan(SMALL + ONE_KEY)
        os.makedirs(self.path("out/aspect_ratio=2"), exist_ok=True)
        lock = self.path("out/aspect_ratio=2/task.lock")
        self.write("out/aspect_ratio=2/task.lock", json.dumps({"host": "elsewhere", "process": 1, "number": "x"}) + "\n")
        result = self.task("point", "aspect_ratio=2")
        self.assertEqual((result.returncode, result.stderr), (75, "aspect_ratio=2: process 1 on elsewhere works on it\n"))
        old = time.time() - 200
        os.utime(lock, (old, old))
        self.assertEqual(self.task("point", "aspect_ratio=2").returncode, 0)
        self.assertFalse(os.path.exists(lock))

    def test_hosts_of_one_name(self):
        # A process of this number is not here, but on another host of this name, or on this one before it was booted.
        self.plan(SMALL + ONE_KEY)
        os.makedirs(self.path("out/aspect_ratio=2"), exist_ok=True)
        lock = {"host": socket.gethostname(), "boot": "another", "namespace": "", "process": 2**22 + 1, "number": "x"}
        self.write("out/aspect_ratio=2/task.lock", json.dumps(lock) + "\n")
        result = self.task("point", "aspect_ratio=2")
        self.assertEqual(result.returncode, 75)
        self.assertIn("works on it", result.stderr)
        old = time.time() - 200
        os.utime(self.path("out/aspect_ratio=2/task.lock"), (old, old))
        self.assertEqual(self.task("point", "aspect_ratio=2").returncode, 0)

    def test_a_paused_task_keeps_its_run(self):
        self.plan(LONG + ONE_KEY)
        first = "aspect_ratio=0.5"
        process = self.begin(first)
        self.wait_for(lambda: os.path.exists(self.path(f"out/{first}/checkpoint.bin")), "a checkpoint")
        os.kill(process.pid, signal.SIGSTOP)
        lock = self.path(f"out/{first}/task.lock")
        old = time.time() - 200
        os.utime(lock, (old, old))
        result = self.task("point", first)
        self.assertEqual(result.returncode, 75)
        self.assertIn("another hardbody process is using it", result.stderr)
        self.assertTrue(os.path.exists(lock))
        process.send_signal(signal.SIGTERM)
        process.send_signal(signal.SIGCONT)
        self.assertEqual(process.wait(timeout=60), 143)
        self.assertTrue(self.summary(f"out/{first}")["interrupted"])

    def test_signals_that_are_repeated(self):
        # As a scheduler sends them, to the task and again, and as its run gets another one when the task ends.
        self.plan(LONG + ONE_KEY)
        first = "aspect_ratio=0.5"
        process = self.begin(first)
        self.wait_for(lambda: os.path.exists(self.path(f"out/{first}/checkpoint.bin")), "a checkpoint")
        for _ in range(5):
            process.send_signal(signal.SIGTERM)
            time.sleep(0.02)
        self.assertEqual(process.wait(timeout=60), 143)
        self.assertEqual(process.stderr.read(), f"{first}: stopped, its state is saved\n")
        self.assertTrue(self.summary(f"out/{first}")["interrupted"])
        self.assertEqual(self.state(first)["status"], "stopped")

    def test_what_a_sweep_could_not_complete(self):
        # Memory was short, say: on another machine there is more.
        text = LONG + ONE_KEY
        process = self.start(text, "--jobs", "1")
        self.wait_for(lambda: os.path.exists(self.path("out/aspect_ratio=0.5/checkpoint.bin")), "a checkpoint")
        children = self.read(f"/proc/{process.pid}/task/{process.pid}/children").split()
        os.kill(int(children[0]), signal.SIGKILL)
        self.wait_for(lambda: self.state("aspect_ratio=0.5")["status"] == "failed", "the failure")
        self.assertEqual(self.state("aspect_ratio=0.5")["message"], "ended by signal 9")
        self.wait_for(lambda: os.path.exists(self.path("out/aspect_ratio=2/checkpoint.bin")), "the second run's checkpoint")
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=60), 143)
        self.assertEqual(self.task("collect").returncode, 75)
        self.assertEqual(self.statuses(), ["failed", "stopped"])
        plan = self.plan(text)
        self.assertEqual([task["runs"] for task in plan["tasks"]], [["aspect_ratio=0.5", "aspect_ratio=2"]])

    def test_failures_of_the_machine(self):
        self.plan(SMALL + ONE_KEY)
        for files in (4, 5, 6, 7):
            limit = lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (files, files))
            result = self.task("point", "aspect_ratio=2", preexec_fn=limit)
            self.assertIn(result.returncode, (0, 2, 75), f"{files}: {result.stderr}")
            if os.path.exists(self.path("out/aspect_ratio=2/state.json")):
                self.assertNotEqual(self.state("aspect_ratio=2")["status"], "failed", files)
        self.assertEqual(self.task("point", "aspect_ratio=2").returncode, 0)

    def test_the_same_sweep_in_other_words(self):
        self.plan(SMALL + ONE_KEY)
        self.write("sweep.toml", SMALL.replace("number = 64\npacking_fraction = 0.2\n", "packing_fraction = 0.20\nnumber = 64\n")
                   + ONE_KEY.replace("2]", "2.0]"))
        self.assertEqual(self.task("point", "aspect_ratio=2").returncode, 0)
        self.assertEqual(self.task("collect").returncode, 75)

    def test_time_limit(self):
        self.plan(LONG + ONE_KEY)
        begin = time.monotonic()
        result = self.task("point", "1", "--time-limit", "3")  # the start is over by then on a busy machine, too
        self.assertEqual((result.returncode, result.stderr), (138, "aspect_ratio=0.5: stopped, its state is saved\n"))
        self.assertLess(time.monotonic() - begin, 60)
        self.assertTrue(self.summary("out/aspect_ratio=0.5")["interrupted"])
        self.assertFalse(os.path.exists(self.path("out/aspect_ratio=2")))
        # A report shows the sweep as it is, without a table that was made before.
        self.assertFalse(os.path.exists(self.path("out/sweep.csv")))
        result = self.hardbody("report", "out")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(self.statuses(), ["stopped", "pending"])

    def test_failed_along_a_chain(self):
        # The first cannot be run, and no task of the plan is for it; the others start from each other, each in a task of its own.
        text = 'chain = "system.packing_fraction"\n' + SMALL + "[grid]\nsystem.packing_fraction = [-0.1, 0.1, 0.2]\n"
        plan = self.plan(text, "--task-time", "1e-9")
        self.assertEqual([task["runs"] for task in plan["tasks"]], [["packing_fraction=0.1"], ["packing_fraction=0.2"]])
        for name in ["packing_fraction=0.1", "packing_fraction=0.2"]:
            result = self.task("point", name)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn("which failed", result.stderr)

    def test_failed_for_good(self):
        self.plan(SMALL + "[grid]\nsystem.packing_fraction = [0.2, 0.99]\n")
        result = self.task("point", "packing_fraction=0.99", "packing_fraction=0.2")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 1)
        self.assertIn("0.99", result.stderr)
        result = self.task("collect")
        self.assertEqual(result.returncode, 1)
        self.assertIn("2 points: 1 done, 1 failed", result.stdout)

    def test_failed_and_to_do(self):
        # What another attempt may complete counts more than a failure, for the table as for tasks.
        self.plan(SMALL + "[grid]\nsystem.packing_fraction = [0.2, 0.99]\n")
        self.assertEqual(self.task("point", "packing_fraction=0.99").returncode, 1)
        result = self.task("collect")
        self.assertEqual((result.returncode, result.stdout.splitlines()[0]), (75, "out: 2 points: 0 done, 1 failed, 1 to do"))
        # A point has failed with its first replica; the second one is to do.
        os.makedirs(self.path("two/replica=0"))
        self.write("sweep.toml", "replicas = 2\n" + SMALL)
        self.write("two/sweep.toml", "replicas = 2\n" + SMALL)
        self.assertEqual(self.task("plan", out="two").returncode, 0)
        self.write("two/replica=0/summary.json", "{}\n")
        result = self.task("collect", out="two")
        self.assertEqual((result.returncode, result.stdout.splitlines()[0]), (75, "two: 1 points of 2 replicas: 0 done, 1 failed"))

    def test_refused(self):
        self.write("sweep.toml", SMALL + ONE_KEY)
        self.assert_refused(self.task("point", "1"), "out: holds no sweep; accepted: the directory of a sweep after hardbody sweep plan")
        self.plan(SMALL + ONE_KEY)
        self.assert_refused(self.task("point", "9"), "9: no run or task of this sweep has this id; accepted: the number of a task in out/plan.json")
        self.assert_refused(self.task("point", "aspect_ratio=9"), "aspect_ratio=9: no run or task", "accepted: an id in out/plan.json")
        self.assert_refused(self.task("point"), "hardbody sweep point sweep.toml; accepted: SWEEP, plan SWEEP, point SWEEP ID.., or collect SWEEP")
        self.assert_refused(self.task("plan", "1"), "accepted: SWEEP, plan SWEEP")
        self.assert_refused(self.task("plan", "--time-limit", "2"), "--time-limit with plan; accepted: with hardbody sweep point")
        self.assert_refused(self.task("plan", "--on", "slurm"), "--on with plan; accepted: hardbody sweep SWEEP --on NAME")
        self.assert_refused(self.task("plan", "--jobs", "2"), "--jobs with plan; accepted: hardbody sweep SWEEP --jobs N")
        self.assert_refused(self.hardbody("sweep", "plan", "sweep.toml", "--task-time", "0"), "--task-time")
        self.assert_refused(self.task("collect", "--task-time", "5"), "--task-time with collect; accepted: with hardbody sweep plan, or --on")
        self.assert_refused(self.hardbody("sweep", "sweep.toml", "--task-time", "5"), "--task-time; accepted: with hardbody sweep plan, or --on")
        self.assert_refused(self.hardbody("sweep", "collect", "sweep.toml", "--out", "out", "--set", "grid.shape.aspect_ratio=[0.5, 2, 3]"),
                            "out: holds this sweep with fewer points or replicas")


# Stands in for Snakemake: runs the tasks of tasks.json one after the other, as the rules of the workflow do.
ENGINE = """#!/usr/bin/python3
import json, pathlib, signal, subprocess, sys
stopped = []
signal.signal(signal.SIGINT, lambda *_: stopped.append(True))  # as Snakemake, it waits for what runs
if sys.argv[1:] == ["--version"]:
    print("{version}")
    sys.exit()
config = json.load(open(sys.argv[sys.argv.index("--configfile") + 1]))
{body}
for task in json.load(open(config["tasks"])):
    if stopped:
        break
    mark = pathlib.Path("tasks") / str(task["id"])
    mark.with_suffix(".begun").touch()
    command = [*config["program"], "sweep", "point", config["sweep"], "--out", config["directory"], str(task["id"])]
    status = subprocess.run(command).returncode
    if status in (0, 1):
        mark.with_suffix(".done").write_text(str(status))
"""


class Workflow(SweepCase):
    def engine(self, version="9.27.1", body=""):
        os.makedirs(self.path("bin"), exist_ok=True)
        self.write("bin/snakemake", ENGINE.format(version=version, body=body))
        os.chmod(self.path("bin/snakemake"), 0o755)
        return {**os.environ, "PATH": self.path("bin")}

    def on(self, name, text, *options, env):
        self.write("sweep.toml", text)
        return subprocess.run([HARDBODY, "sweep", "sweep.toml", "--out", "out", "--on", name, *options], cwd=self.here, env=env,
                              capture_output=True, text=True, timeout=120, stdin=subprocess.DEVNULL)

    def test_the_same_table(self):
        text = "replicas = 2\n" + SMALL + GRID
        self.assertEqual(self.sweep(text, out="whole").returncode, 0)
        result = self.on("local", text, "--task-time", "0.2", env=self.engine())
        self.assertEqual((result.returncode, result.stdout), (0, "out: 4 points of 2 replicas: 4 done, 0 failed\n"), result.stderr)
        self.assertEqual(self.without_timing(), self.without_timing("whole"))
        self.assertGreater(len(glob.glob(self.path("out/workflow/tasks/*.done"))), 1)
        # There is nothing left to do, and nothing is started for it.
        result = self.on("local", text, env=self.engine(body="sys.exit(1)"))
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_a_task_for_each_job(self):
        """On this machine it is known how many tasks run at once: short sweeps are not one task."""
        text = SMALL + GRID
        for options, jobs in [([], len(os.sched_getaffinity(0))), (["--jobs", "3"], 3), (["--jobs", "64"], 64)]:
            with self.subTest(options):
                result = self.on("local", text, *options, env=self.engine(body="sys.exit(1)"))
                self.assertEqual(result.returncode, 1, result.stderr)
                plan = json.loads(self.read("out/plan.json"))
                self.assertEqual((plan["jobs"], len(plan["tasks"])), (jobs, min(jobs, 4)))
        # Elsewhere it is not.
        os.makedirs(self.path("profile"))
        self.write("profile/config.yaml", "executor: local\n")
        self.on("profile", text, "--jobs", "3", env=self.engine(body="sys.exit(1)"))
        plan = json.loads(self.read("out/plan.json"))
        self.assertEqual((plan["jobs"], len(plan["tasks"])), (None, 1))

    def test_stopped(self):
        env = self.engine()
        process = self.start(LONG + ONE_KEY, "--on", "local", "--task-time", "1e-9", env=env)
        self.wait_for(lambda: os.path.exists(self.path("out/aspect_ratio=0.5/checkpoint.bin")), "a checkpoint")
        # Neither a sweep here nor a second workflow may use the directory.
        self.assert_refused(self.sweep(LONG + ONE_KEY), "out: another hardbody process is using it")
        self.assert_refused(self.on("local", LONG + ONE_KEY, env=env), "out: another hardbody process is using it")
        process.send_signal(signal.SIGTERM)
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 143, said)
        self.assertIn("out: stopped by SIGTERM: the same command continues", said)
        self.assertTrue(self.summary("out/aspect_ratio=0.5")["interrupted"])
        self.assertEqual(glob.glob(self.path("out/*/task.lock")), [])

    def test_slurm_without_accounts(self):
        env = self.engine(body='open("arguments", "w").write(" ".join(sys.argv)); sys.exit(1)')
        for name in ["sbatch", "squeue", "scancel", "sacct"]:
            self.write(f"bin/{name}", "#!/bin/sh\nexit ${accounts:-0}\n")
            os.chmod(self.path(f"bin/{name}"), 0o755)
        for accounts, told in [("0", False), ("1", True)]:
            with self.subTest(accounts):
                self.on("slurm", SMALL + ONE_KEY, env={**env, "accounts": accounts})
                self.assertEqual("--slurm-status-command squeue" in self.read("out/workflow/arguments"), told)

    def test_tasks_that_do_not_begin(self):
        text = SMALL + ONE_KEY
        result = self.on("local", text, env=self.engine(body='print("WorkflowError: no queue"); sys.exit(1)'))
        self.assertEqual(result.returncode, 1)
        self.assertIn("out: no task has begun: WorkflowError: no queue; see out/workflow/log.txt; machines that run tasks must see", result.stderr)

    def test_tasks_that_fail_before_they_begin(self):
        """As Snakemake where the program is not found by jobs; it would try 20 times. Stopped, it ends."""
        body = """print("Error in rule task:", "    log: /somewhere/1.log (check log file(s) for error details)", sep="\\n", flush=True)
import time
for _ in range(600):
    print("Error in rule task:", flush=True)
    time.sleep(0.1)
    if stopped:
        print("WorkflowError:", "stopped", sep="\\n", flush=True)
        sys.exit(1)"""
        result = self.on("local", SMALL + ONE_KEY, "--task-time", "1e-9", env=self.engine(body=body))
        self.assertEqual(result.returncode, 1)
        self.assertIn("out: no task has begun: WorkflowError: stopped; a job's log is /somewhere/1.log; see out/workflow/log.txt; machines that",
                      result.stderr)

    def test_refused(self):
        text = SMALL + ONE_KEY
        self.assert_refused(self.on("slurm", text, env={**os.environ, "PATH": self.path("nowhere")}),
                            "--on slurm: snakemake is not installed; accepted: Snakemake 8 or newer: pip install snakemake")
        self.assert_refused(self.on("local", text, env=self.engine("7.32.4")), "snakemake --version prints 7.32.4; accepted: Snakemake 8")
        self.assert_refused(self.on("slurm", text, env=self.engine()), "--on slurm: sbatch is not installed; accepted: a machine from which")
        for jobs in ["0", "-2", "1025"]:
            self.assert_refused(self.on("local", text, "--jobs", jobs, env=self.engine()), f"--jobs is {jobs}; accepted: an integer from 1 to 1024")
        self.assert_refused(self.on("slurm", text, "--jobs", "0", env=self.engine()), "--jobs is 0; accepted: an integer from 1 to 100000")
        self.assert_refused(self.on("cloud", text, env=self.engine()), "--on cloud; accepted: slurm, local, or the directory of a Snakemake profile")
        self.assertFalse(os.path.exists(self.path("out")))


if __name__ == "__main__":
    unittest.main()
