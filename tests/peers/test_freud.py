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


def species_of(frame: Any) -> list[Any]:
    """Indices of the bodies of each species."""
    group = frame.log["particles/hardbody/group"]
    return [np.flatnonzero(group == g) for g in range(int(group.max()) + 1)]


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

    def mean(self, frames: list[Any], L: float, of: tuple[Any, Any] | None = None) -> float:
        """S(q) averaged over frames of a cubic box of edge L; `of`: of the bodies of one index array with another's.

        freud then gives the sum over pairs of both over all bodies, which tends to 0.
        """
        box = freud.box.Box(*(L / self.unit))
        k = 2 * np.pi / L * self.length
        factor = freud.diffraction.StaticStructureFactorDirect(
            bins=1, k_min=k * (1 - self._NARROW), k_max=k * (1 + self._NARROW), num_sampled_k_points=0
        )
        for frame in frames:
            points = box.wrap(frame.particles.position * self.n / self.unit)
            if of is None:
                factor.compute((box, points), reset=False)
            else:
                a, b = (points[indices] for indices in of)
                factor.compute((box, a), query_points=b, N_total=len(points), reset=False)
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


def test_radial_distribution_of_two_species(mixture: hb.Run, mixed: hb.Analysis) -> None:
    ours = mixed.observables["g_r"]
    bins, width = len(ours) - 1, ours["r"][1] - ours["r"][0]
    rdf = freud.density.RDF(bins=bins, r_max=bins * width)
    for frame in mixture.trajectory():
        first, second = species_of(frame)
        box, positions = frame.configuration.box, frame.particles.position
        rdf.compute((box, positions[first]), query_points=positions[second], reset=False)
    assert ours["g_1_2"].max() > 1.1
    # A pair that 32 bits move to the next bin changes g there by 1 / its pairs.
    wrong = abs(rdf.rdf - ours["g_1_2"][:bins])
    assert np.mean(wrong > 1e-5 * np.maximum(1, rdf.rdf)) < 0.02


def test_structure_factor_of_two_species(mixture: hb.Run, mixed: hb.Analysis) -> None:
    """Ashcroft and Langreth's S_12 from freud's sum over pairs, in the shells with few vectors and at the peak."""
    ours = mixed.observables["s_q"]
    frames = mixture.trajectory()
    L = float(frames[0].log["hardbody/box"][0])
    first, second = species_of(frames[0])
    scale = (len(first) + len(second)) / np.sqrt(len(first) * len(second))
    vectors = shells(len(ours))
    for shell in (0, 1, 2, int(np.argmax(np.abs(ours["S_1_2"])))):
        S = scale * np.mean([OneVector(n).mean(frames, L, (first, second)) for n in vectors[shell]])
        assert abs(S - ours["S_1_2"][shell]) < 1e-5
    assert np.abs(ours["S_1_2"]).max() > 0.1


def test_bond_order(crystal: hb.Run) -> None:
    """Steinhardt's q_4, q_6 of twelve neighbours, and psi_6 of the bonds that NumPy finds in layers."""
    found = hb.analyze(crystal).summary["observables"]
    run = crystal.summary["observables"]
    q = {4: [], 6: []}
    hexatic = []
    for frame in crystal.trajectory():
        system = (frame.configuration.box, frame.particles.position)
        for order, values in q.items():
            steinhardt = freud.order.Steinhardt(l=order)
            steinhardt.compute(system, neighbors={"num_neighbors": 12, "exclude_ii": True})
            values.append(steinhardt.particle_order.mean())
        hexatic.append(hexatic_order(frame))
    psi = np.mean(hexatic, axis=0)
    for key, value in {"q4": np.mean(q[4]), "q6": np.mean(q[6]), "psi6": psi[0], "psi6_local": psi[1]}.items():
        assert abs(found[key]["value"] - value) < 1e-5, key
        assert abs(run[key]["value"] - value) < 0.1, key  # of other frames
    assert found["psi6_local"]["value"] > 0.2


def hexatic_order(frame: Any) -> tuple[float, float]:
    """|<psi_6>| and <|psi_6|>: freud's of a layer about each body, laid into a plane."""
    L = float(frame.log["hardbody/box"][0])
    positions = frame.log["particles/hardbody/position"]
    axes = frame.log["particles/hardbody/rotation"].reshape(-1, 3, 3)[:, :, 2]
    director = np.linalg.eigh(axes.T @ axes)[1][:, 2]
    reach = 2 / 3 * 2 * frame.log["hardbody/species"][0][3]
    across = np.linalg.svd(director[None])[2][1:]
    plane = freud.box.Box.square(2 * L)
    own = []
    for k, centre in enumerate(positions):
        r = np.delete(positions, k, axis=0) - centre
        r -= L * np.round(r / L)
        near = r[abs(r @ director) <= reach]
        flat = np.column_stack([near @ across.T, np.zeros(len(near))])
        psi = freud.order.Hexatic(k=6)
        query = freud.locality.AABBQuery(plane, np.vstack([np.zeros((1, 3)), flat]))
        neighbors = query.query(np.zeros((1, 3)), {"num_neighbors": 7}).toNeighborList()
        neighbors.filter(neighbors.point_indices != 0)
        psi.compute((plane, query.points), neighbors=neighbors)
        own.append(psi.particle_order[0])
    return abs(np.mean(own)), float(np.abs(own).mean())
