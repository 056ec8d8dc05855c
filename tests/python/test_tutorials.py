"""The tutorials run, what they assert holds, and their figures are drawn. That about other programs: tests/peers."""

from __future__ import annotations

import os
import pathlib
import subprocess
import sys

import pytest

TUTORIALS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "tutorials"
FIGURES = {
    "first_fluid": True,
    "your_shape": False,
    "sweep_and_map": True,
    "robot_links": True,
    "path_among_bodies": True,
    "grains": True,
}


@pytest.mark.parametrize("name", FIGURES)
def test_runs(name: str, tmp_path: pathlib.Path) -> None:
    done = subprocess.run(
        [sys.executable, TUTORIALS / f"{name}.py"],
        cwd=tmp_path,
        env=os.environ | {"MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert not done.stderr, "warnings"
    assert not FIGURES[name] or (tmp_path / f"{name}.png").stat().st_size > 1000


def test_all_are_known() -> None:
    assert {file.stem for file in TUTORIALS.glob("*.py")} == set(FIGURES) | {"freud_and_ovito"}
