"""Progress of runs on a terminal."""

from __future__ import annotations

import sys
import time


class ProgressLine:
    """Line on stderr with the fraction that is done and the time that is left."""

    def __init__(self) -> None:
        self._begin = time.monotonic()

    def __call__(self, done: float) -> None:
        seconds = time.monotonic() - self._begin
        left = f", {seconds / done - seconds:.0f} s left" if 0 < done < 1 else ""
        end = "\n" if done >= 1 else ""
        print(f"\rrun: {100 * done:5.1f} %, {seconds:.0f} s{left}   ", end=end, file=sys.stderr, flush=True)
