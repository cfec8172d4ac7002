#pragma once
/// The gather of branches leaf by leaf: which voxels they reach, and their sums in single precision.
#include <span>
#include <vector>

#include "grainvdb/accumulation.hpp"
#include "grainvdb/leaf_buffers.hpp"
#include "splat/branch_set.hpp"
#include "splat/contact_bricks.hpp"
#include "splat/leaf_consumer.hpp"

namespace grainvdb {

/// What a thread needs for one leaf, reused from leaf to leaf.
struct ContactWork {
  LeafBranches candidates, sorted;
  std::vector<std::size_t> cells;
  std::vector<BranchClass> classes;
  std::vector<DoubtfulVoxel> doubtful;
  std::vector<std::int32_t> at_voxel;
  std::vector<std::size_t> again;  // channels of a voxel to be summed in double
  BrickSums sums;
  std::vector<float> faint, certain;
  std::vector<double> values;  // [channel][offset]
  BranchScratch scratch;
};

class ContactLeaves {
 public:
  ContactLeaves(const Lattice& lattice, const LucyKernel& kernel, const BranchSet& set);

  /// The voxels of the stored period within one cutoff of a branch, exactly; of the leaves that are wanted, if not all.
  std::shared_ptr<const Topology> topology(const Region* wanted) const;

  /// The sums by the rules of the set.
  void sums(const Topology& topology, const LeafConsumer& consume, Accumulation how) const;
  /// The same at the voxels of a topology that has more of them than the branches reach: 0 at those.
  void sums_where_reached(const Topology& topology, const LeafConsumer& consume, Accumulation how) const;

 private:
  void find_scales();
  void find_cells(const Coord& leaf, ContactWork& work) const;
  void collect(const Coord& leaf, ContactWork& work) const;
  void sort_by_rule(ContactWork& work) const;
  LeafMask reached(const Coord& leaf, ContactWork& work) const;
  void add_reach(const Coord& leaf, const LeafMask& window, ContactWork& work, LeafMask& mask) const;
  void run(const Coord& origin, const LeafMask& mask, Accumulation how, ContactWork& work) const;
  void run_in_single(const Coord& origin, const LeafMask& mask, ContactWork& work) const;
  void sum_again(const Coord& origin, const LeafMask& mask, ContactWork& work) const;
  void leave_out_large_sums(int offset, const float* bar, ContactWork& work) const;
  void sum_in_double(const Coord& origin, int offset, ContactWork& work) const;
  Vec3 from_middle(const Coord& voxel, std::size_t entry) const;
  float half_arm() const { return static_cast<float>(set_.half_arm() / kernel_.cutoff()); }

  const Lattice& lattice_;
  const LucyKernel& kernel_;
  const BranchSet& set_;
  std::size_t channels_;
  std::size_t stride_;
  std::vector<double> scale_;         // of each channel a power of two about its largest |q|
  Grow<float> records_;               // [entry][arm, values]: 4 (3 + channels) bytes per entry
  std::vector<std::uint8_t> points_;  // of each entry; empty when all take the same
  std::vector<BranchRule> rules_;     // by number of points
};

}  // namespace grainvdb
