#pragma once
/// The sums over the frames of a window and, of the moments whose fields get a standard error, those over each of the
/// blocks of successive frames that the window is made of.
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "average/moment_sums.hpp"
#include "grainvdb/leaf_buffers.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/topology.hpp"

namespace grainvdb {

class WindowSums {
 public:
  /// `blocked` are among the moments. Without any there are no blocks, whatever is begun.
  WindowSums(const std::vector<MomentPtr>& moments, const std::vector<MomentPtr>& blocked);

  /// Frames that follow belong to this block. Blocks begin in their order; a further sweep goes through them again.
  void begin_block(std::size_t block);

  bool wants(const Moment& moment) const { return all_.wants(moment); }

  /// As MomentSums::Target, for the window and the current block.
  class Target {
   public:
    void add(std::size_t leaf, std::size_t k, const double* values) const;

   private:
    friend class WindowSums;
    MomentSums::Target all_, block_;
    std::vector<std::size_t> blocked_;  // which of the moments are summed in the block as well
  };
  Target target(const std::vector<MomentPtr>& moments, const Topology& topology);
  void add(const MomentPtr& moment, const LeafBuffers& part, int channel);
  void end_frame();

  /// Adds frames of the first sweep that were summed elsewhere.
  void add(const WindowSums& frames);

  /// Ends a sweep over all frames of the window: what it summed is complete, and becomes a mean.
  void end_sweep();
  MomentMeans means() const { return all_.means(); }
  MomentMeans means(std::shared_ptr<const Topology> leaves) const { return all_.means(std::move(leaves)); }

  /// Joins every two successive blocks.
  void join_blocks();

  std::size_t frames() const { return all_.frames(); }
  const std::vector<MomentPtr>& blocked() const { return blocked_; }
  const std::vector<MomentSums>& blocks() const { return blocks_; }

  std::size_t leaf_count() const { return all_.leaf_count(); }

  /// As with MomentSums.
  void save(ByteWriter& to) const;
  void load(ByteReader& from);
  /// Bytes that a leaf takes in the sums of a window with so many blocks.
  static std::size_t bytes_per_leaf(const std::vector<MomentPtr>& moments, const std::vector<MomentPtr>& blocked,
                                    std::size_t blocks);

 private:
  MomentSums all_;
  std::vector<MomentPtr> blocked_;
  std::vector<MomentSums> blocks_;
  std::size_t current_ = 0;
};

}  // namespace grainvdb
