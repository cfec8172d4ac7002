"""Pictures of results. Every function draws into axes that it is given or makes, and returns them."""
from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from . import laws
from .arrays import Array
from .collapse import Collapse, collapse
from .fields import AXES, Fields
from .tables import Table
from .tracers import Tracers

# Fields of three numbers that are no vector in space.
TRIPLES = ("principal_stress",)
# Two unit vectors in one field.
SLIP_LINES = "slip_lines"
# Part of the packing fraction inside below which a voxel is taken for one at a smeared edge.
SMEARED = 0.8


def label(name: str, unit: str) -> str:
    """A name for people: `gd_over_dv`, `1` gives `gd over dv`; `phi_error` keeps its unit."""
    words = name.replace("_", " ")
    return words if unit in ("", "1") else f"{words} [{unit}]"


def scalar(fields: Fields, name: str, time: int = -1) -> tuple[Array, str]:
    """A field as one number per voxel with its label: the magnitude of a vector, a third of the trace of a tensor, the
    most compressive principal stress, the angle between slip lines in degrees."""
    values = fields.values(name, time).astype(float)
    unit = fields.unit(name)
    if values.ndim == 3:
        return values, label(name, unit)
    if values.shape[3] == 9:
        return values[..., [0, 4, 8]].mean(axis=3), label(f"mean {name}", unit)
    if name in TRIPLES:
        return values[..., 2], label(f"{name} 3", unit)
    if name == SLIP_LINES:
        cosine = np.clip((values[..., :3] * values[..., 3:]).sum(axis=3), -1, 1)
        return np.degrees(np.arccos(np.abs(cosine))), "angle between slip lines [degrees]"
    return np.linalg.norm(values[..., :3], axis=3), label(f"|{name}|", unit)


def slice_axis(fields: Fields) -> str:
    """The axis to cut: that with the fewest voxels, y where several have."""
    return min("yxz", key=lambda axis: len(fields.axis(axis)))


def middle(fields: Fields, axis: str) -> int:
    """The layer to cut at: the fullest one by phi, else the middle."""
    if "phi" in fields:
        phi = fields.values("phi", -1)
        others = tuple(k for k, name in enumerate("zyx") if name != axis)
        filled = np.nansum(phi, axis=others)
        best = np.flatnonzero(filled > 0.98 * filled.max())
        return int(best[len(best) // 2])
    return len(fields.axis(axis)) // 2


def colours(*values: Array) -> dict[str, object]:
    """A colour map with its ends that suits several pictures together: from their 1st to their 99th percentile, about
    zero where they have either sign."""
    finite = np.concatenate([np.ma.masked_invalid(v).compressed() for v in values])
    low, high = np.percentile(finite, [1, 99]) if finite.size else (0.0, 1.0)
    if not low < 0 < high:
        return {"cmap": "viridis", "vmin": low, "vmax": high}
    bound = max(abs(low), abs(high))
    return {"cmap": "RdBu_r", "vmin": -bound, "vmax": bound}


def layer(fields: Fields, name: str, axis: str, index: int, time: int = -1) -> Array:
    """One layer of voxels across an axis as one number per voxel, rows upwards."""
    return _layer_of(scalar(fields, name, time)[0], axis, index)


def _layer_of(values: Array, axis: str, index: int) -> Array:
    return np.take(values, index, axis=2 - AXES.index(axis))


def field_slice(fields: Fields, name: str, axis: str | None = None, index: int | None = None, time: int = -1,
                ax: Axes | None = None, scale: Mapping[str, object] | None = None) -> Axes:
    """One layer of voxels as a picture, with arrows for vectors; blank where the field is undefined. `scale` is that of
    `colours`, its own unless given."""
    axis = axis or slice_axis(fields)
    index = middle(fields, axis) if index is None else index
    ax = ax or plt.subplots()[1]
    across, up = [a for a in AXES if a != axis]
    values, text = scalar(fields, name, time)
    shown = np.ma.masked_invalid(_layer_of(values, axis, index))
    half = fields.voxel / 2
    ends = [fields.axis(a)[k] + s * half for a in (across, up) for k, s in ((0, -1), (-1, 1))]
    image = ax.imshow(shown, origin="lower", extent=ends, aspect="equal", interpolation="nearest", **(scale or colours(shown)))
    ax.figure.colorbar(image, ax=ax, shrink=0.85)
    vectors = fields.values(name, time)
    if vectors.ndim == 4 and vectors.shape[3] == 3 and name not in TRIPLES:
        _arrows(fields, ax, np.take(vectors, index, axis=2 - AXES.index(axis)), across, up)
    if name == SLIP_LINES:
        _dashes(fields, ax, np.take(vectors, index, axis=2 - AXES.index(axis)), across, up)
    ax.set(xlabel=label(across, fields.unit(across)), ylabel=label(up, fields.unit(up)), title=text)
    return ax


def _arrows(fields: Fields, ax: Axes, vectors: Array, across: str, up: str) -> None:
    step = max(1, max(vectors.shape[:2]) // 14)
    part = vectors[step // 2::step, step // 2::step]
    ax.quiver(fields.axis(across)[step // 2::step], fields.axis(up)[step // 2::step], part[..., AXES.index(across)],
              part[..., AXES.index(up)], color="white", pivot="middle", width=0.006)


def _dashes(fields: Fields, ax: Axes, vectors: Array, across: str, up: str) -> None:
    """Both families of slip lines as far as they lie in the plane, without heads: they have no sense."""
    step = max(1, max(vectors.shape[:2]) // 14)
    part = vectors[step // 2::step, step // 2::step]
    for first, colour in ((0, "white"), (3, "orange")):
        ax.quiver(fields.axis(across)[step // 2::step], fields.axis(up)[step // 2::step], part[..., first + AXES.index(across)],
                  part[..., first + AXES.index(up)], color=colour, pivot="middle", width=0.006, headwidth=0, headlength=0, headaxislength=0,
                  angles="xy", scale_units="xy", scale=1 / (0.8 * step * fields.voxel))


def _layers(values: Array, axis: str) -> tuple[Array, Array]:
    """Mean and standard deviation of the values in each layer of voxels across an axis; NaN where there are none."""
    others = tuple(k for k, other in enumerate("zyx") if other != axis)
    layers = np.ma.masked_invalid(values)
    return layers.mean(axis=others).filled(np.nan), layers.std(axis=others).filled(np.nan)


def scalar_error(fields: Fields, name: str, time: int = -1) -> Array | None:
    """The standard error of what `scalar` gives, from `<name>_error`, None where the result has no such field. Components
    are taken as uncorrelated: of a magnitude |u| it is sqrt(Σ (u_i/|u|)² e_i²), of a third of the trace sqrt(Σ e_ii²)/3."""
    if f"{name}_error" not in fields:
        return None
    errors = fields.values(f"{name}_error", time).astype(float)
    if errors.ndim == 3:
        return errors
    if errors.shape[3] == 9:
        return np.linalg.norm(errors[..., [0, 4, 8]], axis=3) / 3
    if name in TRIPLES:
        return errors[..., 2]
    vectors = fields.values(name, time).astype(float)[..., :3]
    magnitude = np.linalg.norm(vectors, axis=3)
    magnitude[magnitude == 0] = np.nan  # has no direction, and so no error to first order
    return np.linalg.norm(vectors * errors[..., :3], axis=3) / magnitude


def error_bars(values: Array, errors: Array | None) -> Array | None:
    """The errors for `Axes.errorbar`; None where no value has one, of which matplotlib would warn."""
    return errors if errors is not None and np.any(np.isfinite(values) & np.isfinite(errors)) else None


def profile(fields: Fields, name: str, axis: str = "z", time: int = -1, ax: Axes | None = None) -> Axes:
    """The mean over each layer across an axis, with the spread of the voxels as a band and, where the result has
    `<name>_error`, the standard error of the mean as bars (`scalar_error`; the errors of neighbouring voxels taken as one)."""
    ax = ax or plt.subplots()[1]
    values, text = scalar(fields, name, time)
    mean, spread = _layers(values, axis)
    at = fields.axis(axis)
    ax.fill_betweenx(at, mean - spread, mean + spread, alpha=0.2, linewidth=0)
    errors = scalar_error(fields, name, time)
    ends = error_bars(mean, None if errors is None else _layers(errors, axis)[0])
    ax.errorbar(mean, at, xerr=ends, fmt="o-", markersize=3, linewidth=1, capsize=2)
    ax.set(xlabel=text, ylabel=label(axis, fields.unit(axis)))
    ax.grid(alpha=0.3)
    return ax


def scales(results: Mapping[str, Fields], name: str, axis: str = "z", time: int = -1, ax: Axes | None = None) -> Axes:
    """The mean over each layer across an axis, from results of several cutoffs and voxels by their names. Where the lines fall
    together the field does not depend on the cutoff."""
    ax = ax or plt.subplots()[1]
    for scale, fields in results.items():
        values, text = scalar(fields, name, time)
        mean, _ = _layers(values, axis)
        ax.plot(mean, fields.axis(axis), "o-", markersize=2, linewidth=1, label=scale)
        ax.set(xlabel=text, ylabel=label(axis, fields.unit(axis)))
    ax.grid(alpha=0.3)
    return ax


def against(fields: Fields, x: str, y: str, time: int = -1, ax: Axes | None = None, where: Array | None = None) -> Axes:
    """One field against another, a point per voxel where both are defined, and `where` they count, coloured by height."""
    ax = ax or plt.subplots()[1]
    (a, x_label), (b, y_label) = scalar(fields, x, time), scalar(fields, y, time)
    height = np.broadcast_to(fields.axis("z")[:, None, None], a.shape)
    both = np.isfinite(a) & np.isfinite(b)
    if where is not None:
        both &= where
    points = ax.scatter(a[both], b[both], c=height[both], s=4, linewidth=0, alpha=0.6, rasterized=True)
    ax.figure.colorbar(points, ax=ax, label=label("z", fields.unit("z")))
    if both.any():
        low, high = np.percentile(b[both], [0.5, 99.5])
        ax.set_ylim(min(0.0, low), high * 1.1 if high > 0 else None)
    ax.set(xlabel=x_label, ylabel=y_label)
    ax.grid(alpha=0.3)
    return ax


def smeared_below(fields: Fields, time: int = -1) -> float:
    """The packing fraction below which a voxel is taken to lie where the kernel smears the edge of the material: `SMEARED`
    of the 90th percentile over the voxels with material; 0 in a result without φ, or without material."""
    phi = fields.values("phi", time) if "phi" in fields else np.zeros(1)
    filled = phi[phi > 0]
    return SMEARED * float(np.percentile(filled, 90)) if filled.size else 0.0


def inside(fields: Fields, time: int = -1) -> Array | None:
    """Which voxels do not lie at smeared edges; None in a result without φ, of which nobody knows."""
    return fields.values("phi", time) >= smeared_below(fields, time) if "phi" in fields else None


@dataclasses.dataclass(frozen=True)
class Fit:
    """Parameters of a law, and how its line is drawn and called."""

    parameters: tuple[float, ...]
    text: str
    colour: str = "red"


def fluidity_laws(ax: Axes, fits: Sequence[Fit]) -> None:
    """The law (3), solid, and fits of (A20), dashed, over the span of φ of a panel of g d/δv."""
    low, high = ax.get_xlim()
    phi = np.linspace(low, high, 400)
    ax.plot(phi, laws.fluidity(phi, *laws.FLUIDITY_3), "k-", linewidth=1.2, label="(3)")
    for fit in fits:
        ax.plot(phi, laws.fluidity(phi, *fit.parameters), "--", color=fit.colour, linewidth=1.2, label=fit.text)
    top = np.nanmax([ax.get_ylim()[1], 2.2])
    ax.set(xlim=(low, high), ylim=(0, top), xlabel="φ", ylabel="g d/δv")
    ax.legend()


def friction_laws(ax: Axes, span: tuple[float, float] | None, fits: Sequence[Fit]) -> None:
    """μ(I) of common parameters, solid, and fitted ones, dashed, over a span of I in a panel of μ; none where there is no span."""
    if span:
        inertial = np.geomspace(*span, 200)
        ax.plot(inertial, laws.friction(inertial, *laws.INERTIAL), "k-", linewidth=1.2, label=laws.friction_text(*laws.INERTIAL))
        for fit in fits:
            ax.plot(inertial, laws.friction(inertial, *fit.parameters), "--", color=fit.colour, linewidth=1.2, label=fit.text)
        ax.set(xscale="log", xlim=span)
        ax.legend()
    ax.set(xlabel="inertial number I", ylabel="μ")


def inertial_span(fields: Fields, time: int = -1) -> tuple[float, float] | None:
    """From the first percentile to the greatest inertial number above 0 away from smeared edges; None where there is none."""
    values = fields.values("inertial_number", time)
    there = inside(fields, time)
    positive = values[np.isfinite(values) & (values > 0) & (True if there is None else there)]
    if not positive.size:
        return None
    low, high = np.percentile(positive, [1, 100])
    return float(low), float(high)


def fluidity_against_phi(fields: Fields, time: int = -1, ax: Axes | None = None,
                         fitted: tuple[float, ...] | None = None) -> Axes:
    """g d/δv against φ away from smeared edges, with the law (3) and, when given, fitted parameters of (A20)."""
    ax = against(fields, "phi", "gd_over_dv", time, ax, inside(fields, time))
    fluidity_laws(ax, [Fit(fitted, "(A20), fitted")] if fitted else [])
    return ax


def friction_against_inertial(fields: Fields, time: int = -1, ax: Axes | None = None,
                              fitted: tuple[float, ...] | None = None) -> Axes:
    """μ against I away from smeared edges, with the law μ(I) of common and, when given, of fitted parameters."""
    ax = against(fields, "inertial_number", "mu", time, ax, inside(fields, time))
    friction_laws(ax, inertial_span(fields, time), [Fit(fitted, "fitted: " + laws.friction_text(*fitted))] if fitted else [])
    return ax


def _bars(ax: Axes, numbers: Mapping[str, float], style: str, xlabel: str) -> Axes:
    """A bar for each number, the first on top."""
    bars = ax.barh(list(numbers)[::-1], list(numbers.values())[::-1], color="0.5")
    ax.bar_label(bars, fmt=style, padding=3)
    ax.set(xlabel=xlabel)
    ax.margins(x=0.15)
    return ax


def mask_reasons(fields: Fields, time: int = -1, ax: Axes | None = None) -> Axes:
    """How many voxels carry each reason of the mask."""
    ax = ax or plt.subplots()[1]
    flags = fields.mask(time)
    counts = [(r.name.replace("_", " "), int(np.count_nonzero(flags & r.flag))) for r in fields.reasons if r.name != "outside"]
    counts = [(name, count) for name, count in counts if count]
    if not counts:
        ax.text(0.5, 0.5, "every field has a value wherever there is material", ha="center", va="center")
        ax.set_axis_off()
        return ax
    return _bars(ax, dict(counts), "%d", "voxels")


def seconds_by_step(seconds: Mapping[str, float], ax: Axes | None = None) -> Axes:
    """How long the steps of a run took [s], as `run.json` has them; steps overlap."""
    ax = ax or plt.subplots()[1]
    return _bars(ax, seconds, "%.3g", "time [s]")


def tracer_paths(tracers: Tracers, ax: Axes | None = None, across: str = "x", up: str = "z", colour: str = "strain") -> Axes:
    """Paths of tracers, coloured by what was recorded along them."""
    ax = ax or plt.subplots()[1]
    position = tracers.positions()
    moving = tracers.moving
    a, b = (np.where(moving, position[..., AXES.index(axis)], np.nan) for axis in (across, up))
    ax.plot(a, b, color="0.8", linewidth=0.6, zorder=1)
    if colour in tracers.names and tracers.values(colour).ndim == 2:
        points = ax.scatter(a, b, c=tracers.values(colour), s=5, linewidth=0, zorder=2)
        ax.figure.colorbar(points, ax=ax, label=label(colour, tracers.unit(colour)))
    ax.plot(a[0], b[0], "k.", markersize=3, zorder=3)
    ax.set(xlabel=label(across, tracers.unit("position")), ylabel=label(up, tracers.unit("position")), aspect="equal")
    return ax


def tracer_history(tracers: Tracers, name: str, ax: Axes | None = None) -> Axes:
    """What was recorded against time: every tracer thin, the median thick."""
    ax = ax or plt.subplots()[1]
    values = tracers.values(name).astype(float)
    if values.ndim == 3:
        values = np.linalg.norm(values, axis=2)
    values = np.where(tracers.moving, values, np.nan)
    ax.plot(tracers.times, values, color="0.75", linewidth=0.5)
    some = np.isfinite(values).any(axis=1)
    ax.plot(tracers.times[some], np.nanmedian(values[some], axis=1), "k-", linewidth=1.5)
    ax.set(xlabel=label("time", tracers.time_unit), ylabel=label(name, tracers.unit(name)))
    ax.grid(alpha=0.3)
    return ax


def tracer_against(tracers: Tracers, x: str, y: str, where: Array | None = None, ax: Axes | None = None,
                   bins: int = 25) -> tuple[Axes, Collapse]:
    """One recorded quantity against another along the ways of tracers, `where` they count, with the mean of each bin and the
    scatter about it."""
    ax = ax or plt.subplots()[1]
    counts = tracers.moving if where is None else tracers.moving & where
    a, b = (np.where(counts, tracers.values(name), np.nan).astype(float) for name in (x, y))
    found = collapse(a, b, bins)
    ax.plot(a, b, color="0.8", linewidth=0.3, rasterized=True)
    ax.plot(found.centres, found.means, "k.-", linewidth=1.2)
    low, high = np.nanpercentile(b, [0.2, 99.8])
    ax.set(xlabel=label(x, tracers.unit(x)), ylabel=label(y, tracers.unit(y)), xlim=np.nanpercentile(a, [0, 99.5]),
           ylim=(low - 0.05 * (high - low), high + 0.05 * (high - low)),
           title=f"scatter/spread = {found.share:.2f}")
    ax.grid(alpha=0.3)
    return ax, found


def table_column(table: Table, name: str, ax: Axes | None = None) -> Axes:
    """A column of a table against its first, with error bars where there is a column of its name and `_error`; joined by
    lines where the first column ascends."""
    ax = ax or plt.subplots()[1]
    first = table.columns[0]
    error = f"{name}_error"
    ends = error_bars(table[name], table[error] if error in table.columns else None)
    joined = ".-" if np.all(np.diff(table[first]) > 0) else "."
    ax.errorbar(table[first], table[name], yerr=ends, fmt=joined, ms=4, lw=0.8, elinewidth=0.8)
    ax.set_xlabel(label(first, table.unit(first)))
    ax.set_ylabel(label(name, table.unit(name)))
    return ax


def is_map(table: Table) -> bool:
    """Whether the first two columns are the places of a plane: each once, at even distances along both."""
    if len(table.columns) < 3:
        return False
    first, second = table.columns[:2]
    places = set(zip(table[first], table[second]))
    sides = [np.unique(table[c]) for c in (first, second)]
    steps = [np.diff(side) / np.diff(side).min() for side in sides if len(side) > 1]
    even = len(steps) == 2 and all(np.allclose(step, np.rint(step), rtol=0, atol=1e-3) for step in steps)
    return even and table.unit(first) == table.unit(second) and len(places) == len(table[first]) > max(map(len, sides))


def table_map(table: Table, name: str, ax: Axes | None = None, scale: Mapping[str, object] | None = None) -> Axes:
    """A column of a table of places (`is_map`) as a picture; blank where there is none."""
    ax = ax or plt.subplots()[1]
    first, second = table.columns[:2]
    steps = [np.diff(np.unique(table[c])).min() for c in (first, second)]
    at = [np.rint((table[c] - table[c].min()) / step).astype(int) for c, step in zip((first, second), steps)]
    shown = np.full([at[1].max() + 1, at[0].max() + 1], np.nan)
    shown[at[1], at[0]] = table[name]
    ends = [end for c, step in zip((first, second), steps) for end in (table[c].min() - step / 2, table[c].max() + step / 2)]
    image = ax.imshow(np.ma.masked_invalid(shown), origin="lower", extent=ends, aspect="equal", interpolation="nearest",
                      **(scale or colours(shown)))
    ax.figure.colorbar(image, ax=ax, shrink=0.85)
    ax.set(xlabel=label(first, table.unit(first)), ylabel=label(second, table.unit(second)), title=label(name, table.unit(name)))
    return ax
