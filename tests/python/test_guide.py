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


@pytest.mark.parametrize(
    "page", ["python.md", "python-shapes.md", "shapes.md", "scenes.md", "derivatives.md", "contact-patches.md"]
)
def test_examples_run(page):
    """Examples of runs are in test_runs."""
    names: dict[str, object] = {}
    for block in blocks_of(f"docs/{page}"):
        exec(compile(block, page, "exec"), names)


def test_the_first_example_of_the_readme_runs():
    """The second is a whole run, of a minute; its types are checked below."""
    names: dict[str, object] = {}
    exec(compile(blocks_of("README.md")[0], "README.md", "exec"), names)
    assert isinstance(names["r"], hb.DistanceResult) and names["r"].status == "separated"


@pytest.mark.skipif(not is_installed, reason="stubs are made for the installed package")
def test_types_of_the_examples(tmp_path):
    pytest.importorskip("mypy")
    names = ("python", "python-runs", "python-shapes", "shapes", "scenes", "derivatives", "contact-patches")
    pages = ["README.md", *(f"docs/{name}.md" for name in names)]
    for page in pages:
        (tmp_path / page.replace("/", "_").replace("-", "_").replace(".md", ".py")).write_text(
            "\n".join(blocks_of(page))
        )
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--no-error-summary", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
