#pragma once
/// The box whose grains a measurement counts: the options `lo` and `hi`.
#include <optional>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/measurement.hpp"

namespace grainvdb {

/// Grains whose centres lie in lo ≤ x < hi count. Their neighbours may lie outside.
class CountedRegion {
 public:
  CountedRegion() = default;  ///< everywhere
  explicit CountedRegion(const OptionValues& options);

  bool holds(const Vec3& x) const;

  /// The part of the region where there is material: cut to the box along periodic axes and to the extent of the
  /// centres along others. Empty along an axis (hi ≤ lo) where they do not meet.
  Box within(const Box& box, const Columns3& position) const;

  /// The declarations of `lo` and `hi`, in front of the others.
  static std::vector<OptionInfo> options(std::vector<OptionInfo> others);
  /// Refuses lists that are not of three numbers, or upper ends below the lower ones.
  static std::optional<OptionConflict> conflict(const OptionValues& options);

 private:
  std::optional<Vec3> lo_, hi_;
};

}  // namespace grainvdb
