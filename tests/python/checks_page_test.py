"""The tests that docs/measurement_checks.md names are there."""
import re
import unittest

from support import ROOT

_NAMED = re.compile(r"`(\w*)\.(\w+|\*)`")
_TEST = re.compile(r"^TEST(?:_[PF])?\((\w+),\s*(\w+)\)", re.MULTILINE)
_METHOD = re.compile(r"^class (\w+)|^    def (test_\w+)", re.MULTILINE)


def existing():
    found = {match.groups() for file in (ROOT / "tests").rglob("*.cpp") for match in _TEST.finditer(file.read_text())}
    for file in (ROOT / "tests/python").glob("*_test.py"):
        suite = ""
        for match in _METHOD.finditer(file.read_text()):
            suite = match[1] or suite
            if match[2]:
                found.add((suite, match[2]))
    return found


class ChecksPage(unittest.TestCase):
    def test_names_are_those_of_tests(self):
        tests = existing()
        suites = {suite for suite, _ in tests}
        named = 0
        for line in (ROOT / "docs/measurement_checks.md").read_text().splitlines():
            if not line.startswith("|"):
                continue
            suite = ""
            for match in _NAMED.finditer(line):
                suite = match[1] or suite  # `.Name` is of the suite before it
                named += 1
                self.assertIn(suite, suites, line)
                if match[2] != "*":
                    self.assertIn((suite, match[2]), tests, line)
        self.assertGreater(named, 50)


if __name__ == "__main__":
    unittest.main()
