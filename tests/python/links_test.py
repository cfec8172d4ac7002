import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def pages():
    return [page for pattern in ("*.md", "docs/*.md", "sample_dumps/**/*.md", "tests/**/*.md") for page in ROOT.glob(pattern)]


def anchor(heading):
    """As GitHub makes it."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", re.sub(r"[`*]", "", heading.strip())).lower()
    return "".join(c for c in text.replace(" ", "-") if c.isalnum() or c in "-_")


def anchors(page):
    return {anchor(heading) for heading in re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)}


def broken_links(page):
    for link in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
        if "://" in link:
            continue
        path, _, part = link.partition("#")
        target = page.parent / path if path else page
        if not target.exists() or part and target.suffix == ".md" and part not in anchors(target):
            yield link


class Links(unittest.TestCase):
    def test_lead_to_files_and_headings(self):
        self.assertGreater(len(pages()), 20)
        self.assertEqual({page.name: links for page in pages() if (links := list(broken_links(page)))}, {})


if __name__ == "__main__":
    unittest.main()
