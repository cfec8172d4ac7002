#pragma once
/// The half branches of a frame as the splat sums them: long ones divided, all of them in buckets about their middles.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bin/buckets.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/moment.hpp"

namespace grainvdb {

/// A straight piece of a half branch, or all of it.
class BranchSet {
 public:
  /// Divides what the method cannot integrate in one piece. `branches` must outlive the set. Throws
  /// std::invalid_argument when an arm is longer than 1e6 cutoffs.
  BranchSet(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches, LineIntegral method);

  /// The middles of the pieces; a bucket's point is a piece.
  const Buckets& buckets() const { return buckets_; }

  /// Which half branch a piece belongs to, and its share in it.
  std::size_t branch(std::size_t piece) const { return source_.empty() ? piece : source_[piece]; }
  double share(std::size_t piece) const { return source_.empty() ? 1.0 : 1.0 / division(branch(piece)).parts; }
  Vec3 arm(std::size_t piece) const;

  /// The points that a piece takes, 0 for the exact integral.
  int points(std::size_t piece) const;
  std::span<const LineNode> rule(int points) const;
  /// Half the longest arm of the pieces with so many points [length]; negative when there are none.
  double half_arm(int points) const { return half_arm_[static_cast<std::size_t>(points)]; }
  double longest_half_arm() const { return *std::max_element(half_arm_.begin(), half_arm_.end()); }

  /// The integral over a piece at index distance d (in voxels) from its middle.
  double weight(std::size_t piece, const Vec3& d) const;
  /// Whether it is positive: the piece has a point within one cutoff.
  bool reaches(std::size_t piece, const Vec3& d) const;

 private:
  LineDivision division(std::size_t branch) const;
  double length(std::size_t branch) const;
  Vec3 from_start(const Vec3& d, const Vec3& arm) const;

  const LucyKernel& kernel_;
  const HalfBranches& branches_;
  LineIntegral method_;
  double voxel_;
  std::vector<std::uint32_t> source_;  // of each piece; empty when no branch is divided
  Buckets buckets_;
  std::array<double, 9> half_arm_{};
};

}  // namespace grainvdb
