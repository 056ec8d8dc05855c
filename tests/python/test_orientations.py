"""Array forms take quaternions, rotation matrices and rotations of SciPy."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import hardbody as hb


@pytest.fixture(params=["matrices", "rotations"])
def as_matrices(mixture, request):
    """The mixture with matrices, or SciPy's rotations, in the place of quaternions; one pose where a body has one."""
    q = mixture["quaternions"]
    scipy = Rotation.from_quat(q, scalar_first=True)
    R = scipy.as_matrix()
    poses = [hb.Pose(p, r) for p, r in zip(mixture["positions"], R, strict=True)]
    return mixture | dict(quaternions=R if request.param == "matrices" else scipy), poses


def test_orientations_may_be_matrices_and_rotations(as_matrices):
    m, poses = as_matrices
    few = m | dict(pairs=m["pairs"][:9])  # poses are computed in advance where bodies have many pairs each
    for bodies in (m, few):
        R, overlaps = hb.distance_many(**bodies, threads=2), hb.overlap_many(**bodies)
        for k, (i, j) in enumerate(bodies["pairs"]):
            a, b = (m["shapes"][m["shape_of"][n]] for n in (i, j))
            one = hb.distance(a, poses[i], b, poses[j])
            assert i == j or R.distance[k] == pytest.approx(one.distance, abs=1e-12 + 2 * one.error_bound)
            assert i == j or overlaps.overlap[k] == (R.distance[k] < 0)


def test_queries_take_matrices_and_rotations(as_matrices, random):
    m, poses = as_matrices
    bodies = {k: m[k] for k in ("shapes", "positions", "quaternions", "shape_of")}
    points = random.uniform(-6, 6, (60, 3))
    velocities = random.normal(size=(60, 3))
    near, inside = hb.closest_point_many(points=points, **bodies), hb.contains_many(points=points, **bodies)
    hits = hb.ray_cast_many(origins=points, directions=-points, **bodies)
    C = hb.time_of_contact_many(
        velocities=velocities, angular_velocities=None, pairs=m["pairs"], t_max=2.0, **bodies, threads=2
    )
    for k, (point, X) in enumerate(zip(points, poses, strict=True)):
        shape = m["shapes"][m["shape_of"][k]]
        assert near.distance[k] == hb.closest_point(shape, X, point).distance
        assert inside[k] == hb.contains(shape, X, point)
        np.testing.assert_array_equal(hits.t[k], hb.ray_cast(shape, X, point, -point).t)
    for k, (i, j) in enumerate(m["pairs"]):
        a, b = (m["shapes"][m["shape_of"][n]] for n in (i, j))
        one = hb.time_of_contact(a, hb.Motion(poses[i], velocities[i]), b, hb.Motion(poses[j], velocities[j]), 2.0)
        np.testing.assert_array_equal(C.time[k], one.time)


def test_bad_matrices_name_the_body(mixture):
    R = Rotation.from_quat(mixture["quaternions"], scalar_first=True).as_matrix()
    R[41] *= 1.1
    with pytest.raises(ValueError, match=r"quaternions\[41\]: Pose: rotation is not orthonormal"):
        hb.distance_many(**mixture | dict(quaternions=R, pairs=[[0, 41]]))
    with pytest.raises(ValueError, match=r"quaternions\[41\]: Pose: rotation is not orthonormal"):
        hb.distance_many(**mixture | dict(quaternions=R))
    assert len(hb.distance_many(**mixture | dict(quaternions=R, pairs=[[0, 1]]))) == 1
    for bad in (Rotation.identity(), np.eye(3), R[:, :2], mixture["quaternions"][:, :3]):
        with pytest.raises(ValueError, match=r"accepted: quaternions \(w, x, y, z\) of shape \(N, 4\), rotation"):
            hb.distance_many(**mixture | dict(quaternions=bad))
