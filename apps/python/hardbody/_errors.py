"""Exceptions of simulations."""

from __future__ import annotations

from typing import Any

from hardbody import _core


class NumericalError(RuntimeError):
    """Raised if bodies overlapped, no method could decide whether they do, bodies in contact did not approach, or the
    run stalled. Results after that moment are wrong.

    Raised when the event loop has returned: the state of the simulation can be read and saved. The program also audits
    the last state and its energy and momentum: call Simulation.audit and Simulation.kinetic.

    failures: first pairs whose prediction failed, at most 16 for each reason.
    counters: those of the simulation.
    stall: stall of the run; None if it has not stalled.
    """

    failures: list[_core.FailedPair]
    counters: _core.Counters | None
    stall: _core.Stall | None

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

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickles keep the message alone."""
        return type(self), (str(self),)
