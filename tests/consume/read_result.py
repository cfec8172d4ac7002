"""Opens the result of pipelines/minimal.yaml as a user would, and compares it with the dumps themselves."""
import pathlib
import sys

import h5py
import numpy as np

SAMPLE = pathlib.Path(__file__).parents[2] / "sample_dumps" / "shear_cell"


def grain_volume(dump):
    """The volume of the mobile grains, type 1, of a dump."""
    lines = dump.read_text().splitlines()
    header = next(i for i, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
    names = lines[header].split()[2:]
    rows = np.array([line.split() for line in lines[header + 1:]], float)
    radius = rows[rows[:, names.index("type")] == 1, names.index("radius")]
    return (4 / 3 * np.pi * radius**3).sum()


with h5py.File(sys.argv[1]) as file:
    image = file["VTKHDF"].attrs
    assert bytes(image["Type"]) == b"ImageData", image["Type"]
    phi = file["VTKHDF/PointData/phi"]
    extent = np.asarray(image["WholeExtent"]).reshape(3, 2)
    points = extent[:, 1] - extent[:, 0] + 1
    assert phi.shape == tuple(points[::-1]), (phi.shape, points)
    units = phi.attrs["units"]
    assert units in ("1", b"1"), units
    volume = np.nansum(phi[...].astype(float)) * np.prod(image["Spacing"])

# The lattice holds the whole support of every grain, so that h³ Σφ is the grains' volume up to the quadrature error of the
# kernel: at c/h = 6 at most 2.4e-5 for a grain in the worst position, and a dump rounds radii to 6 digits.
expected = np.mean([grain_volume(dump) for dump in SAMPLE.glob("dump*.liggghts")])
assert abs(volume / expected - 1) < 3e-5, (volume, expected)
print(f"h5py reads phi {phi}; volume {volume:.6e} m3, expected {expected:.6e} m3")
