"""Types that annotations name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from hardbody import _core

Reals = NDArray[np.float64]
Bools = NDArray[np.bool_]
Strings = NDArray[np.str_]


class Rotation(Protocol):
    """One rotation of scipy.spatial.transform.Rotation."""

    def as_matrix(self) -> Any: ...

    def as_quat(self) -> Any: ...


class HasSupport(Protocol):
    """Convex body of a user's own (CustomShape)."""

    def support(self, n: Any, /) -> Any: ...


Shape: TypeAlias = "_core.Ellipsoid | _core.Superellipsoid | _core.CustomShape | HasSupport"
SpeciesLike: TypeAlias = "_core.Species | Shape"
Components: TypeAlias = "SpeciesLike | _core.Polydisperse | Sequence[tuple[SpeciesLike, int] | _core.Polydisperse]"
