"""Exceptions of simulations."""

from __future__ import annotations

import pickle
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
        """Pickles keep everything but failed pairs that cannot be pickled, as a shape written in Python cannot."""
        failures = [pair for pair in self.failures if _can_be_pickled(pair)]
        return type(self), (str(self), failures, self.counters, self.stall)


def _can_be_pickled(pair: _core.FailedPair) -> bool:
    try:
        pickle.loads(pickle.dumps(pair))
    except Exception:  # of any kind: from the shape's own __reduce__, or from what checks the shape that it makes
        return False
    return True
