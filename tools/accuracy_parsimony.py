"""What it saves to compute no more than is asked for, measured by tools/accuracy: processor time and memory of a run that asks for less
beside one that asks for more, and how far the fields that both have differ."""
import re

import numpy as np

from accuracy_runs import timed_call
from grainvdb import open_fields, open_tables

FLOW = ["phi", "velocity", "mean_diameter", "temperature", "shear_rate"]
ROTATION = ["angular_velocity", "rotational_fluctuation"]
STRESS = ["stress", "pressure", "mu", "inertial_number", "gd_over_dv"]
EVERYTHING = FLOW + ROTATION + STRESS
HEIGHTS = "from: 0.8e-3, to: 5.6e-3"
ONE_CELL = "{lo: [0, 0, 0], hi: [6.4e-3, 6.4e-3, 6e-3]}"  # of the copies side by side


def wanted(fields, **keys):
    return {"output.fields": f"[{','.join(fields)}]", **keys}


# name, what is asked for, and the settings of the run that asks for less and of the one beside it
PAIRS = [
    ("channels", "fields but φ", wanted(["phi"]), wanted(EVERYTHING)),
    ("rotation", "rotation", wanted(FLOW + STRESS), wanted(EVERYTHING)),
    ("contacts", "stress; no contacts are read", wanted(FLOW + ROTATION), wanted(EVERYTHING)),
    ("region", "what lies outside one of the cells: `region`", wanted(EVERYTHING, region=ONE_CELL), wanted(EVERYTHING)),
]
# The same T from both: about the velocity averaged over planes.
PROFILES = {"plane_profile": {"measure": f"{{plane_profile: {{axis: z, {HEIGHTS}}}}}"},
            "profile": {"measure": f"{{profile: {{axis: z, {HEIGHTS}, fields: [phi, velocity, mean_diameter, temperature]}}}}",
                        "stages.temperature.mode": "two_pass_profile"}}
VOXELS = {"d/2": 0.4e-3, "d/4": 0.2e-3}  # of the profiles [m]


def run(options, verb, folder, keys):
    """Seconds of processor time, and the peak memory in MB."""
    words = [word for key, value in keys.items() for word in ("--set", f"{key}={value}")]
    seconds, summary = timed_call(options, verb, "--output", folder, *words)
    return seconds, float(re.search(r"^memory: ([\d.]+) MB at most", summary, re.MULTILINE).group(1))


def repeated(options, verb, folders, settings):
    """The fastest of some runs of each of two settings, in turns, and the memory of the last."""
    found = [[run(options, verb, folder, keys) for folder, keys in zip(folders, settings)] for _ in range(options.repeats)]
    return [(min(seconds for seconds, _ in runs), runs[-1][1]) for runs in zip(*found)]


def difference(found, exact):
    """The largest one, relative to the largest value; infinite where one has a value and the other has none."""
    have = np.isfinite(exact)
    if not np.array_equal(have, np.isfinite(found)):
        return np.inf
    return np.max(np.abs(found - exact)[have]) / np.max(np.abs(exact)[have])


def of_fields(few, many):
    """The largest difference of the fields of one result from those of another that holds them all, at the voxels of the first."""
    with open_fields(few) as less, open_fields(many) as more:
        places = np.ix_(*(np.searchsorted(more.axis(a), less.axis(a) - less.voxel / 2) for a in "zyx"))
        names = [name for name in less if name in EVERYTHING]
        return max(difference(less.values(name), more.values(name)[places]) for name in names)


def of_profiles(marginal, grids):
    with open_tables(marginal) as less, open_tables(grids) as more:
        exact, found = more["profile"], less["plane_profile"]
        heights = exact["z"]
        return {name: difference(np.interp(heights, found["z"], found[name]), exact[name]) for name in ("phi", "velocity_x", "temperature")}


def measure(options, folder):
    """The table, on the dumps in the folder."""
    dumps = {"input.particles": f"{folder}/dump*.liggghts", "input.contacts.files": f"{folder}/contacts*.liggghts"}
    lines = ["| what is not computed | processor time | memory | largest difference |", "|---|---|---|---|"]

    def row(name, pair, error):
        (less, less_memory), (more, more_memory) = pair
        lines.append(f"| {name} | {less:.2f} of {more:.2f} s: {more / less:.1f} times as fast | {less_memory:.0f} of {more_memory:.0f} MB | {error} |")

    for name, asked, less, more in PAIRS:
        folders = [folder / name, folder / "whole"]
        pair = repeated(options, "run", folders, [dumps | less, dumps | more])
        error = of_fields(*folders)
        row(asked, pair, "none" if error == 0 else f"{error:.1e}")
    folders = [folder / name for name in PROFILES]
    for name, voxel in VOXELS.items():
        pair = repeated(options, "measure", folders, [dumps | keys | {"lattice.voxel": voxel} for keys in PROFILES.values()])
        errors = ", ".join(f"{field} {error:.1e}" for field, error in of_profiles(*folders).items())
        row(f"grids, h = {name}: `plane_profile` beside `profile`", pair, errors)
    return "\n".join(lines)
