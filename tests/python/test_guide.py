"""The examples of the documentation run, and mypy --strict accepts them."""

import pathlib
import re
import subprocess
import sys

import pytest

import hardbody as hb

ROOT = pathlib.Path(__file__).resolve().parents[2]
is_installed = (pathlib.Path(hb.__file__).parent / "_core.pyi").is_file()


def blocks_of(page):
    """The examples of a page: each goes on where those before it have ended."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.DOTALL)
    assert blocks
    return blocks


@pytest.mark.parametrize("page", ["python.md", "python-shapes.md", "shapes.md"])
def test_examples_run(page):
    """Examples of runs are in test_runs."""
    names: dict[str, object] = {}
    for block in blocks_of(f"docs/{page}"):
        exec(compile(block, page, "exec"), names)


@pytest.mark.skipif(not is_installed, reason="stubs are made for the installed package")
def test_types_of_the_examples(tmp_path):
    pytest.importorskip("mypy")
    pages = ["README.md", *(f"docs/{page}.md" for page in ("python", "python-runs", "python-shapes", "shapes"))]
    for page in pages:
        (tmp_path / page.replace("/", "_").replace("-", "_").replace(".md", ".py")).write_text(
            "\n".join(blocks_of(page))
        )
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--no-error-summary", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
