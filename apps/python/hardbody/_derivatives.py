"""Derivatives of distances with respect to the poses of both bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hardbody import _core
from hardbody._arrays import Distances, _Outcomes, distance_many
from hardbody._calls import flag
from hardbody._typing import AnyBody, Reals, RotationLike, Shapes
from hardbody._values import Comparable

# In the order of the C++ enumerators.
_STATUS = np.array(["twice", "once", "by_position", "none", "no_distance"])


@dataclass(frozen=True, eq=False)
class Derivatives(Comparable):
    """Derivatives of one distance by x = (dp_A, dtheta_A, dp_B, dtheta_B), world frame.

    A moves to the position p_A + dp_A and the rotation exp(dtheta_A) R_A, a turn about A's origin by |dtheta_A| radian;
    B likewise. Numbers that do not exist are NaN; `status` says which those are.

    at: the distance, a DistanceResult.
    gradient: d distance / dx, shape (12,).
    hessian: second derivatives of the distance, symmetric, shape (12, 12).
    normal, point_a, point_b: d normal / dx and d point / dx, shape (3, 12).
    stiffness: least eigenvalue (length) of the linear system that they follow from; large derivatives where it is near
        zero; infinite where faces or edges fix the normal.
    status: "twice": all exist; "once": the gradient alone, as closest points are about to pass to another edge or face;
        "by_position": the gradient by both positions alone, as of parallel faces; "none": several normals are equally
        good; "no_distance": the distance was declined.
    """

    at: _core.DistanceResult
    gradient: Reals
    hessian: Reals
    normal: Reals
    point_a: Reals
    point_b: Reals
    stiffness: float
    status: str


@dataclass(frozen=True, eq=False, repr=False)
class DerivativesMany(_Outcomes):
    """Answers of distance_derivatives_many: arrays with one row a pair, named as the attributes of Derivatives.

    at: the distances, as of distance_many.
    gradient: shape (M, 12).
    hessian: shape (M, 12, 12); None if only gradients were asked for, as the next three.
    normal, point_a, point_b: Jacobians, shape (M, 3, 12).
    stiffness: shape (M,).
    status: "twice", "once", "by_position", "none" or "no_distance", shape (M,).
    """

    _names = _STATUS

    at: Distances
    gradient: Reals
    hessian: Reals | None
    normal: Reals | None
    point_a: Reals | None
    point_b: Reals | None
    stiffness: Reals
    _code: NDArray[np.uint8]


def distance_derivatives(
    a: AnyBody,
    pose_a: _core.Pose,
    b: AnyBody,
    pose_b: _core.Pose,
    *,
    start: ArrayLike | None = None,
    max_iterations: int = 60,
    penetration: Literal["global", "local"] = "global",
) -> Derivatives:
    """Returns the signed distance of two bodies and its derivatives with respect to both poses.

    Arguments are those of distance. Lengths are in the unit of the shapes, angles in radian. Bodies apart, in general
    position, have all derivatives, whatever their kinds; docs/derivatives.md says where fewer exist.

    Accuracy where `status` is "twice", for bodies of aspect ratios up to 4 and lengths of about their size: gradient
    1e-9, Hessian 1e-7 of its norm; less where `stiffness` is small. Shapes of your own need a `support_hessian` for
    more than gradients.

    Raises as distance. A pair without derivatives raises nothing: its status says so.
    """
    at, columns = _core.distance_derivatives(a, pose_a, b, pose_b, start, max_iterations, penetration)
    gradient, hessian, normal, point_a, point_b, stiffness, code = (column[0] for column in columns)
    return Derivatives(at, gradient, hessian, normal, point_a, point_b, float(stiffness), str(_STATUS[code]))


def distance_derivatives_many(
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
    second: bool = True,
) -> DerivativesMany:
    """Returns the signed distances of M pairs among N bodies and their derivatives with respect to both poses.

    second: whether Hessians and Jacobians are wanted, 2 kB a pair; else gradients alone. Other arguments, frames, units
    and exceptions are those of distance_many; accuracy is that of distance_derivatives. The GIL is released.
    """
    second = flag(second, "second")
    at = distance_many(
        shapes,
        positions,
        quaternions,
        pairs,
        shape_of,
        threads,
        start=start,
        max_iterations=max_iterations,
        penetration=penetration,
    )
    answers = (at.distance, at.normal, at.point_a, at.point_b, at.error_bound, at._code)
    columns = _core.distance_derivatives_many(
        shapes, positions, quaternions, pairs, shape_of, threads, answers, bool(second)
    )
    return DerivativesMany(at, *columns)
