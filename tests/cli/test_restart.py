"""Runs that are stopped, killed, short of disk or not alone: what `hardbody resume` makes of them.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_restart.py [TestClass[.test]]

HARDBODY_FULL=1 kills a hundred runs instead of twelve.
"""

import json
import os
import re
import random
import resource
import shutil
import signal
import subprocess
import time
import unittest

from test_cli import FULL, HARDBODY, MIXTURE, SMALL, Case


# Of about a second each, with some tens of checkpoints.
OFTEN = 'events = 2000\ncheckpoint_every = "0.02s"'
SUPERBALL = 'kind = "superellipsoid"\nsemi_axes = [1, 1, 1]\nexponents = [0.5, 0.5]'


def config(shape="aspect_ratio = 2", dynamics="", base=SMALL, equilibration=20, production=60):
    text = base.replace("aspect_ratio = 2", shape).replace("events = 500", OFTEN)
    text = text.replace("time = 5\n", f"time = {production}\n").replace("time = 1\n", f"time = {equilibration}\n")
    return text + (f"[dynamics]\n{dynamics}\n" if dynamics else "")


# Every family of bodies, and every finder and kind of neighbour list with one of them.
RUNS = {
    "rods": config(equilibration=150, production=100),
    "superballs": config(SUPERBALL, 'neighbours = "obp"', equilibration=60, production=8),
    "mixture": config(base=MIXTURE, equilibration=15, production=3),
    "rods by the paper": config(dynamics='finder = "bracketing"\nneighbours = "obp"', equilibration=15, production=5),
    "spinning discs": config("aspect_ratio = 0.5", 'inertia = "uniform"\nneighbours = "cells"', equilibration=150, production=30),
    "three axes": config("semi_axes = [1, 0.8, 0.6]", equilibration=50, production=1),
    "superellipsoids": config(
        'kind = "superellipsoid"\nsemi_axes = [1, 0.8, 0.6]\nexponents = [0.7, 1.3]',
        'finder = "bracketing"\nneighbours = "cells"', equilibration=6, production=0.4,
    ),
    "auto": config(dynamics='neighbours = "cells"').replace("time = 20\n", 'time = "auto"\n').replace("60\n", '"auto"\n'),
    "until precise": config().replace("time = 20\n", 'time = "auto"\n').replace("60\n", '"auto"\ntarget_error = 0.08\n'),
}

TRAJECTORIES = ["trajectory.gsd", "trajectory.lammpstrj", "trajectory.vtp"]


def with_trajectories(text, frames):
    return text.replace("[output]\n", f'[output]\ntrajectory = ["gsd", "lammps", "vtk"]\nframes = {frames}\n')


RUNS["rods with trajectories"] = with_trajectories(RUNS["rods"], 60)
RUNS["mixture with trajectories"] = with_trajectories(RUNS["mixture"], 15)
RUNS["trajectories until precise"] = with_trajectories(RUNS["until precise"], 1000)


class Restart(Case):
    def start(self, *arguments, **options):
        process = subprocess.Popen(
            [HARDBODY, *arguments],
            **{"cwd": self.here, "stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "text": True, **options},
        )
        self.addCleanup(process.stderr.close)
        if process.stdout:
            self.addCleanup(process.stdout.close)
        self.addCleanup(process.kill)
        return process

    def stop(self, process, number=signal.SIGKILL):
        """The exit status; that of the process itself if it was faster."""
        process.send_signal(number)
        return process.wait(timeout=60)

    def wait_for(self, holds, what):
        deadline = time.monotonic() + 60
        while not holds():
            self.assertLess(time.monotonic(), deadline, f"{what} never came")
            time.sleep(0.002)

    def log_has(self, out, text):
        return os.path.exists(self.path(f"{out}/log.txt")) and text in self.read(f"{out}/log.txt")

    def undisturbed(self, out, text):
        """Runs it to its end; returns the seconds that took."""
        return self.run_small(out, config=text).seconds

    def results(self, out):
        """All that a run says of itself and its bodies, timing apart."""
        files = {name: self.bytes_of(f"{out}/observables/{name}") for name in sorted(os.listdir(self.path(f"{out}/observables")))}
        summary = self.summary(out)
        del summary["performance"]
        files["summary.json"] = json.dumps(summary)
        files["events.csv"] = self.bytes_of(f"{out}/events.csv")
        files["config.toml"] = self.bytes_of(f"{out}/config.toml")
        files["checkpoint.bin"] = self.state_of(out)
        for name in TRAJECTORIES:
            if os.path.exists(self.path(f"{out}/{name}")):
                files[name] = self.bytes_of(f"{out}/{name}")
        return files

    def assert_same_run(self, out, expected):
        results = self.results(out)
        self.assertEqual(sorted(results), sorted(expected))
        for name, content in expected.items():
            self.assertTrue(results[name] == content, f"{out}/{name} differs")
        self.assertEqual([f for f in os.listdir(self.path(out)) if f.endswith(".part")], [])

    def resume(self, out):
        result = self.hardbody("resume", out)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def everything(self, out):
        """All names, contents and times of change."""
        found = {}
        for directory, _, names in os.walk(self.path(out)):
            for name in names:
                path = os.path.join(directory, name)
                with open(path, "rb") as file:
                    found[path] = (file.read(), os.stat(path).st_mtime_ns)
        return found

    def assert_refused_untouched(self, out, *parts):
        before = self.everything(out)
        self.assert_refused(self.hardbody("resume", out), "accepted: ", *parts)
        self.assertEqual(self.everything(out), before)


class Kills(Restart):
    def test_at_any_moment(self):
        """kill -9, resumed (and killed again now and then): the same bytes as without."""
        draws = random.Random(1)
        kills = 100 if FULL else 12
        expected = {}
        seconds = {}
        where = {}
        for k in range(kills):
            name = list(RUNS)[k % len(RUNS)]
            if name not in expected:
                seconds[name] = self.undisturbed("reference", RUNS[name])
                expected[name] = self.results("reference")
                shutil.rmtree(self.path("reference"))
            with self.subTest(name, kill=k):
                self.write("run.toml", RUNS[name])
                command = ["run", "run.toml", "--out", "out"]
                killed = 0
                while True:
                    process = self.start(*command)
                    time.sleep(draws.uniform(0, seconds[name]))
                    status = self.stop(process)
                    self.assertIn(status, [0, -signal.SIGKILL], process.stderr.read())
                    if status == 0 and killed > 0:
                        break
                    if status == 0:  # it was faster: this was no kill
                        shutil.rmtree(self.path("out"))
                        continue
                    killed += 1
                    phase = self.phase("out")
                    where[phase] = where.get(phase, 0) + 1
                    # Before there is a config there is no run to go on with.
                    command = ["resume", "out"] if os.path.exists(self.path("out/config.toml")) else command
                    if draws.random() < 0.7:
                        break
                self.assertEqual(self.hardbody(*command).returncode, 0)
                self.assert_same_run("out", expected[name])
                shutil.rmtree(self.path("out"))
        print(f"killed {sum(where.values())} times: {where}")
        self.assertGreaterEqual(sum(where.values()), kills)
        for phase in ["equilibration", "production"]:
            self.assertGreaterEqual(where.get(phase, 0), 5 if FULL else 1, phase)

    def phase(self, out):
        if not os.path.exists(self.path(f"{out}/log.txt")):
            return "nothing yet"
        log = self.read(f"{out}/log.txt")
        for phase, text in [("finished", " end\n"), ("writing", "production: done"), ("production", "production: "),
                            ("equilibration", "finder: "), ("start", "start: ")]:
            if text in log:
                return phase
        return "nothing yet"

    def test_while_a_checkpoint_is_written(self):
        self.undisturbed("reference", RUNS["rods"])
        expected = self.results("reference")
        caught = tries = 0
        while caught < 2 and tries < 40:
            tries += 1
            self.write("run.toml", RUNS["rods"])
            process = self.start("run", "run.toml", "--out", "out")
            part = self.path("out/checkpoint.bin.part")
            self.wait_for(lambda: os.path.exists(part) or process.poll() is not None, "a checkpoint")
            self.stop(process)
            caught += os.path.exists(part)
            self.resume("out")
            self.assert_same_run("out", expected)
            shutil.rmtree(self.path("out"))
        print(f"killed in the middle of writing {caught} times of {tries}")
        self.assertGreater(caught, 0)


class Stops(Restart):
    def test_signals_in_every_phase(self):
        text = RUNS["rods"]
        self.undisturbed("reference", text)
        expected = self.results("reference")
        for number, status in [(signal.SIGTERM, 143), (signal.SIGINT, 130)]:
            for phase in ["start: ", "finder: ", "envelope thickness", "production: "]:
                with self.subTest(number=number, phase=phase):
                    self.write("run.toml", text)
                    process = self.start("run", "run.toml", "--out", "out")
                    self.wait_for(lambda: self.log_has("out", phase), phase)
                    self.assertEqual(self.stop(process, number), status)
                    self.assertEqual(self.hardbody("check", "out").returncode if self.has("out/checkpoint.bin") else 0, 0)
                    self.resume("out")
                    self.assert_same_run("out", expected)
                    shutil.rmtree(self.path("out"))

    def has(self, name):
        return os.path.exists(self.path(name))

    def test_many_times(self):
        text = config(SUPERBALL, 'neighbours = "obp"', equilibration=60, production=8)
        self.undisturbed("reference", text)
        self.write("run.toml", text)
        command = ["run", "run.toml", "--out", "out"]
        stops = 0
        wait = 0.1
        while True:
            process = self.start(*command)
            # Longer each time: a slow machine may need more than 0.1 s to read the checkpoint.
            time.sleep(wait)
            wait *= 1.3
            status = self.stop(process, signal.SIGTERM)
            command = ["resume", "out"]
            if status == 0:
                break
            # Before the program has its own handlers the signal just ends it.
            self.assertIn(status, [143, -signal.SIGTERM], process.stderr.read())
            stops += 1
            self.assertLess(stops, 80)
        self.assertGreater(stops, 2)
        self.assert_same_run("out", self.results("reference"))
        self.assertGreaterEqual(self.summary("out")["performance"]["resumed"], 1)

    def test_without_a_checkpoint_it_starts_over(self):
        text = config().replace(OFTEN, "events = 2000")
        self.undisturbed("reference", text)
        self.write("run.toml", text)
        process = self.start("run", "run.toml", "--out", "out")
        self.wait_for(lambda: self.log_has("out", "envelope thickness"), "equilibration")
        self.stop(process)
        self.assertFalse(self.has("out/checkpoint.bin"))
        self.resume("out")
        self.assertIn("starts over", self.read("out/log.txt"))
        self.assert_same_run("out", self.results("reference"))

    def assert_left_alone(self, out, **options):
        before = self.everything(out)
        result = subprocess.run(
            [HARDBODY, "resume", out], cwd=self.here, capture_output=True, text=True, timeout=60, **options
        )
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(f"{out}: the run is finished", result.stdout)
        self.assertEqual(self.everything(out), before)

    def test_a_finished_run_is_left_alone(self):
        self.run_small("out")
        self.assert_left_alone("out")
        # Where nothing may be written, too. Root may write anywhere.
        self.addCleanup(os.chmod, self.path("out"), 0o755)
        os.chmod(self.path("out"), 0o555)
        os.chmod(self.here, 0o755)
        self.assert_left_alone("out", **({"user": 65534} if os.geteuid() == 0 else {}))
        os.chmod(self.path("out"), 0o755)
        os.remove(self.path("out/checkpoint.bin"))
        self.assert_left_alone("out")

    def test_a_stopped_run_without_its_checkpoint_starts_over(self):
        text = RUNS["rods"]
        self.undisturbed("reference", text)
        self.write("run.toml", text)
        process = self.start("run", "run.toml", "--out", "out")
        self.wait_for(lambda: self.log_has("out", "production: "), "production")
        self.assertEqual(self.stop(process, signal.SIGTERM), 143)
        self.assertTrue(self.summary("out")["interrupted"])
        os.remove(self.path("out/checkpoint.bin"))
        self.resume("out")
        self.assertIn("starts over", self.read("out/log.txt"))
        self.assert_same_run("out", self.results("reference"))

    def test_a_start_from_a_file_that_is_gone(self):
        """The run has it in its first checkpoint, however short it has been at work."""
        origin = config(equilibration=1, production=1).replace(OFTEN, 'trajectory = ["gsd"]\nframes = 2')
        self.run_small("origin", config=origin)
        shutil.copy(self.path("origin/trajectory.gsd"), self.path("state.gsd"))
        text = (
            f'seed = 3\n[start]\nfile = "{self.path("state.gsd")}"\n[shape]\naspect_ratio = 2\n'
            '[equilibration]\ntime = 20\n[production]\ntime = 60\n[output]\nevents = 2000\ncheckpoint_every = "9h"\n'
        )
        self.undisturbed("reference", text)
        expected = self.results("reference")
        for gone in [True, False]:
            with self.subTest(gone=gone):
                shutil.copy(self.path("origin/trajectory.gsd"), self.path("state.gsd"))
                self.write("run.toml", text)
                process = self.start("run", "run.toml", "--out", "out")
                self.wait_for(lambda: self.log_has("out", "equilibration: "), "equilibration")
                self.assertEqual(self.stop(process), -signal.SIGKILL)
                os.remove(self.path("state.gsd"))
                if not gone:
                    self.run_small("other", config=origin.replace("seed = 3", "seed = 4"))
                    shutil.copy(self.path("other/trajectory.gsd"), self.path("state.gsd"))
                self.resume("out")
                self.assert_same_run("out", expected)
                shutil.rmtree(self.path("out"))

    def test_a_lost_terminal_and_the_end_of_the_processor_time(self):
        text = RUNS["rods"]
        self.undisturbed("reference", text)
        expected = self.results("reference")
        self.write("run.toml", text)
        for number in [signal.SIGHUP, signal.SIGXCPU]:
            with self.subTest(number=number):
                process = self.start("run", "run.toml", "--out", "out")
                self.wait_for(lambda: self.log_has("out", "production: "), "production")
                # Such signals come again while the run saves its state.
                process.send_signal(number)
                self.assertEqual(self.stop(process, number), 128 + number)
                self.assertIn(f"stopped by {number.name}", self.read("out/log.txt"))
                self.resume("out")
                self.assert_same_run("out", expected)
                shutil.rmtree(self.path("out"))
        # Under nohup the terminal does not matter.
        ignoring = {"preexec_fn": lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)}
        process = self.start("run", "run.toml", "--out", "out", **ignoring)
        self.wait_for(lambda: self.log_has("out", "production: "), "production")
        process.send_signal(signal.SIGHUP)
        self.assertEqual(process.wait(timeout=60), 0)
        self.assert_same_run("out", expected)

    def test_during_the_start(self):
        self.write("run.toml", config().replace("number = 64", "number = 900").replace("packing_fraction = 0.2", "packing_fraction = 0.6"))
        process = self.start("run", "run.toml", "--out", "out")
        self.wait_for(lambda: self.log_has("out", "start: "), "the start")
        self.assertEqual(self.stop(process, signal.SIGTERM), 143)
        self.assertIn(
            "stopped by SIGTERM during the start: nothing was measured, and the start is not saved: hardbody resume begins it again",
            process.stderr.read(),
        )

    def test_killed_before_the_summary(self):
        self.run_small("out")
        expected = self.results("out")
        os.remove(self.path("out/summary.json"))
        os.remove(self.path("out/observables/msd.csv"))
        self.resume("out")
        self.assert_same_run("out", expected)

    def test_results_of_a_stopped_run_do_not_outlive_it(self):
        self.write("run.toml", config(production=100000))
        process = self.start("run", "run.toml", "--out", "out")
        self.wait_for(lambda: self.log_has("out", "production: "), "production")
        self.stop(process, signal.SIGTERM)
        self.assertTrue(self.summary("out")["interrupted"])
        process = self.start("resume", "out")
        self.wait_for(lambda: self.log_has("out", "resumed from production"), "production")
        self.stop(process)
        self.assertFalse(self.has("out/summary.json"))

    def test_checkpoints_change_nothing(self):
        often = config(production=30)
        self.run_small("often", config=often)
        self.run_small("never", config=often.replace(OFTEN, 'events = 2000\ncheckpoint_every = "9h"'))
        self.assertGreater(self.summary("often")["performance"]["checkpoints"], 3)
        self.assertEqual(self.summary("never")["performance"]["checkpoints"], 1)  # the last state
        often, never = self.results("often"), self.results("never")
        for name in set(often) - {"config.toml", "checkpoint.bin"}:
            self.assertTrue(often[name] == never[name], name)


class Refusals(Restart):
    """One line, exit status 2, nothing touched."""

    def stopped(self):
        self.write("run.toml", config(production=100000))
        process = self.start("run", "run.toml", "--out", "out")
        self.wait_for(lambda: self.log_has("out", "production: "), "production")
        time.sleep(0.2)
        self.stop(process, signal.SIGTERM)

    def change(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content)

    def test_no_run(self):
        self.assert_refused(self.hardbody("resume", "none"), "none: is not there", "accepted: the directory of a run")
        self.write("file", "x")
        self.assert_refused(self.hardbody("resume", "file"), "file: is not a directory")
        os.makedirs(self.path("empty"))
        self.assert_refused(self.hardbody("resume", "empty"), "empty: holds no run: config.toml is missing")
        self.assert_refused(self.hardbody("resume"), "hardbody resume --help")

    def test_pipes(self):
        """Nobody writes them: a program that opens one waits for ever."""
        self.stopped()
        for name in ["checkpoint.bin", "config.toml", "summary.json"]:
            with self.subTest(name):
                good = self.bytes_of(f"out/{name}")
                os.remove(self.path(f"out/{name}"))
                os.mkfifo(self.path(f"out/{name}"))
                result = self.hardbody("resume", "out", timeout=20)
                self.assert_refused(result, f"out/{name}: cannot be read: it is not a file", "accepted: ")
                os.remove(self.path(f"out/{name}"))
                self.change(f"out/{name}", good)

    def test_changed_config(self):
        self.stopped()
        good = self.read("out/config.toml")
        for old, new, key in [
            ("time = 100000.0", "time = 99.0", "production.time is 99.0, the checkpoint was made with 100000.0"),
            ("seed = 3", "seed = 4", "seed is 4"),
            ("events = 2000", "events = 2001", "output.events is 2001"),
            ("trajectory = []", 'trajectory = ["gsd"]', 'output.trajectory is ["gsd"], the checkpoint was made with []'),
            ("frames = 100", "frames = 99", "output.frames is 99"),
            ("aspect_ratio = 2.0", "semi_axes = [1.0, 1.0, 3.0]", "shape.semi_axes is [1.0, 1.0, 3.0], the checkpoint was made with nothing"),
        ]:
            with self.subTest(new):
                self.assertIn(old, good)
                self.change("out/config.toml", good.replace(old, new).encode())
                self.assert_refused_untouched("out", "out/config.toml: " + key)
        # Written otherwise, the same config is the same.
        self.change("out/config.toml", b"# a remark\n" + good.replace("seed = 3", "seed   =   3").encode())
        process = self.start("resume", "out")
        self.wait_for(lambda: self.log_has("out", "resumed from production"), "production")
        self.assertEqual(self.stop(process, signal.SIGTERM), 143)

    def test_damaged_checkpoint(self):
        self.stopped()
        good = self.bytes_of("out/checkpoint.bin")
        draws = random.Random(2)
        for length in [0, 7, 30, len(good) // 2, len(good) - 1]:
            with self.subTest(length=length):
                self.change("out/checkpoint.bin", good[:length])
                self.assert_refused_untouched("out", "out/checkpoint.bin")
        for position in [0, 9, 13, 17] + [draws.randrange(len(good)) for _ in range(10)]:
            with self.subTest(position=position):
                flipped = bytearray(good)
                flipped[position] ^= 0x10
                self.change("out/checkpoint.bin", bytes(flipped))
                self.assert_refused_untouched("out", "out/checkpoint.bin")

    def test_events_file(self):
        self.stopped()
        good = self.bytes_of("out/events.csv")
        self.change("out/events.csv", good[:-1])
        self.assert_refused_untouched("out", f"out/events.csv: has {len(good) - 1} bytes, {len(good)} when")
        os.remove(self.path("out/events.csv"))
        self.assert_refused_untouched("out", "out/events.csv: has 0 bytes")

    def test_trajectory_file(self):
        self.write("run.toml", with_trajectories(config(production=10000), 10000))
        process = self.start("run", "run.toml", "--out", "out")
        self.wait_for(lambda: self.log_has("out", "production: "), "production")
        time.sleep(0.3)
        self.assertEqual(self.stop(process, signal.SIGTERM), 143)
        for name in TRAJECTORIES:
            with self.subTest(name):
                good = self.bytes_of(f"out/{name}")
                # Of the last frame, not of what only ends the file.
                self.change(f"out/{name}", good[:-100])
                self.assert_refused_untouched("out", f"out/{name}: has {len(good) - 100} bytes")
                os.remove(self.path(f"out/{name}"))
                self.assert_refused_untouched("out", f"out/{name}: has 0 bytes")
                self.change(f"out/{name}", good)

    def test_two_processes(self):
        self.write("run.toml", config(production=100000))
        process = self.start("run", "run.toml", "--out", "out")
        self.wait_for(lambda: self.log_has("out", "production: "), "production")
        for command in [["resume", "out"], ["run", "run.toml", "--out", "out", "--force"]]:
            self.assert_refused(self.hardbody(*command), "out: another hardbody process", "accepted: ")
        self.assertEqual(self.stop(process, signal.SIGTERM), 143)
        self.assertEqual(self.hardbody("check", "out").returncode, 0)


class Faults(Restart):
    def ended(self, process):
        """Its exit status is 1; what it has said, and the files that it says it has written."""
        output, error = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 1)
        files = re.findall(r"^files: (.*)$", output, re.MULTILINE)
        return error, files[0].split(", ") if files else []

    def limited(self, size):
        """For Popen: files cannot grow beyond so many bytes, as on a full disk."""
        return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    def test_checkpoint_that_does_not_fit(self):
        text = RUNS["rods"]
        self.undisturbed("reference", text)
        expected = self.results("reference")
        # None fits; those of equilibration do.
        for size in [6000, int(0.7 * len(expected["checkpoint.bin"]))]:
            with self.subTest(size=size):
                self.write("run.toml", text)
                process = self.start(
                    "run", "run.toml", "--out", "out", preexec_fn=self.limited(size), stdout=subprocess.PIPE
                )
                error, files = self.ended(process)
                self.assertIn(
                    "cannot be written: File too large; "
                    + ("the last checkpoint is intact: free some room, then hardbody resume out\n" if size > 6000 else
                       "there is no checkpoint yet: free some room, then hardbody resume out starts over\n"),
                    error,
                )
                self.assertEqual(files, [])
                self.assertIn("no checkpoint: ", self.read("out/log.txt"))
                self.assertFalse(os.path.exists(self.path("out/summary.json")))
                self.assertFalse(os.path.exists(self.path("out/checkpoint.bin.part")))
                self.assertEqual(os.path.exists(self.path("out/checkpoint.bin")), size > 6000)
                self.resume("out")
                self.assert_same_run("out", expected)
                shutil.rmtree(self.path("out"))

    def test_events_that_do_not_fit(self):
        text = config(production=400).replace("events = 2000", "events = 1000000")
        self.undisturbed("reference", text)
        expected = self.results("reference")
        size = len(expected["events.csv"])
        self.assertGreater(size, 1.5 * len(expected["checkpoint.bin"]))
        self.write("run.toml", text)
        process = self.start(
            "run", "run.toml", "--out", "out", preexec_fn=self.limited(int(0.9 * size)), stdout=subprocess.PIPE
        )
        error, files = self.ended(process)
        self.assertIn("events.csv: cannot be written: File too large; the last checkpoint is intact: free some room", error)
        self.assertEqual(files, [])
        check = self.hardbody("check", "out")
        self.assertEqual(check.returncode, 0, check.stdout)
        self.resume("out")
        self.assertIn("resumed from production", self.read("out/log.txt"))
        self.assert_same_run("out", expected)

    def test_results_that_do_not_fit(self):
        """The table names what was written before the disk was full, and no more."""
        self.undisturbed("reference", RUNS["rods"])
        expected = self.results("reference")
        self.write("run.toml", RUNS["rods"])
        for name, written in [("msd.csv", ["out/checkpoint.bin", "out/events.csv"]),
                              ("summary.json", ["out/observables/*.csv", "out/checkpoint.bin", "out/events.csv"])]:
            with self.subTest(name):
                path = name if name == "summary.json" else f"observables/{name}"
                process = self.start("run", "run.toml", "--out", "out", stdout=subprocess.PIPE)
                self.wait_for(lambda: self.log_has("out", "production: "), "production")
                # Written under another name first, at which there is something that is no file.
                os.makedirs(self.path(f"out/{path}.part"))
                error, files = self.ended(process)
                self.assertIn(f"out/{path}: cannot be written: ", error)
                self.assertIn("; the last checkpoint is intact: resolve this, then hardbody resume out\n", error)
                self.assertEqual(files, written)
                shutil.rmtree(self.path(f"out/{path}.part"), ignore_errors=True)
                self.resume("out")
                self.assert_same_run("out", expected)
                shutil.rmtree(self.path("out"))

    def test_events_between_checkpoints_and_on_a_full_disk(self):
        """What happens when too many wait in memory is tested by events_file_test.cpp."""
        text = config(production=1000000).replace("events = 2000", "events = 100000000").replace("0.02s", "9h")
        self.write("run.toml", text)
        process = self.start("run", "run.toml", "--out", "out")
        self.wait_for(lambda: os.path.exists(self.path("out/events.csv")), "events.csv")
        # Written without any checkpoint.
        self.wait_for(lambda: os.path.getsize(self.path("out/events.csv")) > 3e5, "events")
        self.assertFalse(os.path.exists(self.path("out/checkpoint.bin")))
        self.assertEqual(self.stop(process, signal.SIGTERM), 143)
        rows = self.summary("out")["counters"]["collisions"]
        self.assertEqual(self.read("out/events.csv").count("\n"), rows + 1)
        shutil.rmtree(self.path("out"))
        self.write("run.toml", text.replace("9h", "0.5s"))
        process = self.start("run", "run.toml", "--out", "out", preexec_fn=self.limited(2_000_000))
        self.wait_for(lambda: self.log_has("out", "collisions wait in memory"), "a full disk")
        self.assertEqual(self.stop(process, signal.SIGTERM), 1)
        error = process.stderr.read()
        self.assertIn("events.csv: cannot be written: File too large; the last checkpoint is intact: free some room", error)
        self.assertEqual(self.hardbody("check", "out").returncode, 0)
        process = self.start("resume", "out")
        self.wait_for(lambda: self.log_has("out", "resumed from production"), "production")
        self.assertEqual(self.stop(process, signal.SIGTERM), 143)
        rows = self.summary("out")["counters"]["collisions"]
        self.assertEqual(self.read("out/events.csv").count("\n"), rows + 1)

    def test_trajectory_that_does_not_fit(self):
        """Frames wait in memory, checkpoints cannot be made without them; what was there stays whole."""
        text = with_trajectories(config(production=150), 1200)
        self.undisturbed("reference", text)
        expected = self.results("reference")
        self.write("run.toml", text)
        for name in TRAJECTORIES:
            with self.subTest(name):
                size = int(0.5 * len(expected[name]))
                others = [len(content) for other, content in expected.items() if other not in TRAJECTORIES]
                self.assertGreater(size, max(others))
                process = self.start("run", "run.toml", "--out", "out", preexec_fn=self.limited(size))
                process.wait(timeout=120)
                self.assertEqual(process.returncode, 1)
                self.assertIn("cannot be written: File too large", process.stderr.read())
                log = self.read("out/log.txt")
                self.assertIn("File too large; frames wait in memory", log)
                self.assertEqual(log.count("frames wait in memory"), 1)
                self.assertIn("no checkpoint: ", log)
                self.assertEqual(self.hardbody("check", "out").returncode, 0)
                self.resume("out")
                self.assertIn("resumed from production", self.read("out/log.txt"))
                self.assert_same_run("out", expected)
                shutil.rmtree(self.path("out"))

    def test_stall(self):
        """Spheres that are packed so closely that 2000 events a body take next to no time."""
        self.write(
            "run.toml",
            'seed = 3\n[system]\nnumber = 108\npacking_fraction = 0.7404804896\nstart = "fcc"\n[shape]\naspect_ratio = 1\n'
            "[equilibration]\ntime = 1\n[production]\ntime = 1\n",
        )
        for command in [["run", "run.toml", "--out", "out"], ["resume", "out"]]:
            with self.subTest(command):
                result = self.hardbody(*command)
                self.assertEqual(result.returncode, 1)
                why = r"equilibration stalled at time \S+: 217000 events in \S+ time units, \d+ % of the latest \w+ of bod"
                self.assertRegex(result.stderr, "^out: NOT SOUND: " + why)
                self.assertRegex(self.read("out/log.txt"), "NOT SOUND: " + why)
                self.assertIn("out/checkpoint.bin", result.stdout)
                summary = self.summary("out")
                self.assertIn("stalled at time", summary["stalled"])
                self.assertTrue(summary["interrupted"])
                self.assertEqual(self.hardbody("check", "out").returncode, 0)
        # The second process has gone on where the first one was stuck.
        self.assertIn("resumed from equilibration", self.read("out/log.txt"))

    def test_read_only_directory(self):
        self.write("run.toml", config(production=100000))
        process = self.start("run", "run.toml", "--out", "out")
        self.wait_for(lambda: self.log_has("out", "production: "), "production")
        self.stop(process, signal.SIGTERM)
        self.addCleanup(os.chmod, self.path("out"), 0o755)
        os.chmod(self.path("out"), 0o555)
        os.chmod(self.here, 0o755)
        before = self.everything("out")
        # Root may write anywhere.
        user = {"user": 65534} if os.geteuid() == 0 else {}
        result = subprocess.run(
            [HARDBODY, "resume", "out"], cwd=self.here, capture_output=True, text=True, timeout=60, **user
        )
        self.assert_refused(result, "out: cannot be used as run directory: Permission denied", "accepted: ")
        self.assertEqual(self.everything("out"), before)

    @unittest.skipUnless("HARDBODY_CLOCK" in os.environ, "HARDBODY_CLOCK is the library that sets the wall clock back")
    def test_wall_clock_set_back(self):
        clock = os.environ["HARDBODY_CLOCK"]
        text = config(production=100000).replace("0.02s", "0.2s")
        self.write("run.toml", text)
        process = self.start("run", "run.toml", "--out", "out", env={**os.environ, "LD_PRELOAD": clock})
        checkpoint = self.path("out/checkpoint.bin")
        self.wait_for(lambda: os.path.exists(checkpoint), "a checkpoint")
        versions = set()

        def renewed():
            versions.add((os.stat(checkpoint).st_ino, os.stat(checkpoint).st_mtime_ns))
            return len(versions) > 5

        self.wait_for(renewed, "the fifth checkpoint")
        self.assertEqual(self.stop(process, signal.SIGTERM), 143)
        # It has been set back: the years of the log fall.
        years = [int(line[:4]) for line in self.read("out/log.txt").splitlines()]
        self.assertGreater(years[0], years[-1])


if __name__ == "__main__":
    unittest.main()
