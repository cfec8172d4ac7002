#include "average/moment_sums.hpp"

#include <algorithm>
#include <utility>

#include "base/parallel.hpp"

namespace grainvdb {

MomentMeans::MomentMeans(LeafBuffers values, LeafBuffers frame_count, std::map<std::string, int> first_channel)
    : values_(std::move(values)), frame_count_(std::move(frame_count)), first_channel_(std::move(first_channel)) {}

std::size_t MomentSums::CoordHash::operator()(const Coord& c) const noexcept {
  // Leaf origins are multiples of 8; three odd multipliers spread neighbours over the table.
  const auto u = [](std::int32_t i) { return static_cast<std::size_t>(static_cast<std::uint32_t>(i) >> 3U); };
  return u(c.x) * 73856093U ^ u(c.y) * 19349663U ^ u(c.z) * 83492791U;
}

MomentSums::MomentSums(const std::vector<MomentPtr>& moments) {
  int channels = 0;
  for (const MomentPtr& m : moments)
    if (first_channel_.emplace(m->name, channels).second) channels += m->channels;
  channels_ = static_cast<std::size_t>(channels);
}

MomentSums::Leaf& MomentSums::leaf(const Coord& origin) {
  auto& slot = leaves_[origin];
  if (!slot) {
    slot = std::make_unique<Leaf>();
    slot->sums.resize(channels_ * leaf_size);
  }
  return *slot;
}

std::size_t MomentSums::bytes(std::size_t leaves) const {
  return leaves * (sizeof(Leaf) + channels_ * leaf_size * sizeof(double));
}

bool MomentSums::wants(const Moment& moment) const {
  return first_channel_.contains(moment.name) && !complete_.contains(moment.name);
}

void MomentSums::add(const Moment& moment, const LeafBuffers& part, int channel) {
  added_.insert(moment.name);
  const auto first = static_cast<std::size_t>(first_channel_.at(moment.name));
  const Topology& topology = *part.topology();
  std::vector<Leaf*> targets(topology.leaf_count());
  for (std::size_t l = 0; l < targets.size(); ++l) targets[l] = &leaf(topology.origin(l));
  parallel_for(targets.size(), [&](std::size_t l) {
    Leaf& to = *targets[l];
    to.reached |= topology.mask(l);
    for (int c = 0; c < moment.channels; ++c) {
      const double* from = part.block(l, channel + c);
      double* sum = to.sums.data() + (first + static_cast<std::size_t>(c)) * leaf_size;
      for (int v = 0; v < leaf_size; ++v) sum[v] += from[v];
    }
  });
}

void MomentSums::end_frame() {
  const double sample = complete_.empty() ? 1 : 0;
  for (auto& [origin, leaf] : leaves_) {
    leaf->reached.for_each([&](int v) { leaf->frames[static_cast<std::size_t>(v)] += sample; });
    leaf->mask |= leaf->reached;
    leaf->reached = {};
  }
}

void MomentSums::end_sweep() {
  complete_.merge(added_);
  added_.clear();
}

MomentMeans MomentSums::means(const std::vector<MomentPtr>& subset, std::size_t frames) const {
  std::vector<Coord> origins;
  std::vector<LeafMask> masks;
  origins.reserve(leaves_.size());
  masks.reserve(leaves_.size());
  for (const auto& [origin, leaf] : leaves_) {
    origins.push_back(origin);
    masks.push_back(leaf->mask);
  }
  const auto topology = std::make_shared<const Topology>(std::move(origins), std::move(masks));

  std::map<std::string, int> first_channel;
  std::vector<std::pair<std::size_t, std::size_t>> copies;  // channel in the sums → channel in the means
  int channels = 0;
  for (const MomentPtr& m : subset) {
    if (!first_channel.emplace(m->name, channels).second) continue;
    for (int c = 0; c < m->channels; ++c) copies.emplace_back(first_channel_.at(m->name) + c, channels + c);
    channels += m->channels;
  }

  LeafBuffers values(topology, channels);
  LeafBuffers counts(topology, 1);
  const double n = static_cast<double>(frames);
  parallel_for(topology->leaf_count(), [&](std::size_t l) {
    const Leaf& from = *leaves_.at(topology->origin(l));
    for (const auto& [source, target] : copies) {
      const double* sum = from.sums.data() + source * leaf_size;
      double* to = values.block(l, static_cast<int>(target));
      for (int v = 0; v < leaf_size; ++v) to[v] = sum[v] / n;
    }
    std::copy(from.frames.begin(), from.frames.end(), counts.block(l, 0));
  });
  return {std::move(values), std::move(counts), std::move(first_channel)};
}

}  // namespace grainvdb
