#include "average/leave_one_out.hpp"

#include <algorithm>
#include <utility>

#include "base/parallel.hpp"

namespace grainvdb {
namespace {

int channel_count(const std::vector<MomentPtr>& moments) {
  int n = 0;
  for (const MomentPtr& m : moments) n += m->channels;
  return n;
}

}  // namespace

LeaveOneOut::LeaveOneOut(const WindowSums& sums, const MomentMeans& whole)
    : sums_(sums), values_(whole.topology(), channel_count(sums.blocked())) {
  int channel = 0;
  for (const MomentPtr& m : sums.blocked()) {
    first_channel_[m->name] = channel;
    channel += m->channels;
  }
  for (const MomentSums& block : sums.blocks()) frames_ += block.frames();
  for (std::size_t l = 0; l < whole.topology()->leaf_count(); ++l) frame_counts_.push_back(whole.frame_count(l));
}

MomentMeans LeaveOneOut::without(std::size_t block) {
  return mean_of_others(block);
}
MomentMeans LeaveOneOut::of_all() {
  return mean_of_others(block_count());
}

MomentMeans LeaveOneOut::mean_of_others(std::size_t left_out) {
  const std::size_t left = left_out < block_count() ? frames(left_out) : 0;
  const auto others = static_cast<double>(frames_ - left);
  parallel_for(values_.topology()->leaf_count(), [&](std::size_t l) {
    const Coord& origin = values_.topology()->origin(l);
    for (const MomentPtr& m : sums_.blocked()) {
      double* const to = values_.block(l, first_channel_.at(m->name));
      const std::size_t n = static_cast<std::size_t>(m->channels) * leaf_size;
      std::fill_n(to, n, 0.0);
      for (std::size_t b = 0; b < block_count(); ++b) {
        const double* from = b == left_out ? nullptr : sums_.blocks()[b].sum(origin, *m);
        if (from == nullptr) continue;
        for (std::size_t i = 0; i < n; ++i) to[i] += from[i];
      }
      for (std::size_t i = 0; i < n; ++i) to[i] /= others;
    }
  });
  return {values_.blocks(), frame_counts_, first_channel_};
}

std::size_t LeaveOneOut::bytes_per_leaf(const std::vector<MomentPtr>& moments) {
  return static_cast<std::size_t>(channel_count(moments)) * leaf_size * sizeof(double);
}

LeafMask LeaveOneOut::reached_twice(std::size_t leaf, const std::vector<MomentPtr>& moments) const {
  const Coord& origin = values_.topology()->origin(leaf);
  LeafMask once, twice;
  for (const MomentSums& block : sums_.blocks()) {
    LeafMask reached;
    for (const MomentPtr& m : moments) reached |= block.reached_by(origin, *m);
    for (std::size_t w = 0; w < reached.words.size(); ++w) twice.words[w] |= once.words[w] & reached.words[w];
    once |= reached;
  }
  return twice;
}

}  // namespace grainvdb
