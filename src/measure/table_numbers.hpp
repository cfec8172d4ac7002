#pragma once
/// Numbers of a table by their names.
#include <stdexcept>
#include <string>

#include "grainvdb/table.hpp"

namespace grainvdb {

/// Throws std::out_of_range where the table has no such number.
inline const Quantity& number_of(const Table& table, const std::string& name) {
  for (const Quantity& q : table.numbers)
    if (q.name == name) return q;
  throw std::out_of_range("a table without " + name);
}

}  // namespace grainvdb
