#pragma once
/// Species of grains: types or size classes of which there are partial fields. Those of all species add up to the field
/// of the grains that belong to one.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/frame.hpp"

namespace grainvdb {

/// The grains that satisfy every criterion that is given.
struct Species {
  std::string name;
  std::vector<int> types;                                    ///< empty: any
  std::optional<std::pair<std::int64_t, std::int64_t>> ids;  ///< inclusive range
  std::optional<std::pair<double, double>> diameter;         ///< from ≤ 2 r < to [length]

  /// What must be read to tell its grains.
  ColumnSet columns() const;
  /// Whether particle i is one of its grains.
  bool contains(const Particles& particles, std::size_t i) const;
};

/// What must be read to tell the grains of all of them.
ColumnSet columns_of(const std::vector<Species>& species);

}  // namespace grainvdb
