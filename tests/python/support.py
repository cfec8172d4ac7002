"""Results to read: fields of the shipped dumps, made once by the built command, and histories of a few known tracers."""
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


SHEAR_FIELDS = ("phi", "velocity", "mean_diameter", "temperature", "stress", "shear_rate", "pressure", "shear_stress", "mu", "inertial_number", "fluidity",
                "gd_over_dv")
ERROR_FIELDS = ("phi_error", "velocity_error", "stress_error", "mu_error")


@functools.cache
def result(window: str = "all") -> pathlib.Path:
    """The output folder of the shear cell pipeline, with one mean, with standard errors, or one per `window` frames."""
    folder = pathlib.Path(_kept.name) / f"window-{window}"
    errors = ["--set", "average.blocks=5", "--set", f"output.fields=[{', '.join(SHEAR_FIELDS + ERROR_FIELDS)}]"] if window == "all" else []
    subprocess.run([COMMAND, "run", ROOT / "pipelines/shear_cell.yaml", "--set", f"average.window={window}", *errors, "--output", folder, "--quiet"],
                   check=True)
    return folder


@functools.cache
def last_alone() -> pathlib.Path:
    """The same with the last of the five frames by itself, which has no standard errors."""
    folder = pathlib.Path(_kept.name) / "last-alone"
    subprocess.run([COMMAND, "run", ROOT / "pipelines/shear_cell.yaml", "--set", "average.window=4", "--set", "average.blocks=2",
                    "--set", "output.fields=[phi, mu, mu_error]", "--output", folder, "--quiet"], check=True)
    return folder


@functools.cache
def reduced() -> pathlib.Path:
    """The same in reduced units: d = 1/1024 m, sqrt(d/g) = 1/16 s, rho_p d^3 = 2^-19 kg."""
    folder = pathlib.Path(_kept.name) / "reduced"
    subprocess.run([COMMAND, "run", ROOT / "pipelines/shear_cell.yaml", "--set",
                    f"output.reduced={{diameter: {2**-10}, gravity: 0.25, density: 2048}}", "--output", folder, "--quiet"], check=True)
    return folder


@functools.cache
def at_scales() -> pathlib.Path:
    """The output folder of two cutoffs, computed in one pass."""
    folder = pathlib.Path(_kept.name) / "scales"
    subprocess.run([COMMAND, "run", ROOT / "pipelines/plateau.yaml", "--set", "scales={cutoff: [1.6e-3, 2.4e-3], voxel: [0.4e-3, 0.8e-3]}",
                    "--set", "output.fields=[phi]", "--frames", ":1", "--output", folder, "--quiet"], check=True)
    return folder


@functools.cache
def measured(pipeline: str = "structure") -> pathlib.Path:
    """The output folder of shipped measurements, those of structure unless others are named."""
    folder = pathlib.Path(_kept.name) / f"measured-{pipeline}"
    subprocess.run([COMMAND, "measure", ROOT / f"pipelines/{pipeline}.yaml", "--output", folder, "--quiet"], check=True)
    return folder


@functools.cache
def draining() -> pathlib.Path:
    """Tables and fields of the pipeline of plasticity, at voxels of a diameter."""
    folder = pathlib.Path(_kept.name) / "draining"
    subprocess.run([COMMAND, "run", ROOT / "pipelines/plasticity.yaml", "--set", "lattice.voxel=1", "--frames", ":2", "--output", folder, "--quiet"], check=True)
    return folder


def write_table(path: pathlib.Path, name: str, columns: dict[str, np.ndarray], numbers: dict[str, float]) -> None:
    """Adds a table to a tables.h5, as the library writes it."""
    with h5py.File(path, "a") as file:
        table = file.create_group(name)
        table.attrs.update({"description": "made up", "equation": "y = x", "order": list(columns)})
        for column, values in columns.items():
            table[column] = values
        table.create_group("numbers").attrs["order"] = list(numbers)
        for symbol, value in numbers.items():
            table["numbers"][symbol] = value
            table["numbers"][symbol].attrs["long_name"] = symbol


@functools.cache
def side_by_side() -> tuple[pathlib.Path, pathlib.Path]:
    """The output folders of the shipped comparison: of the sample silo, and of a short spot run of it."""
    folder = pathlib.Path(_kept.name) / "side-by-side"
    subprocess.run([COMMAND, "spot", "run", ROOT / "pipelines/spot_silo.yaml", "--set", "output.interval=0.3", "--set", "output.end=1.2", "--output",
                    folder / "spot", "--quiet"], check=True)
    for name, more in (("dem", []), ("spots", ["--set", f"input.particles={folder}/spot/spot_*.dump"])):
        subprocess.run([COMMAND, "run", ROOT / "pipelines/spot_compare.yaml", *more, "--output", folder / name, "--quiet"], check=True)
    return folder / "dem", folder / "spots"


def write_tracers(folder: pathlib.Path) -> None:
    """tracers.h5 as the library writes it: five tracers over three samples, in a box 4 long along x and 10 along z."""
    subprocess.run([os.environ["GRAINVDB_MAKE_TRACERS"], folder], check=True)
