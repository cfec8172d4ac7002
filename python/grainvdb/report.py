"""One self-contained HTML page from a result, with the same pictures as PNG files.

    grainvdb report DIR
    python3 -m grainvdb.report DIR [--output DIR/report]
"""
from __future__ import annotations

import argparse
import contextlib
import html
import json
import math
import os
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NoReturn

import numpy as np

from . import flowlines, hdf, lawplots, plots
from .beside import write_comparison
from .fields import AXES, Fields
from .page import (FIELDS_FIRST, PROFILES_FIRST, Draw, Page, html_table, number, ordered, panels, plane_size,
                   provenance, with_error, write)
from .tables import Table, Tables
from .tracers import Tracers

_MOST_HISTORIES = 12


def _overview(page: Page, fields: Fields) -> None:
    times = fields.times
    frames = fields.frame_counts
    shape = " × ".join(str(len(fields.axis(a))) for a in AXES)
    unit = fields.unit("x")
    span = "; ".join(f"{a} {number(fields.axis(a)[0])} … {number(fields.axis(a)[-1])}" for a in AXES)
    rows = [("output times", f"{len(times)}, of {frames.min()} to {frames.max()} frames" if len(set(frames)) > 1 else f"{len(times)}, of {frames[0]} frames"),
            ("time", f"{number(times[0])} … {number(times[-1])} {fields.unit('time')}"),
            ("voxels", f"{shape}, edge {number(fields.voxel)} {unit}"),
            ("centres", f"{span} {unit}"),
            ("made by", f"grainvdb {fields.provenance.get('version', '?')}")]
    page.add("Overview", html_table(rows))


def _field_table(page: Page, fields: Fields) -> None:
    rows = []
    for name in ordered(fields.names, FIELDS_FIRST) + [n for n in fields.names if n.endswith("_error") or n == "frames"]:
        values, _ = plots.scalar(fields, name)
        finite = values[np.isfinite(values)]
        ends = [number(v) for v in np.percentile(finite, [1, 50, 99])] if finite.size else ["-"] * 3
        reasons = ", ".join(f"{count} {reason.replace('_', ' ')}" for reason, count in fields.undefined(name).items())
        rows.append((name, fields.unit(name), *ends, fields.equation(name), reasons or "-"))
    page.add("Fields", "<p>Of vectors the magnitude, of tensors a third of the trace; percentiles over all voxels with a value, at the last output time.</p>",
             html_table(rows, ("field", "unit", "1 %", "median", "99 %", "equation", "voxels without a value")))


def _slices(page: Page, fields: Fields, axis: str, index: int) -> None:
    names = ordered(fields.names, FIELDS_FIRST)
    across, up = [a for a in AXES if a != axis]
    shape = float(np.clip(len(fields.axis(up)) / len(fields.axis(across)), 0.4, 2.2))
    draw = [lambda ax, n=n: plots.field_slice(fields, n, axis, index, ax=ax) for n in names]
    caption = f"Slices at {axis} = {number(fields.axis(axis)[index])} {fields.unit(axis)}, at the last output time. Colours span the 1st to 99th percentile; blank: no value."
    page.add("Slices", page.picture("slices", panels(draw, 3, (3.9, 2.5 * shape + 0.9)), caption))


def _profiles(page: Page, fields: Fields, axis: str) -> None:
    names = ordered(fields.names, PROFILES_FIRST)
    draw = [lambda ax, n=n: plots.profile(fields, n, axis, ax=ax) for n in names]
    caption = f"Means over each layer of voxels across {axis}; the band is the spread of the voxels of a layer, bars the standard error over time where it was asked for, of magnitudes and means of components from the errors of the components, taken as uncorrelated."
    page.add("Profiles", page.picture("profiles", panels(draw, 3, (3.6, 3.2)), caption))


def _scales(page: Page, results: Mapping[str, Fields], axis: str) -> None:
    first = next(iter(results.values()))
    draw = [lambda ax, n=n: plots.scales(results, n, axis, ax=ax) for n in ordered(first.names, PROFILES_FIRST)]
    figure = panels(draw, 3, (3.6, 3.2))
    figure.axes[0].legend(fontsize="small")
    caption = (f"Means over each layer of voxels across {axis} by cutoff (c) and voxel (h) [{first.unit('x')}]. "
               "Lines that fall together: the field does not depend on the cutoff there.")
    page.add("Scales", page.picture("scales", figure, caption))


@dataclass(frozen=True)
class _Fitted:
    """Parameters of laws to draw dashed over the voxels, and what they come from."""

    fluidity: tuple[float, ...] | None
    fluidity_from: str
    friction: tuple[float, ...] | None


def _fitted_laws(tables: Mapping[str, Table] | None, given: tuple[float, float, float, float] | None) -> _Fitted:
    """Those given come before those of the tables."""
    measured = lawplots.parameters(tables, "fluidity", lawplots.FLUIDITY)
    return _Fitted(given or measured, "given with --fitted" if given else "fitted in table fluidity",
                   lawplots.parameters(tables, "rheology", lawplots.FRICTION))


def _rheology(page: Page, fields: Fields, fitted: _Fitted) -> None:
    draw: list[Draw] = []
    said = []
    if "phi" in fields and "gd_over_dv" in fields:
        draw.append(lambda ax: plots.fluidity_against_phi(fields, fitted=fitted.fluidity, ax=ax))
        said.append("Granular fluidity in dimensionless form against packing fraction, with the law (3) for friction 0.4" +
                    (f"; dashed: (A20) with the parameters {fitted.fluidity_from}." if fitted.fluidity else "."))
    if "mu" in fields and "inertial_number" in fields:
        draw.append(lambda ax: plots.friction_against_inertial(fields, fitted=fitted.friction, ax=ax))
        said.append("Stress ratio against inertial number, with μ(I) of frictionless grains" +
                    ("; dashed: of those fitted in table rheology, for rigid grains." if fitted.friction else "."))
    if draw:
        said.append("A point per voxel; solid laws are drawn to compare with, not fitted.")
        if "phi" in fields:
            said.append(f"Left out are voxels with φ below {number(plots.smeared_below(fields))}, {plots.SMEARED} of the 90th percentile: there the kernel smears the edge of the material.")
        page.add("Rheology", page.picture("rheology", panels(draw, 2, (5.4, 4)), " ".join(said)))


def _mask(page: Page, fields: Fields) -> None:
    if not fields.reasons:
        return
    figure = panels([lambda ax: plots.mask_reasons(fields, ax=ax)], 1, (7, 2.8))
    rows = [(r.name.replace("_", " "), r.meaning) for r in fields.reasons if np.any(fields.mask(-1) & r.flag) and r.name != "outside"]
    page.add("Where fields have no value", page.picture("mask", figure, "Voxels by the reason that the mask gives."),
             html_table(rows, ("reason", "meaning")))


def _tracers(page: Page, tracers: Tracers) -> None:
    names = [n for n in tracers.names if n != "displacement"][:_MOST_HISTORIES]
    paths = panels([lambda ax: plots.tracer_paths(tracers, ax)], 1, (6.5, 5.5))
    stopped = tracers.stop[-1]
    rows = [(name.replace("_", " "), str(int(np.count_nonzero(stopped == code)))) for code, name in tracers.stop_names.items()]
    parts = [html_table(rows, ("at the end", "tracers")),
             page.picture("tracer_paths", paths, "Paths from the seeds (dots).")]
    if names:
        histories = panels([partial(plots.tracer_history, tracers, n) for n in names], 3, (3.9, 2.9))
        parts.append(page.picture("tracer_histories", histories,
                                  "What was recorded along the paths: every tracer thin, the median thick."))
    page.add("Tracers", *parts)


def _table_caption(table: Table) -> str:
    said = [f"Table {table.name}; bars are standard errors."]
    if lawplots.law_panels(table):
        said.append("Dashed: laws fitted here; solid: to compare with, not fitted; both are drawn at the places that were measured.")
    said += [f"{law}: the fit was refused, and there is no line." for law in lawplots.without_fit(table)]
    return " ".join(said)


def _sides(table: Table, axes: Sequence[str]) -> list[tuple[float, float]]:
    return [(float(table[axis].min()), float(table[axis].max())) for axis in axes]


def _lines(page: Page, table: Table, fields: Fields | None) -> list[str]:
    if not flowlines.lines_of(table):
        return []
    cut = flowlines.plane_of(table)
    over = flowlines.background(fields)
    sides = [(float(fields.axis(a)[0]), float(fields.axis(a)[-1])) for a in AXES if a != cut] if fields and over else _sides(table, [a for a in AXES if a != cut])
    caption = f"Table {table.name}: the lines as seen along {cut}, dots where they begin; of the last output time."
    caption += f" Under them {over.replace('_', ' ')} in the layer of voxels at their mean {cut}." if over else ""
    return [page.picture(f"table_{table.name}", panels([partial(flowlines.flow_lines, table, fields)], 1, plane_size(sides, 7)), caption)]


def _map(page: Page, table: Table, names: Sequence[str]) -> list[str]:
    """Pictures of a table of places; of a flow with its theory also lines at some heights."""
    draw = [partial(plots.table_map, table, c) for c in names]
    pictures = [page.picture(f"table_{table.name}", panels(draw, 3, plane_size(_sides(table, table.columns[:2]))), f"Table {table.name}; blank: no value.")]
    if pairs := lawplots.flow_pairs(table):
        figure = panels([partial(lawplots.at_heights, table, *pair) for pair in pairs], 2, (5.4, 3.8))
        pictures.append(page.picture(f"table_{table.name}_heights", figure, f"Table {table.name} at some heights; points: measured, lines: theory."))
    return pictures


def _measured(page: Page, table: Table, fields: Fields | None) -> None:
    parts = [f"<p>{html.escape(table.description)}: {html.escape(table.equation)}</p>"]
    parts += [f"<p>Note: {html.escape(remark)}</p>" for remark in table.remarks]
    numbers = [(n.name, with_error(n.value, n.error), n.unit, n.description) for n in table.numbers.values()]
    if numbers:
        parts.append(html_table(numbers, ("quantity", "value", "unit", "what it is")))
    drawn = [c for c in table.columns[1:] if not c.endswith("_error") and np.any(np.isfinite(table[c]))]
    if flowlines.is_lines(table):
        parts += _lines(page, table, fields)
    elif plots.is_map(table):
        parts += _map(page, table, [c for c in drawn if c != table.columns[1]])
    elif drawn and len(table[table.columns[0]]) > 1:
        overlaid = lawplots.law_panels(table)
        apart = [c for c in drawn if not any(c in panel.columns for panel in overlaid)]
        draw = [partial(lawplots.measured_with_laws, table, panel) for panel in overlaid] + [partial(plots.table_column, table, c) for c in apart]
        parts.append(page.picture(f"table_{table.name}", panels(draw, 3, (3.9, 2.9)), _table_caption(table)))
    page.add(f"Measured: {table.name.replace('_', ' ')}", *parts)


def _record(path: str) -> dict[str, Any]:
    """What a run took. Raises hdf.ResultError where it is not what `grainvdb run` writes."""
    numbers = {"wall_seconds", "peak_memory_bytes", "frames", "bytes_read", "seconds_by_step"}
    with open(path, encoding="utf-8") as file:
        try:
            record = json.load(file)
        except ValueError as error:
            raise hdf.ResultError(f"{path}: no JSON: {error}; run again, or remove it") from error
    if not isinstance(record, dict) or not numbers <= set(record):
        raise hdf.ResultError(f"{path}: not what `grainvdb run` writes; expected {', '.join(sorted(numbers))}")
    return record


def _run(page: Page, record: Mapping[str, Any]) -> None:
    seconds = record["seconds_by_step"]
    rows = [("time", f"{record['wall_seconds']:.2f} s"), ("memory at most", f"{record['peak_memory_bytes'] / 1e6:.0f} MB"),
            ("read", f"{record['frames']} frames, {record['bytes_read'] / 1e6:.1f} MB")]
    parts = [html_table(rows)]
    if seconds:
        figure = panels([lambda ax: plots.seconds_by_step(seconds, ax)], 1, (7, 0.4 * len(seconds) + 1))
        parts.append(page.picture("run", figure, "Seconds by step of the run; steps overlap."))
    page.add("What the run took", *parts)


def _folders_of_scales(folder: str) -> list[str]:
    """What the section `scales` of a pipeline leaves in an output folder, by ascending cutoff: c0.0024_h4.0e-04, …"""
    found = []
    for name in os.listdir(folder) if os.path.isdir(folder) else []:
        scale = re.fullmatch(r"c([^_]+)_h([^_]+)", name)
        if scale and os.path.isfile(os.path.join(folder, name, "fields.hdf")):
            found.append((float(scale[1]), float(scale[2]), name))
    return [name for *_, name in sorted(found)]


def write_report(folder: str, output: str | None = None, axis: str = "z", cut: str | None = None, at: float | None = None,
                 fitted: tuple[float, float, float, float] | None = None) -> list[str]:
    """Writes report.html and its pictures into `output` (DIR/report unless given) and returns the files. Of several scales
    it compares the profiles; a page of each, with its provenance, is made from its own folder.

    Raises FileNotFoundError when the folder holds no result, and hdf.ResultError for files that are something else.
    """
    have = {name: os.path.isfile(os.path.join(folder, name)) for name in ("fields.hdf", "tracers.h5", "tables.h5", "run.json")}
    at_scales = _folders_of_scales(folder)
    if not any(have[name] for name in ("fields.hdf", "tracers.h5", "tables.h5")) and not at_scales:
        raise FileNotFoundError(f"{folder}: neither fields.hdf nor tracers.h5 nor tables.h5 is there; expected the output folder of `grainvdb run`")
    output = output or os.path.join(folder, "report")
    page = Page(f"grainvdb: {os.path.basename(os.path.abspath(folder))}")
    with contextlib.ExitStack() as stack:
        origin: dict[str, str] = {}
        fields = None
        tables = stack.enter_context(Tables(folder)) if have["tables.h5"] else None
        if at_scales:
            results = {name: stack.enter_context(Fields(os.path.join(folder, name))) for name in at_scales}
            _scales(page, results, axis)
        if have["fields.hdf"]:
            fields = stack.enter_context(Fields(folder))
            origin = fields.provenance
            _overview(page, fields)
            cut = cut or plots.slice_axis(fields)
            index = plots.middle(fields, cut) if at is None else int(np.argmin(np.abs(fields.axis(cut) - at)))
            _slices(page, fields, cut, index)
            _profiles(page, fields, axis)
            _rheology(page, fields, _fitted_laws(tables, fitted))
            _mask(page, fields)
            _field_table(page, fields)
        if have["tracers.h5"]:
            tracers = stack.enter_context(Tracers(folder))
            origin = origin or tracers.provenance
            _tracers(page, tracers)
        if tables:
            origin = origin or tables.provenance
            for table in tables.values():
                _measured(page, table, fields)
        if have["run.json"]:
            _run(page, _record(os.path.join(folder, "run.json")))
        if origin:
            provenance(page, "Provenance", origin)
    return list(write(page, output))


class _Parser(argparse.ArgumentParser):
    """Refuses as the command does: bad usage is exit code 1."""

    def error(self, message: str) -> NoReturn:
        self.exit(1, f"grainvdb: {message}\nRun 'grainvdb report --help' for usage.\n")


def _finite(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"expected a finite number, found '{text}'")
    return value


def main(arguments: Sequence[str] | None = None) -> int:
    parser = _Parser(prog="grainvdb report", description="Makes one self-contained HTML page, and PNG pictures, from a result.",
                                     epilog="Example: grainvdb report output && xdg-open output/report/report.html")
    parser.add_argument("folder", metavar="DIR", help="the output folder of a run, with fields.hdf, tracers.h5 or tables.h5, or a folder for each scale")
    parser.add_argument("--beside", nargs="+", metavar="OTHER", help="other results to set beside this one, in one page")
    parser.add_argument("--label", nargs="+", metavar="NAME", help="what the results are called there, that of DIR first; the names of their folders unless given")
    parser.add_argument("-o", "--output", metavar="DIR", help="where the report goes; DIR/report, or DIR/beside, unless given")
    parser.add_argument("--axis", choices=AXES, default="z", help="axis of the profiles (default: %(default)s)")
    parser.add_argument("--cut", choices=AXES, help="axis across which slices are taken; the one with the fewest voxels unless given")
    parser.add_argument("--at", type=_finite, metavar="X", help="where the slices are taken along that axis; in the fullest layer unless given")
    parser.add_argument("--fitted", type=_finite, nargs=4, metavar=("A", "B", "C", "D"), help="parameters of (A20) to draw beside (3), instead of those in table fluidity")
    options = parser.parse_args(arguments)
    if options.label and len(options.label) != len(options.beside or []) + 1:
        parser.error("--label names each result once: DIR, then those of --beside")
    try:
        if options.beside:
            files = write_comparison([options.folder, *options.beside], options.output, options.label, options.axis, options.cut, options.at)
        else:
            files = write_report(options.folder, options.output, options.axis, options.cut, options.at, options.fitted)
    except (FileNotFoundError, hdf.ResultError) as error:
        print(f"grainvdb: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"grainvdb: {error}", file=sys.stderr)
        return 3
    for path in files:
        print(f"wrote {path}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
