#pragma once
/// Where the particles that contacts name stand in their columns.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace grainvdb {

/// Rows of particles by id. Ids are ascending; where they are dense a table spares the search.
class ParticleRows {
 public:
  explicit ParticleRows(const std::vector<std::int64_t>& ids) : ids_(ids) {
    if (ids.empty()) return;
    const auto span = static_cast<std::uint64_t>(ids.back()) - static_cast<std::uint64_t>(ids.front());
    if (span >= 4 * ids.size()) return;
    table_.assign(static_cast<std::size_t>(span) + 1, absent);
    for (std::size_t i = 0; i < ids.size(); ++i) table_[static_cast<std::size_t>(ids[i] - ids[0])] = i;
  }

  static constexpr std::size_t absent = std::numeric_limits<std::size_t>::max();

  std::size_t find(std::int64_t id) const {
    if (ids_.empty() || id < ids_.front() || id > ids_.back()) return absent;
    if (!table_.empty()) return table_[static_cast<std::size_t>(id - ids_.front())];
    const auto it = std::lower_bound(ids_.begin(), ids_.end(), id);
    return *it == id ? static_cast<std::size_t>(it - ids_.begin()) : absent;
  }

 private:
  const std::vector<std::int64_t>& ids_;
  std::vector<std::size_t> table_;
};

}  // namespace grainvdb
