"""Files that are shown in notebooks: reports and maps."""

from __future__ import annotations

import html
import os

from hardbody._paths import Located
from hardbody._tables import Table, read_table

_LONGEST_EMBEDDED = 2_000_000  # bytes of the largest page that is embedded in a notebook


class Report(Located):
    """HTML page of one or several runs, or of a sweep: one file that needs no network.

    In a notebook the page is shown in a frame, and stored in it; of pages above 2 MB only a link is shown.
    """

    @property
    def html(self) -> str:
        """Text of the page."""
        return self._absolute.read_text(encoding="utf-8")

    @property
    def is_interactive(self) -> bool:
        """Whether the page has the interactive front end. Packages that were built without npm write static pages."""
        return '<div id="report">' in self.html

    def _repr_html_(self) -> str:
        size = self._absolute.stat().st_size
        if size > _LONGEST_EMBEDDED:
            name = html.escape(os.fspath(self))
            return f'<p>Report of {size / 1e6:.1f} MB: <a href="{name}">{name}</a></p>'
        # The frame has no access to the notebook.
        page = html.escape(self.html)
        return f'<iframe sandbox="allow-scripts" srcdoc="{page}" style="width:100%;height:640px;border:0"></iframe>'


class Map(Located):
    """Contour lines over two keys of a sweep.

    path: SVG file of the drawing. csv: file of the lines.
    """

    def __init__(self, path: str | os.PathLike[str], csv: str | os.PathLike[str]) -> None:
        super().__init__(path)
        self._csv = Located(csv, "csv")
        self.csv = self._csv.path

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Map) and super().__eq__(other) and self._csv == other._csv

    def __hash__(self) -> int:
        return hash((self._absolute, self._csv))

    def __repr__(self) -> str:
        return f"Map({os.fspath(self.path)!r}, {os.fspath(self.csv)!r})"

    @property
    def lines(self) -> Table:
        """Points of the lines: value, level, number of the line, x and y."""
        return read_table(self._csv)

    @property
    def svg(self) -> str:
        """Text of the drawing."""
        return self._absolute.read_text(encoding="utf-8")

    def _repr_svg_(self) -> str:
        return self.svg
