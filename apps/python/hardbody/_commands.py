"""The program's commands as functions."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, overload

from hardbody import _core
from hardbody._calls import (
    assignments,
    call,
    config_arguments,
    finite,
    flag,
    integer,
    is_text,
    optional_path,
    optional_real,
    path_text,
    progress_function,
    real,
    show_end,
    texts,
    worker_program,
)
from hardbody._dask import known_workers, run_tasks
from hardbody._pages import Map, Report
from hardbody._results import Analysis, Run, Sweep
from hardbody._run_errors import NotEquilibratedWarning, SweepError, UnsoundError
from hardbody._toml import shown, value_text
from hardbody._typing import Progress

_MOST_JOBS = 1024
_MOST_REPLICAS = 1000
_LARGEST_STRIDE = 1_000_000
_UNSOUND = "NOT SOUND: "


@overload
def run(
    config: Mapping[str, Any] | str | PathLike[str],
    out: str | PathLike[str] | None = None,
    *,
    overrides: Mapping[str, Any] | None = None,
    force: bool = False,
    replicas: Literal[1] = 1,
    quiet: bool = True,
    progress: Progress | bool | None = None,
) -> Run: ...
@overload
def run(
    config: Mapping[str, Any] | str | PathLike[str],
    out: str | PathLike[str] | None = None,
    *,
    overrides: Mapping[str, Any] | None = None,
    force: bool = False,
    replicas: int,
    quiet: bool = True,
    progress: Progress | bool | None = None,
) -> Run | Sweep: ...
def run(
    config: Mapping[str, Any] | str | PathLike[str],
    out: str | PathLike[str] | None = None,
    *,
    overrides: Mapping[str, Any] | None = None,
    force: bool = False,
    replicas: int = 1,
    quiet: bool = True,
    progress: Progress | bool | None = None,
) -> Run | Sweep:
    """Runs one state point, as `hardbody run` does: start, equilibration, production. Returns the finished run.

    config: a dict of the sections of a config (docs/configuration.md), {"system": {"packing_fraction": 0.4}, ...}, or
        the path of a TOML file. Both give the same bytes.
    out: run directory; a file has the default out/<name of the file>. Names of files are relative to the working
        directory.
    overrides: values that replace those of the config, {"system.number": 64}.
    force: whether the files of an earlier run in the directory are removed.
    replicas: number of runs with different seeds; for more than one the result is a Sweep of one point, with pooled
        values, and `out` is its directory. The same call continues it; SweepError is raised as by `sweep`.
    quiet: whether nothing is printed; else messages go to sys.stderr and the table of results to sys.stdout.
    progress: function that is called about four times a second with a text and the fraction done of the phase (None if
        unknown); True: a bar of tqdm. An exception that it raises stops the run.

    The GIL is released. Runs in several threads do not disturb each other; a signal stops them all.

    Warns, by NotEquilibratedWarning, of a run that is not shown to be equilibrated.

    Raises ValueError or TypeError for a bad config, with the key, its value and what is accepted; UnsoundError if the
    results are not sound; RuntimeError for other failures, such as a full disk; KeyboardInterrupt after Ctrl-C. The
    state is saved then: `resume` continues the run bit for bit. SIGTERM, SIGHUP and SIGXCPU stop it too, and
    then have their usual effect on the process.
    """
    name, text, directory = config_arguments(config, out)
    number = integer(replicas, "replicas", 1, _MOST_REPLICAS)
    arguments = (name, text, directory, assignments(overrides), flag(force, "force"), number, worker_program())
    outcome = call(_core.run, *arguments, quiet=quiet, progress=progress)
    if number > 1:
        return _swept(Path(directory or Path("out") / Path(name).stem), *outcome[:2])
    return _finished(directory or str(Path("out") / Path(name).stem), *outcome)


def resume(
    run: str | PathLike[str],
    *,
    overrides: Mapping[str, Any] | None = None,
    quiet: bool = True,
    progress: Progress | bool | None = None,
) -> Run:
    """Continues a run that was stopped or killed from its last checkpoint, bit for bit. A finished run is left alone.

    run: a run directory, or a Run.
    overrides: values of keys that change no result, {"output.checkpoint_every": "10m"}; others are refused.

    Other arguments and exceptions are those of `run`.
    """
    directory = path_text(run, "run")
    outcome = call(_core.resume, directory, assignments(overrides), quiet=quiet, progress=progress)
    return _finished(directory, *outcome)


def extend(
    run: str | PathLike[str], *, time: float, quiet: bool = True, progress: Progress | bool | None = None
) -> Run:
    """Continues a finished run to a longer production, bit for bit what a run of that length would have been.

    run: directory of a finished run, or a Run; a run with trajectories is refused, unless it has output.frames_every.
    time: length of the whole production, as production.time. The longest lag of correlations stays that of the run:
        the config then names it.

    If it is stopped, `resume` continues. Other arguments and exceptions are those of `run`.
    """
    directory = path_text(run, "run")
    length = real(time, "time")
    return _finished(directory, *call(_core.extend, directory, length, quiet=quiet, progress=progress))


def _finished(directory: str, status: int, printed: str, said: list[str]) -> Run:
    done = Run(directory)
    if status == 0:
        _warn_unless_equilibrated(done)
        return done
    defects = [line[line.index(_UNSOUND) :] for line in said if _UNSOUND in line]
    raise UnsoundError(f"{directory}: {'; '.join(defects) or printed}", done)


def _warn_unless_equilibrated(run: Run) -> None:
    if run.summary["equilibrated"]:
        return
    text = (
        f"{run.path}: not shown to be equilibrated: neither correlations have decayed nor are order and Z stationary "
        'when production begins (summary["equilibration"])'
    )
    warnings.warn(text, NotEquilibratedWarning, stacklevel=4)


def sweep(
    config: Mapping[str, Any] | str | PathLike[str],
    out: str | PathLike[str] | None = None,
    *,
    overrides: Mapping[str, Any] | None = None,
    jobs: int | None = None,
    client: Any = None,
    task_time: float = 600.0,
    quiet: bool = True,
    progress: Progress | bool | None = None,
) -> Sweep:
    """Runs a grid of state points, several at a time, each in a process of its own. The same call continues a sweep;
    one with a larger grid adds the new points to it.

    config: a dict with "grid", "replicas" or both, or the path of a TOML file (docs/sweeps.md): {"system": ..., "grid":
        {"shape.aspect_ratio": [2, 3], "system.packing_fraction": {"from": 0.2, "to": 0.4, "step": 0.1}}}.
    out: directory of the sweep; a file has the default out/<name of the file>.
    overrides: values that replace those of all points, {"production.time": 50}, or of the grid, {"grid.seed": [1, 2]}.
    jobs: number of points that run at once; None: one for each processor.
    client: a dask.distributed.Client, whose workers run the points as tasks (docs/cluster.md): each has this package,
        and sees the directory under the same name. Tasks of a worker that is lost continue on another one.
    task_time: with `client`: wished seconds of a task of several runs. Tasks are shorter where there would be fewer of
        them than the workers have threads.

    Other arguments and exceptions are those of `run`. Raises SweepError, at the end, if points have failed.
    """
    name, text, directory = config_arguments(config, out)
    number = None if jobs is None else integer(jobs, "jobs", 1, _MOST_JOBS)
    wished = real(task_time, "task_time")
    place = Path(directory or Path("out") / Path(name).stem)
    if client is not None:
        if number is not None:
            raise ValueError(f"jobs is {number} with a client; accepted: None, as the client has its workers")
        if not callable(getattr(client, "submit", None)):
            raise TypeError(f"client is {shown(client)}; accepted: None, or a dask.distributed.Client")
        settings = (name, text, directory, assignments(overrides), wished, known_workers(client))
        with progress_function(progress) as shows:
            _, plan, _ = call(_core.sweep_plan, *settings, quiet=True)
            try:
                lost = run_tasks(client, str(place.resolve()), plan, shows)
            finally:
                status, printed, _ = call(_core.sweep_collect, str(place), quiet=quiet)
            if status == 0 and not lost:
                show_end(shows)
        return _swept(place, status, "; ".join([printed.strip(), *lost]))
    arguments = (name, text, directory, number, assignments(overrides), worker_program())
    return _swept(place, *call(_core.sweep, *arguments, quiet=quiet, progress=progress)[:2])


def _swept(directory: Path, status: int, printed: str) -> Sweep:
    done = Sweep(directory)
    if status != 0:
        raise SweepError(printed.strip().replace("\n", "; "), done)
    return done


def check(path: str | PathLike[str], *, quiet: bool = True) -> str:
    """Audits a run's last state, or all frames of a trajectory: overlaps, conservation, finite values.

    path: a run directory, a GSD file or a LAMMPS text dump. Returns what the program prints, a line for each property.
    Raises UnsoundError with these lines if something is wrong, or could not be tested.
    """
    status, printed, _ = call(_core.check, path_text(path, "path"), quiet=quiet)
    if status != 0:
        raise UnsoundError(printed.rstrip())
    return printed


def analyze(
    path: str | PathLike[str],
    out: str | PathLike[str] | None = None,
    *,
    time_step: float | None = None,
    longest_lag: float | None = None,
    fit_from: float | None = None,
    every: int = 1,
    collective: bool = False,
    quiet: bool = True,
) -> Analysis:
    """Computes observables of a stored trajectory, from this or another program.

    path: a run directory with a trajectory, a GSD file or a LAMMPS text dump. out: directory; default: analysis/ beside
    the trajectory. time_step: time between two steps, instead of the stored times. longest_lag: default: a quarter of
    the trajectory. fit_from: first lag of the fits of C2 and F_self; default: that of the run, or the end of ballistic
    motion. every: use only each `every`-th frame. collective: True to compute F(q, t) / S(q) of all bodies, too.
    """
    file = path_text(path, "path")
    directory = optional_path(out, "out")
    if directory is None:
        directory = str((Path(file) if Path(file).is_dir() else Path(file).parent) / "analysis")
    times = (
        optional_real(time_step, "time_step"),
        optional_real(longest_lag, "longest_lag"),
        optional_real(fit_from, "fit_from"),
    )
    stride = integer(every, "every", 1, _LARGEST_STRIDE)
    call(_core.analyze, file, directory, *times, stride, flag(collective, "collective"), quiet=quiet)
    return Analysis(directory)


def report(
    paths: str | PathLike[str] | Sequence[str | PathLike[str]],
    out: str | PathLike[str] | None = None,
    *,
    quiet: bool = True,
) -> Report:
    """Writes the results of runs, or of a sweep, as one HTML file that needs no network.

    paths: a run directory, several of them to be shown side by side, or the directory of a sweep. out: HTML file;
    default: report.html in the directory.
    """
    if isinstance(paths, (str, PathLike)):
        paths = [paths]
    if not isinstance(paths, Sequence):
        raise TypeError(f"paths is {shown(paths)}; accepted: a str or path, or a list of them")
    directories = [path_text(path, f"paths[{k}]" if len(paths) > 1 else "paths") for k, path in enumerate(paths)]
    if not directories:
        raise ValueError("paths is empty; accepted: run directories, or that of a sweep")
    if out is None and len(directories) > 1:
        raise ValueError("out is None; accepted: the name of an HTML file, as there are several directories")
    page = optional_path(out, "out")
    call(_core.report, directories, page, quiet=quiet)
    return Report(page if page is not None else Path(directories[0]) / "report.html")


def map(
    table: str | PathLike[str],
    x: str,
    y: str,
    values: str | Sequence[str],
    *,
    levels: Sequence[float] | Mapping[str, Sequence[float]] | None = None,
    where: Mapping[str, Any] | None = None,
    log_x: bool = False,
    log_y: bool = False,
    out: str | PathLike[str] | None = None,
    csv: str | PathLike[str] | None = None,
    quiet: bool = True,
) -> Map:
    """Draws contour lines of observables over two keys of a sweep.

    table: the directory of a sweep, or a table like its sweep.csv. x, y: columns along the axes, which may be named by
    their last part: "aspect_ratio". values: the column, or columns, whose lines are drawn. levels: levels of the lines,
    {value: levels} for several values; None: about six round ones are chosen for each. where: {column: value} of the
    rows that are used. out, csv: files of the drawing and of the lines; default: map_<values>.svg and .csv beside the
    table.
    """
    names = texts(values, "values")
    file = Path(path_text(table, "table"))
    beside = (file if file.is_dir() else file.parent) / f"map_{'_'.join(names)}"
    svg = optional_path(out, "out") or f"{beside}.svg"
    lines = optional_path(csv, "csv") or f"{beside}.csv"
    arguments = (str(file), *texts([x, y], "x, y"), names, _level_texts(levels, names), _conditions(where))
    call(_core.map, *arguments, flag(log_x, "log_x"), flag(log_y, "log_y"), svg, lines, quiet=quiet)
    return Map(svg, lines)


def _level_texts(levels: Any, names: list[str]) -> list[str]:
    if levels is None:
        return []
    if not isinstance(levels, Mapping):
        if len(names) != 1:
            raise ValueError(
                f"levels is {shown(levels)}; accepted with several values: a dict with levels for each of them"
            )
        levels = {names[0]: levels}
    if set(levels) != set(names):
        raise ValueError(f"levels has the keys {list(levels)}; accepted: levels for each of {names}")
    return [",".join(repr(level) for level in _levels(levels[name], name)) for name in names]


def _levels(values: Any, name: str) -> list[float]:
    try:
        numbers = [finite(value, f"levels: {name}[{k}]") for k, value in enumerate(values)]
    except TypeError:
        raise TypeError(f"levels: {name} has {shown(values)}; accepted: a list of numbers") from None
    if not numbers:
        raise ValueError(f"levels: {name} has none; accepted: a list of numbers")
    return numbers


def _conditions(where: Any) -> list[str]:
    if where is None:
        return []
    if not isinstance(where, Mapping):
        raise TypeError(f"where is {shown(where)}; accepted: a dict, as {{'seed': 1}}")
    for column in where:
        if not isinstance(column, str) or "=" in column or not is_text(column):
            raise TypeError(f"where: a column is {shown(column)}; accepted: a str, as {{'seed': 1}}")
    return [f"{column}={_condition(value, column)}" for column, value in where.items()]


def _condition(value: Any, column: str) -> str:
    text = value_text(value, "where", column)
    return value if isinstance(value, str) else text
