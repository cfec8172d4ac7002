#pragma once
/// Sums of moments over the frames of a window, on the union of the voxels that any frame reached.
#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "grainvdb/leaf_buffers.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/topology.hpp"

namespace grainvdb {

class ByteReader;
class ByteWriter;

/// The time means of a window: all moments on one topology. A view of the sums they were formed in, which must outlive
/// it.
class MomentMeans {
 public:
  MomentMeans(LeafBlocks values, std::vector<const double*> frame_counts, std::map<std::string, int> first_channel)
      : values_(std::move(values)), frame_counts_(std::move(frame_counts)), first_channel_(std::move(first_channel)) {}

  const std::shared_ptr<const Topology>& topology() const { return values_.topology; }
  const LeafBlocks& values() const { return values_; }
  /// Where a moment's channels start. The moment must be among those that are complete (std::out_of_range).
  int first_channel(const Moment& moment) const { return first_channel_.at(moment.name); }
  const double* block(std::size_t leaf, const Moment& moment, int channel) const {
    return values_.block(leaf, first_channel(moment) + channel);
  }
  const double* frame_count(std::size_t leaf) const { return frame_counts_[leaf]; }

  bool holds(const Moment& moment) const { return first_channel_.contains(moment.name); }
  /// Puts other values, laid out alike, in the place of a leaf's. They must outlive the means.
  void replace(std::size_t leaf, const double* values) { values_.leaves[leaf] = values; }

 private:
  LeafBlocks values_;
  std::vector<const double*> frame_counts_;
  std::map<std::string, int> first_channel_;
};

/// Adds up frames one after another: every voxel's terms are added in the order of the frames, whatever the threads do.
class MomentSums {
  struct Leaf;
  struct Place {
    std::size_t number = 0;  // among the moments
    std::size_t first = 0;   // channel
    std::size_t count = 0;   // of channels
  };

 public:
  explicit MomentSums(const std::vector<MomentPtr>& moments);
  MomentSums(MomentSums&&) noexcept;
  MomentSums& operator=(MomentSums&&) noexcept;
  ~MomentSums();

  /// Whether a moment is to be summed in the current sweep: it is among those asked for, and no earlier sweep summed
  /// it.
  bool wants(const Moment& moment) const;

  /// The place in the sums for some moments of the current frame on one topology.
  class Target {
   public:
    /// Adds the values of moment k in a leaf of that topology, laid out [channel][offset]. Concurrent calls for
    /// different leaves are safe.
    void add(std::size_t leaf, std::size_t k, const double* values) const;

   private:
    friend class MomentSums;
    std::vector<Place> moments_;
    std::vector<Leaf*> leaves_;
  };
  /// All moments must be wanted (std::out_of_range for one that is not known). Their voxels are those that the frame
  /// reached.
  Target target(const std::vector<MomentPtr>& moments, const Topology& topology);
  /// Adds one moment whose channels start at `channel` of `part`.
  void add(const MomentPtr& moment, const LeafBuffers& part, int channel);

  /// Ends a frame. In the first sweep every voxel that its moments reached gains one sample.
  void end_frame();
  /// Adds frames of the same sweep that were summed elsewhere: the sums of the moments that both know, the voxels and,
  /// in the first sweep, the samples.
  void add(const MomentSums& frames);
  /// Ends a sweep over `frames` frames: what it summed is complete, and becomes a mean.
  void end_sweep(std::size_t frames);
  /// Ends a sweep, but leaves the sums what they are.
  void end_sweep();

  /// The means of the moments that are complete. A further sweep leaves them alone.
  MomentMeans means() const;
  /// The same on the leaves that there were when a sweep ended. All must be there still (std::out_of_range).
  MomentMeans means(std::shared_ptr<const Topology> leaves) const;

  /// The frames of the first sweep.
  std::size_t frames() const { return frames_; }
  /// The sum of a moment in a leaf, [channel][offset]; nullptr where no frame reached the leaf.
  const double* sum(const Coord& origin, const Moment& moment) const;
  /// The voxels of a leaf that a moment reached in any frame.
  LeafMask reached_by(const Coord& origin, const Moment& moment) const;

  /// Bytes that `leaves` leaves of sums take.
  std::size_t bytes(std::size_t leaves) const;
  std::size_t leaf_count() const { return leaves_.size(); }

  /// Between two frames.
  void save(ByteWriter& to) const;
  /// Into sums of the same moments that nothing was added to.
  void load(ByteReader& from);

 private:
  struct Leaf {
    LeafMask mask;
    LeafMask reached;                  // by the current frame
    std::vector<LeafMask> reached_by;  // each moment
    std::vector<double> sums;
    std::array<double, leaf_size> frames{};
  };
  struct CoordHash {
    std::size_t operator()(const Coord& c) const noexcept;
  };
  Leaf& leaf(const Coord& origin);
  const Leaf* find(const Coord& origin) const;

  std::map<std::string, Place> places_;
  std::size_t channels_ = 0;
  std::set<std::string> added_;     // in the current sweep
  std::set<std::string> complete_;  // in earlier sweeps
  bool first_sweep_ = true;
  std::size_t frames_ = 0;
  std::unordered_map<Coord, std::unique_ptr<Leaf>, CoordHash> leaves_;
  std::vector<Leaf*> all_;  // in the order they came
};

}  // namespace grainvdb
