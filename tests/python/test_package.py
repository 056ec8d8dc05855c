"""What the package contains, its types, and versions."""

import importlib.metadata
import inspect
import pathlib
import re
import subprocess
import sys

import pytest

import hardbody as hb

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = pathlib.Path(hb.__file__).parent
is_installed = (PACKAGE / "_core.pyi").is_file()


def test_version():
    version = re.search(r"^  VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)[1]
    assert hb.__version__ == version
    if is_installed:
        assert importlib.metadata.version("hardbody") == version


@pytest.mark.parametrize("name", [name for name in hb.__all__ if name != "__version__"])
def test_every_public_name_is_documented(name):
    thing = getattr(hb, name)
    assert inspect.getdoc(thing)
    if inspect.isclass(thing):
        for key, member in vars(thing).items():
            if not key.startswith("_") and (callable(member) or isinstance(member, (property, staticmethod))):
                assert inspect.getdoc(getattr(thing, key)), f"{name}.{key}"


def test_build_requirements_are_those_of_the_constraints():
    pinned = set(re.findall(r'"([a-z-]+==[\d.]+)"', (ROOT / "pyproject.toml").read_text()))
    constraints = set((ROOT / "apps/python/constraints.txt").read_text().replace("_", "-").lower().split("\n"))
    assert pinned
    assert pinned <= constraints


@pytest.mark.skipif(not is_installed, reason="stubs are made for the installed package")
def test_types():
    pytest.importorskip("mypy")
    assert (PACKAGE / "py.typed").is_file()
    example = pathlib.Path(__file__).with_name("typed_example.py")
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--no-error-summary", str(example)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=example.parent, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.skipif(not is_installed, reason="stubs are made for the installed package")
def test_types_of_the_tutorials():
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", "docs/tutorials"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_example_runs():
    done = subprocess.run(
        [sys.executable, str(pathlib.Path(__file__).with_name("typed_example.py"))],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "separated by 2.049" in done.stdout


def test_guide_runs():
    """The examples of docs/python.md, in order, in one name space."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "docs/python.md").read_text(), re.DOTALL)
    assert blocks
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)
