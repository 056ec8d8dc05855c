"""Exceptions of simulations."""

from __future__ import annotations


class NumericalError(RuntimeError):
    """Raised where the program would end with exit code 1: the results are worthless."""
