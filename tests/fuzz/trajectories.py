#!/usr/bin/python3
"""Trajectories at random, through the program: tests/fuzz/trajectories.py [--inputs N] [--seed S] [--keep DIR]

    HARDBODY=build/release/apps/hardbody/hardbody tests/fuzz/trajectories.py --inputs 1000

Two kinds in turn. GSD files and dumps of one walk, in which each quantity is stored in frames drawn at random: what
`hardbody analyze` prints is that of the walk, or nothing where the file does not say it (as in
tests/cli/test_conventions.py). And such files with bytes, words, lines or chunks changed: `hardbody analyze` and
`hardbody check` refuse them with one line or read them, and print finite numbers only.
"""

import argparse
import collections
import json
import os
import random
import re
import shutil
import subprocess
import sys
import warnings

import numpy

warnings.simplefilter("ignore")
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))

import gsd.fl
import test_conventions as conventions
import walks
from test_cli import HARDBODY
from test_conventions import C2, MSD, S, VACF, Way
from walks import EDGE, Walk

WORDS = ["nan", "-nan", "inf", "1e400", "-1e308", "1e-400", "0", "-0", "1", "2", "99999999999999999999", "1e17", "0x1p3", "",
         "1.5.2", "abc", "ITEM:", "TIMESTEP", "id", "x", "xu", "ix", "quatw", "\0", "1e9", "2147483648", "-2147483649", "+3"]


def stored_at_random(draws):
    """A GSD file of a walk in which images, orientations and velocities that are left out are those of frame 0, or are
    stored in frame 0 only."""
    w = walks.walk(draws.choice([1.4, 7.9]), frames=draws.randint(13, 30), seed=draws.randint(0, 999))
    n = len(w.position)
    known, when = {}, {}
    for name, array in [("image", w.image), ("orientation", w.orientation), ("velocity", w.velocity)]:
        stored = [draws.random() < draws.choice([0, 0.2, 0.8, 1]) for _ in range(n)]
        how = draws.choice(["each", "first", "never", "some"])
        stored = {"each": n * [True], "first": [True] + (n - 1) * [False], "never": n * [False], "some": stored}[how]
        known[name] = any(stored[1:])
        when[name] = stored
        if known[name]:
            default = [1, 0, 0, 0] if name == "orientation" else [0, 0, 0]
            first = array[0].copy() if stored[0] else numpy.broadcast_to(default, array[0].shape)
            for k in range(n):
                if not stored[k]:
                    if name == "image":
                        w.position[k] += EDGE * (first - array[k])
                    array[k] = first
    w = Walk(w.position, w.orientation, w.velocity)
    nearest = numpy.diff(w.wrapped, axis=0)
    nearest -= EDGE * numpy.round(nearest / EDGE)
    near = numpy.linalg.norm(nearest, axis=2).max() < EDGE / 4
    logged = draws.choice([0, 0.3])
    log_only = [draws.random() < logged for _ in range(n)]

    def write(path, x):
        chunks = {"image": x.image.astype(numpy.int32), "orientation": x.orientation.astype(numpy.float32),
                  "velocity": x.velocity.astype(numpy.float32)}
        more = {f"particles/{name}": lambda k, name=name: chunks[name][k] if when[name][k] else None for name in chunks}
        walks.gsd_file(path, x, "never", "never", "never", more=more, log_only=lambda k: log_only[k])

    # Images that are 0 in all frames while bodies jump by more than half an edge, as they hardly can within the box, are not believed.
    jumps = numpy.abs(numpy.diff(w.wrapped, axis=0)) / EDGE
    kept = known["image"] and (w.image.any() or (1 - jumps[jumps >= 0.5]).prod() >= 0.01)
    if not kept and near:  # only what nearest images tell
        position = w.position.copy()
        position[1:] = position[0] + numpy.cumsum(nearest, axis=0)
        w = Walk(position, w.orientation, w.velocity)
    absent = [] if kept or near else [MSD]
    absent += [] if known["velocity"] else [VACF]
    absent += [] if known["orientation"] else [C2, S]  # never stored behind frame 0
    return Way(f"gsd: {[(k, v) for k, v in when.items()]}", w, write, tuple(absent), file="walk.gsd")


def columns_at_random(draws):
    """A dump with some of all columns, in any order."""
    w = walks.walk(draws.choice([1.4, 7.9]), frames=draws.randint(13, 30), seed=draws.randint(0, 999))
    names = draws.sample(["x y z", "xs ys zs", "xu yu zu", "xsu ysu zsu"], draws.randint(1, 3))
    names += [c for c in ["ix iy iz", "quatw quati quatj quatk", "vx vy vz", "shapex shapey shapez", "mass", "mol", "type",
                          "element", "id"] if draws.random() < 0.7]
    draws.shuffle(names)
    followed = any("u" in c.split()[0][1:] for c in names if c[0] == "x") or "ix iy iz" in names
    nearest = numpy.diff(w.wrapped, axis=0)
    nearest -= EDGE * numpy.round(nearest / EDGE)
    near = numpy.linalg.norm(nearest, axis=2).max() < EDGE / 4
    absent = [] if followed or near else [MSD]
    absent += [] if "vx vy vz" in names else [VACF]
    absent += [] if "quatw quati quatj quatk" in names else [C2, S]
    if "id" not in names:
        absent += [MSD, VACF, C2]
    low = draws.choice([-5, 0, 17.25])
    return Way(f"dump: {names}", w, lambda path, x: walks.dump(path, x, names, low=low), tuple(absent), file="walk.dump",
               reason="" if "id" in names else r"\bid")


def changed_bytes(draws, content):
    content = bytearray(content)
    for _ in range(draws.choice([1, 1, 2, 5, 20])):
        at = draws.randrange(len(content))
        what = draws.randrange(4)
        if what == 0:
            content[at] = draws.randrange(256)
        elif what == 1:
            content[at] ^= 1 << draws.randrange(8)
        elif what == 2:
            content[at:at + 8] = draws.choice([b"\xff" * 8, b"\0" * 8, (1 << 31).to_bytes(8, "little"), b"\x7f" + b"\xff" * 7])
        elif draws.random() < 0.1:
            del content[at:]
            break
    return bytes(content) or b"\0"


def changed_text(draws, content):
    lines = content.decode("latin-1").split("\n")
    for _ in range(draws.choice([1, 1, 2, 5])):
        at = draws.randrange(len(lines))
        words = lines[at].split(" ")
        what = draws.randrange(7)
        if what == 0:
            words[draws.randrange(len(words))] = draws.choice(WORDS)
        elif what == 1:
            words.insert(draws.randrange(len(words) + 1), draws.choice(WORDS))
        elif what == 2:
            del words[draws.randrange(len(words))]
        if what < 3:
            lines[at] = " ".join(words)
        elif what == 3:
            del lines[at]
        elif what == 4:
            lines.insert(at, draws.choice(lines))
        elif what == 5:
            other = draws.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
        else:
            of = draws.choice([k for k, line in enumerate(lines) if line.startswith("ITEM")] or [0])
            words = lines[of].split(" ")
            words[draws.randrange(len(words))] = draws.choice(WORDS)
            lines[of] = " ".join(words)
        if not lines:
            lines = [""]
    return "\n".join(lines).encode("latin-1")


def changed_chunks(draws, path):
    """Chunks of other types, shapes and values, too few and too many."""
    with gsd.fl.open(path, "rb") as old:
        frames = [{name: old.read_chunk(k, name) for name in old.find_matching_chunk_names("") if old.chunk_exists(k, name)}
                  for k in range(old.nframes)]
    for _ in range(draws.choice([1, 1, 2, 4])):
        frame = draws.choice(frames[:2] + [draws.choice(frames)])
        if not frame:
            continue
        name = draws.choice(list(frame))
        array = numpy.array(frame[name])
        what = draws.randrange(6)
        if what == 0:
            del frame[name]
        elif what == 1:
            frame[name] = array.astype(draws.choice([numpy.float64, numpy.float32, numpy.int32, numpy.uint8, numpy.uint64]))
        elif what == 2:
            frame[name] = array[: draws.randint(0, len(array))] if len(array) > 1 else numpy.repeat(array, 3, axis=0)
        elif what == 3:
            frame[name] = array.reshape(-1)
        elif what == 4:
            flat = array.reshape(-1)
            flat[draws.randrange(len(flat))] = draws.choice([0, 1, 3, 100] if array.dtype.kind in "iu" else
                                                            [0, -1, 1e30, numpy.nan, numpy.inf, 1e-40])
            frame[name] = flat.reshape(array.shape)
        else:
            draws.choice(frames)[name] = array
    with gsd.fl.open(path, "wb", application="test", schema="hoomd", schema_version=(1, 4)) as new:
        for frame in frames:
            for name, array in frame.items():
                if array.size > 0:
                    new.write_chunk(name, array)
            new.end_frame()


class Fuzz(conventions.Conventions):
    """A test case for its means."""

    def runTest(self):
        pass

    def hardbody(self, *arguments, timeout=30):
        """Messages may quote bytes that are no text."""
        return subprocess.run([HARDBODY, *arguments], cwd=self.here, capture_output=True, encoding="utf-8",
                              errors="backslashreplace", timeout=timeout, stdin=subprocess.DEVNULL)

    def finite(self, result):
        json.loads(self.read("analysis/analysis.json"), parse_constant=lambda c: self.fail(f"{c} in analysis.json"))
        for name in os.listdir(self.path("analysis")):
            if name.endswith(".csv"):
                self.assertIsNone(re.search(r"(^|,)[-+]?(nan|inf)", self.read(f"analysis/{name}"), re.I), name)

    def broken(self, draws, way):
        way.write(self.path(way.file), way.walk)
        if way.file.endswith(".gsd") and draws.random() < 0.7:
            changed_chunks(draws, self.path(way.file))
        else:
            content = self.bytes_of(way.file)
            change = changed_text if way.file.endswith(".dump") and draws.random() < 0.8 else changed_bytes
            with open(self.path(way.file), "wb") as file:
                file.write(change(draws, content))
        shutil.rmtree(self.path("analysis"), ignore_errors=True)
        arguments = ["--time-step", "1", "--every", str(draws.choice([1, 1, 2]))]
        result = self.hardbody("analyze", way.file, "--out", "analysis", *arguments, timeout=30)
        self.assertIn(result.returncode, (0, 2), result.stderr)
        if result.returncode == 2:
            self.assert_refused(result, "accepted: ")
        else:
            self.finite(result)
        check = self.hardbody("check", way.file, timeout=30)
        self.assertIn(check.returncode, (0, 1, 2), check.stderr)
        if check.returncode == 2:
            self.assert_refused(check, "accepted: ")
        return f"{way.name.split(':')[0]} changed: analyze {result.returncode}, check {check.returncode}"


def main():
    arguments = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    arguments.add_argument("--inputs", type=int, default=1000)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--keep", default="failures", help="directory for files that failed")
    options = arguments.parse_args()
    outcomes, failed = collections.Counter(), 0
    for k in range(options.inputs):
        draws = random.Random(options.seed * 1_000_003 + k)
        way = draws.choice([stored_at_random, columns_at_random])(draws)
        case = Fuzz()
        case.setUp()
        try:
            if k % 2 == 0:
                case.compare(way)
                outcomes[way.name.split(":")[0] + " as drawn"] += 1
            else:
                outcomes[case.broken(draws, way)] += 1
        except Exception as error:
            failed += 1
            os.makedirs(options.keep, exist_ok=True)
            kept = os.path.join(options.keep, f"{options.seed}_{k}_{way.file}")
            shutil.copy(case.path(way.file), kept)
            print(f"{kept}: {way.name[:200]}\n  {type(error).__name__}: {str(error)[:600]}", flush=True)
        case.doCleanups()
    for what, count in sorted(outcomes.items()):
        print(f"{count:8} {what}")
    print(f"{options.inputs} inputs, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
