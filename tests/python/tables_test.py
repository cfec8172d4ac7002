import csv
import tempfile
import pathlib
import subprocess
import sys
import unittest

import numpy as np

import grainvdb
from grainvdb import hdf
from support import measured, result


class Measured(unittest.TestCase):
    def setUp(self):
        self.tables = grainvdb.open_tables(measured())
        self.addCleanup(self.tables.close)

    def test_columns_are_those_of_the_text_files(self):
        for name, table in self.tables.items():
            path = measured() / "tables" / f"{name}.csv"
            if not table.columns:
                self.assertFalse(path.exists())
                continue
            lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
            rows = list(csv.reader(lines))
            self.assertEqual(rows[0], [f"{column} [{table.unit(column)}]" for column in table.columns])
            values = np.array(rows[1:], dtype=float)
            for k, column in enumerate(table.columns):
                np.testing.assert_array_equal(values[:, k], table[column])

    def test_numbers_are_those_of_the_text_file(self):
        with open(measured() / "tables/numbers.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        told = {(name, n.name): n for name, table in self.tables.items() for n in table.numbers.values()}
        self.assertEqual({(row["table"], row["quantity"]) for row in rows}, set(told))
        for row in rows:
            number = told[row["table"], row["quantity"]]
            np.testing.assert_equal(float(row["value"]), number.value)
            np.testing.assert_equal(float(row["error"]), number.error)
            self.assertEqual((row["unit"], row["description"]), (number.unit, number.description))

    def test_a_table_becomes_a_data_frame(self):
        table = self.tables["pair_correlation"]
        frame = table.table()
        self.assertEqual(list(frame.columns), table.columns)
        np.testing.assert_array_equal(frame[table.columns[1]], table[table.columns[1]])
        self.assertEqual(frame.attrs["units"], {c: table.unit(c) for c in table.columns})

    def test_unknown_names_say_what_there_is(self):
        with self.assertRaisesRegex(KeyError, "pair_correlation"):
            self.tables["pair"]
        with self.assertRaisesRegex(KeyError, "has no column"):
            self.tables["pair_correlation"]["mass"]

    def test_says_where_it_comes_from(self):
        self.assertIn("pair_correlation", self.tables.provenance["measured"])

    def test_the_report_draws_each_table(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, "-m", "grainvdb.report", measured(), "--output", folder], check=True, capture_output=True)
            page = (pathlib.Path(folder) / "report.html").read_text()
            for name, table in self.tables.items():
                self.assertIn(f"Measured: {name.replace('_', ' ')}", page)
                for number in table.numbers:
                    self.assertIn(number, page)

    def test_other_files_are_refused(self):
        with self.assertRaisesRegex(hdf.ResultError, "has no tables"):
            grainvdb.open_tables(result() / "fields.hdf")


if __name__ == "__main__":
    unittest.main()
