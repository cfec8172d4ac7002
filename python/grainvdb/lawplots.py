"""Pictures of tables that measure a law: what was measured, the law that was fitted to it and the one in print, in one panel."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from . import laws
from .arrays import Array
from .plots import error_bars
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


def measured_with_laws(table: Table, panel: Panel, ax: Axes | None = None) -> Axes:
    """What was measured with its standard errors, the fitted law dashed and the printed one solid, both at the places that
    were measured; open points were left out of the fit. A law without values is not drawn."""
    ax = ax or plt.subplots()[1]
    x = table[panel.x]
    taken = table["in_band"] > 0 if "in_band" in table.columns else np.ones(x.shape, bool)
    for rows, text, fill in ((taken, "measured", "C0"), (~taken, "outside the shear band", "none")):
        if rows.any():
            ax.errorbar(x[rows], table[panel.y][rows], xerr=_errors(table, panel.x, rows), yerr=_errors(table, panel.y, rows), fmt="o", ms=3.5, elinewidth=0.8,
                        color="C0", markerfacecolor=fill, label=text)
    for column, style, text in ((panel.law, "k-", panel.law_label), (panel.fitted, "r--", panel.fitted_label)):
        drawn = np.isfinite(table[column]) & np.isfinite(x) if column else np.zeros(x.shape, bool)
        if drawn.any():
            order = np.argsort(x[drawn])
            ax.plot(x[drawn][order], table[column][drawn][order], style, linewidth=1.2, label=text)
    decades = panel.x == "inertial_number" and 0 < 10 * x.min() < x.max()
    ax.set(xlabel=panel.x_label, ylabel=panel.y_label, xscale="log" if decades else "linear")
    ax.legend(fontsize="small")
    ax.grid(alpha=0.3)
    return ax


def without_fit(table: Table) -> list[str]:
    """What the panels call those of their fitted laws that have no value: the fit was refused."""
    return [panel.fitted_label for panel in law_panels(table) if not np.any(np.isfinite(table[panel.fitted]))]
