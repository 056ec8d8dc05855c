"""A long run, killed and resumed many times; see tools/soak."""

import argparse
import json
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import time

RATE = 35.6  # collisions a body and time unit
NUMBER = 512
SPARE = 1.01  # the rate is known to a fraction of that

CONFIG = """seed = 1
[system]
number = {number}
packing_fraction = 0.40
[shape]
kind = "ellipsoid"
aspect_ratio = 3
[equilibration]
time = 20
[production]
time = {time:.1f}
[output]
checkpoint_every = "{every:.3f}s"
"""


def resident_kilobytes(pid):
    """Of a process; 0 if it has ended."""
    try:
        for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
            if line.startswith("VmRSS:"):
                return int(line.split()[1])
    except (FileNotFoundError, ProcessLookupError):
        pass
    return 0


def production_time(checkpoint):
    """How far production has come by the last checkpoint; 0 before. See docs/restart.md, The file."""
    try:
        head = checkpoint.read_bytes()[:65536]
    except FileNotFoundError:
        return 0
    position = 24
    for _ in range(5):  # version, config, processor, arithmetic, phase
        length, = struct.unpack_from("<Q", head, position)
        text = head[position + 8:position + 8 + length]
        position += 8 + length
    return struct.unpack_from("<d", head, position)[0] if text == b"production" else 0


class Soak:
    def __init__(self, program, out, collisions):
        self.program = program
        self.out = out
        self.time = SPARE * 2 * collisions / (RATE * NUMBER)  # of production
        self.memory = []  # kB, one list a process

    def progress(self):
        return production_time(self.out / "checkpoint.bin") / self.time

    def wait(self, process, share, patience):
        """Until so much of production is in a checkpoint, and then for so many seconds; True if the process has ended
        by then."""
        while process.poll() is None and self.progress() < share:
            self.memory[-1].append(resident_kilobytes(process.pid))
            time.sleep(min(0.5, patience))
        end = time.monotonic() + patience
        while process.poll() is None and time.monotonic() < end:
            time.sleep(min(0.5, patience / 4))
        return process.poll() is not None

    def begin(self, command):
        self.memory.append([])
        return subprocess.Popen([self.program, *command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def run(self, kills):
        """Kills when shares of production are done that are drawn about equal distances, whatever that takes; lets it
        end after the last one."""
        shutil.rmtree(self.out, ignore_errors=True)
        self.out.parent.mkdir(parents=True, exist_ok=True)
        # Twenty checkpoints between two kills at 2e5 collisions a second.
        every = min(5, max(0.02, self.time * RATE * NUMBER / 2 / 2e5 / 20 / (kills + 1)))
        config = self.out.with_suffix(".toml")
        config.write_text(CONFIG.format(number=NUMBER, time=self.time, every=every))
        command = ["run", str(config), "--out", str(self.out)]
        draw = random.Random(1)
        killed = 0
        while True:
            process = self.begin(command)
            share = (killed + draw.uniform(0.2, 0.9)) / (kills + 1)
            if killed < kills and not self.wait(process, share, draw.uniform(0, every)):
                kilobytes = resident_kilobytes(process.pid)
                process.kill()
                process.communicate()
                killed += 1
                print(f"killed {killed} of {kills} at {100 * self.progress():.0f} %, {kilobytes} kB", flush=True)
                command = ["resume", str(self.out)]
                continue
            self.wait(process, 2, 0.5)
            _, error = process.communicate()
            if process.returncode != 0:
                sys.exit(f"status {process.returncode}: {error}")
            return killed


def growth(memory):
    """Of the largest resident memory, from the middle third of the whole time to the last one. Within a third it goes
    up and down by some megabytes, as blocks of the observables fill and are merged."""
    series = [k for kilobytes in memory for k in kilobytes if k > 0]
    third = len(series) // 3
    return max(series[2 * third:]) / max(series[third:2 * third]) - 1 if third > 0 else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hardbody", required=True)
    parser.add_argument("--out", required=True, type=pathlib.Path)
    parser.add_argument("--collisions", type=float, default=1e8)
    parser.add_argument("--kills", type=int, default=20)
    arguments = parser.parse_args()
    soak = Soak(str(pathlib.Path(arguments.hardbody).resolve()), arguments.out.resolve(), arguments.collisions)
    killed = soak.run(arguments.kills)
    summary = json.loads((arguments.out / "summary.json").read_text())
    counters = summary["counters"]
    audit = summary["audit"]
    checks = [
        ("collisions of production", counters["collisions"], counters["collisions"] >= arguments.collisions),
        ("kills", killed, killed == arguments.kills),
        ("overlaps", counters["overlaps"], counters["overlaps"] == 0),
        ("pairs without an answer", counters["declined"], counters["declined"] == 0),
        ("rescues", counters["rescues"], counters["rescues"] == 0),
        ("failures", summary["failures"]["recorded"], summary["failures"]["recorded"] == 0),
        ("stalled", summary["stalled"], summary["stalled"] is None),
        ("minimum distance at the end", audit["minimum_distance"], audit["minimum_distance"] >= -1e-12),
        ("relative energy drift", audit["energy_relative_drift"], abs(audit["energy_relative_drift"]) <= 1e-9),
        ("growth of the largest memory", round(growth(soak.memory), 3), growth(soak.memory) < 0.05),
        ("collisions a second", round(summary["performance"]["collisions_per_second"]), True),
    ]
    for name, value, sound in checks:
        print(f"{'ok  ' if sound else 'OFF '} {name}: {value}")
    sys.exit(0 if all(sound for _, _, sound in checks) else 1)


if __name__ == "__main__":
    main()
