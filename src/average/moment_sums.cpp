#include "average/moment_sums.hpp"

#include <algorithm>
#include <utility>

#include "base/parallel.hpp"

namespace grainvdb {

std::size_t MomentSums::CoordHash::operator()(const Coord& c) const noexcept {
  // Leaf origins are multiples of 8; three odd multipliers spread neighbours over the table.
  const auto u = [](std::int32_t i) { return static_cast<std::size_t>(static_cast<std::uint32_t>(i) >> 3U); };
  return u(c.x) * 73856093U ^ u(c.y) * 19349663U ^ u(c.z) * 83492791U;
}

MomentSums::MomentSums(const std::vector<MomentPtr>& moments) {
  int channels = 0;
  for (const MomentPtr& m : moments)
    if (first_channel_.emplace(m->name, channels).second) {
      count_[m->name] = m->channels;
      channels += m->channels;
    }
  channels_ = static_cast<std::size_t>(channels);
}

MomentSums::MomentSums(MomentSums&&) noexcept = default;
MomentSums::~MomentSums() = default;

MomentSums::Leaf& MomentSums::leaf(const Coord& origin) {
  auto& slot = leaves_[origin];
  if (!slot) {
    slot = std::make_unique<Leaf>();
    slot->sums.resize(channels_ * leaf_size);
    all_.push_back(slot.get());
  }
  return *slot;
}

std::size_t MomentSums::bytes(std::size_t leaves) const {
  return leaves * (sizeof(Leaf) + channels_ * leaf_size * sizeof(double));
}

bool MomentSums::wants(const Moment& moment) const {
  return first_channel_.contains(moment.name) && !complete_.contains(moment.name);
}

MomentSums::Target MomentSums::target(const std::vector<MomentPtr>& moments, const Topology& topology) {
  Target target;
  if (moments.empty()) return target;
  for (const MomentPtr& m : moments) {
    added_.insert(m->name);
    target.moments_.push_back(
        {static_cast<std::size_t>(first_channel_.at(m->name)), static_cast<std::size_t>(m->channels)});
  }
  target.leaves_.resize(topology.leaf_count());
  for (std::size_t l = 0; l < target.leaves_.size(); ++l) {
    target.leaves_[l] = &leaf(topology.origin(l));
    target.leaves_[l]->reached |= topology.mask(l);
  }
  return target;
}

void MomentSums::Target::add(std::size_t leaf, std::size_t k, const double* values) const {
  double* sum = leaves_[leaf]->sums.data() + moments_[k].first * leaf_size;
  const std::size_t n = moments_[k].count * leaf_size;
  for (std::size_t i = 0; i < n; ++i) sum[i] += values[i];
}

void MomentSums::add(const MomentPtr& moment, const LeafBuffers& part, int channel) {
  const Target to = target({moment}, *part.topology());
  parallel_for(part.topology()->leaf_count(), [&](std::size_t l) { to.add(l, 0, part.block(l, channel)); });
}

void MomentSums::end_frame() {
  const double sample = complete_.empty() ? 1 : 0;
  parallel_for(all_.size(), [&](std::size_t l) {
    Leaf& leaf = *all_[l];
    leaf.reached.for_each([&](int v) { leaf.frames[static_cast<std::size_t>(v)] += sample; });
    leaf.mask |= leaf.reached;
    leaf.reached = {};
  });
}

void MomentSums::end_sweep(std::size_t frames) {
  const auto n = static_cast<double>(frames);
  parallel_for(all_.size(), [&](std::size_t l) {
    for (const std::string& name : added_) {
      double* sum = all_[l]->sums.data() + static_cast<std::size_t>(first_channel_.at(name)) * leaf_size;
      for (std::size_t i = 0; i < static_cast<std::size_t>(count_.at(name)) * leaf_size; ++i) sum[i] /= n;
    }
  });
  complete_.merge(added_);
  added_.clear();
}

MomentMeans MomentSums::means() const {
  std::vector<Coord> origins;
  std::vector<LeafMask> masks;
  origins.reserve(leaves_.size());
  masks.reserve(leaves_.size());
  for (const auto& [origin, leaf] : leaves_) {
    origins.push_back(origin);
    masks.push_back(leaf->mask);
  }
  LeafBlocks values{std::make_shared<const Topology>(std::move(origins), std::move(masks)), {}};
  std::vector<const double*> frame_counts;
  for (const Coord& origin : values.topology->origins()) {
    const Leaf& leaf = *leaves_.at(origin);
    values.leaves.push_back(leaf.sums.data());
    frame_counts.push_back(leaf.frames.data());
  }
  std::map<std::string, int> first_channel;
  for (const std::string& name : complete_) first_channel[name] = first_channel_.at(name);
  return {std::move(values), std::move(frame_counts), std::move(first_channel)};
}

}  // namespace grainvdb
