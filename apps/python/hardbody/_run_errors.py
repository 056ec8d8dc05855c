"""Exceptions of runs and sweeps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hardbody._errors import NumericalError

if TYPE_CHECKING:
    from hardbody._results import Run, Sweep


class UnsoundError(NumericalError):
    """Raised where the program prints NOT SOUND and ends with exit status 1.

    run: the run, whose files are written, and whose `failures` are pairs that could not be predicted; None for `check`.
    """

    run: Run | None

    def __init__(self, message: str, run: Run | None = None) -> None:
        super().__init__(message)
        self.run = run

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickles keep the message and the run."""
        return type(self), (str(self), self.run)

    def __str__(self) -> str:
        return str(self.args[0])


class NotEquilibratedWarning(UserWarning):
    """Warning of run, resume and extend about a run that is not shown to be equilibrated: summary["equilibrated"] is
    False, by the criterion of docs/configuration.md, also where the time of equilibration was given."""


class SweepError(RuntimeError):
    """Raised when points of a sweep have failed. The other points are done.

    sweep: the sweep, whose table says for each point why it failed.
    """

    sweep: Sweep

    def __init__(self, message: str, sweep: Sweep) -> None:
        super().__init__(message, sweep)
        self.sweep = sweep

    def __str__(self) -> str:
        return str(self.args[0])
