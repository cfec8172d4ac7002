"""Pictures of lines that were followed through a field: streamlines of the drift of spots."""
from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from .arrays import Array
from .fields import AXES, Fields
from .plots import field_slice, label
from .tables import Table

#: Fields to draw lines over, the first that a result has.
_BACKGROUND = ("velocity", "spot_drift", "phi")


def is_lines(table: Table) -> bool:
    """Whether the rows are points along numbered lines in space."""
    return {*AXES, "line"} <= set(table.columns)


def lines_of(table: Table) -> list[Array]:
    """The points of each line of the last output time, of shape (points, 3), in the order of their numbers."""
    points = np.column_stack([table[axis] for axis in AXES])
    line = table["line"]
    last = table["output"] == table["output"].max(initial=0) if "output" in table.columns else np.ones(len(line), bool)
    return [points[last & (line == number)] for number in np.unique(line[last])]


def plane_of(table: Table) -> str:
    """The axis to look along: y or x, whichever the lines cross less; z where they stay at one height."""
    extent = {axis: np.ptp(table[axis]) if len(table[axis]) else 0.0 for axis in AXES}
    return min("yxz", key=lambda axis: extent[axis])


def background(fields: Fields | None) -> str | None:
    """The field that lines are drawn over; None where the result has none of those."""
    return next((name for name in _BACKGROUND if fields is not None and name in fields), None)


def flow_lines(table: Table, fields: Fields | None = None, ax: Axes | None = None, colour: str = "red", text: str | None = None,
               cut: str | None = None) -> Axes:
    """The lines as seen along an axis, that of `plane_of` unless given, dots where they begin, over the layer of voxels of a field that their
    mean place lies in."""
    ax = ax or plt.subplots()[1]
    cut = cut or plane_of(table)
    across, up = [axis for axis in AXES if axis != cut]
    lines = lines_of(table)
    name = background(fields)
    if fields is not None and name and lines:
        mean = np.concatenate(lines)[:, AXES.index(cut)].mean()
        field_slice(fields, name, cut, int(np.argmin(np.abs(fields.axis(cut) - mean))), ax=ax)
    for k, line in enumerate(lines):
        a, b = (line[:, AXES.index(axis)] for axis in (across, up))
        ax.plot(a, b, "-", color=colour, linewidth=1, label=text if k == 0 else None)
        ax.plot(a[:1], b[:1], ".", color=colour, markersize=5)
    ax.set(xlabel=label(across, table.unit(across)), ylabel=label(up, table.unit(up)), aspect="equal")
    return ax
