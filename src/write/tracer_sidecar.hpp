#pragma once
/// The XDMF text that lets ParaView open the histories of tracers as moving points.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "write/atomic_file.hpp"

namespace grainvdb {

/// A dataset of shape (T,N[,C]) in the file of tracers.
struct TracerDataset {
  std::string name;
  std::string path;
  std::uint64_t components;
  std::string number;  ///< XML attributes of its number type, e.g. NumberType="Float" Precision="8"
};

/// Writes one set of points per time, read from `data_file` (a name relative to the sidecar): `position` of shape
/// (T,N,3), `id` of shape (N), and the others as point data. One time step of text is held in memory.
void write_tracer_sidecar(AtomicFile& file, const std::string& data_file, std::uint64_t tracers,
                          std::span<const double> times, const TracerDataset& position, const TracerDataset& id,
                          std::span<const TracerDataset> others);

}  // namespace grainvdb
