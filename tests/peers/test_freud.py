"""freud, in single precision, finds what `hardbody.analyze` finds in the same frames."""

from __future__ import annotations

import itertools
from typing import Any

import freud
import numpy as np
from wave_vectors import shells

import hardbody as hb


def test_mean_square_displacement(run: hb.Run, analysis: hb.Analysis) -> None:
    frames = run.trajectory()
    ours = analysis.observables["msd"]
    msd = freud.msd.MSD(freud.box.Box.from_box(frames[0].configuration.box), mode="window")
    msd.compute(
        np.array([frame.particles.position for frame in frames]),
        images=np.array([frame.particles.image for frame in frames]),
    )
    step = frames[1].log["hardbody/time"][0] - frames[0].log["hardbody/time"][0]
    lags = np.rint(ours["t"] / step).astype(int)
    assert len(lags) == 6 and np.allclose(lags * step, ours["t"], rtol=1e-12)
    np.testing.assert_allclose(msd.msd[lags], ours["msd"], rtol=1e-5)


def test_radial_distribution(run: hb.Run, analysis: hb.Analysis) -> None:
    """A pair in another bin because its distance is rounded to 32 bits would change g there by 1 / its pairs."""
    ours = analysis.observables["g_r"]
    bins, width = len(ours) - 1, ours["r"][1] - ours["r"][0]  # freud takes no distance of half the box
    rdf = freud.density.RDF(bins=bins, r_max=bins * width, normalization_mode="finite_size")
    for frame in run.trajectory():
        rdf.compute((frame.configuration.box, frame.particles.position), reset=False)
    np.testing.assert_allclose(rdf.bin_centers, ours["r"][:bins], rtol=1e-5)
    assert ours["g"].max() > 1.1
    np.testing.assert_allclose(rdf.rdf, ours["g"][:bins], rtol=1e-3, atol=1e-12)


def test_nematic_order(run: hb.Run, analysis: hb.Analysis) -> None:
    ours = analysis.observables["order"]["S"]
    for frame, S in zip(run.trajectory(), ours, strict=True):
        w, x, y, z = frame.particles.orientation.T
        nematic = freud.order.Nematic()
        nematic.compute(np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1))
        assert abs(nematic.order - S) < 1e-5
        assert abs(frame.log["hardbody/S"][0] - S) < 1e-12


class OneVector:
    """S(q) at one wave vector by freud, which averages over all vectors of a bin whose components are not negative.

    Phases do not change in a box of edges L / n: there the vector is (1, 1, 1), or has components 0 along edges so
    short that no other vector is near. The box is stretched until no other vector has about the same length.
    """

    _NARROW = 1e-4

    def __init__(self, n: tuple[int, int, int]) -> None:
        self.n = np.array(n)
        self.wanted = (self.n != 0).astype(int)
        for stretch in itertools.product([1, 1.07, 1.19, 1.31], repeat=3):
            # Unit of the reciprocal lattice along each axis, in units of 2 pi / L.
            self.unit = np.where(self.n != 0, np.abs(self.n), 100) / np.array(stretch)
            self.length = float(np.linalg.norm(self.unit * self.wanted))
            if self._is_alone():
                return
        raise AssertionError(f"no stretch isolates {n}")

    def _is_alone(self) -> bool:
        most = (1.01 * self.length / self.unit).astype(int)
        others = np.array(list(itertools.product(*(range(m + 1) for m in most))))
        lengths = np.linalg.norm(others * self.unit, axis=1)
        return int((np.abs(lengths / self.length - 1) < 5 * self._NARROW).sum()) == 1

    def mean(self, frames: list[Any], L: float) -> float:
        """S(q) averaged over frames of a cubic box of edge L."""
        box = freud.box.Box(*(L / self.unit))
        k = 2 * np.pi / L * self.length
        factor = freud.diffraction.StaticStructureFactorDirect(
            bins=1, k_min=k * (1 - self._NARROW), k_max=k * (1 + self._NARROW), num_sampled_k_points=0
        )
        for frame in frames:
            factor.compute((box, box.wrap(frame.particles.position * self.n / self.unit)), reset=False)
        return float(factor.S_k[0])


def test_structure_factor(run: hb.Run, tmp_path: Any) -> None:
    """All shells, at the wave vectors that hardbody draws, over every eighth frame."""
    ours = hb.analyze(run, out=tmp_path / "analysis", every=8).observables["s_q"]
    frames = run.trajectory()[::8]
    L = float(frames[0].log["hardbody/box"][0])
    vectors = shells(len(ours))
    q = [2 * np.pi / L * np.mean([np.linalg.norm(n) for n in shell]) for shell in vectors]
    np.testing.assert_allclose(q, ours["q"], rtol=1e-5)
    S = [np.mean([OneVector(n).mean(frames, L) for n in shell]) for shell in vectors]
    assert max(S) > 1.1 > 0.3 > min(S)
    np.testing.assert_allclose(S, ours["S"], rtol=1e-3)
