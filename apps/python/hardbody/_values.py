"""Comparison of results that hold arrays."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np


def same(a: Any, b: Any) -> bool:
    """Returns whether two values are the same: arrays element by element; NaN is the same as NaN."""
    if isinstance(a, (np.ndarray, float)) and isinstance(b, (np.ndarray, float)):
        return _same_arrays(np.asarray(a), np.asarray(b))
    if isinstance(a, (tuple, list)):
        return type(a) is type(b) and len(a) == len(b) and all(same(x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, dict):
        return isinstance(b, dict) and a.keys() == b.keys() and all(same(value, b[key]) for key, value in a.items())
    return bool(a == b)


def _same_arrays(a: np.ndarray[Any, Any], b: np.ndarray[Any, Any]) -> bool:
    if a.dtype.names is None:
        return np.array_equal(a, b, equal_nan=np.issubdtype(a.dtype, np.inexact))
    return a.dtype.names == b.dtype.names and all(
        same(np.asarray(a[name]), np.asarray(b[name])) for name in a.dtype.names
    )


class Comparable:
    """Data class whose objects are equal if all their members are the same."""

    __hash__ = None  # type: ignore[assignment]

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        names = [field.name for field in dataclasses.fields(self)]  # type: ignore[arg-type]
        return all(same(getattr(self, name), getattr(other, name)) for name in names)
