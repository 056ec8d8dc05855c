"""Many bodies in open space or in a periodic lattice: pairs that are close, the nearest body, ray casts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hardbody import _core
from hardbody._arrays import _DISTANCE_STATUS, ClosestPoints, RayHits, _Outcomes
from hardbody._toml import shown
from hardbody._typing import BodyShape, Bools, Reals, RotationLike, Shape, Shapes
from hardbody._values import Comparable

Handles = NDArray[np.int64]

_ALL_GROUPS = 0xFFFFFFFF


@dataclass(frozen=True, eq=False, repr=False)
class ScenePairs(_Outcomes):
    """Pairs of bodies of a scene and their distances: arrays with one row a pair, in the order of (i, j, image).

    i, j: handles, i < j, integers of shape (M,).
    image: lattice vectors to be added to the positions of j, shape (M, 3); 0 in open space.
    distance, normal, point_a, point_b, error_bound, residual, iterations, status: as of distance_many, from i to that
        image of j.
    """

    _names = _DISTANCE_STATUS

    i: Handles
    j: Handles
    image: Reals
    distance: Reals
    normal: Reals
    point_a: Reals
    point_b: Reals
    error_bound: Reals
    residual: Reals
    iterations: NDArray[np.int32]
    _code: NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class SceneOverlaps(Comparable):
    """Pairs of bodies of a scene that overlap or touch: arrays with one row a pair, in the order of (i, j, image).

    i, j: handles, i < j, integers of shape (M,).
    image: lattice vectors to be added to the positions of j, shape (M, 3); 0 in open space.
    unknown: whether it is not certain that they overlap, bools of shape (M,): bodies that touch within the error bound.
    """

    i: Handles
    j: Handles
    image: Reals
    unknown: Bools

    def __len__(self) -> int:
        return len(self.i)

    def __repr__(self) -> str:
        return f"SceneOverlaps({len(self)} rows, {self.unknown.sum()} unknown)"


@dataclass(frozen=True, eq=False)
class SceneBodies(Comparable):
    """Bodies of a scene, or images of them: arrays with one row each, in the order of (body, image).

    body: handles, integers of shape (M,).
    image: lattice vectors to be added to the positions, shape (M, 3); 0 in open space.
    """

    body: Handles
    image: Reals

    def __len__(self) -> int:
        return len(self.body)

    def __repr__(self) -> str:
        return f"SceneBodies({len(self)} rows)"


@dataclass(frozen=True, eq=False)
class ScenePair(Comparable):
    """Distance of two bodies of a scene, the least over all images.

    image: lattice vector to be added to the position of the second body, shape (3,); 0 in open space.
    result: DistanceResult from the first body to that image of the second.
    """

    image: Reals
    result: _core.DistanceResult


@dataclass(frozen=True, eq=False)
class SceneContact(Comparable):
    """First contact in a scene.

    i, j: handles of the two bodies, i < j; None: no contact.
    image: lattice vector to be added to the position of j, shape (3,); 0 in open space; None with i and j.
    contact: ContactResult of i and that image of j; "separated": no two bodies touch.
    """

    i: int | None
    j: int | None
    image: Reals | None
    contact: _core.ContactResult


@dataclass(frozen=True, eq=False)
class SceneNearest(Comparable):
    """Body that is nearest to a shape.

    body: handle; None: no body within the distance asked for; `result` then has no meaning.
    image: lattice vector to be added to its position, shape (3,); None with `body`.
    result: DistanceResult from the shape to the body.
    """

    body: int | None
    image: Reals | None
    result: _core.DistanceResult


@dataclass(frozen=True, eq=False)
class ScenePoint(Comparable):
    """Body whose surface is closest to a point.

    body: handle; None: no body within the distance asked for; `closest` then has no meaning.
    image: lattice vector to be added to its position, shape (3,); None with `body`.
    closest: ClosestPoint of that body.
    """

    body: int | None
    image: Reals | None
    closest: _core.ClosestPoint


@dataclass(frozen=True, eq=False)
class SceneRayHit(Comparable):
    """First body that a ray meets.

    body: handle; None: none.
    image: lattice vector to be added to its position, shape (3,); None with `body`.
    hit: RayHit of that body.
    """

    body: int | None
    image: Reals | None
    hit: _core.RayHit


@dataclass(frozen=True, eq=False, repr=False)
class ScenePoints(ClosestPoints):
    """Answers of Scene.closest_point_many: arrays with one row a point.

    distance, point, normal, error_bound, status: as of closest_point_many.
    body: handles, integers of shape (M,); -1: no body within the distance asked for, and no numbers.
    image: lattice vectors to be added to the positions, shape (M, 3); NaN with -1.
    """

    body: Handles
    image: Reals


@dataclass(frozen=True, eq=False, repr=False)
class SceneRayHits(RayHits):
    """Answers of Scene.ray_cast_many: arrays with one row a ray.

    t, point, normal, status: as of ray_cast_many.
    body: handles, integers of shape (M,); -1: none.
    image: lattice vectors to be added to the positions, shape (M, 3); NaN with -1.
    """

    body: Handles
    image: Reals


class Scene:
    """Bodies in open space or in a periodic lattice, in a tree of boxes.

    Bodies are known by handles: integers in the order in which they were added, from 0, never used again. Answers are
    those of trying all pairs, ordered by handles and lattice vectors; they depend on the bodies and poses alone, not on
    the number of threads or on what happened before.

    margin: length by which boxes around bodies are larger than the bodies, 0 or more: bodies that stay inside their
    boxes move at no cost, and queries have more candidates. lattice: None, open space; the edge of a cube; or three
    vectors as rows, shape (3, 3), of which zero ones leave a direction open. Positions may be anywhere: each body
    stands for all its images.

    A body and its own images are no pair. The GIL is released in queries, but held in first_contact. While one runs,
    changes of the scene from other threads raise RuntimeError. Handles of bodies that are gone raise ValueError, and
    nothing is changed.
    """

    def __init__(self, *, margin: float = 0.0, lattice: float | ArrayLike | None = None) -> None:
        self._scene = _core.Scene(margin, lattice)

    def add(self, shape: BodyShape, pose: _core.Pose, *, group: int = 1, meets: int = _ALL_GROUPS) -> int:
        """Adds a body and returns its handle.

        group, meets: bits. Two bodies are paired if the `meets` of each has a bit of the other's `group`.
        """
        return self._scene.add(shape, pose, group, meets)

    def add_many(
        self,
        shapes: Shapes,
        positions: ArrayLike,
        quaternions: ArrayLike | RotationLike | None = None,
        shape_of: ArrayLike | None = None,
        *,
        group: int = 1,
        meets: int = _ALL_GROUPS,
    ) -> Handles:
        """Adds N bodies and returns their handles, shape (N,). Arguments are those of distance_many and add."""
        return self._scene.add_many(shapes, positions, quaternions, shape_of, group, meets)

    def move(self, body: int, pose: _core.Pose) -> None:
        """Moves a body to a new pose."""
        self._scene.move(body, pose)

    def move_many(
        self, bodies: ArrayLike, positions: ArrayLike, quaternions: ArrayLike | RotationLike | None = None
    ) -> None:
        """Moves bodies, handles of shape (K,), to new poses, as of distance_many, one each."""
        self._scene.move_many(bodies, positions, quaternions)

    def remove(self, bodies: int | ArrayLike) -> None:
        """Removes a body, or bodies, handles of shape (K,)."""
        self._scene.remove_many(np.atleast_1d(bodies) if np.ndim(bodies) == 0 else bodies)

    def set_filter(self, body: int, *, group: int = 1, meets: int = _ALL_GROUPS) -> None:
        """Changes which bodies a body is paired with; see add."""
        self._scene.set_filter(body, group, meets)

    def filter(self, body: int) -> tuple[int, int]:
        """Returns (group, meets) of a body."""
        return self._scene.filter(body)

    def shape(self, body: int) -> Shape | _core.CustomShape:
        """Returns the shape of a body; one written in Python as a CustomShape."""
        shape: Shape | _core.CustomShape = self._scene.shape(body)
        return shape

    def pose(self, body: int) -> _core.Pose:
        """Returns the pose of a body, as it was given."""
        return self._scene.pose(body)

    @property
    def bodies(self) -> Handles:
        """Handles of all bodies, in ascending order, shape (N,)."""
        return self._scene.bodies()

    def __len__(self) -> int:
        return self._scene.size()

    def __contains__(self, body: Any) -> bool:
        is_handle = isinstance(body, (int, np.integer)) and not isinstance(body, bool)
        return is_handle and 0 <= int(body) <= _ALL_GROUPS and self._scene.has(int(body))

    def __repr__(self) -> str:
        return f"Scene({len(self)} bodies)"

    def __reduce_ex__(self, protocol: Any) -> Any:
        """Raises TypeError: copies and pickles of scenes are not made."""
        return self._scene.__reduce_ex__(protocol)

    def pairs_within(
        self,
        cutoff: float,
        threads: int = 1,
        *,
        max_iterations: int = 60,
        penetration: Literal["global", "local"] = "global",
    ) -> ScenePairs:
        """Returns every pair of bodies whose distance is at most `cutoff`, images included, with their distances.

        Pairs that may be that near and whose distance was declined are among them, with that status. threads: number of
        threads; 1 where shapes are written in Python. max_iterations, penetration: as for distance.
        """
        return ScenePairs(*self._scene.pairs_within(cutoff, threads, max_iterations, penetration))

    def overlapping_pairs(self, threads: int = 1) -> SceneOverlaps:
        """Returns every pair of bodies that overlap, images included."""
        return SceneOverlaps(*self._scene.overlapping_pairs(threads))

    def overlapping(self, shape: BodyShape, pose: _core.Pose) -> SceneBodies:
        """Returns every body that overlaps a shape, or may do so. Filters do not count."""
        return SceneBodies(*self._scene.overlapping(shape, pose))

    def distance(
        self, i: int, j: int, *, max_iterations: int = 60, penetration: Literal["global", "local"] = "global"
    ) -> ScenePair:
        """Returns the distance from body i to body j, the least over all images of j."""
        return ScenePair(*self._scene.distance(i, j, max_iterations, penetration))

    def nearest(self, shape: BodyShape, pose: _core.Pose, within: float = math.inf) -> SceneNearest:
        """Returns the body that is nearest to a shape, not further than `within`. Filters do not count."""
        place, result = self._scene.nearest(shape, pose, within)
        return SceneNearest(place[0], place[1], result)

    def nearest_to(self, body: int, within: float = math.inf) -> SceneNearest:
        """Returns the body that is nearest to another one of the scene, of those that it is paired with."""
        place, result = self._scene.nearest_to(body, within)
        return SceneNearest(place[0], place[1], result)

    def first_contact(
        self,
        moving: Mapping[int, _core.Motion | _core.GivenMotion],
        t_max: float,
        t_min: float = 0.0,
        *,
        max_evaluations: int | None = None,
        tolerance: float | None = None,
    ) -> SceneContact:
        """Returns the first time in [t_min, t_max] at which a moving body touches another body of the scene.

        moving: handles and motions of the bodies that move; the others stay. They are moved to their poses at the time
        of the answer; if an exception is raised they are where they were. Each pair is searched by time_of_contact,
        with its certificate; max_evaluations, for each pair, and tolerance: as there. max_evaluations is also the
        largest number of intervals that the time is cut into: a body that meets nobody but passes others, or images of
        them, all the time ends with 'budget_exhausted' and no bodies (None), at a time before which there is no
        contact.

        The outcome of the earliest pair is returned: where it is no hit, later contacts are not known. The GIL is held;
        where functions of motions let other threads run, queries of this scene raise RuntimeError. Raises as
        time_of_contact, and ValueError for handles that no body has.
        """
        if not isinstance(moving, Mapping):
            raise TypeError(f"moving is {shown(moving)}; accepted: a dict of handles and motions")
        return SceneContact(*self._scene.first_contact(dict(moving), t_max, t_min, max_evaluations, tolerance))

    def closest_point(self, point: ArrayLike, within: float = math.inf) -> ScenePoint:
        """Returns the body whose surface is closest to a point, not further than `within`, and the point there.

        A point inside bodies belongs to the one in which it is deepest.
        """
        place, closest = self._scene.closest_point(point, within)
        return ScenePoint(place[0], place[1], closest)

    def closest_point_many(self, points: ArrayLike, within: float = math.inf, threads: int = 1) -> ScenePoints:
        """Returns the answers of closest_point for points, world frame, shape (M, 3)."""
        return ScenePoints(*self._scene.closest_point_many(points, within, threads))

    def ray_cast(self, origin: ArrayLike, direction: ArrayLike, t_max: float = math.inf) -> SceneRayHit:
        """Returns the first body that origin + t direction, 0 <= t <= t_max, meets.

        In a periodic scene rays may be 1e6 times as long as the shortest lattice vector, not counting what is beyond
        all bodies along open directions, and may have 1e8 images on their way.
        """
        place, hit = self._scene.ray_cast(origin, direction, t_max)
        return SceneRayHit(place[0], place[1], hit)

    def ray_cast_many(
        self, origins: ArrayLike, directions: ArrayLike, t_max: float = math.inf, threads: int = 1
    ) -> SceneRayHits:
        """Returns the answers of ray_cast for rays, origins and directions of shape (M, 3); t_max as there."""
        return SceneRayHits(*self._scene.ray_cast_many(origins, directions, t_max, threads))
