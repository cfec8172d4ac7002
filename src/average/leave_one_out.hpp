#pragma once
/// The means of a window without one of its blocks of frames: what the jackknife forms fields from.
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "average/window_sums.hpp"
#include "grainvdb/leaf_buffers.hpp"
#include "grainvdb/topology.hpp"

namespace grainvdb {

class LeaveOneOut {
 public:
  /// Of the blocked moments of `sums`, which must outlive this, on the topology of `whole`: the means of the window.
  LeaveOneOut(const WindowSums& sums, const MomentMeans& whole);

  std::size_t block_count() const { return sums_.blocks().size(); }
  /// The frames of a block, and of all blocks.
  std::size_t frames(std::size_t block) const { return sums_.blocks()[block].frames(); }
  std::size_t frames() const { return frames_; }

  /// The means over all frames but those of the block; the next call overwrites them. Each voxel's terms are added up
  /// anew: a difference of sums would leave the rounding of the block that is taken off.
  MomentMeans without(std::size_t block);
  /// The means over all blocks.
  MomentMeans of_all();

  /// The voxels of a leaf that any of the moments reaches in two blocks at least.
  LeafMask reached_twice(std::size_t leaf, const std::vector<MomentPtr>& moments) const;

  /// Bytes that a leaf takes, apart from the sums.
  static std::size_t bytes_per_leaf(const std::vector<MomentPtr>& moments);

 private:
  MomentMeans mean_of_others(std::size_t left_out);

  const WindowSums& sums_;
  std::size_t frames_ = 0;
  std::map<std::string, int> first_channel_;
  LeafBuffers values_;
  std::vector<const double*> frame_counts_;
};

}  // namespace grainvdb
