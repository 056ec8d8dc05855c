"""Files and directories that objects read later."""

from __future__ import annotations

import os
from pathlib import Path

from hardbody._calls import path_text


class Located:
    """File or directory, which is found again after the working directory has changed.

    path: path as given. os.fspath() is the same, or the absolute path once the working directory is another one.
    """

    def __init__(self, path: str | os.PathLike[str], name: str = "path") -> None:
        self.path = Path(path_text(path, name))
        self._absolute = Path(os.path.abspath(self.path))

    def __fspath__(self) -> str:
        is_the_same = os.path.abspath(self.path) == os.fspath(self._absolute)
        return os.fspath(self.path if is_the_same else self._absolute)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Located) and type(self) is type(other) and self._absolute == other._absolute

    def __hash__(self) -> int:
        return hash(self._absolute)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({os.fspath(self.path)!r})"
