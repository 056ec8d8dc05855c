"""Exact distances of smooth convex bodies.

Lengths are in the caller's unit. Positions are arrays of shape (3,) or (n, 3), orientations unit quaternions
(w, x, y, z) of shape (4,) or (n, 4), body to world, all float64. Bad input raises ValueError or TypeError with a
message that names the argument and what is accepted. Numerical outcomes are statuses, never exceptions.
"""

from hardbody._arrays import (
    ClosestPoints,
    Distances,
    Overlaps,
    RayHits,
    closest_point_many,
    contains_many,
    distance_many,
    overlap_many,
    ray_cast_many,
)
from hardbody._core import (
    ClosestPoint,
    ContactResult,
    DistanceResult,
    Ellipsoid,
    MassProperties,
    Motion,
    Pose,
    RayHit,
    Superellipsoid,
    UndecidedError,
    __version__,
    closest_point,
    contains,
    distance,
    distance_lower_bound,
    mass_properties,
    overlap,
    ray_cast,
    time_of_contact,
)

__all__ = [
    "ClosestPoint",
    "ClosestPoints",
    "ContactResult",
    "DistanceResult",
    "Distances",
    "Ellipsoid",
    "MassProperties",
    "Motion",
    "Overlaps",
    "Pose",
    "RayHit",
    "RayHits",
    "Superellipsoid",
    "UndecidedError",
    "__version__",
    "closest_point",
    "closest_point_many",
    "contains",
    "contains_many",
    "distance",
    "distance_lower_bound",
    "distance_many",
    "mass_properties",
    "overlap",
    "overlap_many",
    "ray_cast",
    "ray_cast_many",
    "time_of_contact",
]
