#include "grainvdb/field_sink.hpp"
#include "grainvdb/table_sink.hpp"
#include "grainvdb/tracer_sink.hpp"
#include "write/csv_table_sink.hpp"
#include "write/h5md_sink.hpp"
#include "write/hdf5_sink.hpp"
#include "write/hdf5_table_sink.hpp"
#include "write/lammps_tracer_sink.hpp"
#include "write/vdb_sink.hpp"

namespace grainvdb {

const std::vector<SinkInfo>& sink_registry() {
  static const std::vector<SinkInfo> sinks{
      {"hdf5", "fields.hdf for ParaView, h5py and xarray (VTKHDF layout); series open through fields.xmf2",
       make_hdf5_sink},
      {"vdb", "fields.vdb, one file per output time, for OpenVDB tools", make_vdb_sink},
  };
  return sinks;
}

const std::vector<TracerSinkInfo>& tracer_sink_registry() {
  static const std::vector<TracerSinkInfo> sinks{
      {"h5md", "tracers.h5 for h5py and MDAnalysis (H5MD layout); opens in ParaView through tracers.xmf2",
       make_h5md_sink},
      {"lammps", "tracers.dump, a LAMMPS text dump for OVITO", make_lammps_tracer_sink},
  };
  return sinks;
}

const std::vector<TableSinkInfo>& table_sink_registry() {
  static const std::vector<TableSinkInfo> sinks{
      {"hdf5", "tables.h5 for h5py and xarray, a group per table", make_hdf5_table_sink},
      {"csv", "tables/NAME.csv, a file per table, and tables/numbers.csv", make_csv_table_sink},
  };
  return sinks;
}

}  // namespace grainvdb
