"""Results of measuring a simulation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hardbody._tables import Table
from hardbody._typing import Reals
from hardbody._values import Comparable, same


@dataclass(frozen=True, eq=False)
class Estimate(Comparable):
    """Measured value with its standard error over blocks of the run.

    value: NaN if it is missing.
    error: standard error; NaN if it is not known.
    missing: reason for which the value is missing, in words; None if there is one.

    float() gives the value; formats apply to value and error: f"{estimate:.3f}".
    """

    value: float
    error: float
    missing: str | None = None

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
class VectorEstimate(Comparable):
    """Measured direction: n and -n are equivalent.

    value: unit vector, shape (3,); NaN if it is missing.
    error: standard error, an angle in rad.
    missing: reason for which the value is missing, in words; None if there is one.
    """

    value: Reals
    error: float
    missing: str | None = None


@dataclass(frozen=True, eq=False)
class TensorEstimate(Comparable):
    """Measured symmetric tensor.

    value: elements, shape (3, 3); NaN if they are missing.
    error: standard errors, shape (3, 3).
    missing: reason for which the value is missing, in words; None if there is one.
    """

    value: Reals
    error: Reals
    missing: str | None = None


Curve: TypeAlias = tuple[NDArray[np.void], dict[str, str]]  # structured array, units of its columns
AnyEstimate: TypeAlias = Estimate | tuple[Estimate, ...] | VectorEstimate | TensorEstimate


def _table(array: NDArray[np.void], units: dict[str, str]) -> Table:
    table = array.view(Table)
    table.units = units
    return table


class Results(Mapping[str, Any]):
    """Results of a measurement by their names: those of summary.json and of the files in observables/ of a run.

    Values such as ``results["D_trans"]`` are Estimate; body axes have three of them, ``results["director"]`` is a
    VectorEstimate, ``results["pressure_tensor"]`` a TensorEstimate. Curves such as ``results["msd"]`` are Table, with
    the columns of the CSV file: ``results["msd"]["t"]``, ``["msd"]``, ``["msd_error"]``; of several groups also
    ``["msd_1"]`` and so on. docs/output.md lists them all, with definitions; units are those of the simulation's shapes
    and masses, so that ``results["msd"].units`` has dimensions: "time", "length^2".

    values_by_name: values alone.
    curves: curves alone.
    groups: results of each group of bodies, where there are several.
    """

    values_by_name: dict[str, AnyEstimate]
    curves: dict[str, Table]
    groups: list[Results]

    def __init__(self, values: dict[str, AnyEstimate], curves: dict[str, Curve], groups: list[Results]) -> None:
        self.values_by_name = values
        self.curves = {name: _table(*curve) for name, curve in curves.items()}
        self.groups = groups

    def __getitem__(self, name: str) -> Any:
        if name in self.values_by_name:
            return self.values_by_name[name]
        if name in self.curves:
            return self.curves[name]
        raise KeyError(f"there is no {name!r}; there are: {', '.join(self)}")

    def __eq__(self, other: object) -> bool:
        """Whether all values and curves are the same; NaN is the same as NaN."""
        if not isinstance(other, Results):
            return NotImplemented
        mine, others = ((r.values_by_name, r.curves, r.groups) for r in (self, other))
        return same(mine, others)

    def __iter__(self) -> Iterator[str]:
        yield from self.values_by_name
        yield from self.curves

    def __len__(self) -> int:
        return len(self.values_by_name) + len(self.curves)

    def __repr__(self) -> str:
        return f"Results({', '.join(self)})"
