"""Histories of tracers, as `grainvdb trace` writes them (H5MD)."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING

import h5py
import numpy as np

from . import hdf
from .arrays import Array

if TYPE_CHECKING:
    import pandas

_GROUP = "particles/tracers"
_NOT_RECORDED = ("box", "id", "image", "position", "stop", "stop_time")


class Tracers:
    """The histories of one result: every quantity has one row per sample and one column per tracer."""

    def __init__(self, path: str | os.PathLike[str]):
        """Opens a tracers.h5, or the one in a folder. Raises FileNotFoundError, or ResultError for another file."""
        self.path = os.path.join(path, "tracers.h5") if os.path.isdir(path) else os.fspath(path)
        self._file = hdf.open_file(self.path)
        if _GROUP not in self._file:
            self._file.close()
            raise hdf.ResultError(f"{self.path}: has no tracers; expected the group /{_GROUP}, as `grainvdb trace` writes it")
        self._group = self._file[_GROUP]

    def close(self) -> None:
        self._file.close()

    def __enter__(self) -> Tracers:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def ids(self) -> Array:
        return self._group["id"][...]

    @property
    def times(self) -> Array:
        return self._group["position/time"][...]

    @property
    def time_unit(self) -> str:
        return hdf.attribute(self._group["position/time"], "units", "1")

    @property
    def names(self) -> list[str]:
        """What was recorded along the way, positions and stop codes apart."""
        return [name for name in self._group if name not in _NOT_RECORDED]

    @property
    def provenance(self) -> dict[str, str]:
        return hdf.provenance(self._file)

    def unit(self, name: str) -> str:
        return hdf.attribute(self._values(name), "units", "1")

    def values(self, name: str) -> Array:
        """Of shape (sample, tracer) and, for vectors and tensors, the component last; NaN where undefined."""
        return self._values(name)[...]

    def positions(self, unwrapped: bool = True) -> Array:
        """Of shape (sample, tracer, 3) [length]; unwrapped across periodic sides unless that is not wanted."""
        position = self._values("position")[...]
        if not unwrapped:
            return position
        edges = self._group["box/edges/value"][...]  # of every sample, one vector a row
        return position + self._values("image")[...] @ edges

    @property
    def stop(self) -> Array:
        """Why a tracer stands still, as a code of `stop_names`; of shape (sample, tracer)."""
        return self._values("stop")[...]

    @property
    def stop_names(self) -> dict[int, str]:
        attributes = self._values("stop").attrs
        return dict(zip((int(v) for v in attributes["flag_values"]), hdf.text(attributes["flag_meanings"]).split()))

    @property
    def moving(self) -> Array:
        """Where a sample is one of a tracer that still moves, of shape (sample, tracer)."""
        return self.stop == 0

    def table(self) -> pandas.DataFrame:
        """One row per tracer and sample at which it moves: id, time, unwrapped position and all that was recorded."""
        import pandas

        position = self.positions()
        samples, count = position.shape[:2]
        columns: dict[str, Array] = {"id": np.tile(self.ids, samples), "time": np.repeat(self.times, count)}
        for k, axis in enumerate("xyz"):
            columns[axis] = position[:, :, k].ravel()
        for name in self.names:
            values = self.values(name)
            if values.ndim == 2:
                columns[name] = values.ravel()
                continue
            labels = list("xyz") if values.shape[2] == 3 else [a + b for a in "xyz" for b in "xyz"]
            for k, label in enumerate(labels[:values.shape[2]]):
                columns[f"{name}_{label}"] = values[:, :, k].ravel()
        return pandas.DataFrame(columns)[self.moving.ravel()].reset_index(drop=True)

    def _values(self, name: str) -> h5py.Dataset:
        if name not in self._group or name in ("box", "id"):
            raise KeyError(f"'{name}' was not recorded in {self.path}; there are {', '.join(self.names)}")
        return self._group[name]["value"]


def open_tracers(path: str | os.PathLike[str]) -> Tracers:
    """Opens a tracers.h5, or the one in a folder. Raises FileNotFoundError or ResultError."""
    return Tracers(path)
