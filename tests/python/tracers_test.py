import pathlib
import tempfile
import unittest

import h5py
import numpy as np

import grainvdb
from grainvdb import hdf
from support import write_tracers

TRACERS, SAMPLES = 5, 3


def number(quantity, component):
    """The scene's numbers, of shape (sample, tracer): they tell quantity, component, tracer and sample apart."""
    sample, tracer = np.mgrid[0:SAMPLES, 0:TRACERS]
    return np.sqrt(2.0 + 1000 * quantity + 100 * component + tracer + 0.125 * sample)


class Histories(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        write_tracers(pathlib.Path(folder.name))
        self.folder = pathlib.Path(folder.name)
        self.tracers = grainvdb.open_tracers(folder.name)
        self.addCleanup(self.tracers.close)

    def test_positions_go_on_across_the_periodic_sides(self):
        sample, tracer = np.mgrid[0:SAMPLES, 0:TRACERS]
        wrapped = np.stack([number(1, axis) for axis in range(3)], axis=2)
        np.testing.assert_array_equal(self.tracers.positions(unwrapped=False), wrapped)
        crossed = sample * tracer  # times the length, backwards along x and forwards along z
        expected = wrapped + np.stack([-4.0 * crossed, 0.0 * crossed, 10.0 * crossed], axis=2)
        np.testing.assert_allclose(self.tracers.positions(), expected, rtol=1e-15)

    def test_names_units_and_times(self):
        self.assertEqual(set(self.tracers.names),
                         {"phi", "velocity", "stress", "displacement", "strain", "courant", "gradient_number"})
        self.assertEqual(self.tracers.time_unit, "s")
        self.assertEqual(self.tracers.unit("displacement"), "m")
        self.assertEqual(self.tracers.unit("strain"), "1")
        np.testing.assert_array_equal(self.tracers.ids, [10, 17, 24, 31, 38])
        np.testing.assert_allclose(self.tracers.times, [0.5, 0.6, 0.7], rtol=1e-15)
        np.testing.assert_array_equal(self.tracers.values("strain"), number(3, 0))
        with self.assertRaisesRegex(KeyError, "'rho' was not recorded"):
            self.tracers.values("rho")

    def test_table_ends_where_a_tracer_stops(self):
        table = self.tracers.table()
        # Tracer k stops at sample k for k = 1, 2, 3; the first and the last move on.
        self.assertEqual(list(table.id), [10, 17, 24, 31, 38, 10, 24, 31, 38, 10, 31, 38])
        np.testing.assert_allclose(table[table.id == 24].strain, number(3, 0)[:2, 2], rtol=1e-15)
        self.assertEqual(self.tracers.stop_names[int(self.tracers.stop[-1, 1])], "left_material")
        self.assertTrue({"velocity_z", "stress_zx"} <= set(table.columns))

    def test_refuses_what_holds_no_tracers(self):
        other = self.folder / "other.h5"
        with h5py.File(other, "w") as file:
            file["x"] = [1.0]
        with self.assertRaisesRegex(hdf.ResultError, "has no tracers"):
            grainvdb.open_tracers(other)


if __name__ == "__main__":
    unittest.main()
