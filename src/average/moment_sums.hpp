#pragma once
/// Sums of moments over the frames of a window, on the union of the voxels that any frame reached.
#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "grainvdb/leaf_buffers.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/topology.hpp"

namespace grainvdb {

/// The time means of a window: all moments on one topology.
class MomentMeans {
 public:
  MomentMeans(LeafBuffers values, LeafBuffers frame_count, std::map<std::string, int> first_channel);
  const std::shared_ptr<const Topology>& topology() const { return values_.topology(); }
  const LeafBuffers& values() const { return values_; }
  /// Where a moment's channels start. The moment must be among those that were summed (std::out_of_range).
  int first_channel(const Moment& moment) const { return first_channel_.at(moment.name); }
  const double* block(std::size_t leaf, const Moment& moment, int channel) const {
    return values_.block(leaf, first_channel(moment) + channel);
  }
  const double* frame_count(std::size_t leaf) const { return frame_count_.block(leaf, 0); }

 private:
  LeafBuffers values_;
  LeafBuffers frame_count_;
  std::map<std::string, int> first_channel_;
};

/// Adds up frames one after another: every voxel's terms are added in the order of the frames, whatever the threads do.
class MomentSums {
 public:
  explicit MomentSums(const std::vector<MomentPtr>& moments);

  /// Whether a moment is to be summed in the current sweep: it is among those asked for, and no earlier sweep summed
  /// it.
  bool wants(const Moment& moment) const;
  /// Adds a moment of the current frame: its channels start at `channel` of `part`.
  void add(const Moment& moment, const LeafBuffers& part, int channel);
  /// Ends a frame. In the first sweep every voxel that its moments reached gains one sample.
  void end_frame();
  /// Ends a sweep: what it summed is complete.
  void end_sweep();

  /// The mean of a subset of the moments so far, over `frames` frames.
  MomentMeans means(const std::vector<MomentPtr>& subset, std::size_t frames) const;

  /// Bytes that `leaves` leaves of sums take.
  std::size_t bytes(std::size_t leaves) const;
  std::size_t leaf_count() const { return leaves_.size(); }

 private:
  struct Leaf {
    LeafMask mask;
    LeafMask reached;  // by the current frame
    std::vector<double> sums;
    std::array<double, leaf_size> frames{};
  };
  struct CoordHash {
    std::size_t operator()(const Coord& c) const noexcept;
  };
  Leaf& leaf(const Coord& origin);

  std::map<std::string, int> first_channel_;
  std::size_t channels_ = 0;
  std::set<std::string> added_;     // in the current sweep
  std::set<std::string> complete_;  // in earlier sweeps
  std::unordered_map<Coord, std::unique_ptr<Leaf>, CoordHash> leaves_;
};

}  // namespace grainvdb
