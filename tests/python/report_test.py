import base64
import html
import html.parser
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest
import warnings

import matplotlib.pyplot as plt
import numpy as np

from grainvdb import laws, lawplots, open_fields, open_tables, plots
from grainvdb.page import html_table, with_error
from support import COMMAND, at_scales, last_alone, measured, reduced, result, write_table, write_tracers

PNG = b"\x89PNG\r\n\x1a\n"


class Page(html.parser.HTMLParser):
    """What a page shows, and whatever it would load from elsewhere."""

    def __init__(self, text):
        super().__init__()
        self.headings, self.pictures, self.loads, self._in_heading = [], [], [], False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self._in_heading = tag == "h2"
        if tag == "img":
            self.pictures.append(attributes["src"])
        if tag in ("script", "link") or str(attributes.get("src", "data:")).split(":")[0] != "data":
            self.loads.append((tag, attributes))

    def handle_data(self, data):
        if self._in_heading:
            self.headings.append(data)
            self._in_heading = False


# Every warning is an error, but for those of the parser of Debian 12's matplotlib.
WARNINGS = "error,ignore::UserWarning:matplotlib._mathtext,ignore::UserWarning:pyparsing.core"


class Tables(unittest.TestCase):
    def test_numbers_with_errors_are_numbers(self):
        table = html_table([("width", "1.2 ± 0.05", "nan", "-", "slope of the variance against height")])
        self.assertIn("<td>width</td><td class=n>1.2 ± 0.05</td><td class=n>nan</td><td>-</td><td class=long>slope", table)

    def test_errors_have_two_digits(self):
        self.assertEqual(with_error(0.0046213, 0.00056614), "0.004621 ± 0.00057")
        self.assertEqual(with_error(12.5, np.nan), "12.5")


def report(folder, *options):
    return subprocess.run([COMMAND, "report", folder, *options], capture_output=True, text=True, check=False, env=os.environ | {"PYTHONWARNINGS": WARNINGS})


def write_fits(path, fluidity=(1.9, 0.58, 2e-4, 0.05), friction=(0.2, 0.6, 0.3)):
    """Tables of both laws, rows in no order; the last of `rheology` is outside the shear band."""
    phi = np.array([0.60, 0.52, 0.56, 0.58])
    write_table(path, "fluidity", {"phi": phi, "gd_over_dv": laws.fluidity(phi, *laws.FLUIDITY_3) + 0.1, "gd_over_dv_error": np.full(4, 0.05),
                                   "fit": laws.fluidity(phi, *fluidity), "law_3": laws.fluidity(phi, *laws.FLUIDITY_3)},
                dict(zip(lawplots.FLUIDITY, fluidity)))
    i = np.array([0.1, 0.01, 0.3, 0.001])
    write_table(path, "rheology", {"inertial_number": i, "inertial_number_error": i / 10, "mu": 0.3 + i, "mu_error": np.full(4, 0.02), "phi": 0.6 - i / 5,
                                   "phi_error": np.full(4, 0.01), "mu_fit": laws.friction(i, *friction), "mu_law": laws.friction(i, *laws.INERTIAL),
                                   "phi_fit": 0.6 - i / 4, "in_band": np.array([1.0, 1, 1, 0])}, dict(zip(lawplots.FRICTION, friction)))


def curves(ax):
    """The lines that have a name, by it, but for the measured points."""
    return {line.get_label(): line for line in ax.get_lines() if not line.get_label().startswith("_")}


def names(ax):
    return sorted(text.get_text() for text in ax.get_legend().get_texts())


class Report(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        shutil.copy(result() / "fields.hdf", self.folder)

    def test_page_of_reduced_units_names_them(self):
        shutil.copy(reduced() / "fields.hdf", self.folder)
        done = report(self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = (self.folder / "report/report.html").read_text()
        self.assertIn("<td>rho_p g d</td>", page)
        self.assertRegex(page, r"edge \S+ d<")
        self.assertNotIn(">Pa<", page)

    def test_page_holds_everything(self):
        write_tracers(self.folder)
        shutil.copy(result() / "run.json", self.folder)
        done = report(self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = Page((self.folder / "report/report.html").read_text())
        self.assertEqual(page.headings, ["Overview", "Slices", "Profiles", "Rheology", "Where fields have no value", "Fields", "Tracers", "What the run took", "Provenance"])
        self.assertEqual(page.loads, [])
        shown = [base64.b64decode(source.split(",")[1]) for source in page.pictures]
        self.assertTrue(all(picture.startswith(PNG) for picture in shown))
        files = {path.name: path.read_bytes() for path in (self.folder / "report").glob("*.png")}
        self.assertEqual(sorted(files.values()), sorted(shown))
        self.assertEqual(set(re.findall(r"wrote .*/(\S+)", done.stdout)), set(files) | {"report.html"})

    def test_the_same_result_gives_the_same_page(self):
        pages = []
        for name in ("one", "two"):
            self.assertEqual(report(self.folder, "--output", self.folder / name).returncode, 0)
            pages.append((self.folder / name / "report.html").read_bytes())
        self.assertEqual(*pages)

    def test_scales_are_compared_in_one_picture(self):
        with tempfile.TemporaryDirectory() as page:
            done = report(at_scales(), "--output", page)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(Page((pathlib.Path(page) / "report.html").read_text()).headings, ["Scales"])
        results = {name: open_fields(at_scales() / name) for name in ("c0.0016_h4.0e-04", "c0.0024_h8.0e-04")}
        lines = plots.scales(results, "phi").get_lines()
        self.assertEqual([line.get_label() for line in lines], list(results))
        for line, fields in zip(lines, results.values()):
            # Means over 256 floats at most, each sum rounded at most so often by 2^-24 of itself.
            np.testing.assert_allclose(line.get_xdata(), fields["phi"].mean(("x", "y")), rtol=256 * 2**-24)
            np.testing.assert_array_equal(line.get_ydata(), fields.axis("z"))
            fields.close()

    def caption(self, *options):
        """Of the picture of the voxels' laws."""
        done = report(self.folder, *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = html.unescape((self.folder / "report/report.html").read_text())
        return re.search(r"<figcaption>(Granular fluidity[^<]*)</figcaption>", page)[1]

    def test_caption_says_where_dashed_laws_come_from(self):
        self.assertNotIn("dashed", self.caption())
        write_fits(self.folder / "tables.h5")
        caption = self.caption()
        self.assertIn("dashed: (A20) with the parameters fitted in table fluidity", caption)
        self.assertIn("dashed: of those fitted in table rheology", caption)
        self.assertIn("dashed: (A20) with the parameters given with --fitted", self.caption("--fitted", "2", "0.58", "1e-4", "0.04"))

    def test_says_what_is_wrong(self):
        with tempfile.TemporaryDirectory() as empty:
            done = report(empty)
            self.assertEqual(done.returncode, 2)
            self.assertIn("neither fields.hdf nor tracers.h5 nor tables.h5", done.stderr)
        self.assertEqual(report(self.folder, "--axis", "w").returncode, 1)
        for place in ("nan", "inf"):
            done = report(self.folder, "--at", place)
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"--at: expected a finite number, found '{place}'", done.stderr)
        (self.folder / "fields.hdf").write_bytes(b"cut short")
        done = report(self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("not an HDF5 file", done.stderr)
        self.assertNotIn("Traceback", done.stderr)


class Voxels(unittest.TestCase):
    """Pictures of fields, any warning an error."""

    def setUp(self):
        self.fields = open_fields(result())
        self.addCleanup(self.fields.close)
        self.addCleanup(plt.close, "all")
        caught = warnings.catch_warnings()
        caught.__enter__()
        self.addCleanup(caught.__exit__, None, None, None)
        warnings.simplefilter("error")

    def test_laws_over_voxels(self):
        given = (1.9, 0.57, 2e-4, 0.05)
        ax = plots.fluidity_against_phi(self.fields, fitted=given)
        self.assertEqual(list(curves(ax)), ["(3)", "(A20), fitted"])
        for line, parameters in zip(curves(ax).values(), (laws.FLUIDITY_3, given)):
            np.testing.assert_array_equal(line.get_ydata(), laws.fluidity(line.get_xdata(), *parameters))
        self.assertEqual(curves(ax)["(A20), fitted"].get_linestyle(), "--")
        self.assertEqual(list(curves(plots.fluidity_against_phi(self.fields))), ["(3)"])
        ax = plots.friction_against_inertial(self.fields, fitted=(0.2, 0.6, 0.3))
        self.assertEqual(list(curves(ax)), ["μ(I) = 0.12 … 0.55, I₀ = 0.2", "fitted: μ(I) = 0.2 … 0.6, I₀ = 0.3"])
        line = curves(ax)["fitted: μ(I) = 0.2 … 0.6, I₀ = 0.3"]
        np.testing.assert_array_equal(line.get_ydata(), laws.friction(line.get_xdata(), 0.2, 0.6, 0.3))

    def test_smeared_edges_are_left_out(self):
        phi, gd_over_dv = (self.fields.values(name, -1) for name in ("phi", "gd_over_dv"))
        least = plots.smeared_below(self.fields)
        self.assertEqual(least, 0.8 * np.percentile(phi[phi > 0], 90))
        drawn = plots.fluidity_against_phi(self.fields).collections[0].get_offsets()
        defined = phi[np.isfinite(gd_over_dv)]
        self.assertLess(len(drawn), len(defined))
        np.testing.assert_array_equal(np.sort(drawn[:, 0]), np.sort(defined[defined >= least]))

    def test_bars_of_profiles(self):
        """Of scalars, of magnitudes and of a third of the trace; a layer without any has none."""
        velocity, error = self.fields.values("velocity", -1).astype(float), self.fields.values("velocity_error", -1).astype(float)
        speed = np.sqrt((velocity**2).sum(axis=3))
        of_speed = np.sqrt(((velocity * error)**2).sum(axis=3)) / np.where(speed > 0, speed, np.nan)
        of_stress = np.sqrt((self.fields.values("stress_error", -1).astype(float)[..., [0, 4, 8]]**2).sum(axis=3)) / 3
        expected = {"mu": self.fields.values("mu_error", -1).astype(float), "velocity": of_speed, "stress": of_stress}
        for name, errors in expected.items():
            bars = plots.profile(self.fields, name).containers[0].lines[2][0].get_segments()
            count = np.isfinite(errors).sum(axis=(1, 2))
            self.assertTrue(name == "stress" or 0 in count)
            means = np.nansum(errors, axis=(1, 2))[count > 0] / count[count > 0]
            lengths = np.array([segment[1][0] - segment[0][0] for segment in bars if len(segment) and np.all(np.isfinite(segment))])
            # The ends are mean ± error in double precision, and errors are above 1e-6 of the means.
            np.testing.assert_allclose(lengths, 2 * means, rtol=1e-9)
        self.assertIsNone(plots.scalar_error(self.fields, "temperature"))


    def test_a_single_frame_has_no_errors_and_no_bars(self):
        with open_fields(last_alone()) as fields:
            self.assertFalse(np.any(np.isfinite(fields.values("mu_error", -1))))
            line, _, bars = plots.profile(fields, "mu").containers[0].lines
            self.assertTrue(np.any(np.isfinite(line.get_xdata())))
            self.assertEqual(bars, ())


class MeasuredLaws(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(plt.close, "all")
        self.path = pathlib.Path(folder.name) / "tables.h5"

    def drawn(self):
        tables = open_tables(self.path)
        self.addCleanup(tables.close)
        return {panel.y: lawplots.measured_with_laws(table, panel) for table in tables.values() for panel in lawplots.law_panels(table)}

    def test_one_panel_has_values_fit_and_law(self):
        write_fits(self.path)
        drawn = self.drawn()
        self.assertEqual({y: names(ax) for y, ax in drawn.items()},
                         {"gd_over_dv": ["(3)", "(A20), fitted", "measured"],
                          "mu": ["measured", "outside the shear band", "μ(I) = 0.12 … 0.55, I₀ = 0.2", "μ(I), fitted"],
                          "phi": ["measured", "outside the shear band", "φ(I), fitted"]})
        lines = curves(drawn["gd_over_dv"])
        self.assertEqual({text: line.get_linestyle() for text, line in lines.items()}, {"(3)": "-", "(A20), fitted": "--"})
        phi = np.array([0.52, 0.56, 0.58, 0.60])
        np.testing.assert_array_equal(lines["(A20), fitted"].get_xdata(), phi)
        np.testing.assert_array_equal(lines["(A20), fitted"].get_ydata(), laws.fluidity(phi, 1.9, 0.58, 2e-4, 0.05))
        self.assertEqual(drawn["mu"].get_xscale(), "log")

    def test_legends_cover_no_error_bars(self):
        write_fits(self.path)
        for ax in self.drawn().values():
            ax.figure.draw_without_rendering()
            self.assertGreaterEqual(ax.get_legend().get_window_extent().y0, ax.bbox.y1)

    def test_refused_fits_are_not_drawn(self):
        write_fits(self.path, fluidity=[np.nan] * 4, friction=[np.nan] * 3)
        drawn = self.drawn()
        self.assertEqual(names(drawn["gd_over_dv"]), ["(3)", "measured"])
        with open_tables(self.path) as tables:
            self.assertEqual(lawplots.without_fit(tables["fluidity"]), ["(A20), fitted"])
            self.assertIsNone(lawplots.parameters(tables, "fluidity", lawplots.FLUIDITY))

    def test_values_without_any_error_have_no_bars(self):
        unknown = np.full(2, np.nan)
        write_table(self.path, "fluidity", {"phi": np.array([0.5, 0.6]), "gd_over_dv": np.ones(2), "gd_over_dv_error": unknown, "fit": unknown,
                                            "law_3": unknown}, {})
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            drawn = self.drawn()["gd_over_dv"]
        self.assertEqual(drawn.containers[0].lines[2], ())
        self.assertEqual(names(drawn), ["measured"])

    def test_parameters_are_the_numbers_of_the_table(self):
        write_fits(self.path)
        with open_tables(self.path) as tables:
            self.assertEqual(lawplots.parameters(tables, "fluidity", lawplots.FLUIDITY), (1.9, 0.58, 2e-4, 0.05))
            self.assertEqual(lawplots.parameters(tables, "rheology", lawplots.FRICTION), (0.2, 0.6, 0.3))
        self.assertIsNone(lawplots.parameters(None, "fluidity", lawplots.FLUIDITY))

    def test_measured_tables_have_the_columns_and_numbers(self):
        for pipeline, symbols, panels in (("fluidity", lawplots.FLUIDITY, ["gd_over_dv"]), ("rheology", lawplots.FRICTION, ["mu", "phi"])):
            with open_tables(measured(pipeline)) as tables:
                self.assertEqual([panel.y for panel in lawplots.law_panels(tables[pipeline])], panels)
                self.assertLessEqual(set(symbols), set(tables[pipeline].numbers))


class Laws(unittest.TestCase):
    def test_published_values(self):
        """The values of (3) and of mu(I) that are printed with them, to their last digit."""
        np.testing.assert_allclose(laws.fluidity(np.array([0.50, 0.55, 0.58, 0.60, 0.62]), *laws.FLUIDITY_3),
                                   [1.9801, 1.9486, 1.7415, 1.0930, 0.2942], atol=5e-5)
        np.testing.assert_allclose(laws.friction(np.array([0.01, 0.1, 0.2, 1]), *laws.INERTIAL), [0.1405, 0.2633, 0.335, 0.4783], atol=5e-5)


if __name__ == "__main__":
    unittest.main()
