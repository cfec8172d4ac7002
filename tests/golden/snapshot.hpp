#pragma once
/// One snapshot of the sample shear cell: the program's fields, the brute force on the same frame, and the table of
/// reference numbers (README.md).
#include <memory>
#include <optional>
#include <string>

#include "grainvdb/frame_source.hpp"
#include "support/csv_table.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"

namespace grainvdb::testing {

struct Snapshot {
  /// `step` is 60000 or 76000. Kinetic stress about the frame's velocity, velocity_gradient as `gradient` says.
  Snapshot(std::int64_t step, const std::string& gradient);

  Coord voxel_of(std::size_t row) const;
  /// The row's place in the brute force; nothing for a voxel beyond the reach of all particles.
  std::optional<std::size_t> index_of(std::size_t row) const { return reference->box.index(voxel_of(row)); }
  double found(const std::string& field, std::size_t row, int c = 0) const {
    return static_cast<double>(result.only().field(field).at(voxel_of(row), c));
  }

  CsvTable table;
  Pipeline pipeline;
  std::unique_ptr<FrameSource> source;
  Result result;
  Frame frame;
  std::unique_ptr<Reference> reference;
};

/// "prefix_ij" for component 3 i + j.
std::string tensor_column(const std::string& prefix, int component);

}  // namespace grainvdb::testing
