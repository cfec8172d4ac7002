#pragma once
/// The XDMF text that lets ParaView open an HDF5 result as a time series.
#include <span>
#include <string>

#include "grainvdb/field_sink.hpp"

namespace grainvdb {

/// One image per output time, its fields at the voxel centres, read from `data_file` (a name relative to the sidecar).
/// ParaView takes the file with its legacy reader when its name ends in .xmf2; the newer one aborts on it. A selection
/// of one time step says its shape without that step's leading 1.
std::string xdmf_sidecar(const OutputLayout& layout, std::span<const OutputTime> times, const std::string& data_file);

}  // namespace grainvdb
