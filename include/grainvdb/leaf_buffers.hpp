#pragma once
/// Several channels over the leaves of a topology: what the splat returns and the averages add up.
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "grainvdb/topology.hpp"

namespace grainvdb {

/// Values in double precision, laid out [leaf][channel][offset in leaf]; zero where nothing was added.
class LeafBuffers {
 public:
  LeafBuffers() = default;
  LeafBuffers(std::shared_ptr<const Topology> topology, int channels)
      : topology_(std::move(topology)),
        channels_(channels),
        data_(topology_->leaf_count() * static_cast<std::size_t>(channels) * leaf_size) {}

  const std::shared_ptr<const Topology>& topology() const { return topology_; }
  int channels() const { return channels_; }
  double* block(std::size_t leaf, int channel) { return data_.data() + at(leaf, channel); }
  const double* block(std::size_t leaf, int channel) const { return data_.data() + at(leaf, channel); }
  std::size_t bytes() const { return data_.size() * sizeof(double); }

 private:
  std::size_t at(std::size_t leaf, int channel) const {
    return (leaf * static_cast<std::size_t>(channels_) + static_cast<std::size_t>(channel)) * leaf_size;
  }
  std::shared_ptr<const Topology> topology_ = std::make_shared<Topology>();
  int channels_ = 0;
  std::vector<double> data_;
};

}  // namespace grainvdb
