"""Results of runs, sweeps and analyses, read from their directories."""

from __future__ import annotations

import contextlib
import csv
import html
import json
import os
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hardbody._paths import Located
from hardbody._plots import plot_curves
from hardbody._tables import Curves, Table, read_table, required

Keys = tuple[Any, ...]

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hardbody._pages import Map, Report
    from hardbody._typing import Progress


class _Directory(Located):
    """Directory with results."""

    _needed = ""
    _kind = ""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        super().__init__(path)
        if not (self.path / self._needed).is_file():
            absent = "is not a directory" if self.path.exists() else "is not there"
            what = f"has no {self._needed}" if self.path.is_dir() else absent
            raise ValueError(f"{self.path}: {what}; accepted: the directory of {self._kind}")

    def _json(self, name: str) -> dict[str, Any]:
        file = self._absolute / name
        if not self._absolute.is_dir():
            raise FileNotFoundError(f"{self._absolute} is not there any more")
        if not file.is_file():
            raise FileNotFoundError(f"{file} is not there: the run is not finished; resume continues it")
        value = json.loads(file.read_text(encoding="utf-8"))
        if not isinstance(value, dict):
            raise ValueError(f"{file}: is not a JSON object; accepted: the file of a run")
        return value


class Run(_Directory):
    """Run directory (docs/output.md). Files are read when an attribute asks for them.

    A Run can be used where a path of its directory is accepted. Raises ValueError if there is no run in the directory.
    """

    _needed = "config.toml"
    _kind = "a run"

    @property
    def config(self) -> dict[str, Any]:
        """Configuration, defaults filled in."""
        return tomllib.loads((self._absolute / "config.toml").read_text(encoding="utf-8"))

    @property
    def is_finished(self) -> bool:
        """Whether the run has been completed: it has results and was not interrupted."""
        return (self._absolute / "summary.json").is_file() and not self.summary["interrupted"]

    @property
    def summary(self) -> dict[str, Any]:
        """Results with standard errors, counters, performance, units: summary.json.

        summary["observables"]["D_trans"] has "value", "error", and where there is no value "missing", the reason.
        Raises FileNotFoundError if the run has no results yet. Those of a run that was stopped have "interrupted" True:
        they end where it was stopped.
        """
        return self._json("summary.json")

    @property
    def observables(self) -> Curves:
        """Curves by name ("msd", "c2", "f_self", "g_r", ...): structured arrays with a field a column of the CSV file,
        `units` and `to_pandas()`. Errors have the names of their columns with "_error"."""
        return Curves(self._absolute / "observables")

    @property
    def events(self) -> Table:
        """First collisions of production, if the config asks for them ([output] events): time, i, j."""
        return read_table(self._file("events.csv", "events"))

    @property
    def failures(self) -> list[dict[str, Any]]:
        """Pairs that could not be predicted, failures/*.json (docs/output.md); `hardbody replay` shows one."""
        return [json.loads(path.read_text(encoding="utf-8")) for path in sorted(self._absolute.glob("failures/*.json"))]

    def trajectory(self) -> Any:
        """Opens the frames of production (trajectory.gsd) with gsd.hoomd.open. Needs the package gsd.

        Raises ValueError if the run has none: [output] trajectory = ["gsd"].
        """
        file = self._file("trajectory.gsd", "trajectory")
        return required("gsd.hoomd", "gsd", "Run.trajectory").open(file, "r")

    def extend(self, time: float, *, quiet: bool = True, progress: Progress | bool | None = None) -> Run:
        """Continues the finished run to a production of this length, see `hardbody.extend`."""
        from hardbody._commands import extend

        return extend(self, time=time, quiet=quiet, progress=progress)

    def report(self, out: str | os.PathLike[str] | None = None) -> Report:
        """Writes the HTML report of the run, default: report.html in its directory."""
        from hardbody._commands import report

        return report(self, out)

    def plot(self, *names: str) -> Any:
        """Draws plots of the report, default: those of displacements, orientations, F_self and g(r). Needs matplotlib.

        names: "msd", "msd_directions", "rotational_msd", "c1", "c2", "f_self", "f_collective", "overlap", "chi4",
        "velocity", "alpha2", "g_r", "s_q", "van_hove", "pressure", "order".
        Returns the matplotlib.figure.Figure.
        """
        return plot_curves(self.observables, names, os.fspath(self.path))

    def _file(self, name: str, key: str) -> Path:
        file = self._absolute / name
        if not file.is_file():
            raise ValueError(f"{file} is not there; accepted: a run with [output] {key} in its config")
        return file

    def __repr__(self) -> str:
        """Constructor call; a comment behind it says if the run is not finished, not sound or not equilibrated."""
        states = []
        with contextlib.suppress(OSError, ValueError, KeyError, TypeError):  # a repr does not raise
            if not (self._absolute / "summary.json").is_file():
                states.append("not finished")
            else:
                states += _states(self.summary)
        return f"Run({os.fspath(self.path)!r})" + (f"  # {', '.join(states)}" if states else "")

    def _repr_html_(self) -> str:
        name = html.escape(os.fspath(self.path))
        if not (self._absolute / "summary.json").is_file():
            return f"<p>Run {name}: not finished</p>"
        summary = self.summary
        rows = "".join(
            f"<tr><th>{html.escape(key)}</th><td>{html.escape(_shown(value))}</td></tr>"
            for key, value in summary["observables"].items()
            if not isinstance(value, dict) or not isinstance(value.get("value"), list)
        )
        page = html.escape(os.path.join(self, "report.html"))
        link = f', <a href="{page}">report</a>' if (self._absolute / "report.html").is_file() else ""
        state = "".join(f", <b>{state}</b>" for state in _states(summary))
        return f"<p>Run {name}{state}{link}</p><table>{rows}</table>"


def _states(summary: dict[str, Any]) -> list[str]:
    """Returns what has to be known about results before they are used; empty for those without reservations."""
    states = ["interrupted: not finished"] if summary["interrupted"] else []
    states += [] if summary["sound"] else ["NOT SOUND"]
    return states + ([] if summary["equilibrated"] else ["not shown to be equilibrated"])


def _shown(estimate: Any) -> str:
    if isinstance(estimate, list):
        return ", ".join(_shown(each) for each in estimate)
    if not isinstance(estimate, dict):
        return str(estimate)
    if estimate.get("value") is None:
        return f"- ({estimate.get('missing', '')})"
    value = f"{estimate['value']:.5g}"
    return value if estimate.get("error") is None else f"{value} ± {estimate['error']:.2g}"


class Analysis(_Directory):
    """Directory that `analyze` has written. Files are read when an attribute asks for them."""

    _needed = "analysis.json"
    _kind = "an analysis"

    @property
    def summary(self) -> dict[str, Any]:
        """Results with standard errors, and notices about what was not used: analysis.json."""
        return self._json("analysis.json")

    @property
    def observables(self) -> Curves:
        """Curves by name, as those of a Run, and "order": S and the energy of each frame."""
        return Curves(self._absolute)

    def plot(self, *names: str) -> Any:
        """Draws plots of the curves, see Run.plot."""
        return plot_curves(self.observables, names, os.fspath(self.path))


class Sweep(_Directory):
    """Directory of a sweep (docs/sweeps.md). Files are read when an attribute asks for them."""

    _needed = "sweep.csv"
    _kind = "a sweep"

    @property
    def table(self) -> Table:
        """One row per point, in the order of the grid: keys, observables and their errors, status, message."""
        return read_table(self._absolute / "sweep.csv")

    @property
    def runs(self) -> list[Run | None]:
        """Runs of the points, in the order of the table; None for points that have not been begun. The first replica of
        each."""
        return self._runs_of("sweep.csv")

    @property
    def replicas(self) -> list[list[Run | None]]:
        """Runs of each point, in the order of the table: its replicas, which differ in their seed."""
        if not (self._absolute / "replicas.csv").is_file():
            return [[run] for run in self.runs]
        runs = self._runs_of("replicas.csv")
        each = len(runs) // max(1, len(self.table))
        return [runs[k : k + each] for k in range(0, len(runs), each)]

    @property
    def agreement(self) -> Table:
        """Rows of each observable of each point: errors from within and between replicas, chi-square, outlier."""
        file = self._absolute / "agreement.csv"
        if not file.is_file():
            raise ValueError(f"{file} is not there; accepted: a sweep with replicas")
        return read_table(file)

    def _runs_of(self, table: str) -> list[Run | None]:
        with open(self._absolute / table, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        states = [json.loads(path.read_text(encoding="utf-8")) for path in sorted(self._absolute.glob("*/state.json"))]
        names = _names_of_points(states)
        return [self._run_of(row, names) for row in rows]

    def map(self, x: str, y: str, values: str | Sequence[str], **options: Any) -> Map:
        """Draws contour lines of observables over two keys, see hardbody.map."""
        from hardbody import _commands

        return _commands.map(self, x, y, values, **options)

    def report(self, out: str | os.PathLike[str] | None = None) -> Report:
        """Writes the HTML report of the sweep, default: report.html in its directory."""
        from hardbody._commands import report

        return report(self, out)

    def to_pandas(self) -> Any:
        """Returns the table as a pandas.DataFrame."""
        return self.table.to_pandas()

    def _run_of(self, row: dict[str, str], names: dict[Keys, dict[Keys, str]]) -> Run | None:
        for keys, points in names.items():
            name = points.get(tuple(_hashable(_value(row[key])) for key in keys))
            if name is not None:
                directory = Path(self) / name
                return Run(directory) if (directory / Run._needed).is_file() else None
        return None

    def _repr_html_(self) -> str:
        table = self.table
        done = int((table["status"] == "done").sum()) if len(table) else 0
        return f"<p>Sweep {html.escape(os.fspath(self.path))}: {done} of {len(table)} points done</p>"


def _names_of_points(states: list[dict[str, Any]]) -> dict[Keys, dict[Keys, str]]:
    """Returns names of points by their values, for each of the lists of keys that they have: one a grid."""
    names: dict[Keys, dict[Keys, str]] = {}
    for state in states:
        values = {**state["keys"], "seed": state["seed"]}
        points = names.setdefault(tuple(values), {})
        points.setdefault(tuple(_hashable(value) for value in values.values()), state["name"])
    return names


def _hashable(value: Any) -> Any:
    return tuple(_hashable(v) for v in value) if isinstance(value, list) else value


def _value(cell: str) -> Any:
    """Returns what a cell of a key holds: numbers, lists and bools as TOML has them, or text."""
    try:
        return tomllib.loads(f"x = {cell}")["x"]
    except tomllib.TOMLDecodeError:
        return cell
