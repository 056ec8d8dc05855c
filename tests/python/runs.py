"""Small runs, and comparisons of what they leave."""

from __future__ import annotations

import json
import os
import pathlib
import subprocess
import sys
from typing import Any

CONFIG: dict[str, Any] = {
    "seed": 3,
    "system": {"number": 48, "packing_fraction": 0.3},
    "shape": {"aspect_ratio": 2.0},
    "equilibration": {"time": 1.0},
    "production": {"time": 3.0},
    "output": {"trajectory": ["gsd", "lammps", "vtk"], "frames": 4, "events": 10},
}
TEXT = """
seed = 3
[system]
number = 48
packing_fraction = 0.3
[shape]
aspect_ratio = 2.0
[equilibration]
time = 1.0
[production]
time = 3.0
[output]
trajectory = ["gsd", "lammps", "vtk"]
frames = 4
events = 10
"""
ROOT = pathlib.Path(__file__).resolve().parents[2]


def with_values(config: dict[str, Any], **sections: dict[str, Any]) -> dict[str, Any]:
    """A copy of a config with values of some sections replaced."""
    return config | {name: config.get(name, {}) | values for name, values in sections.items()}


def results(directory: os.PathLike[str] | str) -> dict[str, Any]:
    """Bytes of all files of a run but its log, and the summary without what differs from process to process."""
    path = pathlib.Path(directory)
    files: dict[str, Any] = {}
    for file in sorted(p for p in path.rglob("*") if p.is_file()):
        name = str(file.relative_to(path))
        if name == "summary.json":
            summary = json.loads(file.read_text())
            del summary["performance"]
            files[name] = json.dumps(summary)  # in the order of the file
        elif name not in ("log.txt", "checkpoint.bin"):  # which hold times of this process
            files[name] = file.read_bytes()
    return files


def program() -> list[str]:
    """The program as users of the package start it."""
    return [sys.executable, "-m", "hardbody"]


def call(*arguments: str, cwd: pathlib.Path, command: list[str] | None = None) -> subprocess.CompletedProcess[str]:
    """Runs the program."""
    return subprocess.run([*(command or program()), *arguments], cwd=cwd, capture_output=True, text=True, check=False)
