"""How well one quantity tells another: the scatter of points about the mean of their bin."""
from __future__ import annotations

import dataclasses

import numpy as np


@dataclasses.dataclass(frozen=True)
class Collapse:
    """Points (x, y) in bins of x that hold equally many."""

    centres: np.ndarray  # of the bins: median of x
    means: np.ndarray  # of y in each bin
    count: int  # of points
    spread: float  # standard deviation of y
    scatter: float  # of y about the mean of its bin, rms, for as many degrees of freedom as the bins leave

    @property
    def share(self) -> float:
        """scatter/spread: 0 where x tells y exactly, 1 where it tells nothing."""
        return self.scatter / self.spread if self.spread > 0 else float("nan")


def collapse(x: np.ndarray, y: np.ndarray, bins: int = 25) -> Collapse:
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
