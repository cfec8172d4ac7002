"""Results to read: made once by the built command from the shipped dumps, and small files made by hand."""
import functools
import os
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).parents[2]
COMMAND = os.environ["GRAINVDB_COMMAND"]
_kept = tempfile.TemporaryDirectory(prefix="grainvdb-python-")


@functools.cache
def result(window: str = "all") -> pathlib.Path:
    """The output folder of the shear cell pipeline, with one mean or one per `window` frames."""
    folder = pathlib.Path(_kept.name) / f"window-{window}"
    subprocess.run([COMMAND, "run", ROOT / "pipelines/shear_cell.yaml", "--set", f"average.window={window}", "--output", folder, "--quiet"],
                   check=True)
    return folder


def write_tracers(path: pathlib.Path) -> None:
    """Two tracers over three samples in a box that is periodic over a length of 10 along x: one crosses it, one stops."""
    with h5py.File(path, "w") as file:
        group = file.create_group("particles/tracers")
        group["box/edges"] = np.array([10.0, 4.0, 6.0])
        group["id"] = np.array([3, 7])

        def element(name, values, unit="1"):
            group[f"{name}/value"] = values
            group[f"{name}/value"].attrs["units"] = unit
            group[f"{name}/step"] = np.arange(3)
            group[f"{name}/time"] = np.array([0.0, 0.5, 1.0])
            group[f"{name}/time"].attrs["units"] = "s"

        element("position", np.array([[[9.0, 1, 1], [2, 2, 2]], [[9.5, 1, 1], [3, 2, 2]], [[0.5, 1, 1], [3, 2, 2]]]), "m")
        element("image", np.array([[[0, 0, 0]] * 2, [[0, 0, 0]] * 2, [[1, 0, 0], [0, 0, 0]]], np.int32))
        element("phi", np.array([[0.5, 0.6], [0.51, 0.61], [0.52, np.nan]], np.float32))
        element("velocity", np.full((3, 2, 3), 2.0, np.float32), "m/s")
        element("stop", np.array([[0, 0], [0, 0], [0, 1]], np.uint8))
        group["stop/value"].attrs["flag_values"] = np.array([0, 1], np.uint8)
        group["stop/value"].attrs["flag_meanings"] = "moving left_material"
