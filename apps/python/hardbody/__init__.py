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
from hardbody._commands import analyze, check, report, resume, run, sweep
from hardbody._commands import map as map
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
from hardbody._errors import NumericalError
from hardbody._pages import Map, Report
from hardbody._results import Analysis, Run, Sweep
from hardbody._run_errors import SweepError, UnsoundError
from hardbody._tables import Curves, Table

# "map" is no name for `from hardbody import *`, which would hide Python's own.
__all__ = [
    "Analysis",
    "ClosestPoint",
    "ClosestPoints",
    "ContactResult",
    "Curves",
    "DistanceResult",
    "Distances",
    "Ellipsoid",
    "Map",
    "MassProperties",
    "Motion",
    "NumericalError",
    "Overlaps",
    "Pose",
    "RayHit",
    "RayHits",
    "Report",
    "Run",
    "Superellipsoid",
    "Sweep",
    "SweepError",
    "Table",
    "UndecidedError",
    "UnsoundError",
    "__version__",
    "analyze",
    "check",
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
    "report",
    "resume",
    "run",
    "sweep",
    "time_of_contact",
]
