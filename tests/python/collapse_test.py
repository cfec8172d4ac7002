"""The scatter of points about the mean of their bin."""
import unittest

import numpy as np

from grainvdb.collapse import collapse


class CollapseTest(unittest.TestCase):
    def setUp(self):
        self.random = np.random.default_rng(5)

    def test_what_is_told_exactly_has_the_scatter_of_the_bin_width(self):
        x = np.linspace(0, 1, 10001)[self.random.permutation(10001)]
        found = collapse(x, 3 * x, bins=20)
        # Uniform points in bins of 1/20: 3/20/√12 of 3/√12.
        self.assertAlmostEqual(found.share, 1 / 20, delta=1e-4)
        np.testing.assert_allclose(found.means, 3 * found.centres, atol=1e-3)

    def test_what_is_not_told_keeps_its_spread(self):
        found = collapse(self.random.normal(size=100000), self.random.normal(size=100000))
        self.assertAlmostEqual(found.share, 1, delta=5 / np.sqrt(2 * 100000))

    def test_noise_about_a_curve_is_found_again(self):
        x = self.random.uniform(-1, 1, 200000)
        found = collapse(x, x**2 + 0.1 * self.random.normal(size=len(x)), bins=200)
        self.assertAlmostEqual(found.scatter, 0.1, delta=5 * 0.1 / np.sqrt(2 * len(x)) + 1e-4)

    def test_undefined_points_do_not_count(self):
        x = np.arange(100.0)
        x[::2] = np.nan
        self.assertEqual(collapse(x, np.ones(100), bins=5).count, 50)
        with self.assertRaisesRegex(ValueError, "5 bins need at least 10 points, found 0"):
            collapse(np.full(9, np.nan), np.ones(9), bins=5)


if __name__ == "__main__":
    unittest.main()
