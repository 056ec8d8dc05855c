"""Results of measuring a simulation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hardbody._tables import Table
from hardbody._typing import Reals


@dataclass(frozen=True)
class Estimate:
    """Measured value with its standard error over blocks of the run.

    value: NaN if it is missing. error: standard error, NaN if it is not known. missing: the reason for which the value
    is missing, in words, or None. float() gives the value; formats apply to value and error: f"{estimate:.3f}".
    """

    value: float
    """Value; NaN if it is missing."""
    error: float
    """Standard error; NaN if it is not known."""
    missing: str | None = None
    """Reason for which the value is missing, in words; None if there is one."""

    def __float__(self) -> float:
        return self.value

    def __str__(self) -> str:
        if self.missing is not None:
            return f"missing: {self.missing}"
        return f"{self.value:.6g} +- {self.error:.2g}"

    def __format__(self, spec: str) -> str:
        """Returns value and error, both as `spec` says: f"{estimate:.3f}". A missing value is text."""
        if not spec or self.missing is not None:
            return str(self)
        return f"{self.value:{spec}} +- {self.error:{spec}}"


@dataclass(frozen=True, eq=False)
class VectorEstimate:
    """Measured direction: n and -n are equivalent.

    value: unit vector, shape (3,); NaN if it is missing. error: standard error, an angle in rad. missing: the reason
    for which the value is missing, or None.
    """

    value: Reals
    """Unit vector, shape (3,); NaN if it is missing."""
    error: float
    """Standard error, an angle in rad."""
    missing: str | None = None
    """Reason for which the value is missing; None if there is one."""


@dataclass(frozen=True, eq=False)
class TensorEstimate:
    """Measured symmetric tensor.

    value: elements, shape (3, 3); NaN if they are missing. error: standard errors, shape (3, 3). missing: the reason
    for which the value is missing, or None.
    """

    value: Reals
    """Elements, shape (3, 3); NaN if they are missing."""
    error: Reals
    """Standard errors, shape (3, 3)."""
    missing: str | None = None
    """Reason for which the value is missing; None if there is one."""


Value: TypeAlias = Estimate | tuple[Estimate, ...] | VectorEstimate | TensorEstimate


class Results(Mapping[str, Any]):
    """Results of a measurement by their names: those of summary.json and of the files in observables/ of a run.

    Values such as ``results["D_trans"]`` are Estimate; body axes have three of them, ``results["director"]`` is a
    VectorEstimate, ``results["pressure_tensor"]`` a TensorEstimate. Curves such as ``results["msd"]`` are Table, with
    the columns of the CSV file: ``results["msd"]["t"]``, ``["msd"]``, ``["msd_error"]``; of several groups also
    ``["msd_1"]`` and so on. docs/output.md lists them all, with dimensions and definitions; units are those of the
    simulation's shapes and masses.
    """

    values_by_name: dict[str, Value]
    """Values alone."""
    curves: dict[str, Table]
    """Curves alone."""
    groups: list[Results]
    """Values of each group of bodies, where there are several."""

    def __init__(self, values: dict[str, Value], curves: dict[str, NDArray[np.void]], groups: list[Results]) -> None:
        self.values_by_name = values
        self.curves = {name: curve.view(Table) for name, curve in curves.items()}
        self.groups = groups

    def __getitem__(self, name: str) -> Any:
        if name in self.values_by_name:
            return self.values_by_name[name]
        if name in self.curves:
            return self.curves[name]
        raise KeyError(f"there is no {name!r}; there are: {', '.join(self)}")

    def __iter__(self) -> Iterator[str]:
        yield from self.values_by_name
        yield from self.curves

    def __len__(self) -> int:
        return len(self.values_by_name) + len(self.curves)

    def __repr__(self) -> str:
        return f"Results({', '.join(self)})"
