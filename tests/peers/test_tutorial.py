"""The tutorial about freud and OVITO runs, and what it asserts holds."""

from __future__ import annotations

import pathlib
import subprocess
import sys


def test_freud_and_ovito(repository: pathlib.Path, tmp_path: pathlib.Path) -> None:
    script = repository / "docs/tutorials/freud_and_ovito.py"
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (tmp_path / "freud_and_ovito.png").stat().st_size > 1000
