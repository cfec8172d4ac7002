#pragma once
/// Orders of rows.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "read/dump_file.hpp"

namespace grainvdb {

/// The numbers of rows in another order; nothing where it is the order that they have.
using RowOrder = std::optional<std::vector<std::uint32_t>>;

/// The rows in ascending order of `key`, those of equal keys as they are. Throws LimitError for 2^32 - 1 rows or more
/// that are not in order.
RowOrder ascending(const std::vector<std::int64_t>& key);
/// The same by the first key, and by the second where the first are equal.
RowOrder ascending(const std::vector<std::int64_t>& first, const std::vector<std::int64_t>& second);

/// Puts all columns of a table into an order.
void reorder(DumpTable& table, const RowOrder& order);

}  // namespace grainvdb
