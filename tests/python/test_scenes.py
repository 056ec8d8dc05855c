"""Scenes: answers against those of all pairs."""

import copy
import pickle
import threading

import numpy as np
import pytest
from conftest import unit_rows

import hardbody as hb

SHAPES = [
    hb.Ellipsoid([0.4, 0.5, 0.9]),
    hb.Superellipsoid([0.4, 0.5, 0.6], 0.5, 0.6),
    hb.Capsule(0.5, 0.3),
    hb.Box([0.4, 0.5, 0.6]),
    hb.Sphere(0.4),
]
SHEARED = np.array([[6.0, 0.5, 0.0], [0.0, 5.0, 1.0], [0.7, 0.0, 6.0]])


class Bodies:
    """60 bodies of five kinds."""

    def __init__(self, seed: int = 1, edge: float = 6.0) -> None:
        random = np.random.default_rng(seed)
        self.positions = random.uniform(0, edge, (60, 3))
        self.quaternions = unit_rows(random, 60, 4)
        self.shape_of = np.arange(60) % len(SHAPES)

    def scene(self, **options) -> hb.Scene:
        scene = hb.Scene(**options)
        handles = scene.add_many(SHAPES, self.positions, self.quaternions, self.shape_of)
        assert handles.tolist() == list(range(60))
        return scene

    def all_pairs(self, image=(0.0, 0.0, 0.0)) -> tuple[np.ndarray, hb.Distances]:
        """Pairs i < j and their distances, all j moved by `image`."""
        pairs = np.stack(np.triu_indices(60, 1), axis=1)
        positions = np.concatenate([self.positions, self.positions + image])
        quaternions = np.concatenate([self.quaternions, self.quaternions])
        shape_of = np.concatenate([self.shape_of, self.shape_of])
        return pairs, hb.distance_many(SHAPES, positions, quaternions, pairs + [0, 60], shape_of)


@pytest.fixture(scope="module")
def bodies() -> Bodies:
    return Bodies()


@pytest.mark.parametrize("threads", [1, 3])
def test_pairs_are_those_of_all_pairs(bodies, threads):
    found = bodies.scene().pairs_within(0.3, threads)
    pairs, wanted = bodies.all_pairs()
    near = wanted.distance <= 0.3
    assert near.sum() > 50
    assert np.array_equal(np.stack([found.i, found.j], axis=1), pairs[near])
    size = 10.0
    assert np.allclose(found.distance, wanted.distance[near], rtol=0, atol=1e-13 * size + wanted.error_bound[near])
    assert (found.image == 0).all()
    apart = found.status == "separated"
    gap = found.point_b - found.point_a
    assert np.allclose(gap[apart], (found.distance[:, None] * found.normal)[apart], atol=1e-12)
    assert "rows" in repr(found) and len(found) == near.sum()


@pytest.mark.parametrize("lattice", [6.0, SHEARED])
def test_periodic_pairs_are_those_of_all_images(lattice):
    bodies = Bodies(2)
    vectors = np.eye(3) * lattice if np.ndim(lattice) == 0 else lattice
    wanted = set()
    for cell in np.ndindex(5, 5, 5):
        image = (np.array(cell) - 2) @ vectors
        pairs, distances = bodies.all_pairs(image)
        for i, j in pairs[distances.distance <= 0.2]:
            wanted.add((int(i), int(j), *np.round(image, 9)))
    found = bodies.scene(lattice=lattice).pairs_within(0.2)
    assert {(int(i), int(j), *np.round(v, 9)) for i, j, v in zip(found.i, found.j, found.image, strict=True)} == wanted


def test_overlaps_are_those_of_all_pairs(bodies):
    scene = bodies.scene()
    found = scene.overlapping_pairs(2)
    pairs, wanted = bodies.all_pairs()
    assert np.array_equal(np.stack([found.i, found.j], axis=1), pairs[wanted.distance <= 0])
    assert not found.unknown.any()
    body = scene.overlapping(SHAPES[bodies.shape_of[7]], scene.pose(7))
    others = set(found.j[found.i == 7]) | set(found.i[found.j == 7])
    assert set(body.body) == others | {7}


def test_a_moved_scene_is_a_new_one(bodies):
    other = Bodies(5)
    scene = bodies.scene(margin=0.1)
    scene.pairs_within(0.1)
    scene.move_many(np.arange(60), other.positions, other.quaternions)
    assert scene.pairs_within(0.3) == other.scene().pairs_within(0.3)
    scene.move(3, hb.Pose([100, 0, 0]))
    assert 3 not in set(scene.pairs_within(1.0).i)
    assert scene.pose(3) == hb.Pose([100, 0, 0])


def test_bodies_come_and_go(bodies):
    scene = bodies.scene()
    scene.remove(5)
    scene.remove([1, 2])
    assert (
        len(scene) == 57
        and 5 not in scene
        and 6 in scene
        and True not in scene
        and "x" not in scene
        and -1 not in scene
    )
    assert scene.add(hb.Sphere(1), hb.Pose()) == 60
    assert scene.bodies.tolist() == [k for k in range(61) if k not in (1, 2, 5)]
    for call in (lambda: scene.move(5, hb.Pose()), lambda: scene.remove([7, 5]), lambda: scene.pose(5)):
        with pytest.raises(ValueError, match="body 5 has been removed"):
            call()
    assert 7 in scene  # nothing half-done
    with pytest.raises(ValueError, match="body 99 has not been added; accepted: one of the scene's 58 bodies"):
        scene.distance(0, 99)


def test_shapes_come_back(bodies):
    class Ball:
        bounding_radius = inscribed_radius = 0.5

        def support(self, n):
            length = np.linalg.norm(n)
            return 0.5 * length, 0.5 * np.asarray(n) / length

    scene, ball = hb.Scene(), Ball()
    shapes = [hb.Ellipsoid([1, 2, 3]), hb.Box([1, 2, 3]), hb.CustomShape(ball)]
    for shape in shapes:
        scene.add(shape, hb.Pose())
    assert [scene.shape(k) for k in range(2)] == shapes[:2]
    assert scene.shape(2).object is ball
    scene.remove(2)
    with pytest.raises(ValueError, match="body 2 has been removed"):
        scene.shape(2)
    for duplicate in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="^a Scene cannot be pickled .*; accepted: its shapes and poses"):
            duplicate(scene)


def test_filters(bodies):
    scene = hb.Scene()
    a = scene.add(hb.Sphere(1), hb.Pose(), group=1, meets=2)
    b = scene.add(hb.Sphere(1), hb.Pose([1.5, 0, 0]), group=1, meets=2)
    c = scene.add(hb.Sphere(1), hb.Pose([0.7, 1.2, 0]), group=2)
    pairs = scene.overlapping_pairs()
    assert list(zip(pairs.i, pairs.j, strict=True)) == [(a, c), (b, c)]
    scene.set_filter(b, group=2)
    assert scene.filter(b) == (2, 0xFFFFFFFF)
    assert len(scene.overlapping_pairs()) == 3


def test_nearest_points_and_rays(bodies):
    scene = bodies.scene()
    random = np.random.default_rng(4)
    points = random.uniform(0, 6, (40, 3))
    many = scene.closest_point_many(points, threads=2)
    each = hb.closest_point_many(
        SHAPES,
        np.repeat(bodies.positions, 40, axis=0),
        np.repeat(bodies.quaternions, 40, axis=0),
        np.tile(points, (60, 1)),
        shape_of=np.repeat(bodies.shape_of, 40),
    )
    assert np.allclose(many.distance, each.distance.reshape(60, 40).min(axis=0), atol=1e-12)
    one = scene.closest_point(points[0])
    assert (one.body, one.closest.distance) == (many.body[0], many.distance[0])
    directions = unit_rows(random, 40, 3)
    rays = scene.ray_cast_many(points, directions, threads=2)
    all_rays = hb.ray_cast_many(
        SHAPES,
        np.repeat(bodies.positions, 40, axis=0),
        np.repeat(bodies.quaternions, 40, axis=0),
        np.tile(points, (60, 1)),
        np.tile(directions, (60, 1)),
        shape_of=np.repeat(bodies.shape_of, 40),
    )
    first = np.where(np.isnan(all_rays.t), np.inf, all_rays.t).reshape(60, 40).min(axis=0)
    assert np.allclose(np.where(rays.body < 0, np.inf, rays.t), first, atol=1e-12)
    hit = scene.ray_cast(points[0], directions[0])
    assert hit.body == (None if rays.body[0] < 0 else rays.body[0])
    for body in (0, 17):
        near = scene.nearest_to(body)
        d = [scene.distance(body, k).result.distance for k in range(60) if k != body]
        assert near.result.distance == pytest.approx(min(d), abs=1e-12)
    assert scene.nearest(hb.Sphere(1), hb.Pose([50, 0, 0]), within=1.0).body is None
    assert scene.closest_point_many([[50, 0, 0]], within=1.0).body.tolist() == [-1]


def test_shapes_written_in_python():
    class Ball:
        radius = 0.5
        bounding_radius = inscribed_radius = 0.5

        def support(self, n):
            length = np.linalg.norm(n)
            return self.radius * length, self.radius * np.asarray(n) / length

    scene = hb.Scene()
    scene.add(Ball(), hb.Pose())
    scene.add(hb.Sphere(0.5), hb.Pose([2, 0, 0]))
    pairs = scene.pairs_within(1.5, threads=2)
    assert pairs.distance == pytest.approx([1.0], abs=1e-12)

    class Broken(Ball):
        broken = False

        def support(self, n):
            if self.broken:
                raise ZeroDivisionError("of the shape")
            return super().support(n)

    ball = Broken()
    scene.add(ball, hb.Pose([0, 2, 0]))
    ball.broken = True
    with pytest.raises(ZeroDivisionError, match="of the shape"):
        scene.pairs_within(3.0)
    assert len(scene) == 3

    class Meddler(Ball):
        def support(self, n):
            if self.armed:
                scene.remove(0)
            return super().support(n)

        armed = False

    meddler = Meddler()
    scene = hb.Scene()
    scene.add(meddler, hb.Pose())
    scene.add(hb.Sphere(0.5), hb.Pose([2, 0, 0]))
    meddler.armed = True
    with pytest.raises(RuntimeError, match="a query is running"):
        scene.pairs_within(3.0)
    assert len(scene) == 2


def test_queries_of_several_threads(bodies):
    scene = bodies.scene()
    wanted = scene.pairs_within(0.5)
    answers = []
    workers = [threading.Thread(target=lambda: answers.append(scene.pairs_within(0.5))) for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(answers) == 4 and all(answer == wanted for answer in answers)


def test_bad_scenes(bodies):
    for value, what in ((-1.0, "margin"), (np.nan, "margin"), ("x", "margin")):
        with pytest.raises((ValueError, TypeError), match=what):
            hb.Scene(margin=value)
    assert hb.Scene(lattice=np.float32(3)).add(hb.Sphere(1), hb.Pose()) == 0
    for value in ([1, 0, 0], np.eye(2), [[1, 0, 0]], "cube"):
        with pytest.raises((ValueError, TypeError), match=r"^lattice .*; accepted: the edge of a cube, or finite num"):
            hb.Scene(lattice=value)
    for value in (-1.0, np.nan, [[1, 0, 0], [2, 0, 0], [0, 0, 1]]):
        with pytest.raises((ValueError, TypeError), match="(?i)lattice"):
            hb.Scene(lattice=value)
    scene = bodies.scene()
    for call, what in (
        (lambda: scene.pairs_within(-1.0), "cutoff"),
        (lambda: scene.pairs_within(np.inf), "cutoff"),
        (lambda: scene.pairs_within(1.0, threads=0), "threads"),
        (lambda: scene.move_many([0, 1], [[0, 0, 0]]), "positions"),
        (lambda: scene.move_many([0], [[np.nan, 0, 0]]), "positions"),
        (lambda: scene.add("ball", hb.Pose()), "shape"),
        (lambda: scene.add(hb.Sphere(1), None), "pose"),
        (lambda: scene.add(hb.Sphere(1), hb.Pose(), group=-1), "group"),
        (lambda: scene.nearest(hb.Sphere(1), hb.Pose(), within=-1), "within"),
        (lambda: scene.ray_cast([0, 0, 0], [0, 0, 0]), "direction"),
        (lambda: scene.ray_cast_many([[0, 0, 0]], [[0, 0, 0]]), "directions"),
        (lambda: scene.distance(2, 2), "j is 2, as i; accepted: another body"),
        (lambda: scene.first_contact({10**30: hb.Motion()}, 1), "moving: a key is an integer outside"),
        (lambda: scene.first_contact({-1: hb.Motion()}, 1), "moving: a key is -1; accepted: an integer from 0"),
        (lambda: scene.first_contact({True: hb.Motion()}, 1), "moving: a key is"),
        (lambda: scene.first_contact({3: 3}, 1), r"moving\[3\] is 3; accepted: Motion, GivenMotion"),
        (lambda: scene.first_contact(list(range(10**5)), 1), r"^moving is \[0, .{,200}; accepted: a dict"),
        (lambda: scene.remove(1.5), "bodies"),
    ):
        with pytest.raises((ValueError, TypeError), match=what):
            call()
    assert len(scene) == 60
