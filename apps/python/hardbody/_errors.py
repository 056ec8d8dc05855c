"""Exceptions of simulations."""

from __future__ import annotations

from hardbody import _core


class NumericalError(RuntimeError):
    """Raised where the program would end with exit code 1: the results since then are worthless.

    Reasons: bodies overlapped, no method could decide whether two bodies overlap, bodies in contact did not approach,
    the run stalled. Raised when the event loop has returned, so that the simulation is whole: its state can be looked
    at and saved.
    """

    failures: list[_core.FailedPair]
    """First pairs whose prediction failed, at most 16 for each reason."""
    counters: _core.Counters | None
    """Counters of the simulation."""
    stall: _core.Stall | None
    """Stall of the run; None if it has not stalled."""

    def __init__(
        self,
        message: str,
        failures: list[_core.FailedPair] | None = None,
        counters: _core.Counters | None = None,
        stall: _core.Stall | None = None,
    ) -> None:
        super().__init__(message)
        self.failures = failures or []
        self.counters = counters
        self.stall = stall

    def __reduce__(self) -> tuple[type[NumericalError], tuple[str]]:
        """Pickles keep the message alone."""
        return type(self), (str(self),)
