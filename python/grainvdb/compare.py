"""Results side by side: which numbers and curves they share, and pictures with all of them."""
from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Callable, TypeVar

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from . import hdf, plots
from .arrays import Array
from .collapse import Collapse, Curve, collapse_of_runs
from .fields import AXES, Fields
from .tables import Number, Table, Tables
from .tracers import Tracers

_Part = TypeVar("_Part")


@dataclass
class Result:
    """What lies in the output folder of a run; what is not there is None."""

    folder: str
    fields: Fields | None
    tables: Tables | None
    tracers: Tracers | None

    @property
    def parts(self) -> list[Fields | Tables | Tracers]:
        return [part for part in (self.fields, self.tables, self.tracers) if part is not None]

    @property
    def provenance(self) -> dict[str, str]:
        return self.parts[0].provenance

    def units(self) -> dict[str, str]:
        """Of everything in it, by what it is."""
        units: dict[str, str] = {}
        if self.fields is not None:
            units |= {f"the axis {axis}": self.fields.unit(axis) for axis in AXES}
            units |= {f"the field {name}": self.fields.unit(name) for name in self.fields}
        for name, table in (self.tables or {}).items():
            units |= {f"{name}.{column}": table.unit(column) for column in table.columns}
            units |= {f"{name}.{number.name}": number.unit for number in table.numbers.values()}
        if self.tracers is not None:
            units["the places of tracers"] = self.tracers.unit("position")
        return units

    def close(self) -> None:
        for part in self.parts:
            part.close()

    def __enter__(self) -> Result:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def open_result(folder: str | os.PathLike[str]) -> Result:
    """Opens what an output folder holds. Raises FileNotFoundError where it holds no result, ResultError for files that
    are something else."""
    def part(name: str, kind: Callable[[str], _Part]) -> _Part | None:
        path = os.path.join(folder, name)
        return kind(path) if os.path.isfile(path) else None

    result = Result(os.fspath(folder), part("fields.hdf", Fields), part("tables.h5", Tables), part("tracers.h5", Tracers))
    if not result.parts:
        raise FileNotFoundError(f"{os.fspath(folder)}: neither fields.hdf nor tracers.h5 nor tables.h5 is there; "
                                "expected the output folder of `grainvdb run`")
    return result


Results = Mapping[str, Result]


def check_units(results: Results) -> None:
    """Raises ResultError where results tell the same thing in different units: numbers would be compared that mean
    different things."""
    known: dict[str, tuple[str, str]] = {}
    differ = []
    for label, result in results.items():
        for what, unit in result.units().items():
            first, expected = known.setdefault(what, (label, unit))
            if unit != expected:
                differ.append(f"{what} is in {expected} in {first}, in {unit} in {label}")
    if differ:
        more = f", and {len(differ) - 3} more" if len(differ) > 3 else ""
        raise hdf.ResultError(f"the results are in different units: {'; '.join(differ[:3])}{more}. Make them with the same "
                              "units, or all with output.reduced: in grain diameters, gravity and the density of the grains")


def deviation(a: Number, b: Number) -> float:
    """(b - a)/√(σ_a² + σ_b²), the difference in combined standard errors; NaN where one has none."""
    together = np.hypot(a.error, b.error)
    return (b.value - a.value) / together if together > 0 else float("nan")


def _of_all(parts: Mapping[str, _Part | None]) -> dict[str, _Part]:
    there = {label: part for label, part in parts.items() if part is not None}
    return there if len(there) == len(parts) else {}


def fields_of(results: Results) -> dict[str, Fields]:
    """The fields of each result by its label; empty unless all have some."""
    return _of_all({label: result.fields for label, result in results.items()})


def tracers_of(results: Results) -> dict[str, Tracers]:
    """The tracers of each result by its label; empty unless all have some."""
    return _of_all({label: result.tracers for label, result in results.items()})


def common_fields(results: Mapping[str, Fields]) -> list[str]:
    """Names of the fields that all have."""
    return [name for name in next(iter(results.values()), ()) if all(name in fields for fields in results.values())]


def common_tables(results: Results) -> dict[str, dict[str, Table]]:
    """The tables that all have, of each result by its label."""
    all_tables = _of_all({label: result.tables for label, result in results.items()})
    return {name: {label: tables[name] for label, tables in all_tables.items()}
            for name in next(iter(all_tables.values()), ()) if all(name in tables for tables in all_tables.values())}


def missing(results: Results) -> list[str]:
    """Sentences on what only some of them have, which is not compared."""
    have = {label: {f"the field {n}" for n in result.fields or ()} | {f"the table {n}" for n in result.tables or ()}
            for label, result in results.items()}
    every = set().union(*have.values())
    return [f"{label} lacks {', '.join(sorted(every - names))}." for label, names in have.items() if every - names]


def shared_columns(tables: Mapping[str, Table]) -> list[str]:
    """Columns that all have, errors and the first one apart, with a value somewhere."""
    first = next(iter(tables.values()))
    return [c for c in first.columns[1:] if not c.endswith("_error") and all(c in t.columns for t in tables.values())
            and any(np.any(np.isfinite(t[c])) for t in tables.values())]


def collapse_of(tables: Mapping[str, Table]) -> Collapse:
    """The tables of the measurement `collapse` as if the voxels of all results had been binned at once (collapse_of_runs)."""
    return collapse_of_runs([Curve(t["phi"], t["mean"], t["spread"], t["points"]) for t in tables.values()])


def columns(tables: Mapping[str, Table], name: str, ax: Axes | None = None, against: str | None = None) -> Axes:
    """A column of each table against the first or another one, with its standard errors."""
    ax = ax or plt.subplots()[1]
    for label, table in tables.items():
        x = against or table.columns[0]
        ends = plots.error_bars(table[name], table[f"{name}_error"] if f"{name}_error" in table.columns else None)
        line = ".-" if np.all(np.diff(table[x]) > 0) else "."
        ax.errorbar(table[x], table[name], yerr=ends, fmt=line, ms=4, lw=0.9, elinewidth=0.8, label=label)
        ax.set(xlabel=plots.label(x, table.unit(x)), ylabel=plots.label(name, table.unit(name)))
    ax.grid(alpha=0.3)
    return ax


def _voxels(results: Mapping[str, Fields], x: str, y: str, ax: Axes) -> None:
    """One field against another, a point for each voxel away from smeared edges, a colour for each result. The points of all
    are drawn in a random order, so that none hides the others."""
    parts = []
    for k, (label, fields) in enumerate(results.items()):
        (a, x_label), (b, y_label) = plots.scalar(fields, x), plots.scalar(fields, y)
        there = plots.inside(fields)
        drawn = np.isfinite(a) & np.isfinite(b) & (True if there is None else there)
        parts.append(np.column_stack([a[drawn], b[drawn], np.full(drawn.sum(), k)]))
        ax.plot([], [], "o", markersize=4, color=f"C{k}", label=label)
        ax.set(xlabel=x_label, ylabel=y_label)
    points = np.random.default_rng(1).permutation(np.concatenate(parts))
    ax.scatter(points[:, 0], points[:, 1], s=4, linewidth=0, alpha=0.6, color=[f"C{k:.0f}" for k in points[:, 2]], rasterized=True)
    ends = [np.percentile(part[:, 1], [0.5, 99.5]) for part in parts if len(part)]
    if ends:
        low, high = np.min(ends), np.max(ends)
        ax.set_ylim(min(0.0, low), high * 1.1 if high > 0 else None)
    ax.grid(alpha=0.3)


def _fits(fitted: Mapping[str, tuple[float, ...] | None], law: str) -> list[plots.Fit]:
    """Of those results that have one, in their colours."""
    return [plots.Fit(parameters, f"{label}: {law}, fitted", f"C{k}") for k, (label, parameters) in enumerate(fitted.items()) if parameters]


def fluidity_against_phi(results: Mapping[str, Fields], fitted: Mapping[str, tuple[float, ...] | None], ax: Axes | None = None) -> Axes:
    """g d/δv of the voxels of all results against φ, with the law (3) and what was fitted to each."""
    ax = ax or plt.subplots()[1]
    _voxels(results, "phi", "gd_over_dv", ax)
    plots.fluidity_laws(ax, _fits(fitted, "(A20)"))
    return ax


def friction_against_inertial(results: Mapping[str, Fields], fitted: Mapping[str, tuple[float, ...] | None], ax: Axes | None = None) -> Axes:
    """μ of the voxels of all results against I, with μ(I) of common parameters and those fitted to each."""
    ax = ax or plt.subplots()[1]
    _voxels(results, "inertial_number", "mu", ax)
    spans = [span for fields in results.values() if (span := plots.inertial_span(fields))]
    plots.friction_laws(ax, (min(low for low, _ in spans), max(high for _, high in spans)) if spans else None, _fits(fitted, "μ(I)"))
    return ax


def heights(results: Mapping[str, Fields], name: str, along: str, across: str, count: int = 6) -> Array:
    """Places along an axis, far from each other, at which every result knows a field over more than half of the width
    that it has anywhere; voxel centres of the first result."""
    spans = []
    for fields in results.values():
        known = np.isfinite(lines(fields, name, along, across)).sum(axis=1)
        at = fields.axis(along)[known > 0.5 * known.max()]
        spans.append((at.min(), at.max()))
    low, high = max(s[0] for s in spans), min(s[1] for s in spans)
    if low >= high:
        return np.array([])
    centres = next(iter(results.values())).axis(along)
    return np.unique([centres[np.argmin(np.abs(centres - at))] for at in np.linspace(low, high, count + 2)[1:-1]])


def lines(fields: Fields, name: str, along: str, across: str) -> Array:
    """A field, of a vector its component along the first axis, as means over the third axis where it is known; of shape
    (along, across)."""
    values = fields.values(name, -1).astype(float)
    if values.ndim == 4:
        values = values[..., AXES.index(along)]
    third = next(axis for axis in AXES if axis not in (along, across))
    means = np.ma.masked_invalid(values).mean(axis=2 - AXES.index(third)).filled(np.nan)
    return means if AXES.index(along) > AXES.index(across) else means.T


def profile_across(results: Mapping[str, Fields], name: str, at: float, along: str, across: str,
                   ax: Axes | None = None) -> Axes:
    """The line of voxels nearest to a place along an axis, over another axis."""
    ax = ax or plt.subplots()[1]
    for label, fields in results.items():
        k = int(np.argmin(np.abs(fields.axis(along) - at)))
        ax.plot(fields.axis(across), lines(fields, name, along, across)[k], ".-", ms=4, lw=0.9, label=label)
    ax.set(xlabel=plots.label(across, fields.unit(across)), ylabel=plots.label(f"{name} {along}", fields.unit(name)),
           title=f"{along} = {at:.3g} {fields.unit(along)}")
    ax.grid(alpha=0.3)
    return ax
