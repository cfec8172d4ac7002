"""What both kinds of result have in common: texts, attributes and provenance of an HDF5 file."""
from __future__ import annotations

import os
from typing import Any

import h5py


class ResultError(ValueError):
    """A file that is not what it was taken for; says what was found and what was expected."""


def open_file(path: str | os.PathLike[str]) -> h5py.File:
    """Opens a file for reading. Raises FileNotFoundError or ResultError."""
    if not os.path.isfile(path):
        raise FileNotFoundError(f"{os.fspath(path)}: there is no such file")
    try:
        return h5py.File(path, "r")
    except OSError as error:
        raise ResultError(f"{os.fspath(path)}: not an HDF5 file, or one that is not complete ({error})") from error


def text(value: Any) -> str:
    """A text attribute or dataset, however it is stored."""
    return value.decode() if isinstance(value, bytes) else str(value)


def attribute(item: h5py.HLObject, name: str, default: str = "") -> str:
    return text(item.attrs[name]) if name in item.attrs else default


def provenance(file: h5py.File) -> dict[str, str]:
    """What the result was made from and by: version, resolved pipeline, inputs, steps, …"""
    return {key: text(item[()]) for key, item in file.get("provenance", {}).items()}
