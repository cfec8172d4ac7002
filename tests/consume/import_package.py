"""Reads the result of pipelines/minimal.yaml with the Python package of the installation."""
import pathlib
import sys

import numpy as np

import grainvdb

prefix, output = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
found = pathlib.Path(grainvdb.__file__).resolve()
assert found.is_relative_to(prefix), f"{found} is not in {prefix}"
with grainvdb.open_fields(output) as fields:
    assert "phi" in fields.names, fields.names
    assert np.nanmax(fields.values("phi", -1)) > 0
    print(f"{found.parent} reads {', '.join(fields.names)}")
