#pragma once
/// The half branches of a frame as the splat sums them: cut into straight pieces, in buckets about their middles.
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

/// Values of half branches, laid out [branch][channel].
struct BranchValues {
  std::span<const double> q;
  std::size_t channels = 1;
  const double* of(std::size_t branch) const { return q.data() + branch * channels; }
};

/// A piece is a half branch; or an equal part of one that no rule can integrate at once; or both halves of a contact,
/// where its point lies on the line of centres, the values of the halves are as their lengths and both are of the same
/// species: then the whole branch takes fewer points than its halves. Whole branches occur with the adaptive method
/// only, parted ones with that and with midpoint_curvature.
class BranchSet {
 public:
  /// `branches` and `values` must outlive the set. Pieces that reach no leaf that is wanted are left out of the
  /// buckets; nullptr: none. Throws std::invalid_argument when an arm is longer than 1e6 cutoffs.
  BranchSet(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches, const BranchValues& values,
            LineIntegral method, const Region* wanted = nullptr);

  /// The middles of the pieces; a bucket's point is a piece.
  const Buckets& buckets() const { return buckets_; }
  std::size_t channels() const { return values_.channels; }

  Vec3 arm(std::size_t piece) const;
  double value(std::size_t piece, std::size_t channel) const;
  /// [piece][channel]; empty where pieces are half branches, whose values were given.
  std::vector<double> values_of_pieces() const;

  /// The points of the rule that a piece takes, 0 for the exact integral.
  int points(std::size_t piece) const { return plans_.empty() ? only_points_ : plans_[branch(piece)].points; }
  /// The numbers of points that occur, ascending.
  const std::vector<int>& points_used() const { return points_used_; }
  std::span<const LineNode> rule(int points) const;
  /// Whether the second derivative belongs to the rule.
  bool has_curvature() const { return method_.method == LineIntegral::Method::midpoint_curvature; }
  /// Half the longest arm of the pieces with so many points, and of all [length].
  double half_arm(int points) const { return half_arm_[static_cast<std::size_t>(points)]; }
  double half_arm() const { return longest_half_arm_; }

  /// The integral over a piece at index distance d (in voxels) from its middle.
  double weight(std::size_t piece, const Vec3& d) const;
  /// Whether the half branches of a piece have a point within one cutoff of it.
  bool reaches(std::size_t piece, const Vec3& d) const;

 private:
  struct Plan {
    std::uint8_t points = 0;
    bool whole = false;  ///< joined with the next half branch
    std::uint32_t parts = 1;
  };
  void plan();
  double whole_length(std::size_t branch) const;
  Columns3 middles() const;
  std::size_t branch(std::size_t piece) const { return source_.empty() ? piece : source_[piece]; }
  Plan plan_of(std::size_t piece) const { return plans_.empty() ? Plan{} : plans_[branch(piece)]; }
  Vec3 half(std::size_t branch) const;
  Vec3 from_start(const Vec3& d, const Vec3& arm) const;

  const Lattice& lattice_;
  const LucyKernel& kernel_;
  const HalfBranches& branches_;
  BranchValues values_;
  LineIntegral method_;
  int only_points_ = 0;
  std::vector<Plan> plans_;            // of each branch, for methods that divide it
  std::vector<std::uint32_t> source_;  // the branch of each piece; empty when pieces are half branches
  std::vector<int> points_used_;
  std::array<double, 9> half_arm_{};
  double longest_half_arm_ = 0;
  Buckets buckets_;
};

}  // namespace grainvdb
