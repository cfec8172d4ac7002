"""The picture of `grainvdb tune`: error against time of every setting that was tried, a panel per field.

    python3 -m grainvdb.tune tune.csv tune.png"""
from __future__ import annotations

import argparse
import csv
import math
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
from matplotlib.axes import Axes

Row = dict[str, str]


def read(path: str | Path) -> list[Row]:
    """The rows of tune.csv, one per setting and field."""
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def knob(row: Row) -> str:
    """What a setting changes: a key's last part, "several", or "as it is"."""
    keys = [part.split("=")[0].split(".") for part in row["setting"].split()]
    if not keys:
        return "as it is"
    profile = all(key[0] == "measure" for key in keys)  # one measurement in place of another
    return "several" if len(keys) > 1 and not profile else ".".join(keys[0][-2:])


def front(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The (time, error) points to which no other is both faster and closer, by time."""
    best, kept = math.inf, []
    for seconds, error in sorted(points):
        if error < best:
            best = error
            kept.append((seconds, error))
    return kept


def panel(rows: list[Row], field: str, colours: dict[str, object], ax: Axes) -> Axes:
    """Error against time of one field, with the front, the current setting, the proposed one and the tolerance."""
    mine = [r for r in rows if r["field"] == field and int(r["points"]) > 0 and math.isfinite(float(r["rms"]))]
    for row in mine:
        best, worst, error = (float(row[k]) for k in ("best_seconds", "worst_seconds", "rms"))
        ax.errorbar(best, error, xerr=[[0], [worst - best]], fmt="o", markersize=4, linewidth=0.8, color=colours[knob(row)])
        if row["current"] == "1":
            ax.plot(best, error, "*", markersize=13, color="black", zorder=3)
        if row["proposed"] == "1":
            ax.plot(best, error, "o", markersize=12, fillstyle="none", color="black", zorder=3)
    steps = front([(float(r["best_seconds"]), float(r["rms"])) for r in mine])
    if steps:
        ax.step(*zip(*steps), where="post", color="0.6", linewidth=1, zorder=0)
    tolerance = next((float(r["tolerance"]) for r in mine if r["tolerance"]), None)
    if tolerance:
        ax.axhline(tolerance, color="black", linestyle=":", linewidth=1)
    positive = any(float(r["rms"]) > 0 for r in mine)
    unit = "rms distance [d]" if field == "position" else "relative error"
    ax.set(title=field, xlabel="time [s]", ylabel=unit, xscale="log", yscale="log" if positive else "linear")
    ax.grid(alpha=0.3)
    return ax


def draw(rows: list[Row], most_panels: int = 12) -> matplotlib.figure.Figure:
    """All fields, those with a tolerance first."""
    order = {row["field"]: row["tolerance"] == "" for row in rows}
    fields = sorted(order, key=lambda field: order[field])[:most_panels]
    knobs = list(dict.fromkeys(knob(row) for row in rows))  # the current setting's comes first
    palette = matplotlib.colormaps["tab20"]
    colours = {name: palette((2 * k + k // 10) % 20) for k, name in enumerate(knobs)}
    columns = min(3, len(fields))
    lines = -(-len(fields) // columns)
    figure, panels = plt.subplots(lines, columns, squeeze=False, figsize=(4.2 * columns, 3.2 * lines + 0.8),
                                  layout="constrained")
    for ax in panels.flat[len(fields):]:
        ax.set_visible(False)
    for ax, field in zip(panels.flat, fields):
        panel(rows, field, colours, ax)
    handles = [plt.Line2D([], [], marker="o", linestyle="", color=colours[name], label=name) for name in knobs[1:]]
    handles.append(plt.Line2D([], [], marker="*", markersize=11, linestyle="", color="black", label="current setting"))
    if any(row["proposed"] == "1" for row in rows):
        handles.append(plt.Line2D([], [], marker="o", markersize=10, fillstyle="none", linestyle="", color="black",
                                  label="proposed"))
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0), ncols=4, fontsize="small")
    return figure


def main() -> None:
    parser = argparse.ArgumentParser(prog="python3 -m grainvdb.tune", description=__doc__.splitlines()[0])
    parser.add_argument("table", help="tune.csv")
    parser.add_argument("picture", help="what to write: .png, .pdf or .svg")
    arguments = parser.parse_args()
    matplotlib.use("Agg")
    draw(read(arguments.table)).savefig(arguments.picture, dpi=130, bbox_inches="tight")
    print("wrote", arguments.picture)


if __name__ == "__main__":
    main()
