"""Runs state points, a process each, and merges each into the results as soon as it is finished."""

import contextlib
import ctypes
import fcntl
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import time

from . import grid
from .results import TARGET_ERROR

CONFIG = """# {name}: written by tools/reproduce-paper
seed = {seed}
[system]
number = 512
packing_fraction = {phi:g}
[shape]
kind = "ellipsoid"
aspect_ratio = {X0:g}
[dynamics]
inertia = "paper"
[equilibration]
time = "auto"
cap = {cap:g}
[production]
{production}
"""

CAP = 500
LATE_CAP = 60  # where C2 is not expected to decay, which would take hours for what is no fluid
LONGEST_LAG = 40  # of productions of a fixed length
QUICK_PRODUCTION = 60
QUICK_CAP = 60


def production_text(point, quick):
    time_units = QUICK_PRODUCTION if quick else grid.fixed_time(point)
    if not quick and time_units:
        return f"time = {time_units}\nlongest_lag = {min(LONGEST_LAG, time_units / 16):g}"
    return f"time = {time_units}" if time_units else f'time = "auto"\ntarget_error = {TARGET_ERROR:g}'


def config_text(point, quick):
    late = grid.is_late(point) and point not in grid.SLOW_ORDER
    cap = QUICK_CAP if quick else LATE_CAP if late else CAP
    return CONFIG.format(name=point.name, seed=point.seed, phi=point.phi, X0=point.X0, cap=cap,
                         production=production_text(point, quick))


@contextlib.contextmanager
def alone_in(directory):
    """Keeps a second study out of the directory."""
    directory.mkdir(parents=True, exist_ok=True)
    with open(directory / "lock", "w", encoding="utf-8") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise SystemExit(f"{directory}: another study is at work in it; accepted: another --out, or wait") from None
        yield


def _save_when_the_study_is_killed():
    """In the child: SIGTERM when its parent ends, however that does."""
    PR_SET_PDEATHSIG = 1
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


class Stop:
    """A deadline, or a signal; the runs then save what they have."""

    def __init__(self, minutes):
        self.deadline = time.monotonic() + 60 * minutes if minutes else None
        self.signal = 0
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._come)

    def _come(self, number, _frame):
        self.signal = number

    def __bool__(self):
        return bool(self.signal) or (self.deadline is not None and time.monotonic() >= self.deadline)


class Study:
    def __init__(self, program, out, results, jobs, quick=False, costs=None):
        self.program = str(pathlib.Path(program).resolve())
        self.out = pathlib.Path(out).resolve()
        self.results = results
        self.jobs = jobs
        self.quick = quick
        self.running = {}  # process -> point
        self.failed = []
        self.begun = time.monotonic()
        self.pending = []
        self.costs = dict(costs or {})  # seconds of a core that points took elsewhere
        self.spent = {}  # here

    def directory(self, point):
        return self.out / point.name

    def start(self, point):
        """Goes on with a run that was begun with the same config, else begins it."""
        directory = self.directory(point)
        config = self.out / f"{point.name}.toml"
        text = config_text(point, self.quick)
        if not config.exists() or config.read_text(encoding="utf-8") != text:
            shutil.rmtree(directory, ignore_errors=True)
            config.write_text(text, encoding="utf-8")
        begun = (directory / "config.toml").exists()
        command = ["resume", str(directory)] if begun else ["run", str(config), "--out", str(directory)]
        # Appended to: a run of a study that was killed may still write its last line.
        with open(self.out / f"{point.name}.log", "a", encoding="utf-8") as log:
            process = subprocess.Popen([self.program, *command], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                       stderr=log, start_new_session=True, preexec_fn=_save_when_the_study_is_killed)
        self.running[process] = point

    def is_finished(self, point):
        summary = self.directory(point) / "summary.json"
        if not summary.exists():
            return False
        interrupted = json.loads(summary.read_text(encoding="utf-8"))["interrupted"]
        return not interrupted

    def finish(self, process, point):
        """Merges a run that is over; one that failed is left as it is and listed."""
        status = process.returncode
        if status == 0 and self.is_finished(point):
            summary = self.results.take(self.directory(point), point)
            shutil.rmtree(self.directory(point))
            self.spent[point] = summary["performance"]["total_wall_seconds"]
            self.say(f"{point.name}: D_trans {_shown(summary, 'D_trans')}, D_rot {_shown(summary, 'D_rot')}, "
                     f"S {_shown(summary, 'S')}{'' if summary['equilibrated'] else ', not equilibrated'}, "
                     f"{self.spent[point]:.0f} s{self.eta()}")
            return
        text = (self.out / f"{point.name}.log").read_text(encoding="utf-8", errors="replace").strip().splitlines()
        if status == 2 and any("another hardbody process" in line for line in text[-3:]):
            time.sleep(0.5)  # it saves its state
            self.start(point)
        elif status not in (130, 143):
            self.failed.append(point)
            self.say(f"{point.name}: FAILED with exit status {status}: {text[-1] if text else 'no message'}")

    def say(self, text):
        seconds = time.monotonic() - self.begun
        print(f"[{seconds / 60:7.1f} min, {len(self.results.points)} points] {text}", flush=True)

    def seconds_left(self):
        """Of a core, for what is pending or running: by what points took elsewhere, times how much longer they take here, or else by the
        mean of those done here; nothing where nothing is known. What running ones have done already is not taken off."""
        left = [*self.pending, *self.running.values()]
        both = [p for p in self.spent if p in self.costs]
        slower = sum(self.spent[p] for p in both) / sum(self.costs[p] for p in both) if both else 1.0
        known = {p: slower * self.costs[p] for p in left if p in self.costs} if self.costs else {}
        samples = [*self.spent.values()] or [slower * c for c in self.costs.values()]
        if not samples:
            return None
        return sum(known.get(p, sum(samples) / len(samples)) for p in left)

    def eta(self):
        seconds = self.seconds_left()
        if not seconds:
            return ""
        return f"; {len(self.pending) + len(self.running)} points left, ETA {_duration(seconds / self.jobs)}"

    def say_cost(self, points):
        self.say(f"{len(self.pending)} of {len(points)} points to run, {self.jobs} at a time")
        seconds = self.seconds_left()
        if seconds:
            self.say(f"by the times of those in data/paper they cost about {_duration(seconds)} of one core, here about "
                     f"{_duration(seconds / self.jobs)}")

    def reap(self):
        for process in [p for p in self.running if p.poll() is not None]:
            self.finish(process, self.running.pop(process))

    def stop_all(self):
        for process in self.running:
            process.send_signal(signal.SIGTERM)
        for process in list(self.running):
            process.wait()
        self.reap()

    def run(self, points, stop):
        """Whether all points are done."""
        self.pending = [p for p in points if p not in self.results.points]
        self.say_cost(points)
        with alone_in(self.out):
            try:
                while (self.pending or self.running) and not stop:
                    while self.pending and len(self.running) < self.jobs:
                        self.start(self.pending.pop(0))
                    time.sleep(0.1)
                    self.reap()
            finally:
                self.stop_all()
        left = [p for p in points if p not in self.results.points]
        for point in self.failed:
            print(f"failed: {point.name}, see {self.directory(point)} and {self.out / (point.name + '.log')}", file=sys.stderr)
        self.say(f"{len(left)} of {len(points)} points are left")
        return not left


def _duration(seconds):
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"


def _shown(summary, name):
    estimate = summary["observables"][name]
    if estimate["value"] is None:
        return "null"
    error = "?" if estimate["error"] is None else f"{estimate['error']:.2g}"
    return f"{estimate['value']:.4g} +- {error}"
