"""A page under construction: sections, tables and pictures, in one self-contained HTML file."""
from __future__ import annotations

import base64
import html
import io
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Callable, Iterator

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

#: Draws one panel of a picture.
Draw = Callable[[Axes], object]

#: Fields that say the most come first; every other field follows.
FIELDS_FIRST = ("phi", "velocity", "temperature", "shear_rate", "pressure", "mu", "inertial_number", "fluidity", "gd_over_dv")
PROFILES_FIRST = ("phi", "velocity", "temperature", "pressure", "shear_stress", "mu", "shear_rate", "inertial_number", "gd_over_dv")

_STYLE = """
body{font:16px/1.5 system-ui,sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem;color:#222}
h1{font-size:1.6rem;margin-bottom:.2rem} h2{font-size:1.2rem;margin-top:2.2rem;border-bottom:1px solid #ddd}
figure{margin:1rem 0} img{max-width:100%;height:auto} figcaption{color:#555;font-size:.9rem}
table{border-collapse:collapse;margin:.8rem 0} td,th{padding:.2rem .8rem .2rem 0;text-align:left;vertical-align:top;border-bottom:1px solid #eee}
td.n{text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums} td.long{min-width:12rem} pre{background:#f6f6f6;padding:.8rem;overflow:auto;font-size:.8rem}
.wide{overflow-x:auto} nav a{margin-right:1rem}
"""


@dataclass
class Page:
    """The sections of a report; pictures are kept as PNG bytes, and named for the files."""

    title: str
    sections: list[tuple[str, str]] = field(default_factory=list)
    pictures: dict[str, bytes] = field(default_factory=dict)

    def add(self, heading: str, *parts: str) -> None:
        self.sections.append((heading, "\n".join(parts)))

    def picture(self, name: str, figure: plt.Figure, caption: str) -> str:
        buffer = io.BytesIO()
        figure.savefig(buffer, format="png", dpi=130, bbox_inches="tight", metadata={"Software": None})
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
    """Also of a number with its error."""
    try:
        for part in text.split(" ± "):
            float(part)
    except ValueError:
        return False
    return True


def _class(text: str) -> str:
    if _is_number(text):
        return " class=n"
    return " class=long" if len(text) > 30 else ""


def html_table(rows: Sequence[tuple[str, ...]], head: Sequence[str] = ()) -> str:
    def cell(tag: str, value: str) -> str:
        return f"<{tag}{_class(value) if tag == 'td' else ''}>{html.escape(value)}</{tag}>"

    lines = ["<tr>" + "".join(cell("th", v) for v in head) + "</tr>"] if head else []
    lines += ["<tr>" + "".join(cell("td", v) for v in row) + "</tr>" for row in rows]
    return '<div class="wide"><table>' + "\n".join(lines) + "</table></div>"


def panels(draw: Sequence[Draw], columns: int, size: tuple[float, float]) -> plt.Figure:
    columns = min(columns, len(draw))
    rows = -(-len(draw) // columns)
    figure, axes = plt.subplots(rows, columns, squeeze=False, figsize=(size[0] * columns, size[1] * rows), layout="constrained")
    for ax in axes.flat[len(draw):]:
        ax.set_visible(False)
    for ax, one in zip(axes.flat, draw):
        one(ax)
    return figure


def plane_size(sides: Sequence[tuple[float, float]], width: float = 4.2) -> tuple[float, float]:
    """Of one panel with a colour bar that shows a plane, which spans these places across and up."""
    across, up = (high - low for low, high in sides)
    return width, float(np.clip(0.76 * width * up / across, 0.38 * width, 1.67 * width)) + 0.7


def number(value: float) -> str:
    return f"{value:.4g}"


def with_error(value: float, error: float) -> str:
    return number(value) if np.isnan(error) else f"{number(value)} ± {error:.2g}"


def ordered(names: Sequence[str], first: Sequence[str]) -> list[str]:
    """Of fields: those that say the most first; errors and counts of frames not at all."""
    plain = [n for n in names if not n.endswith("_error") and n != "frames"]
    return [n for n in first if n in plain] + [n for n in plain if n not in first]


def provenance(page: Page, heading: str, texts: Mapping[str, str]) -> None:
    """A section with what a result was made from, the pipeline first."""
    parts = [f"<details{' open' if key == 'pipeline' else ''}><summary>{html.escape(key.replace('_', ' '))}</summary><pre>{html.escape(value)}</pre></details>"
             for key, value in sorted(texts.items(), key=lambda item: (item[0] != "pipeline", item[0])) if value.strip()]
    page.add(heading, *parts)


def write(page: Page, output: str) -> Iterator[str]:
    os.makedirs(output, exist_ok=True)
    contents = {f"{name}.png": data for name, data in page.pictures.items()} | {"report.html": page.html().encode()}
    for name, data in contents.items():
        path = os.path.join(output, name)
        with open(path + ".tmp", "wb") as file:
            file.write(data)
        os.replace(path + ".tmp", path)
        yield path
