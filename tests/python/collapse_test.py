"""The scatter of points about the mean of their bin."""
import unittest

import numpy as np

from grainvdb.collapse import Curve, collapse, collapse_of_runs


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

    def curve(self, x, y, width=0.1):
        """As the measurement bins them."""
        bins = np.floor(x / width).astype(int)
        parts = [y[bins == b] for b in np.unique(bins)]
        return Curve((np.unique(bins) + 0.5) * width, np.array([p.mean() for p in parts]),
                     np.array([p.std(ddof=1) if len(p) > 1 else np.nan for p in parts]),
                     np.array([len(p) for p in parts]))

    def test_runs_are_pooled_as_if_binned_at_once(self):
        x = self.random.uniform(0, 1, 4000)
        y = x**2 + 0.1 * self.random.normal(size=len(x))
        at_once = collapse_of_runs([self.curve(x, y)])
        # The second run has other bins, and one of a single point.
        apart = [x < 0.73, (x >= 0.73) & (x < 0.9), x >= 0.9]
        one_more = self.curve(np.array([0.05]), np.array([0.0]))
        runs = collapse_of_runs([self.curve(x[a], y[a]) for a in apart] + [one_more])
        with_one_more = collapse_of_runs([self.curve(np.append(x, 0.05), np.append(y, 0.0))])
        np.testing.assert_allclose(runs.means, with_one_more.means)
        self.assertAlmostEqual(runs.scatter, with_one_more.scatter, delta=1e-12)
        self.assertAlmostEqual(runs.spread, with_one_more.spread, delta=1e-12)
        self.assertAlmostEqual(at_once.spread, y.std(ddof=1), delta=1e-12)

    def test_thin_curves_that_lie_apart_do_not_collapse(self):
        x = np.repeat(np.arange(0.05, 1, 0.1), 100)
        laws = [self.curve(x, x + 10 * run) for run in range(3)]
        self.assertAlmostEqual(laws[0].spreads.max(), 0, delta=1e-12)
        self.assertLess(collapse_of_runs(laws).told, 0.01)
        self.assertAlmostEqual(collapse_of_runs(laws[:1] * 3).told, 1, delta=1e-12)

    def test_no_points_to_spare_are_refused(self):
        with self.assertRaisesRegex(ValueError, "no curves"):
            collapse_of_runs([])
        with self.assertRaisesRegex(ValueError, "2 bins need more points than 2"):
            collapse_of_runs([self.curve(np.array([0.05, 0.15]), np.array([1.0, 2.0]))])


if __name__ == "__main__":
    unittest.main()
