import pathlib
import tempfile
import unittest

import h5py
import numpy as np

import grainvdb
from grainvdb import hdf
from support import reduced, result


class OneMean(unittest.TestCase):
    def setUp(self):
        self.fields = grainvdb.open_fields(result())
        self.addCleanup(self.fields.close)

    def test_values_are_those_of_the_file(self):
        with h5py.File(result() / "fields.hdf") as file:
            for name in ("phi", "velocity", "stress"):
                np.testing.assert_array_equal(self.fields.values(name), file["VTKHDF/PointData"][name][...])

    def test_lists_every_field_but_not_the_mask(self):
        self.assertIn("gd_over_dv", self.fields)
        self.assertNotIn("mask", self.fields)
        self.assertEqual(len(self.fields), len(list(self.fields)))

    def test_arrays_carry_coordinates_units_and_equation(self):
        velocity = self.fields["velocity"]
        self.assertEqual(velocity.dims, ("z", "y", "x", "component3"))
        self.assertEqual(list(velocity.component3.values), ["x", "y", "z"])
        self.assertEqual(velocity.attrs["units"], "m/s")
        self.assertIn("(7)", velocity.attrs["equation"])
        # 16 voxels of 0.4 mm from the origin: the first centre lies at half a voxel.
        self.assertAlmostEqual(float(velocity.x[0]), 0.2e-3, delta=1e-12)
        self.assertAlmostEqual(float(velocity.x[15]), 6.2e-3, delta=1e-12)
        self.assertEqual(self.fields["stress"].sel(component9="xz").shape, velocity.shape[:3])

    def test_reduced_units_are_named_and_applied(self):
        with grainvdb.open_fields(reduced()) as fields:
            self.assertEqual([fields.unit(name) for name in ("x", "time", "velocity", "stress", "phi")],
                             ["d", "sqrt(d/g)", "sqrt(g d)", "rho_p g d", "1"])
            self.assertEqual(fields.voxel, 1024 * self.fields.voxel)
            # Powers of two are exact.
            np.testing.assert_array_equal(fields.values("velocity"), 64 * self.fields.values("velocity"))
            np.testing.assert_array_equal(fields.values("stress"), 2 * self.fields.values("stress"))
            self.assertEqual(fields["velocity"].attrs["units"], "sqrt(g d)")
            self.assertEqual(fields["velocity"].z.attrs["units"], "d")
            self.assertIn("sqrt(d/g) = 0.0625 s", fields.provenance["reduced_units"])

    def test_reasons_account_for_every_missing_value(self):
        for name in ("mu", "velocity"):
            values = self.fields.values(name)
            missing = np.isnan(values).reshape(*values.shape[:3], -1).any(axis=-1)
            self.assertGreater(np.count_nonzero(missing), 0)
            self.assertTrue(np.all(self.fields.mask()[missing] != 0))
        counts = self.fields.undefined("velocity")
        flags = self.fields.mask()
        no_material = next(r for r in self.fields.reasons if r.name == "no_material")
        self.assertEqual(counts["no_material"], np.count_nonzero(flags & no_material.flag))
        self.assertEqual(self.fields.undefined("phi"), {})

    def test_dataset_holds_the_provenance(self):
        data = self.fields.to_dataset(["phi", "mu"])
        self.assertEqual(set(data.data_vars), {"phi", "mu"})
        self.assertIn("cutoff: 0.0024", data.attrs["pipeline"])

    def test_says_what_there_is_when_a_field_is_missing(self):
        with self.assertRaisesRegex(KeyError, "no field 'fi' .*there are .*phi"):
            self.fields.values("fi")


class Series(unittest.TestCase):
    def setUp(self):
        self.fields = grainvdb.open_fields(result("1"))
        self.addCleanup(self.fields.close)

    def test_times_come_first(self):
        phi = self.fields["phi"]
        self.assertEqual(phi.dims[0], "time")
        self.assertEqual(phi.shape[0], 5)
        # Snapshots at steps 60000 … 76000 of 1 µs.
        np.testing.assert_allclose(phi.time, [0.060, 0.064, 0.068, 0.072, 0.076], rtol=1e-12)

    def test_one_time_is_one_row(self):
        np.testing.assert_array_equal(self.fields.values("phi", 2), self.fields.values("phi")[2])
        self.assertEqual(self.fields.mask(2).shape, self.fields.values("phi", 2).shape)
        with self.assertRaises(IndexError):
            self.fields.values("phi", 5)

    def test_mean_of_the_series_is_the_mean(self):
        """Sums add up: the mean of φ over the five snapshots is φ of their mean, to the rounding of floats."""
        with grainvdb.open_fields(result()) as mean:
            together = self.fields["phi"].mean("time")
            one = mean["phi"].sel(z=slice(0, 6e-3))
            np.testing.assert_allclose(together.sel(z=one.z, method="nearest"), one, rtol=0, atol=3e-7)


class OtherFiles(unittest.TestCase):
    def test_refuses_what_is_no_result(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            with self.assertRaises(FileNotFoundError):
                grainvdb.open_fields(path)
            (path / "fields.hdf").write_text("no HDF5")
            with self.assertRaisesRegex(hdf.ResultError, "not an HDF5 file"):
                grainvdb.open_fields(path)
            with h5py.File(path / "other.hdf", "w") as file:
                file["x"] = [1.0]
            with self.assertRaisesRegex(hdf.ResultError, "has no fields"):
                grainvdb.open_fields(path / "other.hdf")


if __name__ == "__main__":
    unittest.main()
