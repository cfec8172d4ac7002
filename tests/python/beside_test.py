"""Results side by side: a silo by forces and by spots, through the same measurements."""
import pathlib
import re
import shutil
import tempfile
import unittest

import matplotlib.colors
import matplotlib.pyplot as plt
import numpy as np

from grainvdb import Number, beside, compare, hdf, lawplots, laws, open_fields, open_tables, plots
from report_test import Page, curves, names, report, write_fits
from support import measured, reduced, result, side_by_side, write_tracers


def number(value, error):
    return Number("n", value, error, "1", "a number")


class SideBySide(unittest.TestCase):
    def setUp(self):
        self.dem, self.spot = side_by_side()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def results(self):
        opened = {"DEM": compare.open_result(self.dem), "spots": compare.open_result(self.spot)}
        for one in opened.values():
            self.addCleanup(one.close)
        return opened

    def fields(self):
        return compare.fields_of(self.results())

    def test_one_page_holds_both(self):
        done = report(self.dem, "--beside", self.spot, "--label", "DEM", "the spots", "--output", self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        text = (self.folder / "report.html").read_text()
        page = Page(text)
        self.assertEqual(page.headings[:6], ["What is compared", "Numbers", "Velocity profiles", "Slices", "Profiles", "Spreading of grains"])
        self.assertEqual(page.headings[-2:], ["Provenance of DEM", "Provenance of the spots"])
        self.assertEqual(set(page.headings[6:-2]), {f"Measured: {name.replace('_', ' ')}" for name in open_tables(self.dem)})
        self.assertEqual(page.loads, [])
        self.assertEqual(len(page.pictures), len(list(self.folder.glob("*.png"))))
        self.assertIn("grainvdb: DEM beside the spots", text)
        # What was measured in another way on the two sides is said.
        self.assertRegex(text, r"<td>of a simulation</td><td[^>]*>of a spot run: there are no forces, and velocities are displacements")
        self.assertRegex(text, r"\n-  particles: .*full_.*\n\+  particles: .*spot_")

    def test_the_page_lies_in_the_first_folder(self):
        copy = shutil.copytree(self.dem, self.folder / "copy")
        self.assertEqual(report(copy, "--beside", self.spot).returncode, 0)
        self.assertTrue((copy / "beside/report.html").is_file())
        self.assertFalse((copy / "report").exists())

    def test_numbers_are_those_of_the_tables(self):
        rows = {row[:2]: row[2:] for row in beside.number_rows(compare.common_tables(self.results()))}
        with open_tables(self.dem) as a, open_tables(self.spot) as b:
            for name, table in a.items():
                for key, first in table.numbers.items():
                    second = b[name].numbers[key]
                    row = rows[name, key]
                    self.assertEqual(row[:2], (first.description, first.unit))
                    self.assertEqual(row[4], f"{second.value - first.value:.4g}")
                    if np.isfinite(first.error + second.error):
                        self.assertEqual(row[5], f"{(second.value - first.value) / np.hypot(first.error, second.error):+.1f}")
                    else:
                        self.assertEqual(row[5], "-")
        self.assertIn(("coordination", "coordination"), rows)

    def test_curves_that_lie_apart_do_not_collapse(self):
        def curve(shift):
            phi = np.array([0.55, 0.56, 0.57])
            return {"phi": phi, "mean": shift + 100 * (phi - 0.56), "spread": np.full(3, 0.1), "points": np.full(3, 50)}

        same = compare.collapse_of({"one": curve(0), "two": curve(0)}).told
        # 300 values about their bins' means, sd 0.1, of a variance of 2/3.
        self.assertAlmostEqual(same, 1 - 0.01 / (2 / 3 + 0.01), delta=0.001)
        apart = compare.collapse_of({"one": curve(0), "two": curve(4)}).told
        # Half the distance of the curves, squared, joins the scatter.
        self.assertAlmostEqual(apart, 1 - 4.01 / (2 / 3 + 4.01), delta=0.01)

    def test_a_result_differs_from_itself_by_nothing(self):
        same = {"one": compare.open_result(self.dem), "two": compare.open_result(self.dem)}
        for row in beside.number_rows(compare.common_tables(same)):
            self.assertIn(row[6], ("0", "nan"), row)
            self.assertIn(row[7], ("+0.0", "-"), row)
        for one in same.values():
            one.close()

    def test_curves_are_on_the_same_axes(self):
        tables = compare.common_tables(self.results())["pair_correlation"]
        ax = compare.columns(tables, "g")
        lines = [container.lines[0] for container in ax.containers]
        self.assertEqual([container.get_label() for container in ax.containers], ["DEM", "spots"])
        for line, table in zip(lines, tables.values()):
            np.testing.assert_array_equal(line.get_xdata(), table["r"])
            np.testing.assert_array_equal(line.get_ydata(), table["g"])

    def test_spreading_is_drawn_against_the_way_travelled(self):
        tables = compare.common_tables(self.results())["diffusion"]
        ax = compare.columns(tables, "variance_y", against="travelled")
        self.assertEqual(ax.get_xlabel(), "travelled [sigma]")
        np.testing.assert_array_equal(ax.containers[1].lines[0].get_xdata(), tables["spots"]["travelled"])

    def test_velocity_profiles_are_means_over_the_depth(self):
        results = self.fields()
        at = compare.heights(results, "velocity", "z", "x")
        self.assertEqual(len(at), 6)
        ax = compare.profile_across(results, "velocity", at[2], "z", "x")
        for line, one in zip(ax.get_lines(), results.values()):
            velocity = one["velocity"].sel(component3="z").sel(z=at[2], method="nearest")
            np.testing.assert_array_equal(line.get_xdata(), velocity.x)
            # 16 voxels deep: each sum is rounded at most so often, by 2^-53 of floats that are exact.
            np.testing.assert_allclose(line.get_ydata(), velocity.astype(float).mean("y"), rtol=16 * 2**-53)
        self.assertLess(ax.get_lines()[0].get_ydata().min(), -0.3)  # it flows down

    def test_pictures_of_a_field_share_their_colours_and_places(self):
        results = self.fields()
        figure = beside.slices(results, "y", [3, 5])
        drawn = [ax for ax in figure.axes if ax.images and ax.get_title()]
        self.assertEqual([ax.get_title().split(":")[0] for ax in drawn], ["DEM", "spots"] * (len(drawn) // 2))
        for left, right in zip(drawn[::2], drawn[1::2]):
            self.assertEqual(left.images[0].get_clim(), right.images[0].get_clim())
            self.assertEqual(left.images[0].get_cmap(), right.images[0].get_cmap())
            self.assertEqual((left.get_xlim(), left.get_ylim()), (right.get_xlim(), right.get_ylim()))
        layer = np.ma.masked_invalid(plots.layer(results["spots"], "phi", "y", 5))
        np.testing.assert_array_equal(layer, drawn[1].images[0].get_array())

    def test_maps_show_where_it_is_loose(self):
        tables = compare.common_tables(self.results())["voronoi_map"]
        figure = beside.maps(tables, ["cells", "kernel"])
        drawn = [ax for ax in figure.axes if ax.get_title()]
        self.assertEqual([ax.get_title() for ax in drawn], ["DEM: cells", "spots: cells", "DEM: kernel", "spots: kernel"])
        self.assertEqual(drawn[0].images[0].get_clim(), drawn[1].images[0].get_clim())
        table = tables["DEM"]
        shown = drawn[0].images[0].get_array()
        self.assertEqual(shown.count(), len(table["cells"]))
        k = len(table["cells"]) // 3
        row, column = (round(table[c][k] - table[c].min()) for c in ("z", "x"))  # the squares are a diameter wide
        self.assertEqual(shown[row, column], table["cells"][k])

    def test_tables_of_places_are_known(self):
        with open_tables(self.dem) as tables:
            self.assertEqual({name for name, table in tables.items() if plots.is_map(table)}, {"voronoi_map", "kinematic_fit"})

    def test_what_one_lacks_is_said(self):
        shutil.copy(self.dem / "tables.h5", self.folder)
        done = report(self.spot, "--beside", self.folder, "--label", "all", "few", "-o", self.folder / "page")
        self.assertEqual(done.returncode, 0, done.stderr)
        text = (self.folder / "page/report.html").read_text()
        self.assertIn("few lacks the field phi, the field shear_rate, the field velocity.", text)
        self.assertNotIn("Slices", Page(text).headings)

    def test_more_than_two_are_compared_with_the_first(self):
        done = report(self.dem, "--beside", self.spot, self.dem, "--label", "a", "b", "c", "-o", self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("<th>a</th><th>b</th><th>difference</th><th>in errors</th><th>c</th><th>difference</th><th>in errors</th>",
                      (self.folder / "report.html").read_text())

    def test_paths_of_tracers_are_drawn_where_all_have_them(self):
        for name in ("one", "two"):
            (self.folder / name).mkdir()
            write_tracers(self.folder / name)
        done = report(self.folder / "one", "--beside", self.folder / "two")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Tracers", Page((self.folder / "one/beside/report.html").read_text()).headings)


class LawsOfRuns(unittest.TestCase):
    """Two results in one panel with the laws."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(plt.close, "all")
        self.folders = {name: pathlib.Path(folder.name) / name for name in ("one", "two")}
        for (name, path), fluidity in zip(self.folders.items(), ((1.9, 0.58, 2e-4, 0.05), [np.nan] * 4)):
            path.mkdir()
            shutil.copy(result() / "fields.hdf", path)
            write_fits(path / "tables.h5", fluidity)

    def tables(self, name):
        opened = {label: open_tables(path) for label, path in self.folders.items()}
        for one in opened.values():
            self.addCleanup(one.close)
        return {label: one[name] for label, one in opened.items()}

    def test_each_has_its_points_and_its_fit(self):
        tables = self.tables("fluidity")
        (panel,) = lawplots.panels_of_all(tables)
        ax = lawplots.runs_with_laws(tables, panel)
        self.assertEqual(names(ax), ["(3)", "one", "one: (A20), fitted", "two"])  # that of two was refused
        phi = np.array([0.52, 0.56, 0.58, 0.60])
        line = curves(ax)["one: (A20), fitted"]
        np.testing.assert_array_equal(line.get_ydata(), laws.fluidity(phi, 1.9, 0.58, 2e-4, 0.05))
        self.assertEqual((line.get_linestyle(), line.get_color()), ("--", "C0"))
        np.testing.assert_array_equal(curves(ax)["(3)"].get_xdata(), np.repeat(phi, 2))
        np.testing.assert_array_equal(curves(ax)["(3)"].get_ydata(), laws.fluidity(np.repeat(phi, 2), *laws.FLUIDITY_3))
        for container, (label, table) in zip(ax.containers, tables.items()):
            self.assertEqual(container.get_label(), label)
            np.testing.assert_array_equal(container.lines[0].get_ydata(), table["gd_over_dv"])

    def test_panels_are_those_that_all_have(self):
        tables = self.tables("rheology")
        self.assertEqual([panel.y for panel in lawplots.panels_of_all(tables)], ["mu", "phi"])
        ax = lawplots.runs_with_laws(tables, lawplots.panels_of_all(tables)[0])
        self.assertEqual(ax.get_xscale(), "log")
        self.assertEqual(names(ax), ["one", "one: μ(I), fitted", "two", "two: μ(I), fitted", "μ(I) = 0.12 … 0.55, I₀ = 0.2"])

    def test_voxels_of_all_are_drawn_with_the_laws(self):
        with open_fields(result()) as a, open_fields(result("4")) as b:
            results = {"a": a, "b": b}
            ax = compare.fluidity_against_phi(results, {"a": None, "b": (1.9, 0.57, 2e-4, 0.05)})
            self.assertEqual(names(ax), ["(3)", "a", "b", "b: (A20), fitted"])
            drawn = ax.collections[0].get_offsets()
            expected = []
            for fields in results.values():
                phi, g = (fields.values(name, -1).astype(float) for name in ("phi", "gd_over_dv"))
                kept = np.isfinite(g) & (phi >= plots.smeared_below(fields))
                expected.append(np.column_stack([phi[kept], g[kept]]))
            self.assertEqual([np.count_nonzero(np.all(ax.collections[0].get_facecolor()[:, :3] == matplotlib.colors.to_rgb(f"C{k}"), axis=1)) for k in (0, 1)],
                             [len(points) for points in expected])
            def ordered(points):
                return points[np.lexsort(points.T)]

            np.testing.assert_array_equal(ordered(np.asarray(drawn)), ordered(np.concatenate(expected)))
            ax = compare.friction_against_inertial(results, {"a": (0.2, 0.6, 0.3), "b": None})
            self.assertEqual(names(ax), ["a", "a: μ(I), fitted", "b", "μ(I) = 0.12 … 0.55, I₀ = 0.2"])
            line = curves(ax)["a: μ(I), fitted"]
            np.testing.assert_array_equal(line.get_ydata(), laws.friction(line.get_xdata(), 0.2, 0.6, 0.3))

    def test_are_in_the_page(self):
        one, two = self.folders.values()
        done = report(one, "--beside", two)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = Page((one / "beside/report.html").read_text())
        self.assertIn("Rheology", page.headings)
        self.assertLessEqual({"rheology.png", "table_fluidity_laws.png", "table_rheology_laws.png"}, {path.name for path in (one / "beside").iterdir()})


class Refusals(unittest.TestCase):
    def test_different_units(self):
        with tempfile.TemporaryDirectory() as folder:
            done = report(result(), "--beside", reduced(), "-o", folder)
            self.assertEqual(done.returncode, 2)
            self.assertRegex(done.stderr, "the results are in different units: the axis x is in m in window-all, in d in reduced")
            self.assertIn("output.reduced", done.stderr)
            self.assertEqual(list(pathlib.Path(folder).iterdir()), [])
            self.assertEqual(report(reduced(), "--beside", reduced(), "-o", folder).returncode, 0)

    def test_what_is_no_result(self):
        with tempfile.TemporaryDirectory() as empty:
            done = report(measured(), "--beside", empty)
            self.assertEqual(done.returncode, 2)
            self.assertIn("neither fields.hdf nor tracers.h5 nor tables.h5", done.stderr)

    def test_options_that_do_not_go_together(self):
        for options in (["--label", "a", "b"], ["--beside", measured(), "--label", "a"], ["--beside", measured(), "--label", "a", "b", "c"],
                        ["--beside", measured(), "--fitted", "1", "2", "3", "4"]):
            done = report(measured(), *options)
            self.assertEqual(done.returncode, 1, options)
            self.assertIn("Run 'grainvdb report --help' for usage.", done.stderr)


class Arithmetic(unittest.TestCase):
    def test_differences_are_in_combined_errors(self):
        self.assertEqual(compare.deviation(number(1, 3), number(11, 4)), 2)
        self.assertEqual(compare.deviation(number(11, 3), number(1, 4)), -2)
        for a, b in ((number(1, np.nan), number(2, 1)), (number(1, 0), number(2, 0)), (number(np.nan, 1), number(2, 1))):
            self.assertTrue(np.isnan(compare.deviation(a, b)))

    def test_labels(self):
        self.assertEqual(beside.labels_of(["a/x/", "b"], None), ["x", "b"])
        self.assertEqual(beside.labels_of(["/a/x", "/b/x"], None), ["/a/x", "/b/x"])
        self.assertEqual(beside.labels_of(["/a/x", "/b/x"], ["one", "two"]), ["one", "two"])

    def test_colours_span_all_that_is_drawn(self):
        scale = plots.colours(np.array([1.0, 2.0, np.nan]), np.linspace(2, 5, 100))
        self.assertEqual((scale["cmap"], round(scale["vmax"], 1)), ("viridis", 5.0))
        scale = plots.colours(np.full(100, -3.0), np.full(100, 1.0))
        self.assertEqual((scale["cmap"], scale["vmin"], scale["vmax"]), ("RdBu_r", -3.0, 3.0))


if __name__ == "__main__":
    unittest.main()
