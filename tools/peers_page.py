"""The tables and the chart of docs/peers.md, from the figures in docs/peers.json."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from accuracy_runs import write_between

FIELDS = {"phi": "φ", "momentum": "ρu", "flux": "Σ m v² W", "contact_stress": "contact stress", "kinetic_stress": "kinetic stress"}
PROGRAMS = ["grainvdb", "grainvdb, double", "MercuryCG", "NDDEM, Lucy3D", "NDDEM, Lucy3DFancyInt"]


def table(head, rows):
    return "\n".join("| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *rows])


def values_table(figures):
    cell = lambda found: f"{found[0]:.1e}, {found[1]:.1e}" if found else "-"
    columns = [name for name in PROGRAMS if name in figures]
    rows = [[title, *(cell(figures[name].get(field)) for name in columns)] for field, title in FIELDS.items()]
    return table(["rms, largest", *columns], rows)


def notes_text(notes):
    lines = [f"The contact stress differs from its transpose by {notes['asymmetry']:.1%}.",
             f"Kinetic stress of grainvdb with half the voxel: {notes['kinetic_fine']:.1e}.",
             f"Σ m v² W - ρu², summed over the lattice, is {notes['flux_less_mean']:.2f} times the kinetic stress."]
    if "kinetic_between" in notes:
        lines.append(f"grainvdb's kinetic stress and that of NDDEM differ by {notes['kinetic_between']:.1e}.")
    if "undefined_points" in notes:
        lines.append("MercuryCG leaves the contact stress undefined (nan) at {} of {} points of the lattice with h = d.".format(*notes["undefined_points"]))
    return "  \n".join(lines)


def periodic_text(figures):
    rows = [[FIELDS[name], f"{figures[name]['inner']:.1e}", f"{figures[name]['all']:.1e}"] for name in ("phi", "contact_stress")]
    return table(["MercuryCG less grainvdb, rms", f"beyond a cutoff from the faces ({figures['share']:.0%} of the points)", "all points"], rows)


def costs(row, ours, theirs):
    if theirs not in row:
        return ["-", "-", "-", "-"]
    (seconds, memory), (other, other_memory) = row[ours], row[theirs]
    return [f"{seconds:.2f} s", f"{other:.2f} s", f"{other / seconds:.1f}", f"{memory:.0f}, {other_memory:.0f} MB"]


def speed_table(rows, ours, theirs):
    lines = [[f"{row['grains']}", f"{row['voxel']:g}", f"{row['points']}", *costs(row, ours, theirs)]
             for _, row in sorted(rows.items()) if theirs in row]
    return table(["grains", "h/d", "points", "grainvdb", theirs, "ratio", "memory"], lines)


def draw(figures, path):
    marks = {"grainvdb": ("o", "tab:blue"), "MercuryCG": ("s", "tab:red"), "NDDEM": ("^", "tab:green")}
    figure, axes = plt.subplots(figsize=(7, 4.5))
    for name, (seconds, error, _) in figures.items():
        program, _, way = name.partition(", ")
        marker, colour = marks[program]
        axes.loglog(seconds, error, marker, color=colour)
        axes.annotate(way or program, (seconds, error), textcoords="offset points", xytext=(6, 3), fontsize=8, color=colour)
    handles = [plt.Line2D([], [], linestyle="", marker=marker, color=colour, label=name) for name, (marker, colour) in marks.items()]
    axes.legend(handles=handles)
    axes.set_xlabel("processor time [s]")
    axes.set_ylabel("error of the contact stress, rms over rms")
    axes.margins(0.15)
    axes.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)


def chart_table(figures):
    rows = [[name, f"{seconds:.2f} s", f"{error:.1e}", f"{largest:.1e}"] for name, (seconds, error, largest) in sorted(figures.items(), key=lambda row: row[1][0])]
    return table(["way", "processor time", "rms", "largest"], rows)


def write(docs, figures):
    path = docs / "peers.md"
    document = path.read_text()
    if "values" in figures:
        document = write_between(document, "values", values_table(figures["values"]))
        document = write_between(document, "notes", notes_text(figures["values"]["notes"]))
    if figures.get("periodic"):
        document = write_between(document, "periodic", periodic_text(figures["periodic"]))
    if "speed" in figures:
        document = write_between(document, "mercurycg", speed_table(figures["speed"], "grainvdb", "MercuryCG"))
        document = write_between(document, "nddem", speed_table(figures["speed"], "grainvdb as NDDEM", "NDDEM"))
    if "chart" in figures:
        document = write_between(document, "chart", chart_table(figures["chart"]))
        draw(figures["chart"], docs / "images" / "peers.png")
    path.write_text(document)
