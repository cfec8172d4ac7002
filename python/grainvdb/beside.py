"""One page that sets several results beside each other: `grainvdb report DIR --beside OTHER`."""
from __future__ import annotations

import contextlib
import difflib
import html
import os
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Callable

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from . import compare, flowlines, lawplots, plots
from .arrays import Array
from .compare import Result, Results
from .fields import AXES, Fields
from .page import (FIELDS_FIRST, PROFILES_FIRST, Draw, Page, html_table, number, ordered, panels, plane_size,
                   provenance, with_error, write)
from .tables import Table
from .tracers import Tracers


def _legend(figure: plt.Figure) -> plt.Figure:
    """With what the lines of its first panel are called, above all panels."""
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="lower center", bbox_to_anchor=(0.5, 1), ncols=4, frameon=False)
    return figure


def _overview(page: Page, results: Results) -> None:
    def row(what: str, tell: Callable[[Result], str]) -> tuple[str, ...]:
        return (what, *(tell(result) for result in results.values()))

    rows = [row("folder", lambda r: r.folder),
            row("made by", lambda r: f"grainvdb {r.provenance.get('version', '?')}"),
            row("snapshots", lambda r: r.provenance.get("snapshots", "of a simulation")),
            row("frames", lambda r: str(len(r.provenance.get("steps", "").split())))]
    if fields := compare.fields_of(results):
        rows += [("mean time", *(f"{number(f.times[-1])} {f.unit('time')}" for f in fields.values())),
                 ("voxels", *(_voxels(f) for f in fields.values()))]
    parts = [html_table(rows, ("", *results))]
    parts += [f"<p>{html.escape(text)}</p>" for text in compare.missing(results)]
    page.add("What is compared", *parts, *_differing_keys(results))


def _voxels(fields: Fields) -> str:
    counts = " × ".join(str(len(fields.axis(axis))) for axis in AXES)
    return f"{counts}, edge {number(fields.voxel)} {fields.unit('x')}"


def _differing_keys(results: Results) -> list[str]:
    """Lines of the pipelines that differ between the first and each other result."""
    (first, reference), *others = results.items()
    parts = []
    for label, result in others:
        a, b = (r.provenance.get("pipeline", "").splitlines() for r in (reference, result))
        lines = [line for line in difflib.unified_diff(a, b, first, label, lineterm="", n=0) if not line.startswith("@@")]
        said = "\n".join(lines) if lines else "none"
        parts.append(f"<details open><summary>Lines of the pipelines that differ, {html.escape(first)} against {html.escape(label)}</summary>"
                     f"<pre>{html.escape(said)}</pre></details>")
    return parts


def number_rows(tables: Mapping[str, Mapping[str, Table]]) -> list[tuple[str, ...]]:
    """A row for each number that all results have: table, quantity, what it is, unit, and the value of the first; then of each other its value, the
    difference from the first and that difference in combined standard errors."""
    rows = []
    for name, by_label in tables.items():
        first, *others = (table.numbers for table in by_label.values())
        for key, reference in first.items():
            if not all(key in other for other in others):
                continue
            row = [name, key, reference.description, reference.unit, with_error(reference.value, reference.error)]
            for other in (o[key] for o in others):
                apart = compare.deviation(reference, other)
                row += [with_error(other.value, other.error), number(other.value - reference.value), "-" if np.isnan(apart) else f"{apart:+.1f}"]
            rows.append(tuple(row))
    return rows


def _numbers(page: Page, tables: Mapping[str, Mapping[str, Table]]) -> None:
    rows = number_rows(tables)
    if not rows:
        return
    first, *others = next(iter(tables.values()))
    head = ("table", "quantity", "what it is", "unit", first, *(text for label in others for text in (label, "difference", "in errors")))
    page.add("Numbers", "<p>± is the standard error; the last column is the difference over √(σ₁² + σ₂²), where both have one. "
             "Errors are those that the measurements state, and most of these are lower bounds: see their pages.</p>", html_table(rows, head))


def _profiles(page: Page, results: Mapping[str, Fields], axis: str) -> None:
    names = ordered(compare.common_fields(results), PROFILES_FIRST)
    draw = [lambda ax, n=n: plots.scales(results, n, axis, ax=ax) for n in names]
    page.add("Profiles", page.picture("profiles", _legend(panels(draw, 3, (3.6, 3.2))),
                                      f"Means over each layer of voxels across {axis}, of vectors the magnitude."))


def _velocity(page: Page, results: Mapping[str, Fields], along: str, cut: str) -> None:
    across = next(axis for axis in AXES if axis not in (along, cut))
    at = compare.heights(results, "velocity", along, across)
    if at.size == 0:
        return
    draw = [partial(compare.profile_across, results, "velocity", z, along, across) for z in at]
    page.add("Velocity profiles", page.picture("velocity_profiles", _legend(panels(draw, 3, (3.9, 2.9))),
                                               f"The component of the velocity along {along} against {across} at heights {along}, averaged over {cut}."))


def _spans(ends: Sequence[tuple[Array, Array]], margin: float) -> list[tuple[float, float]]:
    """From the least to the greatest place along both axes of a plane, in any of the results."""
    return [(min(e[k].min() for e in ends) - margin, max(e[k].max() for e in ends) + margin) for k in (0, 1)]


def slices(results: Mapping[str, Fields], cut: str, index: Sequence[int]) -> plt.Figure:
    """The layer of each result with that index across the axis `cut`: a row for each field that all have, on one colour
    scale and over one span of places."""
    across, up = [axis for axis in AXES if axis != cut]
    sides = _spans([(f.axis(across), f.axis(up)) for f in results.values()], next(iter(results.values())).voxel)

    def one(name: str, scale: Mapping[str, object], label: str, k: int, ax: Axes) -> None:
        plots.field_slice(results[label], name, cut, k, ax=ax, scale=scale)
        ax.set(xlim=sides[0], ylim=sides[1], title=f"{label}: {ax.get_title()}")

    draw = []
    for name in ordered(compare.common_fields(results), FIELDS_FIRST):
        scale = plots.colours(*(plots.layer(f, name, cut, k) for f, k in zip(results.values(), index)))
        draw += [partial(one, name, scale, label, k) for label, k in zip(results, index)]
    return panels(draw, len(results), plane_size(sides))


def maps(tables: Mapping[str, Table], names: Sequence[str]) -> plt.Figure:
    """Columns of tables of places, a row for each, on one colour scale and over one span of places."""
    first, second = next(iter(tables.values())).columns[:2]
    sides = _spans([(t[first], t[second]) for t in tables.values()], 0)

    def one(name: str, scale: Mapping[str, object], label: str, ax: Axes) -> None:
        plots.table_map(tables[label], name, ax, scale)
        ax.set(xlim=sides[0], ylim=sides[1], title=f"{label}: {ax.get_title()}")

    draw = []
    for name in names:
        scale = plots.colours(*(table[name] for table in tables.values()))
        draw += [partial(one, name, scale, label) for label in tables]
    return panels(draw, len(tables), plane_size(sides))


def _slices(page: Page, results: Mapping[str, Fields], cut: str, at: float | None) -> None:
    index = [plots.middle(f, cut) if at is None else int(np.argmin(np.abs(f.axis(cut) - at))) for f in results.values()]
    where = ", ".join(f"{label} at {cut} = {number(f.axis(cut)[k])}" for (label, f), k in zip(results.items(), index))
    page.add("Slices", page.picture("slices", slices(results, cut, index),
                                    f"Slices ({where}), each field on one colour scale; blank: no value."))


def _laws(page: Page, results: Results, fields: Mapping[str, Fields]) -> None:
    """Voxels of all results in one panel for each law whose fields all have."""
    common = compare.common_fields(fields)
    draw: list[Draw] = []
    if {"phi", "gd_over_dv"} <= set(common):
        fluidity = {label: lawplots.parameters(r.tables, "fluidity", lawplots.FLUIDITY) for label, r in results.items()}
        draw.append(partial(compare.fluidity_against_phi, fields, fluidity))
    if {"inertial_number", "mu"} <= set(common):
        friction = {label: lawplots.parameters(r.tables, "rheology", lawplots.FRICTION) for label, r in results.items()}
        draw.append(partial(compare.friction_against_inertial, fields, friction))
    if draw:
        page.add("Rheology", page.picture("rheology", panels(draw, 2, (5.4, 4)), "A point per voxel of the last output time, a colour per result; left out are voxels where the kernel smears the "
                                          "edge of the material. Solid laws are drawn to compare with, not fitted; dashed: fitted in the tables of each result."))


def _spreading(page: Page, tables: Mapping[str, Table]) -> None:
    names = [c for c in compare.shared_columns(tables) if c.startswith("variance_")]
    draw = [lambda ax, c=c: compare.columns(tables, c, ax, against="travelled") for c in names]
    page.add("Spreading of grains", page.picture("spreading", _legend(panels(draw, 3, (3.9, 2.9))),
                                                 "Variance of the displacements of grains about their mean motion against the way that they fell."))


def _tracers(page: Page, results: Mapping[str, Tracers]) -> None:
    def one(label: str, tracers: Tracers, ax: Axes) -> None:
        plots.tracer_paths(tracers, ax)
        ax.set(title=label)

    draw = [partial(one, label, tracers) for label, tracers in results.items()]
    page.add("Tracers", page.picture("tracers", panels(draw, len(results), (5, 5)),
                                     "Paths of tracers from their seeds (dots)."))


def _lines(page: Page, name: str, tables: Mapping[str, Table]) -> list[str]:
    """Lines followed through a field, of all results in one picture."""
    followed = {label: table for label, table in tables.items() if flowlines.lines_of(table)}
    if not followed:
        return []
    cut = flowlines.plane_of(next(iter(followed.values())))
    across, up = [axis for axis in AXES if axis != cut]

    def draw(ax: Axes) -> None:
        for k, (label, table) in enumerate(followed.items()):
            flowlines.flow_lines(table, ax=ax, colour=f"C{k}", text=label, cut=cut)
        ax.legend(fontsize="small")

    sides = _spans([(table[across], table[up]) for table in followed.values()], 0)
    return [page.picture(f"table_{name}", panels([draw], 1, plane_size(sides, 7)), f"Table {name}: the lines as seen along {cut}, dots where they begin.")]


def _table_pictures(page: Page, name: str, tables: Mapping[str, Table]) -> list[str]:
    first = next(iter(tables.values()))
    drawn = compare.shared_columns(tables)
    if all(flowlines.is_lines(table) for table in tables.values()):
        return _lines(page, name, tables)
    if all(plots.is_map(table) for table in tables.values()):
        drawn = [c for c in drawn if c != first.columns[1]]
        return [page.picture(f"table_{name}", maps(tables, drawn), f"Table {name}, each column on one colour scale.")]
    if not drawn or not all(len(t[t.columns[0]]) > 1 and t.columns[0] == first.columns[0] for t in tables.values()):
        return []
    overlaid = lawplots.panels_of_all(tables)
    apart = [c for c in drawn if not any(c in panel.columns for panel in overlaid)]
    pictures = []
    if overlaid:
        figure = panels([partial(lawplots.runs_with_laws, tables, panel) for panel in overlaid], 2, (5.4, 4))
        pictures.append(page.picture(f"table_{name}_laws", figure, f"Table {name} with laws: dashed those fitted to each result, solid to compare with, not fitted; open points "
                                     "were left out of the fit; bars are standard errors."))
    if apart:
        draw = [lambda ax, c=c: compare.columns(tables, c, ax) for c in apart]
        pictures.append(page.picture(f"table_{name}", _legend(panels(draw, 3, (3.9, 2.9))), f"Table {name}; bars are standard errors."))
    return pictures


def _measured(page: Page, name: str, tables: Mapping[str, Table]) -> None:
    first = next(iter(tables.values()))
    parts = [f"<p>{html.escape(first.description)}: {html.escape(first.equation)}</p>"]
    parts += [f"<p>Note on {html.escape(label)}: {html.escape(remark)}</p>" for label, table in tables.items() for remark in table.remarks]
    if name.startswith("collapse_"):
        alone = ", ".join(f"{html.escape(label)} {number(t.numbers['collapse'].value)}" for label, t in tables.items())
        parts.append(f"<p>Collapse, the part of the variance that the packing fraction tells: alone {alone}; "
                     f"of all together {number(compare.collapse_of(tables).told)}. Curves that lie apart do not collapse.</p>")
    parts += _table_pictures(page, name, tables)
    page.add(f"Measured: {name.replace('_', ' ')}", *parts)


def labels_of(folders: Sequence[str], labels: Sequence[str] | None) -> Sequence[str]:
    """Those given, or the names of the folders, or their paths where names come twice."""
    labels = labels or [os.path.basename(os.path.abspath(folder)) for folder in folders]
    if len(set(labels)) < len(folders):
        labels = [os.path.abspath(folder) for folder in folders]
    return labels


def write_comparison(folders: Sequence[str], output: str | None = None, labels: Sequence[str] | None = None,
                     axis: str = "z", cut: str | None = None, at: float | None = None) -> list[str]:
    """Writes report.html and its pictures into `output` (beside/ in the first folder unless given) and returns the files.

    Raises FileNotFoundError for a folder without a result, and hdf.ResultError for files that are something else and for
    results in different units.
    """
    with contextlib.ExitStack() as stack:
        names = labels_of(folders, labels)
        results: dict[str, Result] = {label: stack.enter_context(compare.open_result(folder)) for label, folder in zip(names, folders)}
        compare.check_units(results)
        page = Page("grainvdb: " + " beside ".join(names))
        tables = compare.common_tables(results)
        _overview(page, results)
        _numbers(page, tables)
        fields = compare.fields_of(results)
        if common := compare.common_fields(fields):
            cut = cut or plots.slice_axis(next(iter(fields.values())))
            if "velocity" in common and cut != axis:
                _velocity(page, fields, axis, cut)
            _slices(page, fields, cut, at)
            _profiles(page, fields, axis)
            _laws(page, results, fields)
        if "diffusion" in tables:
            _spreading(page, tables["diffusion"])
        if tracers := compare.tracers_of(results):
            _tracers(page, tracers)
        for name, by_label in tables.items():
            _measured(page, name, by_label)
        for label, result in results.items():
            provenance(page, f"Provenance of {label}", result.provenance)
    return list(write(page, output or os.path.join(folders[0], "beside")))
