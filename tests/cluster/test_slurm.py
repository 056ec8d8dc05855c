"""A sweep on real Slurm, on this machine: the same table as here, also with tasks killed, nodes lost, time limits and a full disk.

    HARDBODY=build/test/apps/hardbody/hardbody SNAKEMAKE=build/workflow/bin /usr/bin/python3 tests/cluster/test_slurm.py [--rounds N]

`tools/test --cluster` does that.
One undisturbed sweep, then N (1) with faults; needs root. SNAKEMAKE is the bin of a virtual environment with
apps/workflow/constraints.txt; where it or Slurm is missing the test fails and says so.
"""

import argparse
import csv
import glob
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

from slurm import Cluster

HARDBODY = os.path.abspath(os.environ["HARDBODY"])
SNAKEMAKE = os.path.abspath(os.environ["SNAKEMAKE"])
TIMING = ["wall_seconds", "collisions_per_second"]
LONGEST = 900  # seconds of one sweep

# 24 points of two replicas, each a second or two.
SWEEP = """replicas = 2
seed = 5
[system]
number = 108
[equilibration]
time = 2
[production]
time = 60
[output]
checkpoint_every = "0.3s"
[grid]
shape.aspect_ratio = [0.5, 0.75, 1.25, 2]
system.packing_fraction = {from = 0.15, to = 0.4, count = 6}
"""
# One run of somewhat more than a minute, which is the shortest time limit of a job, beside short ones.
LONG = SWEEP.replace("replicas = 2\n", "").replace("[0.5, 0.75, 1.25, 2]", "[2, 2.1]").replace("count = 6", "count = 2").replace(
    "time = 60\n", "time = 12000\n")

PROFILE = """executor: slurm
jobs: 100
keep-going: true
retries: 40
latency-wait: 60
seconds-between-status-checks: 2
slurm-init-seconds-before-status-checks: 2
slurm-status-command: squeue
slurm-requeue: true
config:
{config}
"""


def table(directory):
    """Rows of sweep.csv without times of machines."""
    with open(directory / "sweep.csv", newline="", encoding="utf-8") as file:
        return [{key: value for key, value in row.items() if key not in TIMING} for row in csv.DictReader(file)]


def processes(directory):
    """Tasks of a sweep that run on this machine."""
    found = []
    for path in glob.glob("/proc/[0-9]*/cmdline"):
        try:
            words = pathlib.Path(path).read_bytes().split(b"\0")
        except OSError:
            continue
        if b"point" in words and os.fsencode(directory) in words and os.fsencode(HARDBODY) == words[0]:
            found.append(int(path.split("/")[2]))
    return found


def kill(process):
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        pass


class FullDisk:
    """A run's directory that has room for next to nothing, for a while."""

    def __init__(self, directory):
        self.directory = directory
        directory.mkdir(parents=True, exist_ok=True)
        subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", str(directory)], check=True)
        self.mounted = True

    def end(self):
        if self.mounted:
            subprocess.run(["umount", "-l", str(self.directory)], check=True)
        self.mounted = False


class Faults(threading.Thread):
    """Kills tasks and takes nodes away, at random times, until it is told to stop."""

    def __init__(self, cluster, directory, seed):
        super().__init__(daemon=True)
        self.cluster, self.directory = cluster, directory
        self.random = random.Random(seed)
        self.over = threading.Event()
        self.done = []

    def kill_task(self):
        running = processes(self.directory)
        if running:
            kill(self.random.choice(running))
            return "kill -9 of a task"
        return None

    def restart_slurmd(self):
        node = self.random.choice(["n1", "n2"])
        self.cluster.stop_node(node, kill=self.random.random() < 0.5)
        self.over.wait(3)
        self.cluster.start_node(node)
        return f"slurmd of {node} stopped and started"

    def node_down(self):
        node = self.random.choice(["n1", "n2"])
        self.cluster.set_node(node, "down")
        self.over.wait(3)
        self.cluster.set_node(node, "resume")
        return f"{node} marked down and up"

    def run(self):
        # Each kind once, then at random.
        kinds = [self.kill_task, self.node_down, self.restart_slurmd, self.kill_task]
        while not self.over.wait(self.random.uniform(4, 8)):
            if not processes(self.directory):
                continue
            kind = kinds.pop(0) if kinds else self.random.choice([self.kill_task, self.kill_task, self.node_down])
            what = kind()
            if what:
                self.done.append(what)

    def stop(self):
        self.over.set()
        self.join()


class Study:
    def __init__(self, cluster, here):
        self.cluster, self.here = cluster, here
        self.env = {**cluster.env, "PATH": os.pathsep.join([SNAKEMAKE, cluster.env["PATH"]]),
                    "XDG_CACHE_HOME": str(here / "cache")}

    def profile(self, name, **config):
        directory = self.here / f"profile_{name}"
        directory.mkdir(exist_ok=True)
        lines = "\n".join(f"  - {key}={value}" for key, value in config.items())
        (directory / "config.yaml").write_text(PROFILE.format(config=lines))
        return directory

    def sweep(self, text, name, *options):
        file = self.here / f"{name}.toml"
        file.write_text(text)
        return subprocess.Popen([HARDBODY, "sweep", str(file), "--out", str(self.here / name), *options], cwd=self.here,
                                env=self.env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def finish(self, process, name):
        try:
            out, said = process.communicate(timeout=LONGEST)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGTERM)
            out, said = process.communicate(timeout=120)
            raise AssertionError(f"{name}: not done within {LONGEST} s: {self.tell(name, out, said)}") from None
        if process.returncode != 0:
            raise AssertionError(f"{name}: exit status {process.returncode}: {self.tell(name, out, said)}")
        return out

    def tell(self, name, out, said):
        log = self.here / name / "workflow" / "log.txt"
        tail = log.read_text(errors="replace")[-6000:] if log.exists() else ""
        return f"{out}\n{said[-3000:]}\n{tail}\n{self.cluster.run('squeue', check=False)}"

    def check_runs(self, name):
        """Every run is whole and was completed once, and nothing is left of tasks."""
        directory = self.here / name
        plan = json.loads((directory / "plan.json").read_text())
        for run in plan["runs"]:
            path = directory / run["id"]
            log = (path / "log.txt").read_text()
            # A run that is killed before its files are written ends its production again.
            ends = len(re.findall(r"  end$", log, re.M))
            assert ends == 1, f"{path}: ended {ends} times: {log}"
            audit = subprocess.run([HARDBODY, "check", str(path)], capture_output=True, text=True, check=False)
            assert audit.returncode == 0, f"{path}: {audit.stdout}{audit.stderr}"
        left = glob.glob(str(directory / "*" / "task.lock*")) + glob.glob(str(directory / "*" / "*.part"))
        assert not left, left

    def attempts(self, name):
        return len(re.findall(r"^Job \d+ has been submitted", (self.here / name / "workflow" / "log.txt").read_text(), re.M))


def undisturbed(study, expected):
    begin = time.monotonic()
    # The profile that is shipped, as users have it: this Slurm keeps no accounts.
    study.finish(study.sweep(SWEEP, "plain", "--on", "slurm", "--task-time", "1.5"), "plain")
    assert table(study.here / "plain") == expected, "plain: another table than locally"
    study.check_runs("plain")
    print(f"undisturbed: the same table as locally, {study.attempts('plain')} jobs, {time.monotonic() - begin:.0f} s", flush=True)


def stopped(study):
    """SIGTERM: jobs are cancelled, states saved; the same command continues."""
    options = ["--on", str(study.profile("plain", pause=2, minutes=10)), "--task-time", "1.5"]
    process = study.sweep(SWEEP, "stopped", *options)
    end = time.monotonic() + 120
    while not processes(study.here / "stopped") and time.monotonic() < end:
        time.sleep(0.1)
    process.send_signal(signal.SIGTERM)
    out, said = process.communicate(timeout=120)
    assert process.returncode == 143, (process.returncode, out, said)
    assert not processes(study.here / "stopped"), "stopped: a task still runs"
    assert "stopped by SIGTERM: the same command continues" in said, said
    study.finish(study.sweep(SWEEP, "stopped", *options), "stopped")
    print("SIGTERM: jobs cancelled, states saved; the same command has continued", flush=True)
    return table(study.here / "stopped")


def time_limit(study):
    """A run that takes longer than the time limit of its job."""
    begin = time.monotonic()
    options = ["--on", str(study.profile("limit", pause=2, minutes=1, seconds=600)), "--task-time", "1"]
    process = study.sweep(LONG, "limit", *options)
    study.finish(process, "limit")
    study.check_runs("limit")
    assert study.attempts("limit") > 4, "limit: no run took longer than a minute"
    print(f"time limit of a minute: {study.attempts('limit')} jobs for 4 runs, {time.monotonic() - begin:.0f} s", flush=True)


def disturbed(study, number, expected):
    name = f"round{number}"
    begin = time.monotonic()
    # The time limit is that of the task itself here: a job's own is a minute at least.
    options = ["--on", str(study.profile(name, pause=2, minutes=10, seconds=8)), "--task-time", "2.5"]
    file = study.here / f"{name}.toml"
    file.write_text(SWEEP)
    subprocess.run([HARDBODY, "sweep", "plan", str(file), "--out", str(study.here / name)], check=True, capture_output=True)
    disk = FullDisk(study.here / name / "aspect_ratio=2_packing_fraction=0.3")
    faults = Faults(study.cluster, study.here / name, number)
    try:
        process = study.sweep(SWEEP, name, *options)
        faults.start()
        end = time.monotonic() + 60
        state = study.here / name / "workflow" / "log.txt"
        while process.poll() is None and time.monotonic() < end and "Error in rule" not in (state.read_text() if state.exists() else ""):
            time.sleep(0.5)
        time.sleep(5)
        disk.end()
        study.finish(process, name)
    finally:
        faults.stop()
        disk.end()
        for node in ["n1", "n2"]:
            study.cluster.set_node(node, "resume")
    assert table(study.here / name) == expected, f"{name}: another table than locally"
    study.check_runs(name)
    assert faults.done, f"{name}: no fault has happened"
    print(f"round {number}: {study.attempts(name)} jobs, {time.monotonic() - begin:.0f} s; {', '.join(faults.done)}", flush=True)
    shutil.rmtree(study.here / name)


def interrupted(*_):
    raise KeyboardInterrupt


def main():
    signal.signal(signal.SIGTERM, interrupted)  # daemons are ended, disks given back
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--only-faults", action="store_true", help="no undisturbed sweep and no SIGTERM")
    parser.add_argument("--limit", action="store_true", help="also a run longer than the time limit of a job")
    parser.add_argument("--keep", help="directory for all files, which is kept")
    wanted = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="hardbody_slurm_") as temporary:
        here = pathlib.Path(wanted.keep or temporary).resolve()
        here.mkdir(parents=True, exist_ok=True)
        with Cluster(here / "slurm") as cluster:
            study = Study(cluster, here)
            study.finish(study.sweep(SWEEP, "local"), "local")
            expected = table(here / "local")
            if not wanted.only_faults:
                undisturbed(study, expected)
                assert stopped(study) == expected, "stopped: another table than locally"
            for number in range(1, wanted.rounds + 1):
                disturbed(study, number, expected)
            if wanted.limit:
                time_limit(study)
    print("all as locally")


if __name__ == "__main__":
    sys.exit(main())
