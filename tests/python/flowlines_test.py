"""Lines followed through fields, slip lines, and flows beside their theory."""
import pathlib
import tempfile
import unittest

import matplotlib.pyplot as plt
import numpy as np

from grainvdb import flowlines, lawplots, open_fields, open_tables, plots
from report_test import Page, report
from support import draining, measured, write_table


class FlowLines(unittest.TestCase):
    def setUp(self):
        self.tables = open_tables(draining())
        self.fields = open_fields(draining())
        self.table = self.tables["spot_streamlines"]
        for opened in (self.tables, self.fields):
            self.addCleanup(opened.close)
        self.addCleanup(plt.close, "all")

    def made_up(self, columns):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = pathlib.Path(folder.name) / "tables.h5"
        write_table(path, "spot_streamlines", columns, {})
        tables = open_tables(path)
        self.addCleanup(tables.close)
        return tables["spot_streamlines"]

    def test_are_known(self):
        self.assertEqual([name for name, table in self.tables.items() if flowlines.is_lines(table)], ["spot_streamlines"])

    def test_are_drawn_over_the_velocity_in_their_plane(self):
        ax = flowlines.flow_lines(self.table, self.fields)
        self.assertEqual((ax.get_xlabel(), ax.get_ylabel(), ax.get_title()), ("x [sigma]", "z [sigma]", "|velocity| [sigma/tau]"))
        drawn = [line for line in ax.get_lines() if line.get_linestyle() == "-"]
        begins = [line for line in ax.get_lines() if line.get_marker() == "."]
        number = self.table["line"]
        self.assertEqual(len(drawn), len(np.unique(number)))
        for line, begin, k in zip(drawn, begins, np.unique(number)):
            np.testing.assert_array_equal(line.get_xdata(), self.table["x"][number == k])
            np.testing.assert_array_equal(line.get_ydata(), self.table["z"][number == k])
            np.testing.assert_array_equal(begin.get_xydata(), [[self.table["x"][number == k][0], self.table["z"][number == k][0]]])
        index = int(np.argmin(np.abs(self.fields.axis("y") - self.table["y"].mean())))
        np.testing.assert_array_equal(ax.images[0].get_array(), np.ma.masked_invalid(plots.layer(self.fields, "velocity", "y", index)))

    def test_without_fields_are_drawn_alone(self):
        ax = flowlines.flow_lines(self.table)
        self.assertEqual(len(ax.images), 0)
        self.assertEqual(ax.get_aspect(), 1)

    def test_are_those_of_the_last_output_time(self):
        table = self.made_up({"way": np.zeros(5), "x": np.array([0.0, 1, 5, 6, 7]), "y": np.array([0.0, 9, 3, 4, 5]), "z": np.ones(5),
                              "line": np.array([0.0, 0, 1, 1, 4]), "output": np.array([0.0, 0, 2, 2, 2])})
        lines = flowlines.lines_of(table)
        np.testing.assert_array_equal(lines[0], [[5, 3, 1], [6, 4, 1]])
        np.testing.assert_array_equal(lines[1], [[7, 5, 1]])
        self.assertEqual(flowlines.plane_of(table), "z")

    def test_none_are_no_lines(self):
        table = self.made_up({name: np.array([]) for name in ("way", "x", "y", "z", "line", "output")})
        self.assertEqual(flowlines.lines_of(table), [])
        self.assertEqual(flowlines.flow_lines(table).get_lines()[:], [])

    def test_are_in_the_pages(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(report(draining(), "--output", folder).returncode, 0)
            text = (pathlib.Path(folder) / "report.html").read_text()
            self.assertTrue((pathlib.Path(folder) / "table_spot_streamlines.png").is_file())
            self.assertIn("the lines as seen along y, dots where they begin; of the last output time. Under them velocity", text)
        with tempfile.TemporaryDirectory() as folder:
            done = report(draining(), "--beside", draining(), "--label", "a", "b", "--output", folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("Table spot_streamlines: the lines as seen along y", (pathlib.Path(folder) / "report.html").read_text())
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(report(measured("plasticity"), "--output", folder).returncode, 0)
            self.assertIn("Measured: spot streamlines", Page((pathlib.Path(folder) / "report.html").read_text()).headings)


class SlipLines(unittest.TestCase):
    def test_of_both_families_cross_at_the_angle_that_is_shown(self):
        with open_fields(draining()) as fields:
            ax = plots.field_slice(fields, "slip_lines", "y", 3)
            self.assertEqual(ax.get_title(), "angle between slip lines [degrees]")
            first, second = ax.collections[:2]
            vectors = np.take(fields.values("slip_lines", -1), 3, axis=1)
            step = max(1, max(vectors.shape[:2]) // 14)
            part = vectors[step // 2::step, step // 2::step]
            for family, at in ((first, 0), (second, 3)):
                np.testing.assert_array_equal(~family.Umask, np.isfinite(part[..., at].ravel()))
                for drawn, component in ((family.U, at), (family.V, at + 2)):
                    np.testing.assert_array_equal(drawn[~family.Umask], part[..., component].ravel()[~family.Umask])
                self.assertEqual(family.headlength, 0)
            a, b = vectors[..., :3].astype(float), vectors[..., 3:].astype(float)
            # sin and cos of the whole angle, of unit vectors in floats.
            sine, cosine = np.linalg.norm(np.cross(a, b), axis=-1), np.abs((a * b).sum(axis=-1))
            shown = ax.images[0].get_array()
            known = np.isfinite(cosine)
            self.assertTrue(known.any())
            np.testing.assert_array_equal(known, ~np.ma.getmaskarray(shown))
            np.testing.assert_allclose(shown[known], np.degrees(np.arctan2(sine, cosine))[known], atol=1e-3)
        plt.close("all")


class FlowsWithTheory(unittest.TestCase):
    def test_lines_at_heights_are_rows_of_the_table(self):
        with open_tables(measured("kinematic")) as tables:
            self.assertEqual({name: lawplots.flow_pairs(table) for name, table in tables.items() if lawplots.flow_pairs(table)},
                             {"kinematic_fit": [("velocity", "fitted")], "mean_field": [("velocity", "drift"), ("sideways", "drift_sideways")]})
            table = tables["mean_field"]
            ax = lawplots.at_heights(table, "sideways", "drift_sideways", count=3)
            heights = np.unique(table["z"])
            chosen = heights[[0, round((len(heights) - 1) / 2), len(heights) - 1]]
            self.assertEqual([text.get_text() for text in ax.get_legend().get_texts()], [f"z = {z:.3g}" for z in chosen])
            for (points, line), z in zip(zip(ax.get_lines()[::2], ax.get_lines()[1::2]), chosen):
                row = table["z"] == z
                np.testing.assert_array_equal(points.get_xydata(), np.column_stack([table["x"][row], table["sideways"][row]]))
                np.testing.assert_array_equal(line.get_ydata(), table["drift_sideways"][row])
                self.assertEqual(points.get_color(), line.get_color())
        plt.close("all")

    def test_are_in_the_page(self):
        with tempfile.TemporaryDirectory() as folder:
            done = report(measured("kinematic"), "--output", folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertLessEqual({"table_mean_field.png", "table_mean_field_heights.png", "table_kinematic_fit_heights.png"},
                                 {path.name for path in pathlib.Path(folder).iterdir()})


if __name__ == "__main__":
    unittest.main()
