"""Array forms: right values, forms of arrays, threads, interrupts."""

import re
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import Pairs, unit_rows, work_after_interrupt

import hardbody as hb


def one_by_one(m, function, **options):
    def body(i):
        return m["shapes"][m["shape_of"][i]], hb.Pose(m["positions"][i], m["quaternions"][i])

    return [function(*body(i), *body(j), **options) for i, j in m["pairs"]]


@pytest.mark.parametrize("axes", [(1.0, 1.0, 3.0), (1.0, 2.0, 3.0), (2.0, 2.0, 2.0)])
def test_distances_of_manufactured_pairs(random, axes):
    m = Pairs(random, axes, 1000)
    R = hb.distance_many(hb.Ellipsoid(axes), m.positions, m.quaternions, m.pairs)
    size = np.linalg.norm(m.positions[1::2] - m.positions[0::2], axis=1) + 2 * max(axes)
    assert np.all(np.abs(R.distance - m.gap) <= 1e-13 * size)
    np.testing.assert_allclose(R.normal, m.normal, atol=1e-6)
    np.testing.assert_allclose(R.point_b - R.point_a, R.distance[:, None] * R.normal, atol=1e-13)
    assert set(R.status) == {"separated"}
    assert np.all(R.error_bound <= 1e-12)
    assert np.all(R.iterations >= 1)
    assert len(R) == 1000
    assert repr(R) == "Distances(1000 rows: 1000 separated)"
    assert R.instruction_set in ("portable", "avx2", "avx512")


@pytest.mark.parametrize("penetration", ["global", "local"])
def test_distances_agree_with_single_ones(mixture, penetration):
    m = mixture
    R = hb.distance_many(**m, penetration=penetration)
    singles = one_by_one(m, hb.distance, penetration=penetration)
    assert {s.status for s in singles} >= {"separated", "overlapping"}
    for k, s in enumerate(singles):
        i, j = m["pairs"][k]
        if i == j:
            continue
        bound = 1e-12 if penetration == "local" else 1e-12 + s.error_bound + R.error_bound[k]
        assert R.distance[k] == pytest.approx(s.distance, abs=bound)
        assert R.status[k] == s.status
        # Of deep overlaps two directions may be equally good; at the nearest stationary one the distance is flat.
        if s.status == "separated" or penetration == "local":
            np.testing.assert_allclose(R.normal[k], s.normal, atol=1e-6)


def test_overlaps_agree_with_distances(mixture):
    R, overlaps = hb.distance_many(**mixture), hb.overlap_many(**mixture)
    assert not overlaps.unknown.any()
    np.testing.assert_array_equal(overlaps.overlap, R.distance < 0)
    np.testing.assert_array_equal(hb.overlap_many(**mixture, start=R.normal).overlap, overlaps.overlap)
    assert repr(overlaps) == f"Overlaps(400 rows: {overlaps.overlap.sum()} overlap, 0 unknown)"


def test_queries_about_bodies_agree_with_single_ones(mixture, random):
    m = {k: mixture[k] for k in ("shapes", "positions", "quaternions", "shape_of")}
    points, directions = random.uniform(-6, 6, (500, 3)), random.normal(size=(500, 3))
    of = random.integers(0, 60, 500)
    inside = hb.contains_many(**m, points=points, body_of=of)
    closest = hb.closest_point_many(**m, points=points, body_of=of, threads=2)
    rays = hb.ray_cast_many(**m, origins=points, directions=directions, body_of=of)
    for k, i in enumerate(of):
        body = m["shapes"][m["shape_of"][i]], hb.Pose(m["positions"][i], m["quaternions"][i])
        assert inside[k] == hb.contains(*body, points[k])
        c, r = hb.closest_point(*body, points[k]), hb.ray_cast(*body, points[k], directions[k])
        assert (closest.status[k], rays.status[k]) == (c.status, r.status)
        assert closest.distance[k] == pytest.approx(c.distance, abs=1e-11)
        np.testing.assert_allclose(rays.t[k], r.t, rtol=1e-9)
        np.testing.assert_allclose(rays.point[k], r.point, atol=1e-9)
    assert inside.dtype == bool
    assert {"hit", "missed"} <= set(rays.status)


@pytest.mark.parametrize("finder", ["certified", "bracketing"])
@pytest.mark.parametrize("moments", ["given", "ones"])
def test_times_of_contact_are_those_of_single_pairs_bit_for_bit(mixture, random, finder, moments):
    m = {**mixture, "positions": 2.5 * mixture["positions"]}
    velocities, omegas = -0.5 * m["positions"] + random.normal(size=(60, 3)), random.normal(size=(60, 3))
    inertias = np.array([m["shapes"][k].inertia() for k in m["shape_of"]]) if moments == "given" else None
    motions = [
        hb.Motion(hb.Pose(m["positions"][i], m["quaternions"][i]), velocities[i], omegas[i], inertia)
        for i, inertia in enumerate([None] * 60 if inertias is None else inertias)
    ]
    options = dict(t_max=3.0, finder=finder, max_evaluations=500, eps_d=1e-3 if finder == "bracketing" else None)
    more = dict(velocities=velocities, angular_velocities=omegas, inertias=inertias, **options)
    C = hb.time_of_contact_many(**m, **more)
    for k, (i, j) in enumerate(m["pairs"]):
        a, b = (m["shapes"][m["shape_of"][body]] for body in (i, j))
        s = hb.time_of_contact(a, motions[i], b, motions[j], **options)
        assert (C.status[k], C.evaluations[k], C.rescues[k]) == (s.status, s.evaluations, s.rescues)
        np.testing.assert_array_equal(C.time[k], s.time)
        np.testing.assert_array_equal(C.point[k], s.point)
        np.testing.assert_array_equal(C.normal[k], s.normal)
    assert {"hit", "separated", "overlapping"} <= set(C.status)
    for threads in (2, 7):
        for name in ("time", "point", "normal", "evaluations"):
            again = hb.time_of_contact_many(**m, **more, threads=threads)
            np.testing.assert_array_equal(getattr(again, name), getattr(C, name))


def test_contacts_of_spheres():
    centers, velocities = np.array([[0, 0, 0], [4, 0, 0], [0, 9, 0]]), [[0, 0, 0], [-1, 0, 0], [0, 1, 0]]
    C = hb.time_of_contact_many(hb.Ellipsoid([1, 1, 1]), centers, None, velocities, None, [[0, 1], [2, 0]], np.inf)
    assert list(C.status) == ["hit", "separated"]
    np.testing.assert_allclose(C.time, [2, np.inf], rtol=1e-15)
    np.testing.assert_allclose(C.point, [[1, 0, 0], [np.nan] * 3], atol=1e-15)
    np.testing.assert_allclose(C.normal, [[1, 0, 0], [np.nan] * 3], atol=1e-15)
    assert repr(C) == "Contacts(2 rows: 1 hit, 1 separated)"
    at_rest = hb.time_of_contact_many(hb.Ellipsoid([1, 1, 1]), centers, None, None, None, [[0, 1]], 1.0)
    assert (at_rest.status[0], at_rest.time[0]) == ("separated", 1.0)
    assert len(hb.time_of_contact_many([], [], None, None, None, [], 1.0)) == 0


@pytest.mark.parametrize("axes", [(1.0, 1.0, 3.0), (1.0, 2.0, 3.0)])
def test_contacts_touch_where_they_say(random, axes):
    """The distance at the time of contact is 0; normals and points agree with its own."""
    e, n = hb.Ellipsoid(axes), 300
    positions, velocities = np.zeros((2 * n, 3)), random.normal(size=(2 * n, 3))
    positions[1::2] = 8 * unit_rows(random, n, 3)
    velocities[1::2] = -0.5 * positions[1::2]
    quaternions, omegas, inertia = unit_rows(random, 2 * n, 4), random.normal(size=(2 * n, 3)), e.inertia()
    pairs = np.arange(2 * n).reshape(n, 2)
    inertias = np.tile(inertia, (2 * n, 1))
    C = hb.time_of_contact_many(e, positions, quaternions, velocities, omegas, pairs, 20.0, inertias=inertias)
    hits = np.flatnonzero(C.status == "hit")
    assert len(hits) > 100
    for k in hits:
        a, b = (
            hb.Motion(hb.Pose(positions[i], quaternions[i]), velocities[i], omegas[i], inertia).at(C.time[k]).pose
            for i in pairs[k]
        )
        r = hb.distance(e, a, e, b)
        assert r.distance == pytest.approx(0, abs=1e-13)  # sizes are 12, times are rounded
        np.testing.assert_allclose(C.normal[k], r.normal, atol=1e-11)
        np.testing.assert_allclose(C.point[k], r.point_a, atol=1e-10)


def test_masses_are_those_of_single_shapes(mixture):
    shapes = mixture["shapes"]
    for density in (2.5, [1.0, 2.0, 0.5]):
        many = hb.mass_properties_many(shapes, density)
        assert (len(many), repr(many)) == (3, "Masses(3 rows)")
        for k, shape in enumerate(shapes):
            one = hb.mass_properties(shape, np.broadcast_to(density, 3)[k])
            for name in ("volume", "mass", "center_of_mass", "inertia", "relative_error"):
                np.testing.assert_array_equal(getattr(many, name)[k], getattr(one, name))
    sphere = hb.mass_properties_many(hb.Ellipsoid([2, 2, 2]), 3.0)
    np.testing.assert_allclose(sphere.mass, [32 * np.pi])
    np.testing.assert_allclose(sphere.inertia, [0.4 * 32 * np.pi * 4 * np.eye(3)])
    assert hb.mass_properties_many([]).inertia.shape == (0, 3, 3)


def test_one_body_or_one_a_query(random):
    sphere = hb.Ellipsoid([1, 1, 1])
    points = random.uniform(-2, 2, (50, 3))
    expected = np.linalg.norm(points, axis=1)
    np.testing.assert_array_equal(hb.contains_many(sphere, [[0, 0, 0]], None, points), expected <= 1)
    one_each = hb.closest_point_many(sphere, points, None, np.zeros((50, 3)))
    np.testing.assert_allclose(one_each.distance, expected - 1, atol=1e-13)


def test_threads_change_no_bit(mixture):
    one = hb.distance_many(**mixture)
    for threads in (2, 5, 64):
        many = hb.distance_many(**mixture, threads=threads)
        for name in ("distance", "normal", "point_a", "point_b", "error_bound", "residual", "iterations"):
            np.testing.assert_array_equal(getattr(many, name), getattr(one, name))


def test_warm_starts_save_evaluations(random):
    m = Pairs(random, (1.0, 1.0, 3.0), 200)
    e = hb.Ellipsoid(m.axes)
    cold = hb.distance_many(e, m.positions, m.quaternions, m.pairs)
    warm = hb.distance_many(e, m.positions, m.quaternions, m.pairs, start=cold.normal)
    assert warm.iterations.max() <= 2
    np.testing.assert_allclose(warm.distance, cold.distance, atol=1e-13)


def test_all_forms_of_arrays_give_the_same_bits(mixture):
    m = mixture
    expected = hb.distance_many(**m).distance
    double = np.empty((120, 6))[::2, ::2]  # not contiguous
    double[:] = m["positions"]
    frozen = m["quaternions"].copy()
    frozen.flags.writeable = False
    forms = [
        dict(positions=double),
        dict(positions=np.asfortranarray(m["positions"])),
        dict(positions=m["positions"].astype(">f8")),
        dict(positions=m["positions"].tolist(), pairs=m["pairs"].tolist()),
        dict(quaternions=frozen),
        dict(shapes=tuple(m["shapes"])),
        dict(shapes=[m["shapes"][k] for k in m["shape_of"]], shape_of=None),
        *(dict(pairs=m["pairs"].astype(kind)) for kind in ("u1", "i2", ">i4", "u4", "u8")),
        dict(pairs=np.asfortranarray(m["pairs"])),
        dict(shape_of=m["shape_of"].astype(np.int8)[:, None][:, 0]),
    ]
    for form in forms:
        np.testing.assert_array_equal(hb.distance_many(**{**m, **form}).distance, expected)
    unaligned = np.frombuffer(b"x" + m["positions"].tobytes(), offset=1).reshape(60, 3)
    np.testing.assert_array_equal(hb.distance_many(**{**m, "positions": unaligned}).distance, expected)
    single = m["positions"].astype(np.float32)
    np.testing.assert_array_equal(
        hb.distance_many(**{**m, "positions": single}).distance,
        hb.distance_many(**{**m, "positions": single.astype(float)}).distance,
    )


REFUSED = """
import resource
import numpy as np
import hardbody as hb
pairs = np.tile([0, 1], (40_000, 1))
with open("/proc/self/statm") as file:
    size = int(file.read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (size + 2**28, size + 2**28))  # of 8 MB a thread
try:
    hb.distance_many(hb.Ellipsoid([1, 1, 3]), [[0, 0, 0], [9, 0, 0]], None, pairs, threads=1024)
except RuntimeError as error:
    print(error)
"""


def test_threads_that_the_system_refuses_are_named():
    done = subprocess.run([sys.executable, "-c", REFUSED], capture_output=True, text=True, check=True)
    assert re.fullmatch(r"threads: the system refused thread \d+ of 1024: .+; accepted: .*\n", done.stdout), done.stdout


@pytest.mark.parametrize("empty", [[], np.zeros((0, 2), int), np.zeros((0, 2), np.uint8)])
def test_no_pairs(empty):
    R = hb.distance_many(hb.Ellipsoid([1, 1, 1]), np.zeros((0, 3)), np.zeros((0, 4)), empty)
    assert (R.distance.shape, R.normal.shape, R.status.shape) == ((0,), (0, 3), (0,))
    assert repr(R) == "Distances(0 rows)"
    assert hb.contains_many([], [], None, []).shape == (0,)


def test_results_outlive_their_input(random):
    m = Pairs(random, (1.0, 1.0, 3.0), 300)
    R = hb.distance_many([hb.Ellipsoid(m.axes)], m.positions, m.quaternions, m.pairs)
    distance, gap = R.distance, m.gap
    del R, m
    np.testing.assert_allclose(distance, gap, atol=1e-12)
    assert distance.flags.writeable


def slow_call(threads=1, pairs=100_000):
    """Deep overlaps of needles, a search over all normals each: minutes for 100,000."""
    needle = hb.Ellipsoid([1, 1, 1000])
    positions = np.zeros((2, 3))
    positions[1] = 0.3, 0, 0
    turned = [[1, 0, 0, 0], [np.cos(1e-4), np.sin(1e-4), 0, 0]]
    return hb.distance_many(needle, positions, turned, np.tile([0, 1], (pairs, 1)), threads=threads)


@pytest.mark.parametrize("threads", [1, 2])
def test_interrupts_end_a_call(threads):
    assert work_after_interrupt(lambda: slow_call(threads)) < 2  # minutes without the interrupt


def test_other_threads_run_meanwhile():
    """One call of at least 0.3 s, and what another thread does between its begin and its end."""
    ticks = []
    stop = threading.Event()

    def tick():
        while not stop.wait(0.005):
            ticks.append(time.monotonic())

    clock = threading.Thread(target=tick)
    clock.start()
    pairs, begin, end = 1, 0.0, 0.0
    try:
        while end - begin < 0.3:
            pairs *= 2
            begin = time.monotonic()
            slow_call(pairs=pairs)
            end = time.monotonic()
    finally:
        stop.set()
        clock.join()
    assert sum(begin < time < end for time in ticks) > 2  # with the GIL kept: one at the most


LITTLE_MEMORY = """
import re
import resource

import numpy as np

import hardbody as hb


def distances(pairs):
    return hb.distance_many(hb.Ellipsoid([1, 1, 1]), [[0, 0, 0], [3, 0, 0]], None, pairs)


def allow(megabytes):
    used = int(re.search("VmSize:\\s+([0-9]+)", open("/proc/self/status").read())[1]) << 10
    resource.setrlimit(resource.RLIMIT_AS, (used + (megabytes << 20), resource.RLIM_INFINITY))


some, more, many = (np.tile(np.array([0, 1], np.int64), (n, 1)) for n in (1_000_000, 1_400_000, 10_000_000))
R = distances(some)
print(R.distance.mean())
del R  # 116 MB are kept
allow(megabytes=120)
print(distances(more).distance.mean())  # 162 MB: fit where those are given back
try:
    distances(many)  # 80 MB of distances would fit, 240 MB of normals never
except MemoryError as error:
    print(error)
print(distances(some).distance.mean())
"""


NO_MEMORY = (
    LITTLE_MEMORY.split("some, more")[0]
    + """
allow(megabytes=60)
try:
    hb.lattice_start(hb.Ellipsoid([1, 1, 3]), number=4 * 60**3, packing_fraction=0.1)
except MemoryError as error:
    print(error)
"""
)


def test_states_that_do_not_fit_are_refused():
    done = subprocess.run([sys.executable, "-c", NO_MEMORY], capture_output=True, text=True, check=False)
    assert done.stdout == "hardbody: what this call computes does not fit into memory\n", done.stderr


def test_results_that_do_not_fit_are_named():
    done = subprocess.run([sys.executable, "-c", LITTLE_MEMORY], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    message = "a result of shape (10000000, 3) does not fit into memory"
    assert done.stdout.splitlines() == ["1.0", "1.0", message, "1.0"]
