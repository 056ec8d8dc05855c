"""Calls of the program's commands: arguments, what is printed, how they end."""

from __future__ import annotations

import math
import operator
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from typing import Any, TextIO

import numpy as np

from hardbody import _core
from hardbody._tables import required
from hardbody._toml import shown, toml_text, value_text
from hardbody._typing import Progress

Outcome = tuple[int, str, list[str]]

_INTERRUPTED = 128 + 2  # exit status of a command that SIGINT has stopped
_LONG_INTERVAL = 10.0  # seconds between two lines about progress
_SHORT_INTERVAL = 0.25  # the same where they replace each other

# Code of a process that runs points of a sweep: the extension alone, without NumPy. Arguments: its file, and the
# program's. Tasks of a cluster start processes of their own, by the same command.
_WORKER = """
import importlib.util, os, sys
spec = importlib.util.spec_from_file_location("_core", sys.argv[1])
core = importlib.util.module_from_spec(spec)
spec.loader.exec_module(core)
program = [sys.executable, *sys.orig_argv[1 : len(sys.orig_argv) - len(sys.argv[2:])]]
sys.exit(core.main([os.fsencode(a) for a in sys.argv[2:]], program))
"""


def worker_program() -> list[str]:
    """Returns the command that the arguments of `hardbody` are appended to."""
    if not sys.executable:
        raise RuntimeError("sys.executable is empty: there is no Python to run the points of a sweep with")
    return [sys.executable, "-P", "-S", "-c", _WORKER, os.fspath(_core.__file__)]


def is_text(text: str) -> bool:
    """Returns whether the program can take a text: it has neither NUL nor surrogates, which have no encoding."""
    return not any(character == "\0" or "\ud800" <= character <= "\udfff" for character in text)


def path_text(value: Any, name: str, *, only_unicode: bool = True) -> str:
    """Returns a path as text. The extension calls it too.

    only_unicode: whether names whose bytes are no Unicode are refused: those that configs and results tell.
    """
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"{name} is {shown(value)}; accepted: a str or path")
    text = os.fspath(value)
    if not isinstance(text, str):
        raise TypeError(f"{name} is {shown(value)}; accepted: a str or path")
    unreadable = not is_text(text) if only_unicode else "\0" in text
    if not text or unreadable:
        raise ValueError(f"{name} is {shown(text)}; accepted: the name of a file or directory")
    return text


def optional_path(value: Any, name: str) -> str | None:
    """Returns a path as text; None for None."""
    return None if value is None else path_text(value, name)


def config_arguments(config: Any, out: Any) -> tuple[str, str | None, str | None]:
    """Returns path (or name), text and directory for the commands run and sweep."""
    if isinstance(config, Mapping):
        if out is None:
            raise ValueError("out is None; accepted: the name of a directory, as a dict has no name of its own")
        return "config", toml_text(config), path_text(out, "out")
    if not isinstance(config, (str, os.PathLike)):
        raise TypeError(f"config is {shown(config)}; accepted: a dict, or the path of a TOML file")
    return path_text(config, "config"), None, optional_path(out, "out")


def assignments(overrides: Mapping[str, Any] | None) -> list[str]:
    """Returns overrides as --set takes them."""
    if overrides is None:
        return []
    if not isinstance(overrides, Mapping):
        raise TypeError(f"overrides is {shown(overrides)}; accepted: a dict, as {{'system.number': 64}}")
    for key in overrides:
        if not isinstance(key, str) or "=" in key or "\n" in key or not is_text(key):
            raise TypeError(f"overrides: a key is {shown(key)}; accepted: a str, section.key")
    return [f"{key}={value_text(value, 'overrides', key)}" for key, value in overrides.items()]


def finite(value: Any, name: str, accepted: str = "a finite number") -> float:
    """Returns a finite number. Bools and texts are none, as for all other functions."""
    scalar = value[()] if isinstance(value, np.ndarray) else value
    is_number = hasattr(scalar, "__float__") or hasattr(scalar, "__index__")
    if isinstance(scalar, (np.generic, np.ndarray)):
        is_number = scalar.ndim == 0 and scalar.dtype.kind in "iuf"
    if isinstance(scalar, (bool, str)) or not is_number:
        raise TypeError(f"{name} is {shown(value)}; accepted: {accepted}")
    try:
        number = float(scalar)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"{name} is {shown(value)}; accepted: {accepted}")
    return number


def real(value: Any, name: str) -> float:
    """Returns a positive finite number."""
    number = finite(value, name, "a positive finite number")
    if number <= 0:
        raise ValueError(f"{name} is {shown(value)}; accepted: a positive finite number")
    return number


def optional_real(value: Any, name: str) -> float | None:
    """Returns a positive finite number; None for None."""
    return None if value is None else real(value, name)


def integer(value: Any, name: str, least: int, most: int) -> int:
    """Returns an integer from `least` to `most`."""
    try:
        if isinstance(value, bool):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is {shown(value)}; accepted: an integer from {least} to {most}") from None
    if not least <= number <= most:
        raise ValueError(f"{name} is {number}; accepted: an integer from {least} to {most}")
    return number


def flag(value: Any, name: str) -> bool:
    """Returns a bool."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} is {shown(value)}; accepted: True or False")
    return bool(value)


def texts(value: Any, name: str) -> list[str]:
    """Returns one or several strings as a list."""
    if isinstance(value, str):
        value = [value]
    if not isinstance(value, Sequence) or not all(isinstance(v, str) for v in value):
        raise TypeError(f"{name} is {shown(value)}; accepted: a str, or a list of them")
    if not value:
        raise ValueError(f"{name} is empty; accepted: a str, or a list of them")
    for text in value:
        if not is_text(text):
            raise ValueError(f"{name} has {shown(text)}; accepted: Unicode without NUL")
    return list(value)


class _Bar:
    """Progress bar of tqdm."""

    def __init__(self) -> None:
        self._bar = required("tqdm.auto", "tqdm", "progress=True").tqdm(total=1, bar_format="{l_bar}{bar}|")

    def __call__(self, text: str, done: float | None) -> None:
        self._bar.set_description_str(text, refresh=False)
        if done is not None:
            self._bar.n = min(max(done, 0.0), 1.0)
        self._bar.refresh()

    @contextmanager
    def moved_aside(self) -> Iterator[None]:
        """Clears the bar while something else is printed, and draws it again below."""
        self._bar.clear()
        try:
            yield
        finally:
            self._bar.refresh()

    def finish(self) -> None:
        """Shows that all is done, which the last of the calls, some time before the end, did not know."""
        self._bar.set_description_str("done", refresh=False)
        self._bar.n = 1.0
        self._bar.refresh()

    def close(self) -> None:
        self._bar.close()


def _write(stream: TextIO | None, text: str) -> None:
    if stream is not None:
        stream.write(text)
        stream.flush()


class _Printer:
    """Prints what a command says to sys.stdout and sys.stderr, as they are at each call."""

    def __init__(self, quiet: bool, progress: Progress | None) -> None:
        self._terminal = not quiet and sys.stderr is not None and sys.stderr.isatty()
        self._shown = False
        self._interval = _SHORT_INTERVAL if progress or self._terminal else _LONG_INTERVAL
        self._progress = progress
        self._quiet = quiet

    def functions(self) -> tuple[Any, Any, Any, float]:
        """Returns what the extension calls."""
        if self._quiet:
            return None, None, self._progress, self._interval
        return self._print, self._say, self._progress or self._show, self._interval

    def clear(self) -> None:
        if self._shown:
            _write(sys.stderr, "\r\x1b[K")
        self._shown = False

    def _write(self, stream: TextIO | None, text: str) -> None:
        self.clear()
        with self._progress.moved_aside() if isinstance(self._progress, _Bar) else nullcontext():
            _write(stream, text)

    def _print(self, text: str) -> None:
        self._write(sys.stdout, text)

    def _say(self, line: str) -> None:
        self._write(sys.stderr, line + "\n")

    def _show(self, text: str, _done: float | None) -> None:
        if not self._terminal:
            self._say(text)
            return
        _write(sys.stderr, "\r\x1b[K" + text)
        self._shown = True


def show_end(progress: Progress | None) -> None:
    """Shows at the end of a command, if it has succeeded, that all is done: on a bar of ours."""
    if isinstance(progress, _Bar):
        progress.finish()


@contextmanager
def progress_function(progress: Progress | bool | None) -> Iterator[Progress | None]:
    """Gives the function that is told about progress: for True a bar of tqdm, which is closed at the end."""
    if not (progress is None or isinstance(progress, bool) or callable(progress)):
        raise TypeError(
            f"progress is {shown(progress)}; accepted: None, True, or a function of a text and the fraction done"
        )
    if progress is not True:
        yield progress if callable(progress) else None
        return
    bar = _Bar()
    try:
        yield bar
    finally:
        bar.close()


def call(
    command: Callable[..., Outcome], *arguments: Any, quiet: bool = True, progress: Progress | bool | None = None
) -> Outcome:
    """Calls a command. Returns its exit status, what it has printed, and its messages.

    Raises KeyboardInterrupt if it was stopped by Ctrl-C, RuntimeError if by another signal, both with its last message.
    """
    with progress_function(progress) as shows:
        printer = _Printer(flag(quiet, "quiet"), shows)
        try:
            status, printed, said = command(printer.functions(), *arguments)
        finally:
            printer.clear()
        if status == 0:
            show_end(shows)
    if status == _INTERRUPTED:
        raise KeyboardInterrupt(said[-1] if said else "stopped by SIGINT")
    if status > 128:
        raise RuntimeError(said[-1] if said else f"stopped by signal {status - 128}")
    return status, printed, said
