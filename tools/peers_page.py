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


def speed_table(rows, theirs, *ours):
    """A row for each job that all of them did; the ratio is to the first of ours."""
    lines = []
    for _, row in sorted(rows.items()):
        if {theirs, *ours} <= row.keys():
            lines.append([f"{row['grains']}", f"{row['voxel']:g}", f"{row['points']}", *(f"{row[name][0]:.2f} s" for name in (*ours, theirs)),
                          f"{row[theirs][0] / row[ours[0]][0]:.1f}", f"{row[ours[0]][1]:.0f}, {row[theirs][1]:.0f} MB"])
    return table(["grains", "h/d", "points", *(name.removesuffix(" as NDDEM") for name in (*ours, theirs)), "ratio", "memory"], lines)


def label_place(way, seconds):
    """Where the name of a point goes, so that none lies over another."""
    if way == "exact":
        return {"xytext": (-6, -4), "ha": "right"}
    return {"xytext": (-6, -4), "ha": "right"} if seconds > 20 else {"xytext": (6, 3)}


def draw(figures, path):
    marks = {"grainvdb": ("o", "tab:blue"), "MercuryCG": ("s", "tab:red"), "NDDEM": ("^", "tab:green")}
    figure, axes = plt.subplots(figsize=(7, 4.5))
    for name, (seconds, error, _) in figures.items():
        program, _, way = name.partition(", ")
        marker, colour = marks[program]
        axes.loglog(seconds, error, marker, color=colour)
        title = way or "closed form, six digits"
        axes.annotate(title, (seconds, error), textcoords="offset points", fontsize=8, color=colour, **label_place(way, seconds))
    handles = [plt.Line2D([], [], linestyle="", marker=marker, color=colour, label=name) for name, (marker, colour) in marks.items()]
    axes.legend(handles=handles, loc="lower right")
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
        document = write_between(document, "mercurycg", speed_table(figures["speed"], "MercuryCG", "grainvdb", "grainvdb, exact"))
        document = write_between(document, "nddem", speed_table(figures["speed"], "NDDEM", "grainvdb as NDDEM"))
    if "chart" in figures:
        document = write_between(document, "chart", chart_table(figures["chart"]))
        draw(figures["chart"], docs / "images" / "peers.png")
    path.write_text(document)
