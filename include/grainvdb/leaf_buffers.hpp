#pragma once
/// Several channels over the leaves of a topology: what the splat returns and the averages add up.
#include <cstddef>
#include <memory>
#include <vector>

#include "grainvdb/topology.hpp"

namespace grainvdb {

/// Gives back pages that were mapped from the system.
struct PageUnmapper {
  std::size_t bytes = 0;
  void operator()(double* pages) const;
};

/// Where the values of each leaf lie, [channel][offset in leaf], whoever owns them.
struct LeafBlocks {
  std::shared_ptr<const Topology> topology;
  std::vector<const double*> leaves;
  const double* block(std::size_t leaf, int channel) const {
    return leaves[leaf] + static_cast<std::size_t>(channel) * leaf_size;
  }
};

/// Values in double precision, laid out [leaf][channel][offset in leaf]; zero until written.
class LeafBuffers {
 public:
  LeafBuffers() = default;
  /// Throws std::bad_alloc when the memory cannot be had.
  LeafBuffers(std::shared_ptr<const Topology> topology, int channels);

  const std::shared_ptr<const Topology>& topology() const { return topology_; }
  int channels() const { return channels_; }
  double* block(std::size_t leaf, int channel) { return data_.get() + at(leaf, channel); }
  const double* block(std::size_t leaf, int channel) const { return data_.get() + at(leaf, channel); }
  LeafBlocks blocks() const;
  std::size_t bytes() const {
    return topology_->leaf_count() * static_cast<std::size_t>(channels_) * leaf_size * sizeof(double);
  }

 private:
  std::size_t at(std::size_t leaf, int channel) const {
    return (leaf * static_cast<std::size_t>(channels_) + static_cast<std::size_t>(channel)) * leaf_size;
  }
  std::shared_ptr<const Topology> topology_ = std::make_shared<Topology>();
  int channels_ = 0;
  std::unique_ptr<double[], PageUnmapper> data_;
};

}  // namespace grainvdb
