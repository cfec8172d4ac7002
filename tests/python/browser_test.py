"""The page of a report in a browser, where there is Chromium."""
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

from support import result, side_by_side

from grainvdb.beside import write_comparison
from grainvdb.report import write_report

CHROMIUM = shutil.which("chromium")
WIDTH = 1280

# What the browser made of the page: the width of each picture in pixels of its own, and whether anything sticks out.
LOOK = """<script>
document.title = [...document.images].map(image => image.naturalWidth).join(" ")
  + " | " + (document.documentElement.scrollWidth <= document.documentElement.clientWidth ? "fits" : "sticks out");
</script></body>"""


@unittest.skipUnless(CHROMIUM, "Chromium is not installed")
class Browser(unittest.TestCase):
    def test_draws_every_picture_within_the_window(self):
        self.look(lambda folder: write_report(str(result()), folder))

    def test_draws_results_side_by_side(self):
        self.look(lambda folder: write_comparison([str(one) for one in side_by_side()], folder))

    def look(self, write):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            files = write(str(folder))
            page = (folder / "report.html").read_text()
            (folder / "looked_at.html").write_text(page.replace("</body>", LOOK))
            shown = subprocess.run([CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", f"--window-size={WIDTH},900", "--dump-dom",
                                    f"--user-data-dir={folder / 'profile'}", f"file://{folder / 'looked_at.html'}"],
                                   capture_output=True, text=True, timeout=300, check=True).stdout
        widths, verdict = re.search(r"<title>(.*) \| (.*)</title>", shown).groups()
        self.assertEqual(len(widths.split()), sum(file.endswith(".png") for file in files))
        self.assertTrue(all(int(width) > 100 for width in widths.split()), widths)
        self.assertEqual(verdict, "fits")


if __name__ == "__main__":
    unittest.main()
