"""Plots of curves with matplotlib."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from hardbody import _core
from hardbody._tables import Table, required
from hardbody._toml import shown

_USUAL = ("msd", "c2", "f_self", "g_r")


def plot_curves(curves: Mapping[str, Table], names: Sequence[str], title: str) -> Any:
    """Draws these plots of a report in one figure, side by side."""
    plots = {plot["id"]: plot for plot in _core.curve_plots()}
    known = [name for name, plot in plots.items() if plot["file"] in curves]
    if not known:
        raise FileNotFoundError(f"{title} has no curves to draw; accepted: a run whose results are written")
    for name in names:
        if not isinstance(name, str):
            raise TypeError(f"names: {shown(name)} is no plot of {title}; accepted: {', '.join(known)}")
        if name not in known:
            raise ValueError(f"names: {shown(name)} is no plot of {title}; accepted: {', '.join(known)}")
    chosen = [plots[name] for name in names or [name for name in _USUAL if name in known] or known[:1]]
    pyplot = required("matplotlib.pyplot", "matplotlib", "plot")
    columns = min(2, len(chosen))
    rows = math.ceil(len(chosen) / columns)
    figure, axes = pyplot.subplots(
        rows, columns, figsize=(5.5 * columns, 4 * rows), squeeze=False, layout="constrained"
    )
    for axis, plot in zip(axes.flat, chosen, strict=False):
        _draw(axis, plot, curves[plot["file"]])
    for axis in axes.flat[len(chosen) :]:
        axis.remove()
    figure.suptitle(title)
    pyplot.close(figure)  # the caller shows the figure
    return figure


def _draw(axis: Any, plot: dict[str, Any], table: Table) -> None:
    # Blocks begin at their first column and end at the second, which is the abscissa.
    x = table["end"] if plot["file"] == "blocks" else table[table.names[0]]
    for column, label in plot["lines"]:
        for name in table.names:
            found = re.fullmatch(rf"{re.escape(column)}((?:_\d+){{0,2}}(?:_[qt]\d+|_[xyz])?)", name)
            if found is None:
                continue
            y = np.asarray(table[name])
            scale = y[0] if plot["normalised"] else 1.0
            error = table[f"{name}_error"] / scale if f"{name}_error" in table.names else None
            axis.errorbar(x, y / scale, error, label=(label or column) + found[1].replace("_", " "), capsize=2, lw=1)
    axis.set_xscale("log" if plot["log_x"] else "linear")
    axis.set_yscale("log" if plot["log_y"] else "linear")
    axis.set(title=plot["title"], xlabel=plot["x_label"], ylabel=plot["y_label"])
    axis.legend(fontsize="small")
