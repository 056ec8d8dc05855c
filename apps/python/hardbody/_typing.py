"""Types that annotations name."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]
Bools = NDArray[np.bool_]
Strings = NDArray[np.str_]


class Rotation(Protocol):
    """One rotation of scipy.spatial.transform.Rotation."""

    def as_matrix(self) -> Any: ...

    def as_quat(self) -> Any: ...
