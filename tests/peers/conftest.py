"""Other programs' packages, of which none may be missing, and a run whose files they read."""

from __future__ import annotations

import importlib
import os
import pathlib

import pytest

import hardbody as hb

PEERS = ["MDAnalysis", "coal", "fcl", "freud", "gsd.hoomd", "matplotlib", "mujoco", "ovito", "pandas", "trimesh"]

os.environ["MPLBACKEND"] = "Agg"


def pytest_sessionstart(session: pytest.Session) -> None:
    missing = []
    for name in PEERS:
        try:
            importlib.import_module(name)
        except ImportError as error:
            missing.append(f"{name} ({error})")
    if missing:
        pytest.exit(f"tests/peers: missing: {'; '.join(missing)}; tools/peers installs apps/python/peers.txt", 2)


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> hb.Run:
    """Run of 100 spheroids with a trajectory of 25 frames in all formats."""
    config = {
        "seed": 3,
        "system": {"number": 100, "packing_fraction": 0.35},
        "shape": {"aspect_ratio": 2.5},
        "equilibration": {"time": 2.0},
        "production": {"time": 12.0},
        "output": {"trajectory": ["gsd", "lammps", "vtk"], "frames": 25},
    }
    return hb.run(config, out=tmp_path_factory.mktemp("peers") / "run")


@pytest.fixture(scope="session")
def analysis(run: hb.Run) -> hb.Analysis:
    """Observables of all frames of that trajectory."""
    return hb.analyze(run, longest_lag=3.0)


@pytest.fixture(scope="session")
def mixture(tmp_path_factory: pytest.TempPathFactory) -> hb.Run:
    """Run of spheroids and larger spheres with a trajectory of 9 frames."""
    config = {
        "seed": 4,
        "system": {"packing_fraction": 0.35},
        "species": [
            {"semi_axes": [0.8, 0.8, 1.6], "number": 60},
            {"semi_axes": [1.1, 1.1, 1.1], "number": 40},
        ],
        "equilibration": {"time": 2.0},
        "production": {"time": 8.0},
        "output": {"trajectory": ["gsd"], "frames": 9},
    }
    return hb.run(config, out=tmp_path_factory.mktemp("peers") / "mixture")


@pytest.fixture(scope="session")
def mixed(mixture: hb.Run) -> hb.Analysis:
    """Observables of all frames of that trajectory."""
    return hb.analyze(mixture)


@pytest.fixture(scope="session")
def crystal(tmp_path_factory: pytest.TempPathFactory) -> hb.Run:
    """Run of discs that begin as a crystal, with a trajectory of 4 frames."""
    config = {
        "seed": 5,
        "system": {"number": 128, "packing_fraction": 0.6, "start": "fcc"},
        "shape": {"aspect_ratio": 0.4},
        "equilibration": {"time": 1.0},
        "production": {"time": 3.0, "order": ["steinhardt", "hexatic"]},
        "output": {"trajectory": ["gsd"], "frames": 4},
    }
    return hb.run(config, out=tmp_path_factory.mktemp("peers") / "crystal")


@pytest.fixture
def repository() -> pathlib.Path:
    return pathlib.Path(__file__).resolve().parents[2]
