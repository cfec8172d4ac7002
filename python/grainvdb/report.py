"""One self-contained HTML page from a result, with the same pictures as PNG files.

    grainvdb report DIR
    python3 -m grainvdb.report DIR [--output DIR/report]
"""
from __future__ import annotations

import argparse
import base64
import contextlib
import html
import io
import json
import os
import re
import sys
from dataclasses import dataclass, field
from typing import Any, Callable, Iterator

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from . import hdf, plots
from .fields import AXES, Fields
from .tables import Table, Tables
from .tracers import Tracers

#: Fields that say the most come first; every other field follows.
_FIRST = ("phi", "velocity", "temperature", "shear_rate", "pressure", "mu", "inertial_number", "fluidity", "gd_over_dv")
_PROFILE_FIRST = ("phi", "velocity", "temperature", "pressure", "shear_stress", "mu", "shear_rate", "inertial_number", "gd_over_dv")
_MOST_HISTORIES = 12

_STYLE = """
body{font:16px/1.5 system-ui,sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem;color:#222}
h1{font-size:1.6rem;margin-bottom:.2rem} h2{font-size:1.2rem;margin-top:2.2rem;border-bottom:1px solid #ddd}
figure{margin:1rem 0} img{max-width:100%;height:auto} figcaption{color:#555;font-size:.9rem}
table{border-collapse:collapse;margin:.8rem 0} td,th{padding:.2rem .8rem .2rem 0;text-align:left;vertical-align:top;border-bottom:1px solid #eee}
td.n{text-align:right;font-variant-numeric:tabular-nums} pre{background:#f6f6f6;padding:.8rem;overflow:auto;font-size:.8rem}
.wide{overflow-x:auto} nav a{margin-right:1rem}
"""


@dataclass
class _Page:
    """The sections of a report; pictures are kept as PNG bytes, and named for the files."""

    title: str
    sections: list[tuple[str, str]] = field(default_factory=list)
    pictures: dict[str, bytes] = field(default_factory=dict)

    def add(self, heading: str, *parts: str) -> None:
        self.sections.append((heading, "\n".join(parts)))

    def picture(self, name: str, figure: plt.Figure, caption: str) -> str:
        buffer = io.BytesIO()
        figure.savefig(buffer, format="png", dpi=130, metadata={"Software": None})
        plt.close(figure)
        self.pictures[name] = buffer.getvalue()
        data = base64.b64encode(buffer.getvalue()).decode()
        text = html.escape(caption)
        return f'<figure><img alt="{text}" src="data:image/png;base64,{data}"><figcaption>{text}</figcaption></figure>'

    def html(self) -> str:
        links = "".join(f'<a href="#s{k}">{html.escape(h)}</a>' for k, (h, _) in enumerate(self.sections))
        body = "\n".join(f'<h2 id="s{k}">{html.escape(h)}</h2>\n{text}' for k, (h, text) in enumerate(self.sections))
        return (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
                f"<title>{html.escape(self.title)}</title><style>{_STYLE}</style></head>\n"
                f"<body><h1>{html.escape(self.title)}</h1>\n<nav>{links}</nav>\n{body}\n</body></html>\n")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _table(rows: list[tuple[str, ...]], head: tuple[str, ...] = ()) -> str:
    def cell(tag: str, value: str) -> str:
        return f'<{tag}{" class=n" if tag == "td" and _is_number(value) else ""}>{html.escape(value)}</{tag}>'

    lines = ["<tr>" + "".join(cell("th", v) for v in head) + "</tr>"] if head else []
    lines += ["<tr>" + "".join(cell("td", v) for v in row) + "</tr>" for row in rows]
    return '<div class="wide"><table>' + "\n".join(lines) + "</table></div>"


def _panels(draw: list[Callable[[Axes], object]], columns: int, size: tuple[float, float]) -> plt.Figure:
    columns = min(columns, len(draw))
    rows = -(-len(draw) // columns)
    figure, axes = plt.subplots(rows, columns, squeeze=False, figsize=(size[0] * columns, size[1] * rows), layout="constrained")
    for ax in axes.flat[len(draw):]:
        ax.set_visible(False)
    for ax, one in zip(axes.flat, draw):
        one(ax)
    return figure


def _ordered(names: list[str], first: tuple[str, ...]) -> list[str]:
    plain = [n for n in names if not n.endswith("_error") and n != "frames"]
    return [n for n in first if n in plain] + [n for n in plain if n not in first]


def _number(value: float) -> str:
    return f"{value:.4g}"


def _overview(page: _Page, fields: Fields) -> None:
    times = fields.times
    frames = fields.frame_counts
    shape = " × ".join(str(len(fields.axis(a))) for a in AXES)
    unit = fields.unit("x")
    span = "; ".join(f"{a} {_number(fields.axis(a)[0])} … {_number(fields.axis(a)[-1])}" for a in AXES)
    rows = [("output times", f"{len(times)}, of {frames.min()} to {frames.max()} frames" if len(set(frames)) > 1 else f"{len(times)}, of {frames[0]} frames"),
            ("time", f"{_number(times[0])} … {_number(times[-1])} {fields.unit('time')}"),
            ("voxels", f"{shape}, edge {_number(fields.voxel)} {unit}"),
            ("centres", f"{span} {unit}"),
            ("made by", f"grainvdb {fields.provenance.get('version', '?')}")]
    page.add("Overview", _table(rows))


def _field_table(page: _Page, fields: Fields) -> None:
    rows = []
    for name in _ordered(fields.names, _FIRST) + [n for n in fields.names if n.endswith("_error") or n == "frames"]:
        values, _ = plots.scalar(fields, name)
        finite = values[np.isfinite(values)]
        ends = [_number(v) for v in np.percentile(finite, [1, 50, 99])] if finite.size else ["-"] * 3
        reasons = ", ".join(f"{count} {reason.replace('_', ' ')}" for reason, count in fields.undefined(name).items())
        rows.append((name, fields.unit(name), *ends, fields.equation(name), reasons or "-"))
    page.add("Fields", "<p>Of vectors the magnitude, of tensors a third of the trace; percentiles over all voxels with a value, at the last output time.</p>",
             _table(rows, ("field", "unit", "1 %", "median", "99 %", "equation", "voxels without a value")))


def _slices(page: _Page, fields: Fields, axis: str, index: int) -> None:
    names = _ordered(fields.names, _FIRST)
    across, up = [a for a in AXES if a != axis]
    shape = float(np.clip(len(fields.axis(up)) / len(fields.axis(across)), 0.4, 2.2))
    draw = [lambda ax, n=n: plots.field_slice(fields, n, axis, index, ax=ax) for n in names]
    caption = f"Slices at {axis} = {_number(fields.axis(axis)[index])} {fields.unit(axis)}, at the last output time. Colours span the 1st to 99th percentile; blank: no value."
    page.add("Slices", page.picture("slices", _panels(draw, 3, (3.9, 2.5 * shape + 0.9)), caption))


def _profiles(page: _Page, fields: Fields, axis: str) -> None:
    names = _ordered(fields.names, _PROFILE_FIRST)
    draw = [lambda ax, n=n: plots.profile(fields, n, axis, ax=ax) for n in names]
    caption = f"Means over each layer of voxels across {axis}; the band is the spread of the voxels of a layer, bars the standard error over time where it was asked for."
    page.add("Profiles", page.picture("profiles", _panels(draw, 3, (3.6, 3.2)), caption))


def _scales(page: _Page, results: dict[str, Fields], axis: str) -> None:
    first = next(iter(results.values()))
    draw = [lambda ax, n=n: plots.scales(results, n, axis, ax=ax) for n in _ordered(first.names, _PROFILE_FIRST)]
    figure = _panels(draw, 3, (3.6, 3.2))
    figure.axes[0].legend(fontsize="small")
    caption = (f"Means over each layer of voxels across {axis} by cutoff (c) and voxel (h) [{first.unit('x')}]. "
               "Lines that fall together: the field does not depend on the cutoff there.")
    page.add("Scales", page.picture("scales", figure, caption))


def _rheology(page: _Page, fields: Fields, fitted: tuple[float, float, float, float] | None) -> None:
    draw: list[Callable[[Axes], object]] = []
    said = []
    if "phi" in fields and "gd_over_dv" in fields:
        draw.append(lambda ax: plots.fluidity_against_phi(fields, fitted=fitted, ax=ax))
        said.append("left: granular fluidity in dimensionless form against packing fraction, with the law (3) for friction 0.4")
    if "mu" in fields and "inertial_number" in fields:
        draw.append(lambda ax: plots.friction_against_inertial(fields, ax=ax))
        said.append("stress ratio against inertial number, with μ(I) of common parameters")
    if draw:
        caption = "; ".join(said) + ". A point per voxel; the laws are drawn to compare with, not fitted" + (", but for the dashed one." if fitted else ".")
        page.add("Rheology", page.picture("rheology", _panels(draw, 2, (5.4, 4)), caption))


def _mask(page: _Page, fields: Fields) -> None:
    if not fields.reasons:
        return
    figure = _panels([lambda ax: plots.mask_reasons(fields, ax=ax)], 1, (7, 2.8))
    rows = [(r.name.replace("_", " "), r.meaning) for r in fields.reasons if np.any(fields.mask(-1) & r.flag) and r.name != "outside"]
    page.add("Where fields have no value", page.picture("mask", figure, "Voxels by the reason that the mask gives."),
             _table(rows, ("reason", "meaning")))


def _tracers(page: _Page, tracers: Tracers) -> None:
    names = [n for n in tracers.names if n != "displacement"][:_MOST_HISTORIES]
    paths = _panels([lambda ax: plots.tracer_paths(tracers, ax)], 1, (6.5, 5.5))
    stopped = tracers.stop[-1]
    rows = [(name.replace("_", " "), str(int(np.count_nonzero(stopped == code)))) for code, name in tracers.stop_names.items()]
    parts = [_table(rows, ("at the end", "tracers")),
             page.picture("tracer_paths", paths, "Paths from the seeds (dots).")]
    if names:
        histories = _panels([lambda ax, n=n: plots.tracer_history(tracers, n, ax) for n in names], 3, (3.9, 2.9))
        parts.append(page.picture("tracer_histories", histories, "What was recorded along the paths: every tracer thin, the median thick."))
    page.add("Tracers", *parts)


def _with_error(value: float, error: float) -> str:
    return _number(value) if np.isnan(error) else f"{_number(value)} ± {_number(error)}"


def _measured(page: _Page, table: Table) -> None:
    parts = [f"<p>{html.escape(table.description)}: {html.escape(table.equation)}</p>"]
    parts += [f"<p>Note: {html.escape(remark)}</p>" for remark in table.remarks]
    numbers = [(n.name, _with_error(n.value, n.error), n.unit, n.description) for n in table.numbers.values()]
    if numbers:
        parts.append(_table(numbers, ("quantity", "value", "unit", "what it is")))
    drawn = [c for c in table.columns[1:] if not c.endswith("_error") and np.any(np.isfinite(table[c]))]
    if drawn and len(table[table.columns[0]]) > 1:
        draw = [lambda ax, c=c: plots.table_column(table, c, ax) for c in drawn]
        parts.append(page.picture(f"table_{table.name}", _panels(draw, 3, (3.9, 2.9)), f"Table {table.name}; bars are standard errors."))
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


def _run(page: _Page, record: dict[str, Any]) -> None:
    seconds = record["seconds_by_step"]
    rows = [("time", f"{record['wall_seconds']:.2f} s"), ("memory at most", f"{record['peak_memory_bytes'] / 1e6:.0f} MB"),
            ("read", f"{record['frames']} frames, {record['bytes_read'] / 1e6:.1f} MB")]
    parts = [_table(rows)]
    if seconds:
        figure = _panels([lambda ax: plots.seconds_by_step(seconds, ax)], 1, (7, 0.4 * len(seconds) + 1))
        parts.append(page.picture("run", figure, "Seconds by step of the run; steps overlap."))
    page.add("What the run took", *parts)


def _provenance(page: _Page, provenance: dict[str, str]) -> None:
    parts = [f"<details{' open' if key == 'pipeline' else ''}><summary>{html.escape(key.replace('_', ' '))}</summary><pre>{html.escape(value)}</pre></details>"
             for key, value in sorted(provenance.items(), key=lambda item: (item[0] != "pipeline", item[0])) if value.strip()]
    page.add("Provenance", *parts)


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
    page = _Page(f"grainvdb: {os.path.basename(os.path.abspath(folder))}")
    with contextlib.ExitStack() as stack:
        provenance: dict[str, str] = {}
        if at_scales:
            results = {name: stack.enter_context(Fields(os.path.join(folder, name))) for name in at_scales}
            _scales(page, results, axis)
        if have["fields.hdf"]:
            fields = stack.enter_context(Fields(folder))
            provenance = fields.provenance
            _overview(page, fields)
            cut = cut or plots.slice_axis(fields)
            index = plots.middle(fields, cut) if at is None else int(np.argmin(np.abs(fields.axis(cut) - at)))
            _slices(page, fields, cut, index)
            _profiles(page, fields, axis)
            _rheology(page, fields, fitted)
            _mask(page, fields)
            _field_table(page, fields)
        if have["tracers.h5"]:
            tracers = stack.enter_context(Tracers(folder))
            provenance = provenance or tracers.provenance
            _tracers(page, tracers)
        if have["tables.h5"]:
            tables = stack.enter_context(Tables(folder))
            provenance = provenance or tables.provenance
            for table in tables.values():
                _measured(page, table)
        if have["run.json"]:
            _run(page, _record(os.path.join(folder, "run.json")))
        if provenance:
            _provenance(page, provenance)
    return list(_write(page, output))


def _write(page: _Page, output: str) -> Iterator[str]:
    os.makedirs(output, exist_ok=True)
    contents = {f"{name}.png": data for name, data in page.pictures.items()} | {"report.html": page.html().encode()}
    for name, data in contents.items():
        path = os.path.join(output, name)
        with open(path + ".tmp", "wb") as file:
            file.write(data)
        os.replace(path + ".tmp", path)
        yield path


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="grainvdb report", description="Makes one self-contained HTML page, and PNG pictures, from a result.",
                                     epilog="Example: grainvdb report output && xdg-open output/report/report.html")
    parser.add_argument("folder", metavar="DIR", help="the output folder of a run, with fields.hdf, tracers.h5 or tables.h5, or a folder for each scale")
    parser.add_argument("-o", "--output", metavar="DIR", help="where the report goes; DIR/report unless given")
    parser.add_argument("--axis", choices=AXES, default="z", help="axis of the profiles (default: %(default)s)")
    parser.add_argument("--cut", choices=AXES, help="axis across which slices are taken; the one with the fewest voxels unless given")
    parser.add_argument("--at", type=float, metavar="X", help="where the slices are taken along that axis; in the fullest layer unless given")
    parser.add_argument("--fitted", type=float, nargs=4, metavar=("A", "B", "C", "D"), help="parameters of (A20) to draw beside (3)")
    options = parser.parse_args(arguments)
    try:
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
