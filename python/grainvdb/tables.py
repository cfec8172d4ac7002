"""Tables of measurements, as `grainvdb measure` writes them (tables.h5)."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Iterator, Mapping

import h5py
import numpy as np

from . import hdf
from .arrays import Array

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class Number:
    """A single number that was measured; `error` is its standard error, NaN where it has none."""

    name: str
    value: float
    error: float
    unit: str
    description: str


class Table:
    """What one measurement came to: columns of equal length, single numbers, and remarks on what was refused."""

    def __init__(self, group: h5py.Group):
        self._group = group
        self.name: str = group.name.lstrip("/")
        self.description: str = hdf.attribute(group, "description")
        self.equation: str = hdf.attribute(group, "equation")
        self.remarks: list[str] = [hdf.text(line) for line in np.atleast_1d(group.attrs.get("remarks", []))]
        #: Names of the columns; the first is what the others are drawn against.
        self.columns: list[str] = _order(group)

    def __getitem__(self, column: str) -> Array:
        return self._column(column)[...]

    def unit(self, column: str) -> str:
        return hdf.attribute(self._column(column), "units", "1")

    def long_name(self, column: str) -> str:
        return hdf.attribute(self._column(column), "long_name", column)

    @property
    def numbers(self) -> dict[str, Number]:
        group = self._group.get("numbers", {})
        found = {}
        for name in _order(group) if group else []:
            item = group[name]
            found[name] = Number(name, float(item[()]), float(item.attrs.get("standard_error", np.nan)),
                                 hdf.attribute(item, "units", "1"), hdf.attribute(item, "long_name"))
        return found

    def table(self) -> pandas.DataFrame:
        """One row per row, the units in `attrs["units"]`."""
        import pandas

        frame = pandas.DataFrame({name: self[name] for name in self.columns})
        frame.attrs["units"] = {name: self.unit(name) for name in self.columns}
        return frame

    def _column(self, name: str) -> h5py.Dataset:
        if name not in self.columns:
            raise KeyError(f"table {self.name} has no column '{name}'; there are {', '.join(self.columns) or 'none'}")
        return self._group[name]


class Tables(Mapping[str, Table]):
    """The tables of one result, by name."""

    def __init__(self, path: str | os.PathLike[str]):
        """Opens a tables.h5, or the one in a folder. Raises FileNotFoundError, or ResultError for another file."""
        self.path = os.path.join(path, "tables.h5") if os.path.isdir(path) else os.fspath(path)
        self._file = hdf.open_file(self.path)
        self._tables = {name: Table(group) for name, group in self._file.items() if "equation" in group.attrs}
        if not self._tables:
            self._file.close()
            raise hdf.ResultError(f"{self.path}: has no tables; expected a group for each, as `grainvdb measure` writes them")

    def close(self) -> None:
        self._file.close()

    def __enter__(self) -> Tables:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __getitem__(self, name: str) -> Table:
        if name not in self._tables:
            raise KeyError(f"{self.path} has no table '{name}'; there are {', '.join(self._tables)}")
        return self._tables[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._tables)

    def __len__(self) -> int:
        return len(self._tables)

    @property
    def provenance(self) -> dict[str, str]:
        return hdf.provenance(self._file)


def open_tables(path: str | os.PathLike[str]) -> Tables:
    """Opens a tables.h5, or the one in a folder. Raises FileNotFoundError or ResultError."""
    return Tables(path)


def _order(group: h5py.Group) -> list[str]:
    return [hdf.text(name) for name in np.atleast_1d(group.attrs["order"])] if "order" in group.attrs else []
