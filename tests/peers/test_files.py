"""gsd, MDAnalysis and OVITO open the trajectories, and read what the simulation had."""

from __future__ import annotations

import MDAnalysis
import numpy as np
import pytest
from ovito.io import import_file

import hardbody as hb

AXES = hb.Ellipsoid.spheroid(2.5).semi_axes


@pytest.fixture(scope="module")
def exact(run: hb.Run) -> list[dict[str, np.ndarray]]:
    """Doubles of all frames, which the GSD file has beside its 32-bit numbers."""
    names = ("position", "rotation", "velocity")
    return [
        {name: np.array(frame.log[f"particles/hardbody/{name}"]) for name in names}
        | {"box": frame.log["hardbody/box"][0], "time": frame.log["hardbody/time"][0]}
        for frame in run.trajectory()
    ]


def rotations(q: np.ndarray) -> np.ndarray:
    return np.array([hb.Pose.normalized([0, 0, 0], row).rotation for row in q])


def test_gsd(run: hb.Run, exact: list[dict[str, np.ndarray]]) -> None:
    frames = run.trajectory()
    assert len(frames) == 25
    assert frames[0].particles.type_shapes[0] == pytest.approx({"type": "Ellipsoid"} | dict(zip("abc", AXES, strict=True)))
    for frame, state in zip(frames, exact, strict=True):
        assert frame.configuration.box[0] == pytest.approx(state["box"], rel=1e-7)
        np.testing.assert_allclose(frame.particles.position, state["position"], atol=1e-6)
        np.testing.assert_allclose(frame.particles.velocity, state["velocity"], rtol=1e-6, atol=1e-7)
        R = rotations(np.asarray(frame.particles.orientation, float))
        np.testing.assert_allclose(R.reshape(-1, 9), state["rotation"].reshape(-1, 9), atol=1e-6)


@pytest.mark.parametrize("name", ["trajectory.gsd", "trajectory.lammpstrj"])
def test_mdanalysis(name: str, run: hb.Run, exact: list[dict[str, np.ndarray]]) -> None:
    options = {"topology_format": "LAMMPSDUMP", "format": "LAMMPSDUMP"} if name.endswith("lammpstrj") else {}
    universe = MDAnalysis.Universe(str(run.path / name), **options)
    assert len(universe.trajectory) == 25 and len(universe.atoms) == 100
    for step, state in zip(universe.trajectory, exact, strict=True):
        np.testing.assert_allclose(step.dimensions, [state["box"]] * 3 + [90] * 3, rtol=1e-6)
        moved = np.asarray(step.positions, float) - state["position"]
        if name.endswith("lammpstrj"):  # MDAnalysis takes a corner of the box for the origin
            moved -= state["box"] / 2
        np.testing.assert_allclose(moved - state["box"] * np.rint(moved / state["box"]), 0, atol=1e-5)


@pytest.mark.parametrize("name", ["trajectory.gsd", "trajectory.lammpstrj"])
def test_ovito(name: str, run: hb.Run, exact: list[dict[str, np.ndarray]]) -> None:
    pipeline = import_file(str(run.path / name))
    assert pipeline.source.num_frames == 25
    for k, state in enumerate(exact):
        data = pipeline.compute(k)
        np.testing.assert_allclose(np.diag(data.cell[:, :3]), state["box"], rtol=1e-6)
        assert all(data.cell.pbc)
        moved = np.asarray(data.particles.positions, float) - state["position"]
        np.testing.assert_allclose(moved - state["box"] * np.rint(moved / state["box"]), 0, atol=1e-5)
        np.testing.assert_allclose(data.particles["Aspherical Shape"], np.tile(AXES, (100, 1)), rtol=1e-6)
        x, y, z, w = np.asarray(data.particles["Orientation"], float).T
        R = rotations(np.stack([w, x, y, z], axis=1))
        np.testing.assert_allclose(R.reshape(-1, 9), state["rotation"].reshape(-1, 9), atol=1e-5)
