#pragma once
/// Frames that live in memory, as if they had been read from dumps.
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/frame_source.hpp"

namespace grainvdb::testing {

/// Serves copies of the given frames with the wanted columns only, so that a computation that did not ask for a column
/// finds it empty. Contacts are handed out where Column::contacts is wanted, those with walls where
/// Column::wall_contacts is.
class MemorySource : public FrameSource {
 public:
  explicit MemorySource(std::vector<Frame> frames);

  const std::vector<FrameInfo>& frames() const override { return infos_; }
  const UnitSystem& units() const override;
  const std::vector<std::string>& particle_columns() const override { return columns_; }
  std::vector<std::string> contact_columns() override { return {"id1", "id2", "force", "point"}; }
  std::vector<std::pair<std::string, std::uintmax_t>> files() const override { return {{"memory", 0}}; }
  void require(std::size_t, ColumnSet) override {}
  Frame read(std::size_t k, ColumnSet wanted) override;
  const ReadCounters& counters() const override { return counters_; }

 private:
  std::vector<Frame> frames_;
  std::vector<FrameInfo> infos_;
  std::vector<std::string> columns_{"id", "type", "x", "y", "z", "radius", "mass"};
  ReadCounters counters_;
};

}  // namespace grainvdb::testing
