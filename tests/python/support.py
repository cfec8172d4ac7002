"""Results to read: fields of the shipped dumps, made once by the built command, and histories of a few known tracers."""
import functools
import os
import pathlib
import subprocess
import tempfile

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
def measured() -> pathlib.Path:
    """The output folder of the shipped measurements of structure."""
    folder = pathlib.Path(_kept.name) / "measured"
    subprocess.run([COMMAND, "measure", ROOT / "pipelines/structure.yaml", "--output", folder, "--quiet"], check=True)
    return folder


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
