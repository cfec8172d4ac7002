#pragma once
/// A particle of a spot run as the inner loops see it.
///
/// Positions are whole numbers of a small unit per axis and differences wrap, so that the minimum image costs nothing
/// and displacements add without rounding.
#include <array>
#include <cstdint>
#include <limits>

namespace grainvdb::spot {

/// One particle, or a place for one.
struct alignas(16) Site {
  static constexpr std::int32_t in_zone = 1;
  /// No particle is here. As a fourth coordinate it is out of every reach.
  static constexpr std::int32_t empty = std::numeric_limits<std::int32_t>::max();

  std::array<std::int32_t, 3> at{};
  std::int32_t mark = 0;  ///< in_zone while it is being relaxed
};

}  // namespace grainvdb::spot
