"""What the package contains, its types, and versions."""

import dataclasses
import importlib.metadata
import inspect
import os
import pathlib
import re
import subprocess
import sys
import tarfile
import types

import pytest

import hardbody as hb
from hardbody import _core

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = pathlib.Path(hb.__file__).parent
is_installed = (PACKAGE / "_core.pyi").is_file()


def test_version():
    version = re.search(r"^  VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)[1]
    assert hb.__version__ == version
    if is_installed:
        assert importlib.metadata.version("hardbody") == version


# Aliases of types, which have no docstrings of their own, are documented in docs/reference.
DOCUMENTED = [n for n in hb.__all__ if n != "__version__" and not isinstance(getattr(hb, n), types.GenericAlias)]


@pytest.mark.parametrize("name", DOCUMENTED)
def test_every_public_name_is_documented(name):
    thing = getattr(hb, name)
    assert inspect.getdoc(thing)
    if inspect.isclass(thing):
        for key, member in vars(thing).items():
            if not key.startswith("_") and (callable(member) or isinstance(member, (property, staticmethod))):
                assert inspect.getdoc(getattr(thing, key)), f"{name}.{key}"


def annotations(thing):
    """Texts of the types in the signatures of a function, or of a class's members."""
    yield from (text for text, *_ in getattr(thing, "__nb_signature__", ()))
    yield from map(str, getattr(thing, "__annotations__", {}).values())
    if inspect.isclass(thing):
        for key, member in vars(thing).items():
            if not key.startswith("_") or key in ("__init__", "__getitem__", "__call__"):
                yield from annotations(member)
                yield from annotations(getattr(member, "fget", None))


@pytest.mark.parametrize("name", [name for name in dir(hb) if not name.startswith("_")])
def test_types_in_signatures_are_public(name):
    thing = getattr(hb, name)
    if name in ("Reals", "Bools", "Strings") or not hasattr(thing, "__module__"):
        return
    module = sys.modules.get(thing.__module__)
    for text in annotations(thing):
        assert not re.search(r"hardbody\._(?!core\b)\w+\.", text), text
        for word in re.findall(r"(?<![.\w'])[A-Z]\w+(?!['\w])", text):
            kind = getattr(module, word, None)
            if str(getattr(kind, "__module__", "")).startswith("hardbody") or is_union_of_ours(kind):
                assert getattr(hb, word, None) is kind, f"{word} in {text}"


def is_union_of_ours(kind):
    """Whether a type is an alias of a union, tuple or function with classes of the package."""
    return any(
        str(getattr(part, "__module__", "")).startswith("hardbody") or is_union_of_ours(part)
        for part in getattr(kind, "__args__", ())
    )


def test_sources_use_the_stable_abi_alone():
    """Python 3.11 has no stable ABI that nanobind knows: its builds would also take the macros of the full API."""
    for path in sorted((ROOT / "apps/python/src").rglob("*.*")):
        assert not re.findall(r"\bPy[A-Z]\w*_[A-Z]+(?:_[A-Z]+)+\b", path.read_text()), path  # PyBytes_GET_SIZE


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


@pytest.mark.skipif(not is_installed, reason="stubs are made for the installed package")
def test_types_of_the_package():
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--no-error-summary", "-p", "hardbody"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_stubs_are_made_beside_an_older_package(tmp_path):
    nanobind = pytest.importorskip("nanobind")
    older = tmp_path / "older/hardbody/__init__.py"
    older.parent.mkdir(parents=True)
    older.write_text("raise RuntimeError('the older package is imported')")
    core = pathlib.Path(_core.__file__)
    (tmp_path / core.name).symlink_to(core)
    stubgen = pathlib.Path(nanobind.__file__).with_name("stubgen.py")
    command = [sys.executable, "apps/python/make_stub.py", str(stubgen), str(tmp_path)]
    environment = {**os.environ, "PYTHONPATH": str(older.parents[1])}
    subprocess.run(command, check=True, cwd=ROOT, env=environment)
    assert "class Simulation:" in (tmp_path / "_core.pyi").read_text()


@pytest.mark.parametrize("command", ["check", "format --check"])
def test_style(command):
    """The files of [tool.ruff] in pyproject.toml."""
    ruff = [sys.executable, "-m", "ruff", *command.split(), "--quiet", "--no-cache"]
    done = subprocess.run(ruff, capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_help_stands_by_itself():
    said = " ".join(inspect.getdoc(hb.distance_many).split())
    for words in ("shape (N, 3)", "shape (N, 4)", "shape (M, 2)", "world frame", "unit of the shapes", "Raises"):
        assert words in said
    for function in (
        hb.overlap_many,
        hb.contains_many,
        hb.closest_point_many,
        hb.ray_cast_many,
        hb.time_of_contact_many,
        hb.distance_derivatives_many,
        hb.contact_patch_many,
        hb.Scene.add_many,
    ):
        assert "distance_many" in inspect.getdoc(function)


@pytest.mark.parametrize(
    "kind",
    [
        *(hb.Distances, hb.Overlaps, hb.ClosestPoints, hb.RayHits, hb.Contacts, hb.Masses),
        *(
            hb.Derivatives,
            hb.DerivativesMany,
            hb.ContactPatch,
            hb.ContactPatches,
            hb.ScenePairs,
            hb.SceneOverlaps,
            hb.SceneBodies,
            hb.ScenePair,
        ),
        *(hb.SceneContact, hb.SceneNearest, hb.ScenePoint, hb.SceneRayHit, hb.ScenePoints, hb.SceneRayHits),
        *(hb.Estimate, hb.VectorEstimate, hb.TensorEstimate, hb.NumericalError),
    ],
)
def test_help_of_classes_lists_their_fields(kind):
    properties = [name for name in dir(kind) if isinstance(getattr(kind, name), property)]
    fields = [field.name for field in dataclasses.fields(kind)] if dataclasses.is_dataclass(kind) else []
    for name in (name for name in [*fields, *kind.__annotations__, *properties] if not name.startswith("_")):
        assert re.search(rf"\b{name}\b[\w, ]*: ", inspect.getdoc(kind)), name


@pytest.mark.skipif(sys.version_info >= (3, 13), reason="the module has another name there")
def test_subinterpreters_are_refused():
    script = (
        "import _xxsubinterpreters as s; i = s.create()\n"
        "try:\n s.run_string(i, 'import hardbody')\n"
        "except s.RunFailedError as error:\n print(error)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    assert "hardbody cannot be imported in a subinterpreter; accepted: the main interpreter" in done.stdout


@pytest.mark.skipif(not is_installed, reason="other extensions may have debug information")
def test_size_of_the_extension():
    assert pathlib.Path(_core.__file__).stat().st_size < 15_000_000


def test_source_distribution(tmp_path):
    """It has all files that the build reads, and nothing that was built."""
    pytest.importorskip("build")
    command = [sys.executable, "-m", "build", "--sdist", "--no-isolation", "--outdir", str(tmp_path), str(ROOT)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    (archive,) = tmp_path.glob("hardbody-*.tar.gz")
    with tarfile.open(archive) as file:
        names = {name.partition("/")[2] for name in file.getnames()}
    git = ["git", "ls-files", "CMakeLists.txt", "pyproject.toml", "LICENSE", "README.md", "CHANGELOG.md"]
    git += ["apps", "cmake", "libed", "libgeom", "tools/setup"]
    listed = subprocess.run(git, capture_output=True, text=True, cwd=ROOT, check=False)
    if listed.returncode == 0:
        assert set(listed.stdout.split("\n")) - {""} <= names
    for name in (name for name in names if name.endswith(("CMakeLists.txt", ".cmake"))):
        for read in re.findall(r"\$\{PROJECT_SOURCE_DIR\}/([\w/.-]+)", (ROOT / name).read_text()):
            assert any(other == read or other.startswith(f"{read}/") for other in names), f"{name} reads {read}"
    assert not [name for name in names if re.search(r"(^|/)(build|node_modules|__pycache__|\.git)/", name)]
    assert archive.stat().st_size < 15_000_000


def test_example_runs():
    done = subprocess.run(
        [sys.executable, str(pathlib.Path(__file__).with_name("typed_example.py"))],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "separated by 2.049" in done.stdout
