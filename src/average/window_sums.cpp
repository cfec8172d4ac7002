#include "average/window_sums.hpp"

#include <algorithm>
#include <utility>

#include "base/parallel.hpp"

namespace grainvdb {

WindowSums::WindowSums(const std::vector<MomentPtr>& moments, const std::vector<MomentPtr>& blocked)
    : all_(moments), blocked_(blocked) {}

void WindowSums::begin_block(std::size_t block) {
  if (blocked_.empty()) return;
  current_ = block;
  if (block == blocks_.size()) blocks_.emplace_back(blocked_);
}

void WindowSums::Target::add(std::size_t leaf, std::size_t k, const double* values) const {
  all_.add(leaf, k, values);
  const auto it = std::lower_bound(blocked_.begin(), blocked_.end(), k);
  if (it != blocked_.end() && *it == k) block_.add(leaf, static_cast<std::size_t>(it - blocked_.begin()), values);
}

WindowSums::Target WindowSums::target(const std::vector<MomentPtr>& moments, const Topology& topology) {
  Target target;
  target.all_ = all_.target(moments, topology);
  if (blocked_.empty()) return target;
  std::vector<MomentPtr> in_block;
  for (std::size_t k = 0; k < moments.size(); ++k)
    if (blocks_[current_].wants(*moments[k])) {
      target.blocked_.push_back(k);
      in_block.push_back(moments[k]);
    }
  target.block_ = blocks_[current_].target(in_block, topology);
  return target;
}

void WindowSums::add(const MomentPtr& moment, const LeafBuffers& part, int channel) {
  const Target to = target({moment}, *part.topology());
  parallel_for(part.topology()->leaf_count(), [&](std::size_t l) { to.add(l, 0, part.block(l, channel)); });
}

void WindowSums::end_frame() {
  all_.end_frame();
  if (!blocked_.empty()) blocks_[current_].end_frame();
}

void WindowSums::add(const WindowSums& frames) {
  all_.add(frames.all_);
  if (!blocked_.empty()) blocks_[current_].add(frames.all_);
}

void WindowSums::end_sweep() {
  all_.end_sweep(all_.frames());
  for (MomentSums& block : blocks_) block.end_sweep();
}

void WindowSums::join_blocks() {
  std::vector<MomentSums> joined;
  for (std::size_t k = 0; k < blocks_.size(); k += 2) {
    joined.push_back(std::move(blocks_[k]));
    if (k + 1 < blocks_.size()) joined.back().add(blocks_[k + 1]);
  }
  blocks_ = std::move(joined);
}

std::size_t WindowSums::bytes_per_leaf(const std::vector<MomentPtr>& moments, const std::vector<MomentPtr>& blocked,
                                       std::size_t blocks) {
  return MomentSums(moments).bytes(1) + (blocked.empty() ? 0 : blocks * MomentSums(blocked).bytes(1));
}

}  // namespace grainvdb
