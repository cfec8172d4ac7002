"""How well one quantity tells another: the scatter of points about the mean of their bin."""
from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from .arrays import Array


@dataclasses.dataclass(frozen=True)
class Collapse:
    """Points (x, y) in bins of x that hold equally many."""

    centres: Array  # of the bins: median of x
    means: Array  # of y in each bin
    count: int  # of points
    spread: float  # standard deviation of y
    scatter: float  # of y about the mean of its bin, rms, for as many degrees of freedom as the bins leave

    @property
    def share(self) -> float:
        """scatter/spread: 0 where x tells y exactly, 1 where it tells nothing."""
        return self.scatter / self.spread if self.spread > 0 else float("nan")

    @property
    def told(self) -> float:
        """1 - share²: the part of the variance of y that x tells, `collapse` in the tables of that measurement."""
        return 1 - self.share**2


def collapse(x: Array, y: Array, bins: int = 25) -> Collapse:
    """Of the points where both are finite. Raises ValueError where there are fewer than two a bin."""
    x, y = np.ravel(x).astype(float), np.ravel(y).astype(float)
    both = np.isfinite(x) & np.isfinite(y)
    x, y = x[both], y[both]
    if len(x) < 2 * bins:
        raise ValueError(f"{bins} bins need at least {2 * bins} points, found {len(x)}")
    order = np.argsort(x, kind="stable")
    parts = np.array_split(order, bins)
    means = np.array([y[part].mean() for part in parts])
    squares = sum(float(((y[part] - mean) ** 2).sum()) for part, mean in zip(parts, means))
    return Collapse(np.array([np.median(x[part]) for part in parts]), means, len(x), float(y.std(ddof=1)),
                    float(np.sqrt(squares / (len(x) - bins))))


@dataclasses.dataclass(frozen=True)
class Curve:
    """A binned curve of one run: the columns of a table of the measurement `collapse`."""

    centres: Array  # of the bins
    means: Array
    spreads: Array  # standard deviations; NaN in bins of one point
    points: Array  # how many


def collapse_of_runs(curves: Sequence[Curve]) -> Collapse:
    """As if the points of all runs had been binned at once: runs whose curves lie apart do not collapse, however thin
    each is. The bins of all runs must be the same. Raises ValueError where there are no more points than bins."""
    if not curves:
        raise ValueError("no curves to collapse")
    centres, means, spreads, points = (np.concatenate([np.asarray(getattr(c, f.name), float) for c in curves])
                                       for f in dataclasses.fields(Curve))
    bins, where = np.unique(np.round(centres, 12), return_inverse=True)
    count = np.bincount(where, points)
    if count.sum() <= len(bins):
        raise ValueError(f"{len(bins)} bins need more points than {int(count.sum())}")
    together = np.bincount(where, points * means) / count
    own = np.where(points > 1, (points - 1) * np.square(np.nan_to_num(spreads)), 0)
    squares = float((own + points * (means - together[where]) ** 2).sum())
    mean = float((count * together).sum() / count.sum())
    total = squares + float((count * (together - mean) ** 2).sum())
    return Collapse(bins, together, int(count.sum()), float(np.sqrt(total / (count.sum() - 1))),
                    float(np.sqrt(squares / (count.sum() - len(bins)))))
