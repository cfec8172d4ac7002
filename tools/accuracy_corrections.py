"""What each correction changes, measured by tools/accuracy on packings whose fields are known and on the samples: the chart of
each, for docs/accuracy.md. All numbers come out of the command; only sums over its fields are made here."""
import subprocess
import sys

import matplotlib.pyplot as plt
import numpy as np

import accuracy_scenes as scenes
from accuracy_runs import ROOT, SAMPLE, Dump
from grainvdb import open_fields

CUTOFFS = [1.5, 2, 2.5, 3, 3.5, 4]  # [d]
REST_EDGE, SHEAR_EDGE, SHEAR_HEIGHT, FRAMES = 10, 10, 24, 24
WINDOW = 6  # frames of an average, which L is formed from
RATE = 0.3  # of the shear; T is 1
WAVELENGTH, WAVE_CUTOFF, WAVE_EDGE, WAVE_HEIGHT = 12, 3, 6, 24
SPACINGS = {"wave": 1, "fine": 1 / 3}  # of grains; the edge of material is as smooth as there are layers of them
PER_CUTOFF = [2, 3, 4, 6]  # voxels; the edge is a whole number of each
WEIGHT = 9.81
HEAVY, MIXTURE_EDGE, MIXTURE_HEIGHT = 4, 24, 24  # of the grains of two materials
SIZES = {"small": "[0, 7.7e-4]", "middle": "[7.7e-4, 8.2e-4]", "large": "[8.2e-4, .inf]"}
HALF_STEP = ("{law: hooke, youngs_modulus: 1e9, poisson_ratio: 0.5, restitution: 0.1, characteristic_velocity: 1, friction: 0.4, "
             "still_types: [2], whole_steps: [60000]}")
BROWN, VIOLET, GREEN, GREY = "#b35806", "#542788", "#1b9e77", "#888888"


def pipeline(folder, name, cutoff, voxel, fields, more=""):
    path = folder / f"{name}.yaml"
    path.write_text(f"grainvdb: 1\ninput: {{particles: {name}*.dump, units: lj}}\nlattice: {{voxel: {voxel:.9g}}}\n"
                    f"kernel: {{cutoff: {cutoff:.9g}}}\noutput: {{fields: [{', '.join(fields)}]}}\n{more}")
    return path


def run(options, path, folder, **keys):
    words = [word for key, value in keys.items() for word in ("--set", f"{key.replace('__', '.')}={value}")]
    result = subprocess.run([options.command, "run", path, "--quiet", "--output", folder / "out", *words], capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"accuracy: {result.stderr.strip()}")
    return open_fields(folder / "out")


def finish(figure, path):
    figure.savefig(path, dpi=80)
    plt.close(figure)


# Temperature

MODES = {  # name: mode, self_weight, colour, style
    "two_pass": ("two_pass", "none", BROWN, "o-"),
    "two_pass, corrected": ("two_pass", "corrected", BROWN, "o:"),
    "one_pass": ("one_pass", "none", VIOLET, "s-"),
    "one_pass, corrected": ("one_pass", "corrected", VIOLET, "s:"),
    "one_pass_corrected, corrected": ("one_pass_corrected", "corrected", GREEN, "^:"),
}


def of_frames(result, name, heights):
    """The mean of Σ φ q/Σ φ over output times at these heights, and its standard error."""
    z = result.axis("z")
    rows = (z > heights[0]) & (z < heights[1])
    each = []
    for time in range(len(result.times)):
        phi, q = result.values("phi", time)[rows], result.values(name, time)[rows]
        each.append(np.sum(phi * q, dtype=float) / np.sum(phi, dtype=float))
    return np.mean(each), np.std(each, ddof=1) / np.sqrt(len(each))


def temperatures(options, folder, name, field, heights, modes):
    found = {}
    for mode in modes:
        way, weight, *_ = MODES[mode]
        found[mode] = []
        for cutoff in CUTOFFS:
            path = pipeline(folder, name, cutoff, 0.5, ["phi", field], f"average: {{window: {WINDOW}}}\n")
            keys = {f"stages__{field}__mode": way, f"stages__{field}__self_weight": weight}
            with run(options, path, folder, **keys) as result:
                found[mode].append(of_frames(result, field, heights(cutoff)))
    return found


def draw_biases(panel, found, title):
    for mode, each in found.items():
        *_, colour, style = MODES[mode]
        value, error = np.array(each).T
        panel.errorbar(CUTOFFS, 100 * (value - 1), 100 * error, fmt=style, color=colour, label=mode, capsize=2, markersize=4)
    panel.axhline(0, color=GREY, linewidth=0.8)
    panel.set(title=title, xlabel="cutoff c/d")
    panel.title.set_fontsize(9)


def temperature(options, folder, images):
    """The bias of T and δω² against the cutoff."""
    scenes.at_rest(folder, REST_EDGE, FRAMES)
    scenes.in_shear(folder, SHEAR_EDGE, SHEAR_HEIGHT, RATE, FRAMES)
    everywhere = lambda cutoff: (0, REST_EDGE)
    inside = lambda cutoff: (2 * cutoff, SHEAR_HEIGHT - 2 * cutoff)
    rest = temperatures(options, folder, "rest", "temperature", everywhere, list(MODES)[:4])
    shear = temperatures(options, folder, "shear", "temperature", inside, MODES)
    spin = temperatures(options, folder, "rest", "rotational_fluctuation", everywhere, list(MODES)[:4])
    spin_shear = temperatures(options, folder, "shear", "rotational_fluctuation", inside, MODES)
    figure, grid = plt.subplots(2, 2, figsize=(8, 6.4), layout="constrained")
    panels = list(grid.T.flat)
    draw_biases(panels[0], rest, "T of a packing without flow")
    draw_biases(panels[1], shear, f"T in shear, γ̇d/√T = {RATE}")
    draw_biases(panels[2], spin, "δω² of a packing without flow")
    draw_biases(panels[3], spin_shear, f"δω² in shear of spin, d|∂ω|/δω = {RATE}")
    c = np.linspace(CUTOFFS[0], CUTOFFS[-1], 50)
    a, b = 105 / 96 / c**3 / scenes.PHI, 455 / (176 * np.pi * c**3) * (np.pi / 6) / scenes.PHI
    for panel in (panels[0], panels[2]):
        panel.plot(c, 100 * (b - 2 * a), color=GREY, linewidth=0.8, label="1 - 2a + b of the formula")
    for panel in panels[:2]:
        panel.set_ylabel("found less true value [%]")
    panels[0].legend(fontsize=6.5)
    panels[1].legend(fontsize=6.5)
    finish(figure, images / "temperature_bias.png")
    at = CUTOFFS.index(3)
    return [(f"{field}, {mode}", *each[at]) for field, found in (("T at rest", rest), ("T in shear", shear), ("δω² at rest", spin),
                                                               ("δω² in shear of spin", spin_shear))
            for mode, each in found.items()]


def temperature_table(rows):
    lines = ["| c = 3 d | found less true value |", "|---|---|"]
    return "\n".join(lines + [f"| {name} | {100 * (value - 1):+.2f} ± {100 * error:.2f} % |" for name, value, error in rows])


# Gradients

def gradients(options, folder, name, per_cutoff):
    """rms errors of L_xz, and (kh)²/6: of central differences and of the kernel within the material, of one-sided differences at the
    voxels that lack a neighbour. The kernel's is the derivative of the velocity that there is, the wave's that of the smoothed one."""
    voxel = WAVE_CUTOFF / per_cutoff
    path = pipeline(folder, name, WAVE_CUTOFF, voxel, ["velocity", "velocity_gradient"])
    found = {}
    for method in ("central", "kernel"):
        with run(options, path, folder, stages__velocity_gradient__method=method) as result:
            found[method] = result.values("velocity_gradient")[..., 2].astype(float)
            z, velocity = result.axis("z"), result.values("velocity")[..., 0].astype(float)
    exact = found["kernel"]
    there = np.isfinite(exact)
    edge = there.copy()
    edge[1:-1] = there[1:-1] & ~(there[:-2] & there[2:])
    inside = there & ~edge & ((z > 2 * WAVE_CUTOFF) & (z < WAVE_HEIGHT - 2 * WAVE_CUTOFF))[:, None, None]
    k = 2 * np.pi / WAVELENGTH
    x = k * WAVE_CUTOFF
    smoothed = 630 * (x**2 * np.sin(x) + x * (7 * np.cos(x) + 8) - 15 * np.sin(x)) / x**7
    wave = np.broadcast_to((k * smoothed * np.cos(k * z + scenes.PHASE))[:, None, None], exact.shape)
    rms = lambda values, where: np.sqrt(np.mean(values[where] ** 2))
    scale = rms(wave, inside)
    return (rms(found["central"] - exact, inside) / scale, rms(exact - wave, inside) / scale,
            rms(found["central"] - exact, edge) / scale, rms(velocity, edge) / (2 * voxel) / scale,
            (k * voxel) ** 2 / 6)


def gradient(options, folder, images):
    """Errors of gradients against the voxel."""
    for name, spacing in SPACINGS.items():
        scenes.in_a_wave(folder, name, WAVE_EDGE, WAVE_HEIGHT, WAVELENGTH, spacing)
    central, kernel, _, _, derived = np.array([gradients(options, folder, "wave", n) for n in PER_CUTOFF]).T
    _, _, one_sided, naive, _ = np.array([gradients(options, folder, "fine", n) for n in PER_CUTOFF]).T
    figure, panel = plt.subplots(figsize=(5, 3.6), layout="constrained")
    panel.plot(PER_CUTOFF, central, "o-", color=BROWN, label="central differences, within the material")
    panel.plot(PER_CUTOFF, derived, "--", color=BROWN, alpha=0.5, label="(kh)²/6")
    panel.plot(PER_CUTOFF, one_sided, "s-", color=VIOLET, label="one-sided differences, at its edge")
    panel.plot(PER_CUTOFF, naive, ":", color=VIOLET, label="there, with 0 for the neighbour that is not there")
    panel.plot(PER_CUTOFF, kernel, "^-", color=GREEN, label="kernel, from the smoothed wave")
    panel.set(xscale="log", yscale="log", xlabel="voxels per cutoff c/h", ylabel="rms error, relative to the gradient")
    panel.set_ylim(bottom=2e-4)
    panel.set_xticks(PER_CUTOFF, [str(n) for n in PER_CUTOFF])
    panel.minorticks_off()
    panel.legend(fontsize=7)
    finish(figure, images / "gradients.png")
    lines = ["| c/h | central | (kh)²/6 | one-sided, at the edge | 0 for the neighbour there | kernel |", "|---|---|---|---|---|---|"]
    return "\n".join(lines + ["| " + " | ".join([str(n), *(f"{error:.1e}" for error in row)]) + " |"
                              for n, *row in zip(PER_CUTOFF, central, derived, one_sided, naive, kernel)])


# Walls

BALANCES = {  # name: wall_contacts, whether wall_force enters, colour, style
    "stress to the centres of wall grains, no wall_force": ("include", False, BROWN, "--"),
    "stress to the wall, no wall_force": ("exclude", False, VIOLET, "--"),
    "stress to the wall and wall_force": ("exclude", True, GREEN, "-"),
}


def mobile_grains(path):
    """Columns by name of the mobile grains in a dump of the cell."""
    dump = Dump(path, "ATOMS")
    at = dump.columns.index("type")
    rows = np.array([[float(word) for word in row] for row in dump.rows if row[at] == "1"])
    return dict(zip(dump.columns, rows.T))


def inertia_above(z, cutoff):
    """∫_z Σ F_α W dV of the mobile grains of the cell, F_α the force on each, which accelerates it; mean over the frames."""
    def beyond(height):  # the part of a kernel there that lies above 0
        x = np.minimum(np.abs(height) / cutoff, 1)
        half = 21 / 16 * x * (1 + x**2 * (-5 / 3 + x**2 * (3 + x * (-8 / 3 + 5 / 7 * x))))
        return 0.5 + np.sign(height) * half
    frames = [mobile_grains(path) for path in sorted(SAMPLE.glob("dump*.liggghts"))]
    return np.mean([[np.sum(grains["fz"] * beyond(grains["z"] - height)) for height in z] for grains in frames], axis=0)


def missing(options, path, folder, contacts, with_force, gravity, inertia, **keys):
    """Heights, and σ_zz(z) + ∫_z (ρg - f_z + force that accelerates) dz of means over planes, of the weight by area: 0 where the momentum
    above z is balanced. σ is the contact stress, as the force is that on moving grains. Integrals are by the trapezoidal rule with
    the term of its ends."""
    fields = "[density,contact_stress,wall_force]"
    with run(options, path, folder, output__fields=fields, stages__contact_stress__wall_contacts=contacts, **keys) as result:
        z, h = result.axis("z"), result.voxel
        planes = lambda values: np.nan_to_num(values.astype(float)).mean(axis=(1, 2))
        density, stress, force = (planes(result.values(name)[component]) for name, component in
                                  (("density", ...), ("contact_stress", (..., 8)), ("wall_force", (..., 2))))
        area = h**2 * len(result.axis("x")) * len(result.axis("y"))
    load = gravity * density - (force if with_force else 0)
    above = h * (np.cumsum(load[::-1])[::-1] - load / 2) + h**2 / 12 * np.gradient(load, h)
    return z, (stress + above + inertia(z) / area) / (gravity * density.sum() * h)


def wall_balance(options, folder, images):
    """What is missing in the balance of momentum at a wall of grains, with and without wall_force."""
    scenes.column(folder, 6, 12)
    contacts = "{files: column_contacts0.dump, columns: {id1: id1, id2: id2, force: [fx, fy, fz], point: [px, py, pz]}}"
    column = folder / "column.yaml"
    column.write_text(f"grainvdb: 1\ninput: {{particles: column0.dump, units: lj, contacts: {contacts}}}\nselect: {{types: [1]}}\n"
                      "lattice: {voxel: 0.25}\nkernel: {cutoff: 3}\noutput: {fields: [phi]}\n")
    figure, panels = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    cell = {"walls__types": "[2, 3]", "input__contacts__half_step": HALF_STEP, "lattice__voxel": "0.2e-3"}
    scenes_of = [("grains at rest on a wall of grains", column, 1, 1, 1, lambda z: 0 * z, {}),
                 ("shear cell", ROOT / "pipelines/shear_cell.yaml", WEIGHT, 0.8e-3, 0, lambda z: inertia_above(z, 2.4e-3), cell)]
    lines = ["| largest part of the weight that is missing | " + " | ".join(BALANCES) + " |", "|---|" + "---|" * len(BALANCES)]
    for panel, (title, path, gravity, diameter, wall, inertia, keys) in zip(panels, scenes_of):
        largest = []
        for name, (ends, with_force, colour, style) in BALANCES.items():
            z, part = missing(options, path, folder, ends, with_force, gravity, inertia, **keys)
            panel.plot(z / diameter - wall, part, style, color=colour, label=name)
            largest.append(np.abs(part).max())
        panel.axvline(0, color=GREY, linewidth=0.8)
        panel.set(title=title, xlabel="height above the wall / d")
        lines.append(f"| {title} | " + " | ".join(f"{value:.1e}" for value in largest) + " |")
    panels[0].set_ylabel("missing part of the weight")
    panels[0].legend(fontsize=7)
    finish(figure, images / "wall_balance.png")
    return "\n".join(lines)


# Half a step

def residuals(options, folder, **keys):
    """Σ f - M g - ∫ wall_force dV of the mobile grains of each frame, and their weight M g."""
    cell = ROOT / "pipelines/shear_cell.yaml"
    found = []
    with run(options, cell, folder, output__fields="[wall_force]", average__window="none", walls__types="[2, 3]", **keys) as result:
        forces = [np.nansum(result.values("wall_force", n), axis=(0, 1, 2), dtype=float) * result.voxel**3 for n in range(len(result.times))]
    paths = sorted(SAMPLE.glob("dump*.liggghts"))
    for path, force in zip(paths, forces):
        mobile = mobile_grains(path)
        total = np.array([mobile[axis].sum() for axis in ("fx", "fy", "fz")])
        weight = WEIGHT * mobile["mass"].sum()
        found.append((total + [0, 0, weight] - force) / weight)
    return [path.stem[4:] for path in paths], np.array(found)


def half_step(options, folder, images):
    """What is missing in the balance of forces of the shear cell, frame by frame."""
    steps, before = residuals(options, folder)
    _, after = residuals(options, folder, input__contacts__half_step=HALF_STEP)
    figure, panel = plt.subplots(figsize=(5, 3.4), layout="constrained")
    places = np.arange(len(steps))
    for n, (values, name, colour) in enumerate(((before, "forces as dumped", BROWN), (after, "half_step", GREEN))):
        panel.bar(places + 0.4 * n - 0.2, np.linalg.norm(values, axis=1), 0.38, color=colour, label=name)
    panel.set(yscale="log", xlabel="step", ylabel="|Σ f - M g - ∫ f_wall dV| / M g")
    panel.set_xticks(places, steps)
    panel.legend(fontsize=8)
    finish(figure, images / "half_step.png")
    size = lambda values: ", ".join(f"{np.linalg.norm(v):.1e}" for v in values)
    return f"Of the weight, for steps {', '.join(steps)}: {size(before)} as dumped, {size(after)} with `half_step`."


# Species

def weightings(options, folder, panel):
    """Draws the velocity of two materials over the height by either weighting; returns its rms differences from what is expected."""
    scenes.mixture(folder, MIXTURE_EDGE, MIXTURE_HEIGHT, HEAVY)
    share = lambda z: z / MIXTURE_HEIGHT
    expected = {"volume": share, "mass": lambda z: HEAVY * share(z) / (1 + (HEAVY - 1) * share(z))}
    far = {}
    for (weighting, value), colour in zip(expected.items(), (BROWN, GREEN)):
        path = pipeline(folder, "mixture", 3, 1, ["phi", "velocity"])
        with run(options, path, folder, stages__velocity__weighting=weighting) as result:
            z, phi, u = result.axis("z"), result.values("phi"), result.values("velocity")[..., 0]
        inside = (z > 3) & (z < MIXTURE_HEIGHT - 3)  # where the kernel is whole
        found = np.nansum(phi * u, axis=(1, 2))[inside] / np.sum(phi, axis=(1, 2))[inside]
        panel.plot(z[inside], found, "o", color=colour, markersize=3, label=f"weighting: {weighting}")
        panel.plot(z[inside], value(z[inside]), color=colour, linewidth=0.8)
        far[weighting] = np.sqrt(np.mean((found - value(z[inside])) ** 2))
    panel.set(xlabel="height z/d", ylabel="u of two materials")
    panel.legend(fontsize=7)
    return far


def species(options, folder, images):
    """Fields of three size classes of the shear cell against those of all grains."""
    names = {"phi": 1, "velocity": 3, "temperature": 1, "stress": 9}
    fields = ["phi", *(f"{name}_{size}" for name in names for size in SIZES), *list(names)[1:]]
    classes = "{" + ", ".join(f"{size}: {{diameter: {bounds}}}" for size, bounds in SIZES.items()) + "}"
    with run(options, ROOT / "pipelines/shear_cell.yaml", folder, output__fields=f"[{','.join(fields)}]", species=classes) as result:
        value = {name: result.values(name).astype(float) for name in fields}
        z = result.axis("z") / 0.8e-3
    figure, (stack, rest, weights) = plt.subplots(1, 3, figsize=(11, 3.4), layout="constrained")
    below = np.zeros(len(z))
    for size, colour in zip(SIZES, (BROWN, GREEN, VIOLET)):
        above = below + np.nanmean(value[f"phi_{size}"], axis=(1, 2))
        stack.fill_between(z, below, above, color=colour, alpha=0.5, label=f"phi_{size}")
        below = above
    stack.plot(z, np.nanmean(value["phi"], axis=(1, 2)), "k--", label="phi")
    stack.set(xlabel="height z/d", ylabel="packing fraction")
    stack.legend(fontsize=7)
    largest = {}
    for name, style in zip(names, ("o-", "s-", "^-", "v-")):
        weigh = name in ("velocity", "temperature")
        of = lambda field, phi: (field * phi[..., None] if field.ndim > phi.ndim else field * phi) if weigh else field
        parts = [np.nan_to_num(of(value[f"{name}_{size}"], value[f"phi_{size}"])) for size in SIZES]
        whole = np.nan_to_num(of(value[name], value["phi"]))
        scale = np.max(np.abs(whole))
        gap = np.abs(sum(parts) - whole).reshape(len(z), -1).max(axis=1) / scale
        rest.plot(z, np.maximum(gap, 1e-10), style, markersize=3, label=("φ " if weigh else "") + name)
        largest[name] = gap.max()
    rest.set(yscale="log", xlabel="height z/d", ylabel="largest |sum of species - all| / largest |all|")
    rest.legend(fontsize=7)
    far = weightings(options, folder, weights)
    finish(figure, images / "species.png")
    return ("Largest difference of the sum, of the largest value: " + ", ".join(f"{name} {gap:.0e}" for name, gap in largest.items()) + ".\n"
            + "Velocity of two materials, rms difference of planes from the expected: " + ", ".join(f"{name} {gap:.3f}" for name, gap in far.items()) + ".")


def measure(options, folder, images):
    """Draws all charts; returns the texts by the names of their places in docs/accuracy.md."""
    subprocess.run([sys.executable, ROOT / "tools/wall-profiles", "--command", options.command, "--picture", images / "walls"], check=True)
    return {"temperature_bias": temperature_table(temperature(options, folder, images)), "gradients": gradient(options, folder, images),
            "wall_balance": wall_balance(options, folder, images),
            "half_step": half_step(options, folder, images), "species": species(options, folder, images)}
