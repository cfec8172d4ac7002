"""Fields on a lattice, as `grainvdb run` writes them."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Iterator

import h5py
import numpy as np

from . import hdf
from .arrays import Array

if TYPE_CHECKING:
    import xarray

AXES = ("x", "y", "z")
_COMPONENTS = {
    3: ("component3", list("xyz")),
    6: ("component6", [str(k) for k in range(6)]),
    9: ("component9", [a + b for a in "xyz" for b in "xyz"]),
}


@dataclass(frozen=True)
class Reason:
    """Why a field has no value at some voxels (or a less accurate one)."""

    flag: int
    name: str
    meaning: str


class Fields:
    """The fields of one result. A mapping from names to xarray.DataArray; what is not asked for is not read."""

    def __init__(self, path: str | os.PathLike[str]):
        """Opens a fields.hdf, or the one in a folder. Raises FileNotFoundError, or ResultError for another file."""
        self.path = os.path.join(path, "fields.hdf") if os.path.isdir(path) else os.fspath(path)
        self._file = hdf.open_file(self.path)
        if "VTKHDF/PointData" not in self._file or not all(axis in self._file for axis in AXES):
            self._file.close()
            raise hdf.ResultError(
                f"{self.path}: has no fields; expected /VTKHDF/PointData and the axes /x /y /z, as `grainvdb run` writes them")
        self._data = self._file["VTKHDF/PointData"]

    def close(self) -> None:
        self._file.close()

    def __enter__(self) -> Fields:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def names(self) -> list[str]:
        """Of the fields, in alphabetical order; the mask apart."""
        return [name for name in self._data if name != "mask"]

    def __contains__(self, name: str) -> bool:
        return name in self.names

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def axis(self, name: str) -> Array:
        """The voxel centres along x, y or z [length]."""
        return self._file[name][...]

    @property
    def times(self) -> Array:
        """Mean time of the frames of each output time."""
        return self._file["time"][...]

    @property
    def frame_counts(self) -> Array:
        """Frames in the mean of each output time."""
        return self._file["frame_count"][...]

    @property
    def voxel(self) -> float:
        """The edge of a voxel [length]."""
        return float(self._file["VTKHDF"].attrs["Spacing"][0])

    @property
    def provenance(self) -> dict[str, str]:
        """What the result was made from and by: version, resolved pipeline, inputs, steps, …"""
        return hdf.provenance(self._file)

    def unit(self, name: str) -> str:
        """Of a field or an axis, `1` for pure numbers."""
        return hdf.attribute(self._file[name] if name in AXES or name == "time" else self._dataset(name), "units", "1")

    def description(self, name: str) -> str:
        return hdf.attribute(self._dataset(name), "long_name", name)

    def equation(self, name: str) -> str:
        """The formula with the tag of its source."""
        return hdf.attribute(self._dataset(name), "equation")

    def values(self, name: str, time: int | None = None) -> Array:
        """Of shape (z, y, x) and, for vectors and tensors, the component last; NaN where the field is undefined.

        With several output times they come first, unless one is named by its number. Raises KeyError for a field that
        is not there.
        """
        data = self._dataset(name)
        if time is None:
            return data[...]
        if not -len(self.times) <= time < len(self.times):
            raise IndexError(f"{self.path}: no output time {time}; there are {len(self.times)}")
        return data[time] if self._is_series else data[...]

    def __getitem__(self, name: str) -> xarray.DataArray:
        import xarray

        data = self._dataset(name)
        dims: list[str] = (["time"] if self._is_series else []) + ["z", "y", "x"]
        coords: dict[str, object] = {axis: (axis, self.axis(axis), {"units": self.unit(axis)}) for axis in AXES}
        if "time" in dims:
            coords["time"] = ("time", self.times, {"units": self.unit("time")})
        if data.ndim > len(dims):
            dim, labels = _COMPONENTS[data.shape[-1]]
            dims.append(dim)
            coords[dim] = (dim, labels)
        attributes = {key: hdf.attribute(data, key) for key in ("units", "long_name", "equation") if key in data.attrs}
        return xarray.DataArray(data[...], coords, dims, name, attributes)

    def to_dataset(self, names: list[str] | None = None) -> xarray.Dataset:
        """Several fields, all unless some are named."""
        import xarray

        return xarray.Dataset({name: self[name] for name in names or self.names}, attrs=self.provenance)

    @property
    def reasons(self) -> list[Reason]:
        """All reasons that the mask knows; none where no field can be undefined."""
        if "mask" not in self._data:
            return []
        attributes = self._data["mask"].attrs
        meanings = [hdf.text(t).partition(": ")[2] for t in attributes["flags"]]
        names = hdf.text(attributes["flag_meanings"]).split()
        return [Reason(int(f), n, m) for f, n, m in zip(attributes["flag_masks"], names, meanings)]

    def mask(self, time: int | None = None) -> Array:
        """The flags of every voxel, those of several reasons added up; shape as `values`."""
        if "mask" not in self._data:
            return np.zeros(self.values(self.names[0], time).shape[:3], np.uint32)
        data = self._data["mask"]
        return data[time] if time is not None and self._is_series else data[...]

    def undefined(self, name: str, time: int = -1) -> dict[str, int]:
        """How many voxels with material near them have no value of a field, by the reasons of those voxels."""
        values = self.values(name, time)
        missing = np.isnan(values).reshape(*values.shape[:3], -1).any(axis=-1)
        flags = self.mask(time)[missing]
        counts = {r.name: int(np.count_nonzero(flags & r.flag)) for r in self.reasons if r.name != "outside"}
        return {reason: count for reason, count in counts.items() if count}

    @property
    def _is_series(self) -> bool:
        """Whether there is an axis of time: one output time has none."""
        return len(self.times) > 1

    def _dataset(self, name: str) -> h5py.Dataset:
        if name not in self._data:
            raise KeyError(f"no field '{name}' in {self.path}; there are {', '.join(self.names)}")
        return self._data[name]


def open_fields(path: str | os.PathLike[str]) -> Fields:
    """Opens a fields.hdf, or the one in a folder. Raises FileNotFoundError or ResultError."""
    return Fields(path)
