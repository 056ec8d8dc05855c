"""Queries about many pairs, points or rays: NumPy arrays in and out, no loop in Python, the GIL released.

All of them take bodies in the same form:

shapes
    One shape, or a list of shapes.
positions
    Positions of N bodies, world frame, shape (N, 3).
quaternions
    Orientations of the bodies, body to world: unit quaternions (w, x, y, z), shape (N, 4), rotation matrices, shape
    (N, 3, 3), or an array of N rotations of scipy.spatial.transform.Rotation; None: bodies that are not rotated. SciPy
    stores w last: pass the rotations themselves, or as_quat(scalar_first=True).
shape_of
    Index of each body's shape, shape (N,). None: one shape serves all bodies, or there is one a body.
threads
    Number of threads, from 1 to 1024. Answers do not depend on it, not even in their last bit.

Numbers of bodies that no pair, point or ray names are not checked. Arrays of other real types, and arrays that are not
contiguous, are copied. ValueError or TypeError names the argument, the entry and what is accepted. Ctrl-C ends a call
within about a tenth of a second.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hardbody import _core
from hardbody._typing import Bools, Reals, RotationLike, Shapes, Strings
from hardbody._values import Comparable

# In the order of the C++ enumerators.
_DISTANCE_STATUS = np.array(["separated", "overlapping", "not_converged", "singular"])
_RAY_STATUS = np.array(["hit", "missed", "inside", "not_converged"])
_CONTACT_STATUS = np.array(["hit", "separated", "overlapping", "budget_exhausted", "failed"])


class _Rows(Comparable):
    """Results with one row a query, each with a code that stands for a name."""

    _names: ClassVar[Strings]  # in the order of the C++ enumerators
    _code: NDArray[np.uint8]

    def __len__(self) -> int:
        return len(self._code)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self._summary()})"

    def _summary(self) -> str:
        names, counts = np.unique(self._names[self._code], return_counts=True)
        what = ", ".join(f"{count} {name}" for name, count in zip(names, counts, strict=True))
        return f"{len(self)} rows{': ' if what else ''}{what}"


class _Outcomes(_Rows):
    """Results with a status a row."""

    @property
    def status(self) -> Strings:
        """Outcomes, one a row, shape (M,); made at each access."""
        return self._names[self._code]


@dataclass(frozen=True, eq=False, repr=False)
class Distances(_Outcomes):
    """Answers of distance_many: arrays with one row a pair, named as the attributes of DistanceResult.

    distance: signed distances, shape (M,), in the unit of the shapes; below 0: minus the penetration depth; NaN: no
        answer.
    normal: unit vectors from A to B, world frame, shape (M, 3).
    point_a, point_b: closest points of A and B, world frame, shape (M, 3).
    error_bound: certified, distance <= true distance <= distance + error_bound, shape (M,), apart from rounding, 1e-15
        of the size of the pair, its radii and distance of centres together.
    residual: deviations (length) of the points found from being distance * normal apart, shape (M,).
    iterations: numbers of evaluations, shape (M,).
    status: "separated", "overlapping", "not_converged" or "singular", shape (M,).
    redone: number of pairs that the vector kernels left to the method of single pairs.
    instruction_set: that of the vector kernels, "portable", "avx2" or "avx512". The last bits depend on it.
    """

    _names = _DISTANCE_STATUS

    distance: Reals
    normal: Reals
    point_a: Reals
    point_b: Reals
    error_bound: Reals
    residual: Reals
    iterations: NDArray[np.int32]
    _code: NDArray[np.uint8]
    redone: int
    instruction_set: str


@dataclass(frozen=True, eq=False)
class Overlaps(Comparable):
    """Answers of overlap_many: arrays with one row a pair.

    overlap: whether the bodies overlap or touch, bools of shape (M,); False where `unknown`.
    unknown: whether neither answer is certain, bools of shape (M,): bodies that touch within the error bound.
    """

    overlap: Bools
    unknown: Bools

    def __len__(self) -> int:
        return len(self.overlap)

    def __repr__(self) -> str:
        return f"Overlaps({len(self)} rows: {self.overlap.sum()} overlap, {self.unknown.sum()} unknown)"


@dataclass(frozen=True, eq=False, repr=False)
class ClosestPoints(_Outcomes):
    """Answers of closest_point_many: arrays with one row a point, named as the attributes of ClosestPoint.

    distance: signed distances, shape (M,), in the unit of the shapes; below 0: the point is inside, at this depth; NaN:
        no answer.
    point: closest points of the surface, world frame, shape (M, 3).
    normal: unit outward normals there, world frame, shape (M, 3).
    error_bound: certified, distance <= true distance <= distance + error_bound, shape (M,), apart from rounding, 1e-15
        of the size of the body and the distance of its centre together.
    status: "separated", "overlapping", "not_converged" or "singular", shape (M,).
    """

    _names = _DISTANCE_STATUS

    distance: Reals
    point: Reals
    normal: Reals
    error_bound: Reals
    _code: NDArray[np.uint8]


@dataclass(frozen=True, eq=False, repr=False)
class RayHits(_Outcomes):
    """Answers of ray_cast_many: arrays with one row a ray, named as the attributes of RayHit.

    t: ray parameters, in units of the directions' lengths, shape (M,); NaN: the ray misses.
    point: first points of the rays in the bodies, world frame, shape (M, 3).
    normal: unit outward normals there, world frame, shape (M, 3); as of RayHit.normal for rays that start inside.
    status: "hit", "missed", "inside" or "not_converged", shape (M,).
    """

    _names = _RAY_STATUS

    t: Reals
    point: Reals
    normal: Reals
    _code: NDArray[np.uint8]


@dataclass(frozen=True, eq=False, repr=False)
class Contacts(_Outcomes):
    """Answers of time_of_contact_many: arrays with one row a pair, named as the attributes of ContactResult.

    time: times of the outcomes, shape (M,).
    point: contact points at these times, world frame, shape (M, 3); NaN unless it is a hit.
    normal: unit normals from A to B, world frame, shape (M, 3); NaN unless it is a hit.
    evaluations: numbers of evaluations of the pairs at points in time, shape (M,).
    rescues: numbers of distances that "newton8" or "newton5" declined and the dual method answered, shape (M,).
    status: "hit", "separated", "overlapping", "budget_exhausted" or "failed", shape (M,).
    """

    _names = _CONTACT_STATUS

    time: Reals
    point: Reals
    normal: Reals
    evaluations: NDArray[np.int32]
    rescues: NDArray[np.int32]
    _code: NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Masses(Comparable):
    """Answers of mass_properties_many: arrays with one row a shape, named as the attributes of MassProperties.

    volume: volumes, length^3, shape (K,).
    mass: densities times volumes, shape (K,).
    center_of_mass: centres of mass, body frame, shape (K, 3).
    inertia: moments of inertia about the origin, body frame, shape (K, 3, 3): integral of density (|x|^2 I - x x^T).
    relative_error: bounds of the relative errors of volume and inertia, shape (K,).
    """

    volume: Reals
    mass: Reals
    center_of_mass: Reals
    inertia: Reals
    relative_error: Reals

    def __len__(self) -> int:
        return len(self.volume)

    def __repr__(self) -> str:
        return f"Masses({len(self)} rows)"


def distance_many(
    shapes: Shapes,
    positions: ArrayLike,
    quaternions: ArrayLike | RotationLike | None,
    pairs: ArrayLike,
    shape_of: ArrayLike | None = None,
    threads: int = 1,
    *,
    start: ArrayLike | None = None,
    max_iterations: int = 60,
    penetration: Literal["global", "local"] = "global",
) -> Distances:
    """Returns the signed distances of M pairs among N bodies, with closest points, normals and certified error bounds.

    shapes: one built-in shape, or a list of them, of any kind. positions: world frame, shape (N, 3), in the unit of the
    shapes. quaternions: orientations body to world, unit quaternions (w, x, y, z), shape (N, 4), of SciPy's rotations
    as_quat(scalar_first=True) or the rotations themselves, or rotation matrices, shape (N, 3, 3); None: bodies that are
    not rotated. pairs: indices (a, b) of bodies, integers of shape (M, 2). shape_of: index of each body's shape,
    integers of shape (N,); None: one shape serves all bodies, or there is one a body. threads: number of threads, 1 to
    1024, which changes no bit of the answers. start: guesses of the normals from A to B, world frame, finite,
    shape (M, 3); 0 is none, for instance where the last answer is NaN: np.nan_to_num(last.normal). max_iterations:
    maximum number of evaluations from each start, at least 1. penetration: 'global', the shortest of all translations
    that separate overlapping bodies; 'local', the nearest stationary one, which is faster at large depths.

    Arrays of other real types, and arrays that are not contiguous, are copied. The GIL is released.

    Accuracy, of the size of a pair (its radii and distance of centres together): 1e-13 for ellipsoids that are apart,
    1e-12 for superellipsoids; error_bound for overlapping bodies. Answers agree with those of distance within their
    error bounds, and within 1e-14 of the size where both bodies are smooth or both are sharp, and apart. Pairs of
    ellipsoids are answered several at a time in vector lanes; docs/python.md has times.

    Raises ValueError or TypeError that names the argument, the entry and what is accepted; MemoryError if there is no
    memory for copies or answers; RuntimeError if the system refuses threads; KeyboardInterrupt within about a tenth of
    a second of Ctrl-C. A pair without an answer raises nothing: its status says so.
    """
    return Distances(
        *_core.distance_many(
            shapes, positions, quaternions, pairs, shape_of, threads, start, max_iterations, penetration
        )
    )


def overlap_many(
    shapes: Shapes,
    positions: ArrayLike,
    quaternions: ArrayLike | RotationLike | None,
    pairs: ArrayLike,
    shape_of: ArrayLike | None = None,
    threads: int = 1,
    *,
    start: ArrayLike | None = None,
) -> Overlaps:
    """Returns whether the bodies of M pairs overlap; touching counts as overlap. Usually one evaluation each.

    Arguments, frames, units and exceptions are those of distance_many. Where neither answer is certain, `unknown` of
    the answer is True: overlap_many raises no UndecidedError.
    """
    return Overlaps(*_core.overlap_many(shapes, positions, quaternions, pairs, shape_of, threads, start))


def contains_many(
    shapes: Shapes,
    positions: ArrayLike,
    quaternions: ArrayLike | RotationLike | None,
    points: ArrayLike,
    body_of: ArrayLike | None = None,
    shape_of: ArrayLike | None = None,
    threads: int = 1,
) -> Bools:
    """Returns whether points are in bodies or on their surfaces, bools of shape (M,).

    points: world frame, shape (M, 3). body_of: index of the body that each point is tested against, integers of shape
    (M,); None: there is one body, for all points, or one a point.

    Other arguments, units and exceptions are those of distance_many.
    """
    return _core.contains_many(shapes, positions, quaternions, points, body_of, shape_of, threads)


def closest_point_many(
    shapes: Shapes,
    positions: ArrayLike,
    quaternions: ArrayLike | RotationLike | None,
    points: ArrayLike,
    body_of: ArrayLike | None = None,
    shape_of: ArrayLike | None = None,
    threads: int = 1,
) -> ClosestPoints:
    """Returns the points of bodies' surfaces that are closest to M points, which may be inside.

    Arguments are those of contains_many; units, accuracy and exceptions are those of distance_many.
    """
    return ClosestPoints(*_core.closest_point_many(shapes, positions, quaternions, points, body_of, shape_of, threads))


def ray_cast_many(
    shapes: Shapes,
    positions: ArrayLike,
    quaternions: ArrayLike | RotationLike | None,
    origins: ArrayLike,
    directions: ArrayLike,
    body_of: ArrayLike | None = None,
    shape_of: ArrayLike | None = None,
    threads: int = 1,
) -> RayHits:
    """Returns the first points of M rays in bodies.

    origins, directions: world frame, shape (M, 3), the directions of any length but 0. body_of: as for contains_many.

    Other arguments, units and exceptions are those of distance_many.
    """
    return RayHits(
        *_core.ray_cast_many(shapes, positions, quaternions, origins, directions, body_of, shape_of, threads)
    )


def time_of_contact_many(
    shapes: Shapes,
    positions: ArrayLike,
    quaternions: ArrayLike | RotationLike | None,
    velocities: ArrayLike | None,
    angular_velocities: ArrayLike | None,
    pairs: ArrayLike,
    t_max: float,
    shape_of: ArrayLike | None = None,
    threads: int = 1,
    *,
    inertias: ArrayLike | None = None,
    finder: Literal["certified", "bracketing"] = "certified",
    max_evaluations: int = 2000,
    eps_d: float | None = None,
    distance: Literal["dual", "newton8", "newton5"] = "dual",
    root: Literal["newton", "one_dimensional"] | None = None,
) -> Contacts:
    """Returns the first times in [0, t_max] at which the bodies of M pairs touch and approach.

    positions, quaternions, velocities, angular_velocities: states of N freely moving bodies at time 0, as of Motion:
    velocities of the centres and angular velocities, world frame, shape (N, 3); None: at rest, not turning. inertias:
    principal moments of inertia about body x, y, z, shape (N, 3); None: 1, 1, 1, as for Motion, so that bodies turn
    about fixed axes. Moments at uniform density are those of Ellipsoid.inertia. pairs: indices (a, b) of bodies,
    integers of shape (M, 2). t_max: may be infinite. finder, max_evaluations, eps_d, distance, root: as for
    time_of_contact.

    Each pair is searched by itself: answers are those of time_of_contact, bit for bit. Other arguments, units and
    exceptions are those of distance_many.
    """
    return Contacts(
        *_core.time_of_contact_many(
            shapes,
            positions,
            quaternions,
            velocities,
            angular_velocities,
            pairs,
            t_max,
            shape_of,
            threads,
            inertias,
            finder,
            max_evaluations,
            eps_d,
            distance,
            root,
        )
    )


def mass_properties_many(shapes: Shapes, density: ArrayLike = 1.0) -> Masses:
    """Returns volumes, masses and moments of inertia of K shapes of uniform density, by closed forms.

    shapes: one built-in shape, or a list of K. density: one number, or one a shape, shape (K,).

    Raises ValueError or TypeError that names the argument, the entry and what is accepted.
    """
    return Masses(*_core.mass_properties_many(shapes, density))
