#include "grainvdb/field_sink.hpp"
#include "write/hdf5_sink.hpp"
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

}  // namespace grainvdb
