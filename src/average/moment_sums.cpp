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
  for (const MomentPtr& m : moments) {
    const auto count = static_cast<std::size_t>(m->channels);
    if (places_.emplace(m->name, Place{places_.size(), channels_, count}).second) channels_ += count;
  }
}

MomentSums::MomentSums(MomentSums&&) noexcept = default;
MomentSums& MomentSums::operator=(MomentSums&&) noexcept = default;
MomentSums::~MomentSums() = default;

MomentSums::Leaf& MomentSums::leaf(const Coord& origin) {
  auto& slot = leaves_[origin];
  if (!slot) {
    slot = std::make_unique<Leaf>();
    slot->reached_by.resize(places_.size());
    slot->sums.resize(channels_ * leaf_size);
    all_.push_back(slot.get());
  }
  return *slot;
}

const MomentSums::Leaf* MomentSums::find(const Coord& origin) const {
  const auto it = leaves_.find(origin);
  return it == leaves_.end() ? nullptr : it->second.get();
}

std::size_t MomentSums::bytes(std::size_t leaves) const {
  return leaves * (sizeof(Leaf) + places_.size() * sizeof(LeafMask) + channels_ * leaf_size * sizeof(double));
}

bool MomentSums::wants(const Moment& moment) const {
  return places_.contains(moment.name) && !complete_.contains(moment.name);
}

MomentSums::Target MomentSums::target(const std::vector<MomentPtr>& moments, const Topology& topology) {
  Target target;
  if (moments.empty()) return target;
  for (const MomentPtr& m : moments) {
    target.moments_.push_back(places_.at(m->name));
    added_.insert(m->name);
  }
  target.leaves_.resize(topology.leaf_count());
  for (std::size_t l = 0; l < target.leaves_.size(); ++l) {
    Leaf& to = leaf(topology.origin(l));
    to.reached |= topology.mask(l);
    for (const Place& m : target.moments_) to.reached_by[m.number] |= topology.mask(l);
    target.leaves_[l] = &to;
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
  const bool counts = first_sweep_;
  if (counts) ++frames_;
  parallel_for(all_.size(), [&](std::size_t l) {
    Leaf& leaf = *all_[l];
    if (counts) leaf.reached.for_each([&](int v) { leaf.frames[static_cast<std::size_t>(v)] += 1; });
    leaf.mask |= leaf.reached;
    leaf.reached = {};
  });
}

void MomentSums::add(const MomentSums& frames) {
  std::vector<std::pair<Place, Place>> moments;  // here and there
  for (const std::string& name : frames.added_)
    if (const auto it = places_.find(name); it != places_.end()) {
      moments.emplace_back(it->second, frames.places_.at(name));
      added_.insert(name);
    }
  const bool counts = first_sweep_;
  if (counts) frames_ += frames.frames_;
  std::vector<std::pair<Leaf*, const Leaf*>> leaves;
  for (const auto& [origin, from] : frames.leaves_) leaves.emplace_back(&leaf(origin), from.get());
  parallel_for(leaves.size(), [&](std::size_t l) {
    const auto& [to, from] = leaves[l];
    to->mask |= from->mask;
    if (counts)
      for (std::size_t v = 0; v < leaf_size; ++v) to->frames[v] += from->frames[v];
    for (const auto& [here, there] : moments) {
      to->reached_by[here.number] |= from->reached_by[there.number];
      double* sum = to->sums.data() + here.first * leaf_size;
      const double* values = from->sums.data() + there.first * leaf_size;
      for (std::size_t i = 0; i < here.count * leaf_size; ++i) sum[i] += values[i];
    }
  });
}

void MomentSums::end_sweep(std::size_t frames) {
  const auto n = static_cast<double>(frames);
  parallel_for(all_.size(), [&](std::size_t l) {
    for (const std::string& name : added_) {
      const Place& place = places_.at(name);
      double* sum = all_[l]->sums.data() + place.first * leaf_size;
      for (std::size_t i = 0; i < place.count * leaf_size; ++i) sum[i] /= n;
    }
  });
  end_sweep();
}

void MomentSums::end_sweep() {
  first_sweep_ = false;
  complete_.merge(added_);
  added_.clear();
}

const double* MomentSums::sum(const Coord& origin, const Moment& moment) const {
  const Leaf* leaf = find(origin);
  return leaf == nullptr ? nullptr : leaf->sums.data() + places_.at(moment.name).first * leaf_size;
}

LeafMask MomentSums::reached_by(const Coord& origin, const Moment& moment) const {
  const Leaf* leaf = find(origin);
  return leaf == nullptr ? LeafMask{} : leaf->reached_by[places_.at(moment.name).number];
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
  return means(std::make_shared<const Topology>(std::move(origins), std::move(masks)));
}

MomentMeans MomentSums::means(std::shared_ptr<const Topology> topology) const {
  LeafBlocks values{std::move(topology), {}};
  std::vector<const double*> frame_counts;
  for (const Coord& origin : values.topology->origins()) {
    const Leaf& leaf = *leaves_.at(origin);
    values.leaves.push_back(leaf.sums.data());
    frame_counts.push_back(leaf.frames.data());
  }
  std::map<std::string, int> first_channel;
  for (const std::string& name : complete_) first_channel[name] = static_cast<int>(places_.at(name).first);
  return {std::move(values), std::move(frame_counts), std::move(first_channel)};
}

}  // namespace grainvdb
