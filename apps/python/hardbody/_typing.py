"""Types that annotations name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hardbody import _core

Reals = NDArray[np.float64]
Bools = NDArray[np.bool_]
Strings = NDArray[np.str_]


class RotationLike(Protocol):
    """Rotation, or an array of N of them, as of scipy.spatial.transform.Rotation."""

    def as_matrix(self) -> Any:
        """Returns the rotation matrix, shape (3, 3), or the matrices, shape (N, 3, 3)."""

    def as_quat(self) -> Any:
        """Returns the quaternion (x, y, z, w), shape (4,), or the quaternions, shape (N, 4)."""


class SupportShape(Protocol):
    """Object with a method `support`: a shape written in Python. CustomShape lists the other attributes it needs."""

    def support(self, n: Any, /) -> Any:
        """Returns (h, s) for a direction n, shape (3,): the height max n.x over the body, and the point s there."""


Progress: TypeAlias = Callable[[str, float | None], object]
Shape: TypeAlias = (
    _core.Ellipsoid
    | _core.Superellipsoid
    | _core.Sphere
    | _core.Capsule
    | _core.Box
    | _core.ConvexPolyhedron
    | _core.RoundedBox
    | _core.RoundedPolyhedron
    | _core.Cylinder
    | _core.Cone
    | _core.RoundedCylinder
    | _core.RoundedCone
)
Shapes: TypeAlias = Shape | Sequence[Shape]
BodyShape: TypeAlias = Shape | _core.CustomShape | SupportShape
AnyBody: TypeAlias = BodyShape | _core.HalfSpace
SpeciesLike: TypeAlias = _core.Species | BodyShape
Components: TypeAlias = SpeciesLike | _core.Polydisperse | Sequence[tuple[SpeciesLike, int] | _core.Polydisperse]
