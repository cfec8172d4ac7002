"""Reads and draws the results of grainvdb: fields on a lattice (fields.hdf), histories of tracers (tracers.h5) and
tables of measurements (tables.h5).

    import grainvdb
    fields = grainvdb.open_fields("output/fields.hdf")
    phi = fields["phi"]               # an xarray.DataArray with coordinates, units and NaN where it is undefined
    phi.mean(("x", "y")).plot()       # a profile over z
    fields.undefined("mu")            # how many voxels have no value, by reason

Needs h5py and numpy, xarray for labelled arrays and matplotlib for `grainvdb.plots`.
"""
from .fields import Fields, Reason, open_fields
from .tables import Number, Table, Tables, open_tables
from .tracers import Tracers, open_tracers

__all__ = ["Fields", "Number", "Reason", "Table", "Tables", "Tracers", "open_fields", "open_tables", "open_tracers"]
