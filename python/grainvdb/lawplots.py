"""Pictures of tables that measure a law: what was measured, the law that was fitted to it and the one in print, in one panel."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from . import laws
from .arrays import Array
from .plots import error_bars, label
from .tables import Table

#: The numbers of table `fluidity` that are the parameters of (A20), and those of `rheology` of μ(I).
FLUIDITY = ("A", "B", "C", "D")
FRICTION = ("mu_0", "mu_infinity", "I_0")


@dataclass(frozen=True)
class Panel:
    """The columns of one panel with what they are called there."""

    x: str
    y: str
    fitted: str
    fitted_label: str
    x_label: str
    y_label: str
    law: str = ""
    law_label: str = ""

    @property
    def columns(self) -> tuple[str, ...]:
        return tuple(name for name in (self.y, self.fitted, self.law) if name)


#: By table.
_PANELS = {
    "fluidity": (Panel("phi", "gd_over_dv", "fit", "(A20), fitted", "φ", "g d/δv", "law_3", "(3)"),),
    "rheology": (Panel("inertial_number", "mu", "mu_fit", "μ(I), fitted", "inertial number I", "μ", "mu_law", laws.friction_text(*laws.INERTIAL)),
                 Panel("inertial_number", "phi", "phi_fit", "φ(I), fitted", "inertial number I", "φ")),
}


def law_panels(table: Table) -> list[Panel]:
    """Those that the columns of a table suffice for; none of a table that measures no law."""
    return [panel for panel in _PANELS.get(table.name, ()) if {panel.x, *panel.columns} <= set(table.columns)]


def parameters(tables: Mapping[str, Table] | None, name: str, symbols: tuple[str, ...]) -> tuple[float, ...] | None:
    """The numbers of that table by their symbols; None where the table, or the fit, is not there."""
    numbers = tables[name].numbers if tables and name in tables else {}
    values = tuple(numbers[symbol].value if symbol in numbers else np.nan for symbol in symbols)
    return values if np.all(np.isfinite(values)) else None


def _errors(table: Table, column: str, rows: Array) -> Array | None:
    error = f"{column}_error"
    return error_bars(table[column][rows], table[error][rows] if error in table.columns else None)


def _measured(ax: Axes, table: Table, panel: Panel, colour: str, inside: str, outside: str | None) -> None:
    """Points with their standard errors; open ones were left out of the fit. Both with what they are called, None: not at all."""
    x = table[panel.x]
    taken = table["in_band"] > 0 if "in_band" in table.columns else np.ones(x.shape, bool)
    for rows, text, fill in ((taken, inside, colour), (~taken, outside, "none")):
        if rows.any():
            ax.errorbar(x[rows], table[panel.y][rows], xerr=_errors(table, panel.x, rows), yerr=_errors(table, panel.y, rows), fmt="o", ms=3.5, elinewidth=0.8,
                        color=colour, markerfacecolor=fill, label=text)


def _law(ax: Axes, x: Array, y: Array, style: str, colour: str, text: str) -> None:
    """A line through the values that there are."""
    drawn = np.isfinite(y) & np.isfinite(x)
    if drawn.any():
        order = np.argsort(x[drawn])
        ax.plot(x[drawn][order], y[drawn][order], style, color=colour, linewidth=1.2, label=text)


def _dress(ax: Axes, panel: Panel, x: Array) -> None:
    decades = panel.x == "inertial_number" and 0 < 10 * x.min() < x.max()
    ax.set(xlabel=panel.x_label, ylabel=panel.y_label, xscale="log" if decades else "linear")
    # Where there is room inside matplotlib tells from the points alone, and would cover error bars.
    ax.legend(fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1), ncols=2, frameon=False)
    ax.grid(alpha=0.3)


def measured_with_laws(table: Table, panel: Panel, ax: Axes | None = None) -> Axes:
    """What was measured with its standard errors, the fitted law dashed and the printed one solid, both at the places that
    were measured; open points were left out of the fit. A law without values is not drawn."""
    ax = ax or plt.subplots()[1]
    _measured(ax, table, panel, "C0", "measured", "outside the shear band")
    x = table[panel.x]
    if panel.law:
        _law(ax, x, table[panel.law], "-", "black", panel.law_label)
    _law(ax, x, table[panel.fitted], "--", "red", panel.fitted_label)
    _dress(ax, panel, x)
    return ax


def runs_with_laws(tables: Mapping[str, Table], panel: Panel, ax: Axes | None = None) -> Axes:
    """The same of several runs in one panel, each in its colour with the law that was fitted to it dashed; the printed law,
    which is one for all, solid."""
    ax = ax or plt.subplots()[1]
    for k, (run, table) in enumerate(tables.items()):
        _measured(ax, table, panel, f"C{k}", run, None)
        _law(ax, table[panel.x], table[panel.fitted], "--", f"C{k}", f"{run}: {panel.fitted_label}")
    x = np.concatenate([table[panel.x] for table in tables.values()])
    if panel.law:
        _law(ax, x, np.concatenate([table[panel.law] for table in tables.values()]), "-", "black", panel.law_label)
    _dress(ax, panel, x)
    return ax


def panels_of_all(tables: Mapping[str, Table]) -> list[Panel]:
    """Those that all of these tables suffice for."""
    first, *others = (law_panels(table) for table in tables.values())
    return [panel for panel in first if all(panel in other for other in others)]


def without_fit(table: Table) -> list[str]:
    """What the panels call those of their fitted laws that have no value: the fit was refused."""
    return [panel.fitted_label for panel in law_panels(table) if not np.any(np.isfinite(table[panel.fitted]))]


#: Tables of places: which columns are measured and which are the theory's.
_FLOWS = {"kinematic_fit": (("velocity", "fitted"),), "mean_field": (("velocity", "drift"), ("sideways", "drift_sideways"))}


def flow_pairs(table: Table) -> list[tuple[str, str]]:
    """What was measured at places of a plane, and its theory, by the names of their columns."""
    return [pair for pair in _FLOWS.get(table.name, ()) if set(pair) <= set(table.columns)]


def at_heights(table: Table, measured: str, theory: str, ax: Axes | None = None, count: int = 4) -> Axes:
    """Lines of a table of places, its first column against which the second is the height: what was measured at a few
    heights as points, the theory as a line."""
    ax = ax or plt.subplots()[1]
    across, up = table.columns[:2]
    height = np.unique(table[up])
    for k, at in enumerate(height[np.unique(np.linspace(0, len(height) - 1, count).round().astype(int))]):
        row = table[up] == at
        ax.plot(table[across][row], table[measured][row], ".", color=f"C{k}", ms=4, label=f"{up} = {at:.3g}")
        ax.plot(table[across][row], table[theory][row], "-", color=f"C{k}", linewidth=1)
    ax.set(xlabel=label(across, table.unit(across)), ylabel=label(measured, table.unit(measured)))
    ax.legend(fontsize="small")
    ax.grid(alpha=0.3)
    return ax
