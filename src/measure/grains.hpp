#pragma once
/// Small things that measurements of single grains share.
#include <cstddef>
#include <numeric>
#include <vector>

#include "grainvdb/frame.hpp"

namespace grainvdb {

inline Vec3 vector_at(const Columns3& columns, std::size_t i) {
  return {columns[0][i], columns[1][i], columns[2][i]};
}

/// The same, moved into the box along periodic axes.
inline Vec3 wrapped(const Box& box, const Columns3& columns, std::size_t i) {
  return {box.wrap(0, columns[0][i]), box.wrap(1, columns[1][i]), box.wrap(2, columns[2][i])};
}

inline void push_back(Columns3& columns, const Vec3& v) {
  for (std::size_t a = 0; a < 3; ++a) columns[a].push_back(v[a]);
}

/// Number mean; NaN where there are none.
inline double mean_diameter(const std::vector<double>& radius) {
  return 2 * std::accumulate(radius.begin(), radius.end(), 0.0) / static_cast<double>(radius.size());
}

}  // namespace grainvdb
