"""Other programs' distances of random pairs agree within the tolerances that they state. Where they do not, a proof of a
few lines of NumPy (certificate.py) shows that the true distance is ours."""

from __future__ import annotations

import coal
import eigenpy
import fcl
import mujoco
import numpy as np
import pytest
import trimesh
from certificate import Ellipsoids

import hardbody as hb

NUMBER = 1000
ROUNDING = 1e-13  # of numbers of order 10, as the proof computes them


@pytest.fixture(scope="module")
def bodies() -> Ellipsoids:
    return Ellipsoids(NUMBER, seed=5)


@pytest.fixture(scope="module")
def found(bodies: Ellipsoids) -> hb.Distances:
    return bodies.distances()


def of_coal(bodies: Ellipsoids) -> np.ndarray:
    shapes = [coal.Ellipsoid(*axes) for axes in bodies.axes]
    poses = [
        coal.Transform3s(eigenpy.Quaternion(*q), p) for q, p in zip(bodies.quaternions, bodies.positions, strict=True)
    ]
    request = coal.DistanceRequest()
    assert request.gjk_tolerance == 1e-6

    def answer(i: int, j: int) -> float:
        return coal.distance(shapes[i], poses[i], shapes[j], poses[j], request, coal.DistanceResult())

    return np.array([answer(i, j) for i, j in bodies.pairs])


def of_mujoco(bodies: Ellipsoids) -> np.ndarray:
    def numbers(values: np.ndarray) -> str:
        return " ".join(repr(float(value)) for value in values)

    geoms = "".join(
        f'<body pos="{numbers(p)}" quat="{numbers(q)}"><geom type="ellipsoid" size="{numbers(axes)}"/></body>'
        for p, q, axes in zip(bodies.positions, bodies.quaternions, bodies.axes, strict=True)
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option ccd_iterations="200"/><worldbody>{geoms}</worldbody></mujoco>'
    )
    assert model.opt.ccd_tolerance == 1e-6
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return np.array([mujoco.mj_geomDistance(model, data, int(i), int(j), 100.0, None) for i, j in bodies.pairs])


def of_fcl(bodies: Ellipsoids) -> np.ndarray:
    objects = [
        fcl.CollisionObject(fcl.Ellipsoid(*axes), fcl.Transform(q, p))
        for axes, q, p in zip(bodies.axes, bodies.quaternions, bodies.positions, strict=True)
    ]
    request = fcl.DistanceRequest(enable_signed_distance=True)
    return np.array([fcl.distance(objects[i], objects[j], request, fcl.DistanceResult()) for i, j in bodies.pairs])


def test_the_proof_is_tight(bodies: Ellipsoids, found: hb.Distances) -> None:
    apart = found.status == "separated"
    lower, upper = bodies.interval(found)
    assert apart.sum() > 0.8 * NUMBER and (found.status[~apart] == "overlapping").all()
    assert (upper - lower)[apart].max() < ROUNDING
    assert np.abs(found.distance - lower)[apart].max() < ROUNDING


@pytest.fixture(scope="module", params=[of_coal, of_mujoco, of_fcl], ids=["coal", "mujoco", "fcl"])
def theirs(request: pytest.FixtureRequest, bodies: Ellipsoids) -> np.ndarray:
    return request.param(bodies)


def test_separate_pairs(theirs: np.ndarray, bodies: Ellipsoids, found: hb.Distances) -> None:
    """All three state a tolerance of 1e-6. Coal and FCL stop by it, and their answers are further off at times."""
    apart = found.status == "separated"
    agrees = np.abs(theirs - found.distance) < 1e-6
    assert agrees[apart].mean() > 0.4
    assert np.median(np.abs(theirs - found.distance)[apart]) < 2e-6
    lower, upper = bodies.interval(found)
    for k in np.flatnonzero(apart & ~agrees):
        assert theirs[k] < lower[k] - 1e-7 or theirs[k] > upper[k] + 1e-7, "the true distance is ours"


def test_overlapping_pairs(theirs: np.ndarray, bodies: Ellipsoids, found: hb.Distances) -> None:
    """Depths, the least over all directions. Theirs are larger where a search has ended at a local minimum; smaller ones
    are wrong: no direction has such a depth."""
    overlapping = found.status == "overlapping"
    assert (theirs[overlapping] < 0).all()
    difference = theirs - found.distance
    assert np.median(np.abs(difference[overlapping])) < 1e-6
    directions = np.random.default_rng(3).normal(size=(20000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for k in np.flatnonzero(overlapping):
        depth = -found.distance[k]
        least = min(bodies.depths(k, directions).min(), bodies.depths(k, -found.normal[k : k + 1])[0])
        assert bodies.depths(k, found.normal[k : k + 1])[0] == pytest.approx(depth, abs=ROUNDING)
        assert least > depth - ROUNDING


def test_meshes_of_trimesh() -> None:
    """Inscribed polyhedra are further apart than the ellipsoids, at most by the depth of their faces below the surface."""
    random = np.random.default_rng(2)
    ball = trimesh.creation.icosphere(subdivisions=4)
    depth = 1 - np.linalg.norm(ball.triangles_center, axis=1).min()
    for _ in range(5):
        axes = random.uniform(0.5, 2, (2, 3))
        poses = [hb.Pose.normalized(p, random.normal(size=4)) for p in ([0, 0, 0], random.uniform(3, 5, 3))]
        manager = trimesh.collision.CollisionManager()
        manager.add_object("a", trimesh.Trimesh(ball.vertices * axes[0], ball.faces), transform=poses[0].matrix)
        theirs = manager.min_distance_single(
            trimesh.Trimesh(ball.vertices * axes[1], ball.faces), transform=poses[1].matrix
        )
        ours = hb.distance(hb.Ellipsoid(axes[0]), poses[0], hb.Ellipsoid(axes[1]), poses[1]).distance
        assert ours > 0 and -1e-9 < theirs - ours < depth * (axes[0].max() + axes[1].max())
