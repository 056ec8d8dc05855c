"""CSV files as arrays."""

from __future__ import annotations

import csv
import importlib
import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hardbody._toml import shown

_NAME_AND_UNIT = re.compile(r"(.*) \[(.*)\]")
_INTEGER = re.compile(r"-?\d+")


def required(module: str, package: str, purpose: str) -> Any:
    """Imports a module of an optional package. Raises ImportError with the name of the package."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        if error.name != package:
            raise
        raise ImportError(f"{purpose} needs the package {package}: pip install {package}") from error


class Table(np.ndarray[Any, np.dtype[Any]]):
    """Structured array of shape (rows,), with one field a column. Missing numbers are NaN.

    units: unit of each column, "1" for numbers; empty for columns without one.
    """

    units: dict[str, str]

    def __array_finalize__(self, obj: Any) -> None:
        self.units = dict(getattr(obj, "units", {}))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickles keep the units."""
        reduced: Any = super().__reduce__()
        constructor, arguments, state = reduced[:3]
        return constructor, arguments, (state, self.units)

    def __setstate__(self, state: Any) -> None:
        array, self.units = state
        super().__setstate__(array)

    def __getitem__(self, key: Any) -> Any:
        """Column of a name (a plain array), rows, or one row."""
        if isinstance(key, str) and key not in self.names:
            raise KeyError(f"no column {shown(key)}; there are: {', '.join(self.names)}")
        part = super().__getitem__(key)
        if isinstance(key, str):
            return part.view(np.ndarray)
        if isinstance(part, Table):
            part.units = {name: unit for name, unit in self.units.items() if name in part.names}
        return part

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        return self.dtype.names or ()

    def to_pandas(self) -> Any:
        """Returns a pandas.DataFrame with the same columns; its `attrs["units"]` are the units."""
        frame = required("pandas", "pandas", "Table.to_pandas").DataFrame({name: self[name] for name in self.names})
        frame.attrs["units"] = dict(self.units)
        return frame


def read_table(path: str | os.PathLike[str], *, all_real: bool = False) -> Table:
    """Reads a CSV file whose first line has names, and units in brackets. Raises ValueError for any other file.

    all_real: every column is float64; else each has the first of bool, integer, real and text that fits all its cells.
    """
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    if not rows or any(len(row) != len(rows[0]) for row in rows):
        raise ValueError(f"{os.fspath(path)}: is not a table; accepted: comma-separated values with a line of names")
    names, units = zip(*(_name_and_unit(head) for head in rows[0]), strict=True)
    if len(set(names)) != len(names):
        raise ValueError(f"{os.fspath(path)}: has two columns of one name; accepted: names that differ")
    columns = [_column([row[k] for row in rows[1:]], all_real) for k in range(len(names))]
    table = np.empty(len(rows) - 1, dtype=[(name, c.dtype) for name, c in zip(names, columns, strict=True)]).view(Table)
    for name, column in zip(names, columns, strict=True):
        table[name][:] = column
    table.units = dict(zip(names, units, strict=True))
    return table


def _name_and_unit(head: str) -> tuple[str, str]:
    found = _NAME_AND_UNIT.fullmatch(head)
    return (found[1], found[2]) if found else (head, "")


def _column(cells: list[str], all_real: bool) -> np.ndarray[Any, np.dtype[Any]]:
    if not all_real and cells:
        if all(cell in ("true", "false") for cell in cells):
            return np.array([cell == "true" for cell in cells])
        if all(_INTEGER.fullmatch(cell) for cell in cells):
            return np.array([int(cell) for cell in cells])
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells], dtype=np.float64)
    except ValueError:
        if all_real:
            raise
        return np.array(cells)


class Curves(Mapping[str, Table]):
    """Tables of a run, by name: read when they are asked for."""

    def __init__(self, directory: Path, skipped: tuple[str, ...] = ()) -> None:
        self._directory = directory
        self._skipped = skipped

    def __getitem__(self, name: str) -> Table:
        if name not in list(self):
            raise KeyError(f"{self._directory} has no {name}.csv; there are: {', '.join(self) or 'none'}")
        return read_table(self._directory / f"{name}.csv", all_real=True)

    def __eq__(self, other: object) -> bool:
        """Whether they are read from the same files."""
        if not isinstance(other, Curves):
            return NotImplemented
        return (self._directory, self._skipped) == (other._directory, other._skipped)

    def __hash__(self) -> int:
        return hash((self._directory, self._skipped))

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(path.stem for path in self._directory.glob("*.csv") if path.stem not in self._skipped))

    def __len__(self) -> int:
        return len(list(iter(self)))

    def __repr__(self) -> str:
        return f"<curves of {self._directory}: {', '.join(self)}>"
