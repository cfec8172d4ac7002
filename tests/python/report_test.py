import base64
import html.parser
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

from grainvdb import laws, open_fields, plots
from grainvdb.page import html_table, with_error
from support import COMMAND, at_scales, reduced, result, write_tracers

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


class Tables(unittest.TestCase):
    def test_numbers_with_errors_are_numbers(self):
        table = html_table([("width", "1.2 ± 0.05", "nan", "-", "slope of the variance against height")])
        self.assertIn("<td>width</td><td class=n>1.2 ± 0.05</td><td class=n>nan</td><td>-</td><td class=long>slope", table)

    def test_errors_have_two_digits(self):
        self.assertEqual(with_error(0.0046213, 0.00056614), "0.004621 ± 0.00057")
        self.assertEqual(with_error(12.5, np.nan), "12.5")


def report(folder, *options):
    return subprocess.run([COMMAND, "report", folder, *options], capture_output=True, text=True, check=False)


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

    def test_says_what_is_wrong(self):
        with tempfile.TemporaryDirectory() as empty:
            done = report(empty)
            self.assertEqual(done.returncode, 2)
            self.assertIn("neither fields.hdf nor tracers.h5 nor tables.h5", done.stderr)
        self.assertEqual(report(self.folder, "--axis", "w").returncode, 1)
        (self.folder / "fields.hdf").write_bytes(b"cut short")
        done = report(self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("not an HDF5 file", done.stderr)
        self.assertNotIn("Traceback", done.stderr)


class Laws(unittest.TestCase):
    def test_published_values(self):
        """The values of (3) and of mu(I) that are printed with them, to their last digit."""
        np.testing.assert_allclose(laws.fluidity(np.array([0.50, 0.55, 0.58, 0.60, 0.62]), *laws.FLUIDITY_3),
                                   [1.9801, 1.9486, 1.7415, 1.0930, 0.2942], atol=5e-5)
        np.testing.assert_allclose(laws.friction(np.array([0.01, 0.1, 0.2, 1]), *laws.INERTIAL), [0.1405, 0.2633, 0.335, 0.4783], atol=5e-5)


if __name__ == "__main__":
    unittest.main()
