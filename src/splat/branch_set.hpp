#pragma once
/// The half branches of a frame as the splat sums them: long ones divided, all of them in buckets about their middles.
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

/// Straight pieces of half branches: all of a branch, or an equal part of one that no rule can integrate in one piece.
class BranchSet {
 public:
  /// `branches` must outlive the set. Throws std::invalid_argument when an arm is longer than 1e6 cutoffs.
  BranchSet(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches, LineIntegral method);

  /// The middles of the pieces; a bucket's point is a piece.
  const Buckets& buckets() const { return buckets_; }

  /// Which half branch a piece belongs to, and its share in it.
  std::size_t branch(std::size_t piece) const { return source_.empty() ? piece : source_[piece]; }
  double share(std::size_t piece) const { return source_.empty() ? 1.0 : share_[source_[piece]]; }
  Vec3 arm(std::size_t piece) const;

  /// The points of the rule that a piece takes, 0 for the exact integral.
  int points(std::size_t piece) const { return points_.empty() ? only_points_ : points_[branch(piece)]; }
  /// The numbers of points that occur, ascending.
  const std::vector<int>& points_used() const { return points_used_; }
  std::span<const LineNode> rule(int points) const;
  /// Half the longest arm of the pieces with so many points, and of all [length].
  double half_arm(int points) const { return half_arm_[static_cast<std::size_t>(points)]; }
  double half_arm() const { return longest_half_arm_; }

  /// The integral over a piece at index distance d (in voxels) from its middle.
  double weight(std::size_t piece, const Vec3& d) const;
  /// Whether it is positive: the piece has a point within one cutoff.
  bool reaches(std::size_t piece, const Vec3& d) const;

 private:
  void divide();
  Columns3 middles() const;
  double length(std::size_t branch) const;
  Vec3 from_start(const Vec3& d, const Vec3& arm) const;

  const LucyKernel& kernel_;
  const HalfBranches& branches_;
  LineIntegral method_;
  double voxel_;
  std::vector<std::uint32_t> source_;  // of each piece; empty when no branch is divided
  std::vector<double> share_;          // of each branch's pieces, likewise
  int only_points_ = 0;
  std::vector<std::uint8_t> points_;  // of each branch; empty when all take the same
  std::vector<int> points_used_;
  std::array<double, 9> half_arm_{};
  double longest_half_arm_ = 0;
  Buckets buckets_;
};

}  // namespace grainvdb
