#include "pipeline/window.hpp"

#include <cstdint>
#include <utility>

#include "average/growing_blocks.hpp"
#include "base/bytes.hpp"
#include "pipeline/derive_errors.hpp"
#include "pipeline/saved_fields.hpp"
#include "pipeline/wanted_leaves.hpp"

namespace grainvdb {

namespace {

const std::vector<MomentPtr> no_blocks;

/// What a leaf takes at most: in the parts that are kept for further windows, in the window and its blocks, and in what
/// standard errors are computed with.
std::size_t bytes_per_leaf(const Pipeline& pipeline, const Plan& plan, const WindowSchedule& schedule) {
  const std::size_t parts =
      schedule.overlapping ? schedule.most_parts() * WindowSums::bytes_per_leaf(plan.means, no_blocks, 0) : 0;
  const std::size_t blocks = pipeline.until ? 2 * pipeline.blocks : schedule.most_blocks();
  const std::size_t sums = WindowSums::bytes_per_leaf(plan.means, plan.block_sums, blocks);
  return parts + sums + error_bytes_per_leaf(plan);
}

}  // namespace

WindowAverager::WindowAverager(const Pipeline& pipeline, const Plan& plan, const WindowSchedule& schedule,
                               const Lattice& lattice, const std::optional<Region>& region)
    : plan_(plan),
      schedule_(schedule),
      setting_(pipeline, lattice),
      bytes_per_leaf_(bytes_per_leaf(pipeline, plan, schedule)) {
  for (std::size_t sweep = 0; sweep < plan.sweeps.size(); ++sweep) groups_.push_back(group_moments(plan, sweep));
  if (region)
    for (const SweepGroups& groups : groups_) want_leaves(groups, *region);
  begin_window();
}

void WindowAverager::want_leaves(const SweepGroups& groups, const Region& region) {
  const auto want = [&](const Halo& halo) {
    if (!setting_.wanted.contains(halo))
      setting_.wanted.emplace(halo, wanted_leaves(region, halo, setting_.lattice, setting_.kernel));
  };
  for (const SweepGroups::Pass& pass : groups.passes)
    for (const SplatGroup& group : pass.groups) want(group.halo);
  want(groups.particle_halo);
}

void WindowAverager::begin_window() {
  means_.reset();
  sums_.emplace(plan_.means, plan_.block_sums);
}

std::unique_ptr<FrameContext> WindowAverager::prepare(std::shared_ptr<const Material> material,
                                                      std::size_t sweep) const {
  auto context = std::make_unique<FrameContext>(std::move(material), setting_, groups_[sweep]);
  context->prepare(bytes_per_leaf_);
  return context;
}

WindowSums& WindowAverager::destination(const Visit& visit) {
  if (schedule_.overlapping && visit.sweep == 0) {
    for (; first_part_ < schedule_.windows[visit.window].first_part; ++first_part_) parts_.pop_front();
    if (visit.begins_part) parts_.emplace_back(plan_.means, no_blocks);
    return parts_.back();
  }
  if (setting_.pipeline.until) {
    begin_growing_block(visit);
  } else if (visit.begins_part) {
    sums_->begin_block(visit.block);
  }
  return *sums_;
}

void WindowAverager::begin_growing_block(const Visit& visit) {
  const std::size_t fewest = setting_.pipeline.blocks;
  if (visit.sweep == 0) {
    frames_ = visit.place + 1;
    if (growing_block_length(fewest, frames_) > growing_block_length(fewest, visit.place)) sums_->join_blocks();
  }
  sums_->begin_block(visit.place / growing_block_length(fewest, frames_));
}

void WindowAverager::add(FrameContext& frame, const Visit& visit) {
  WindowSums& sums = destination(visit);
  frame.run(sums, bytes_per_leaf_, means_ ? &*means_ : nullptr);
  sums.end_frame();
}

void WindowAverager::join_parts(const Window& window) {
  std::size_t part = window.first_part - first_part_;
  for (std::size_t block = 0; block < window.blocks.size(); ++block) {
    sums_->begin_block(block);
    for (std::size_t k = 0; k < window.blocks[block]; ++k, ++part) sums_->add(parts_[part]);
  }
}

void WindowAverager::end_sweep(const Visit& visit) {
  if (schedule_.overlapping && visit.sweep == 0) join_parts(schedule_.windows[visit.window]);
  sums_->end_sweep();
  means_.emplace(sums_->means());
}

void WindowAverager::save(ByteWriter& to) const {
  to.number(std::uint64_t{first_part_});
  to.number(std::uint64_t{frames_});
  to.number(std::uint64_t{parts_.size()});
  for (const WindowSums& part : parts_) part.save(to);
  sums_->save(to);
  to.number(means_.has_value());
  // A further sweep may reach leaves that the means of the sweep before do not have.
  if (means_) save_topology(to, *means_->topology());
}

void WindowAverager::load(ByteReader& from) {
  first_part_ = from.count();
  frames_ = from.count();
  for (std::size_t left = from.count(); left > 0; --left) parts_.emplace_back(plan_.means, no_blocks).load(from);
  sums_->load(from);
  if (from.number<bool>()) means_.emplace(sums_->means(load_topology(from)));
}

}  // namespace grainvdb
