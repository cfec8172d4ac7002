"""The picture of `grainvdb tune`, from a table of known settings."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

import matplotlib.pyplot as plt
import numpy as np

from grainvdb import tune

HEAD = "setting,field,points,rms,tolerance,best_seconds,worst_seconds,current,proposed"
# mu has no tolerance and comes last; the third setting has no point of mu to compare, the fourth changes two keys.
TABLE = """
,mu,100,0.04,,1.0,1.2,1,0
,phi,100,0.02,0.03,1.0,1.2,1,0
lattice.voxel=0.8,mu,100,0.08,,0.25,0.3,0,1
lattice.voxel=0.8,phi,100,0.025,0.03,0.25,0.3,0,1
kernel.points=1,mu,0,nan,,0.5,0.6,0,0
kernel.points=1,phi,100,0.03,0.03,0.5,0.6,0,0
lattice.voxel=0.8 kernel.points=1,mu,100,0.16,,0.125,0.2,0,0
lattice.voxel=0.8 kernel.points=1,phi,100,0.1,0.03,0.125,0.2,0,0
"""


class Tune(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(plt.close, "all")
        self.table = pathlib.Path(folder.name) / "tune.csv"
        self.table.write_text(HEAD + TABLE)

    def test_a_panel_for_each_field(self):
        figure = tune.draw(tune.read(self.table))
        shown = {ax.get_title(): ax for ax in figure.axes if ax.get_visible()}
        self.assertEqual(list(shown), ["phi", "mu"])
        points = {field: sorted((bar.lines[0].get_xdata()[0], bar.lines[0].get_ydata()[0]) for bar in ax.containers) for field, ax in shown.items()}
        self.assertEqual(points, {"phi": [(0.125, 0.1), (0.25, 0.025), (0.5, 0.03), (1.0, 0.02)], "mu": [(0.125, 0.16), (0.25, 0.08), (1.0, 0.04)]})
        steps = {field: [line for line in ax.get_lines() if line.get_drawstyle() == "steps-post"] for field, ax in shown.items()}
        np.testing.assert_array_equal(steps["phi"][0].get_xydata(), [(0.125, 0.1), (0.25, 0.025), (1.0, 0.02)])
        dotted = {field: [line.get_ydata()[0] for line in ax.get_lines() if line.get_linestyle() == ":"] for field, ax in shown.items()}
        self.assertEqual(dotted, {"phi": [0.03], "mu": []})
        names = [text.get_text() for text in figure.legends[0].get_texts()]
        self.assertEqual(names, ["lattice.voxel", "kernel.points", "several", "current setting", "proposed"])

    def test_one_measurement_in_place_of_another_is_one_change(self):
        setting = "measure.profile=null measure.plane_profile.axis=z"
        self.assertEqual(tune.knob({"setting": setting}), "measure.profile")
        self.assertEqual(tune.knob({"setting": setting + " lattice.voxel=2"}), "several")

    def test_tracers_are_so_many_diameters_away(self):
        rows = [row | {"field": "position"} for row in tune.read(self.table)]
        self.assertEqual(tune.draw(rows).axes[0].get_ylabel(), "rms distance [d]")

    def test_an_exact_setting_has_no_logarithm(self):
        rows = [row | {"rms": "0"} for row in tune.read(self.table) if row["field"] == "phi"]
        self.assertEqual(tune.draw(rows).axes[0].get_yscale(), "linear")

    def test_writes_the_picture(self):
        picture = self.table.with_suffix(".png")
        subprocess.run([sys.executable, "-m", "grainvdb.tune", self.table, picture], check=True, capture_output=True)
        self.assertTrue(picture.read_bytes().startswith(b"\x89PNG\r\n\x1a\n"))


if __name__ == "__main__":
    unittest.main()
