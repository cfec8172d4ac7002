"""Runs of grainvdb, MercuryCG and NDDEM over the same scene, with what they take, and their fields in the same form.

Fields are arrays over x, y, z with the components last: phi, momentum, flux (Σ m v² W), contact_stress and kinetic_stress, stress positive in
tension, with the force first and the branch second."""
from dataclasses import dataclass
import json
import pathlib
import subprocess
import sys

import numpy as np

from peers_scene import DENSITY

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "python"))
from grainvdb import open_fields

PIPELINE = """grainvdb: 1
input:
  particles: {name}.data
  contacts: {{files: {name}.fstat}}
  periodic: {periodic}
  density: {density:g}
  units: si
lattice: {{voxel: {voxel:.9g}, origin: [{low}]}}
kernel: {{name: lucy, cutoff: {cutoff:.9g}}}
region: {{lo: [{low}], hi: [{high}]}}
average: {{window: all}}
stages: {{velocity: {{weighting: mass}}, temperature: {{mode: one_pass}}}}
output: {{fields: [{fields}]}}
"""
SUMS = "phi, density, velocity, temperature, contact_stress"  # from which all that MercuryCG sums follows, but particle numbers
NDDEM_SUMS = "phi, density, velocity, kinetic_stress, contact_stress"


@dataclass
class Cost:
    seconds: float  # of the processor, user and system
    megabytes: float  # at most


# A small process starts the program: memory counts from before the fork, when a child has that of its parent.
STARTER = """import os, sys
_, status, usage = os.wait4(os.posix_spawnp(sys.argv[1], sys.argv[1:], os.environ), 0)
print(usage.ru_utime + usage.ru_stime, usage.ru_maxrss, file=sys.stderr)
sys.exit(os.waitstatus_to_exitcode(status))"""


def cost_of(words, folder, log):
    starter = [sys.executable, "-I", "-S", "-c", STARTER]
    with open(folder / log, "w") as output:
        done = subprocess.run(starter + [str(word) for word in words], cwd=folder, stdout=output, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"against-peers: {words[0]} ended with {done.returncode}: {done.stderr.strip()}; see {folder / log}")
    seconds, kilobytes = done.stderr.split()[-2:]
    return Cost(float(seconds), float(kilobytes) / 1024)


def best(repeats, run):
    return min((run() for _ in range(repeats)), key=lambda cost: cost.seconds)


class Grainvdb:
    def __init__(self, command, scene, folder, voxel, cutoff, fields=SUMS, settings=()):
        low, high = (", ".join(f"{value:.9g}" for value in corner) for corner in scene.corners)
        self._words = [command, "run", "p.yaml", "--threads", "1", "--output", "grainvdb_out"]
        self._words += [word for setting in settings for word in ("--set", setting)]
        self._folder, self._scene, self._voxel = folder, scene, voxel
        self._text = PIPELINE.format(name=scene.name, periodic="xy" if scene.periodic else "none", density=DENSITY, voxel=voxel, cutoff=cutoff, low=low, high=high, fields=fields)

    def run(self):
        (self._folder / "p.yaml").write_text(self._text)
        return cost_of(self._words, self._folder, "grainvdb.log")

    def fields(self):
        """Means over the output times."""
        with open_fields(self._folder / "grainvdb_out") as result:
            each = [self._of_time(result, time) for time in range(len(result.frame_counts))]
        return {name: sum(fields[name] for fields in each) / len(each) for name in each[0]}

    def _of_time(self, result, time):
        part = self._part(result)
        read = {name: self._on_lattice(result.values(name, time), part) for name in result.names if name != "mask"}
        found = {"phi": read["phi"], "momentum": read["density"][..., None] * read["velocity"]}
        if "temperature" in read:
            found["flux"] = read["density"] * (read["temperature"] + (read["velocity"] ** 2).sum(axis=-1))
        for name in {"contact_stress", "kinetic_stress"} & read.keys():
            found[name] = read[name].reshape(read[name].shape[:3] + (3, 3))
        return found

    def _part(self, result):
        """Where the voxels of the result lie in the lattice: they end where grains do."""
        low, _ = self._scene.corners
        starts = [round((result.axis(axis)[0] - corner) / self._voxel - 0.5) for axis, corner in zip("xyz", low)]
        return tuple(slice(start, start + len(result.axis(axis))) for start, axis in zip(starts, "xyz"))

    def _on_lattice(self, values, part):
        values = np.nan_to_num(np.moveaxis(values, (0, 1, 2), (2, 1, 0)).astype(float))  # undefined where there are no grains
        full = np.zeros(tuple(self._scene.points(self._voxel)) + values.shape[3:])
        inside = tuple(slice(max(0, -cut.start), len_ - max(0, cut.stop - size)) for cut, len_, size in zip(part, values.shape, full.shape))
        target = tuple(slice(max(0, cut.start), min(size, cut.stop)) for cut, size in zip(part, full.shape))
        full[target] = values[inside]
        return full


class MercuryCG:
    def __init__(self, command, scene, folder, voxel, cutoff):
        self._words = [command, scene.name, "-coordinates", "XYZ", "-function", "Lucy", "-w", f"{cutoff:.9g}", "-timeaverage"]
        for axis, low, high, count in zip("xyz", *scene.corners, scene.points(voxel)):
            self._words += [f"-{axis}", f"{low:.9g}", f"{high:.9g}", f"-n{axis}", count]
        self._folder, self._shape, self._name = folder, tuple(scene.points(voxel)), scene.name

    def run(self):
        return cost_of(self._words, self._folder, "mercurycg.log")

    def fields(self):
        table = np.loadtxt(self._folder / f"{self._name}.stat", skiprows=2).reshape(self._shape + (-1,))
        flux = table[..., 9:15]  # xx, xy, xz, yy, yz, zz
        return {"phi": table[..., 4], "momentum": table[..., 6:9], "flux": flux[..., 0] + flux[..., 3] + flux[..., 5],
                "contact_stress": -table[..., 15:24].reshape(self._shape + (3, 3))}


class NDDEM:
    """Of its windows, Lucy3D takes the mean of W at both ends for that along the branch, and Lucy3DFancyInt ten trapezia."""

    def __init__(self, command, scene, folder, voxel, cutoff, window):
        columns = dict(zip(("id1", "id2", "fx", "fy", "fz"), (f"c_cl[{n}]" for n in range(1, 6))))
        files = [{"filename": f"{scene.name}.dump", "format": "liggghts", "content": "particles"},
                 {"filename": f"{scene.name}.contacts", "format": "liggghts", "content": "contacts", "mapping": columns}]
        self._settings = {"file": files, "dimension": 3, "fields": ["RHO", "VAVG", "TC", "TK"], "boxes": scene.points(voxel),
                          "boundaries": [list(corner) for corner in scene.corners], "window": window, "window size": cutoff,
                          "max time": len(scene.frames), "time average": "Intermediate and Final", "savefile": "nddem", "saveformat": ["numpy"]}
        self._command, self._folder = command, folder

    def run(self):
        (self._folder / "nddem.json").write_text(json.dumps(self._settings))
        return cost_of([self._command, "nddem.json"], self._folder, "nddem.log")

    def fields(self):
        with np.load(self._folder / "nddem.npz") as result:
            read = {name: result[name] for name in result}
        vector, tensor = (lambda name: np.moveaxis(read[name], 0, -1)), (lambda name: np.moveaxis(read[name], (0, 1), (-2, -1)))
        return {"phi": read["RHO"] / DENSITY, "momentum": read["RHO"][..., None] * vector("VAVG"), "contact_stress": -tensor("TC"),
                "kinetic_stress": -tensor("TK")}
