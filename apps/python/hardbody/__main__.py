"""The program `hardbody`: python -m hardbody ARGUMENTS."""

from __future__ import annotations

import os
import sys

from hardbody import _core
from hardbody._calls import worker_program


def main() -> int:
    """Runs the program with the arguments of this process. Returns its exit status."""
    return _core.main([os.fsencode(argument) for argument in sys.argv[1:]], worker_program())


if __name__ == "__main__":
    sys.exit(main())
