import pathlib
import tempfile
import unittest

import h5py
import numpy as np

import grainvdb
from grainvdb import hdf
from support import write_tracers


class Histories(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name) / "tracers.h5"
        write_tracers(self.path)
        self.tracers = grainvdb.open_tracers(folder.name)
        self.addCleanup(self.tracers.close)

    def test_positions_go_on_across_the_periodic_side(self):
        np.testing.assert_array_equal(self.tracers.positions()[:, 0, 0], [9.0, 9.5, 10.5])
        np.testing.assert_array_equal(self.tracers.positions(unwrapped=False)[:, 0, 0], [9.0, 9.5, 0.5])

    def test_names_units_and_times(self):
        self.assertEqual(self.tracers.names, ["phi", "velocity"])
        self.assertEqual(self.tracers.unit("velocity"), "m/s")
        self.assertEqual(self.tracers.time_unit, "s")
        np.testing.assert_array_equal(self.tracers.ids, [3, 7])
        with self.assertRaisesRegex(KeyError, "'rho' was not recorded"):
            self.tracers.values("rho")

    def test_table_ends_where_a_tracer_stops(self):
        table = self.tracers.table()
        self.assertEqual(list(table.id), [3, 7, 3, 7, 3])
        np.testing.assert_allclose(table[table.id == 3].x, [9.0, 9.5, 10.5])
        self.assertEqual(self.tracers.stop_names[int(self.tracers.stop[-1, 1])], "left_material")
        self.assertIn("velocity_z", table.columns)

    def test_refuses_what_holds_no_tracers(self):
        other = self.path.with_name("other.h5")
        with h5py.File(other, "w") as file:
            file["x"] = [1.0]
        with self.assertRaisesRegex(hdf.ResultError, "has no tracers"):
            grainvdb.open_tracers(other)


if __name__ == "__main__":
    unittest.main()
