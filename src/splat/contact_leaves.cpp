#include "splat/contact_leaves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <tbb/enumerable_thread_specific.h>

#include "base/parallel.hpp"
#include "splat/gather.hpp"
#include "splat/value_unit.hpp"

namespace grainvdb {

ContactLeaves::ContactLeaves(const Lattice& lattice, const LucyKernel& kernel, const BranchSet& set)
    : lattice_(lattice),
      kernel_(kernel),
      set_(set),
      channels_(set.channels()),
      stride_(channels_ + 3),
      scale_(channels_, 0.0) {
  const Buckets& buckets = set.buckets();
  if (buckets.point.size() > std::numeric_limits<std::int32_t>::max()) throw std::invalid_argument("too many contacts");
  for (int n = 0; n <= 8; ++n) rules_.emplace_back(n == 0 ? std::span<const LineNode>{} : set.rule(n));
  rules_[1].has_curvature = set.has_curvature();
  find_scales();
  records_.room(buckets.point.size() * stride_);
  if (set.points_used().size() > 1) points_.resize(buckets.point.size());
  parallel_for(buckets.point.size(), [&](std::size_t e) {
    const std::size_t piece = buckets.point[e];
    const Vec3 arm = set.arm(piece);
    float* to = records_.data() + e * stride_;
    for (std::size_t a = 0; a < 3; ++a) to[a] = static_cast<float>(arm[a] / kernel.cutoff());
    for (std::size_t c = 0; c < channels_; ++c) to[3 + c] = static_cast<float>(set.value(piece, c) / scale_[c]);
    if (!points_.empty()) points_[e] = static_cast<std::uint8_t>(set.points(piece));
  });
}

void ContactLeaves::find_scales() {
  const std::vector<std::uint32_t>& piece = set_.buckets().point;
  constexpr std::size_t run = 4096;
  std::vector<double> largest((piece.size() + run - 1) / run * channels_);
  parallel_for(largest.size() / channels_, [&](std::size_t r) {
    double* of_run = largest.data() + r * channels_;
    for (std::size_t e = r * run; e < std::min(piece.size(), (r + 1) * run); ++e)
      for (std::size_t c = 0; c < channels_; ++c) of_run[c] = std::max(of_run[c], std::abs(set_.value(piece[e], c)));
  });
  for (std::size_t n = 0; n < largest.size(); ++n) scale_[n % channels_] = std::max(scale_[n % channels_], largest[n]);
  for (double& scale : scale_) scale = unit_of(scale);
}

std::shared_ptr<const Topology> ContactLeaves::topology(const Region* wanted) const {
  const double reach = (kernel_.cutoff() + set_.half_arm()) / lattice_.voxel();
  std::vector<Coord> leaves = leaves_in_reach(lattice_, set_.buckets(), reach);
  if (wanted != nullptr) std::erase_if(leaves, [&](const Coord& leaf) { return !wanted->holds(leaf); });
  std::vector<LeafMask> masks(leaves.size());
  tbb::enumerable_thread_specific<ContactWork> work;
  parallel_for(leaves.size(), [&](std::size_t l) { masks[l] = reached(leaves[l], work.local()); });
  return std::make_shared<const Topology>(std::move(leaves), std::move(masks));
}

void ContactLeaves::sums(const Topology& topology, const LeafConsumer& consume, Accumulation how) const {
  tbb::enumerable_thread_specific<ContactWork> works;
  parallel_for(topology.leaf_count(), [&](std::size_t l) {
    ContactWork& work = works.local();
    run(topology.origin(l), topology.mask(l), how, work);
    consume(l, work.values.data());
  });
}

void ContactLeaves::sums_where_reached(const Topology& topology, const LeafConsumer& consume, Accumulation how) const {
  tbb::enumerable_thread_specific<ContactWork> works;
  parallel_for(topology.leaf_count(), [&](std::size_t l) {
    ContactWork& work = works.local();
    run(topology.origin(l), reached(topology.origin(l), work), how, work);
    consume(l, work.values.data());
  });
}

/// Of the branches in work.cells.
void ContactLeaves::collect(const Coord& leaf, ContactWork& work) const {
  LeafBranches& to = work.candidates;
  to.records = records_.data();
  to.stride = stride_;
  const double to_cutoff = lattice_.voxel() / kernel_.cutoff();
  to.voxel = static_cast<float>(to_cutoff);
  collect_branches(set_.buckets(), work.cells, leaf, to_cutoff, 1 + set_.half_arm() / kernel_.cutoff(), to);
}

void ContactLeaves::find_cells(const Coord& leaf, ContactWork& work) const {
  const double reach = (kernel_.cutoff() + set_.half_arm()) / lattice_.voxel();
  work.cells.clear();
  for_each_cell(set_.buckets(), leaf, reach, [&](std::size_t cell) { work.cells.push_back(cell); });
}

/// Candidates of the same rule one after another, each in their order.
void ContactLeaves::sort_by_rule(ContactWork& work) const {
  LeafBranches& from = work.candidates;
  std::array<std::size_t, 10> start{};
  if (points_.empty()) {
    work.classes.assign(1, {0, from.size(), &rules_[static_cast<std::size_t>(set_.points_used().front())], half_arm()});
    return;
  }
  for (const std::uint32_t e : from.entry) ++start[points_[e] + 1U];
  for (std::size_t n = 1; n < start.size(); ++n) start[n] += start[n - 1];
  work.classes.clear();
  for (std::size_t n = 0; n < rules_.size(); ++n)
    if (start[n] < start[n + 1])
      work.classes.push_back({start[n], start[n + 1], &rules_[n],
                              static_cast<float>(set_.half_arm(static_cast<int>(n)) / kernel_.cutoff())});
  LeafBranches& to = work.sorted;
  to.entry.resize(from.size());
  using Values = Grow<float> LeafBranches::*;
  for (const Values column : {&LeafBranches::x, &LeafBranches::y, &LeafBranches::z, &LeafBranches::ax,
                              &LeafBranches::ay, &LeafBranches::az, &LeafBranches::arm2})
    (to.*column).room(from.size());
  for (std::size_t k = 0; k < from.size(); ++k) {
    const std::size_t at = start[points_[from.entry[k]]]++;
    to.entry[at] = from.entry[k];
    for (const Values column : {&LeafBranches::x, &LeafBranches::y, &LeafBranches::z, &LeafBranches::ax,
                                &LeafBranches::ay, &LeafBranches::az, &LeafBranches::arm2})
      (to.*column)[at] = (from.*column)[k];
  }
  to.records = from.records;
  to.stride = from.stride;
  to.voxel = from.voxel;
  std::swap(from, to);
}

LeafMask ContactLeaves::reached(const Coord& leaf, ContactWork& work) const {
  const LeafMask window = LeafWindow(lattice_, leaf).mask();
  LeafMask mask;
  // Inside the material the branches of the leaf itself reach all of it.
  const std::vector<Coord>& cells = set_.buckets().cells;
  const auto own = std::lower_bound(cells.begin(), cells.end(), leaf);
  if (own != cells.end() && *own == leaf) {
    work.cells.assign(1, static_cast<std::size_t>(own - cells.begin()));
    add_reach(leaf, window, work, mask);
    if (mask == window) return mask;
  }
  find_cells(leaf, work);
  add_reach(leaf, window, work, mask);
  return mask;
}

void ContactLeaves::add_reach(const Coord& leaf, const LeafMask& window, ContactWork& work, LeafMask& mask) const {
  collect(leaf, work);
  work.doubtful.clear();
  reach_of_branches(work.candidates, window, work.scratch, mask, work.doubtful);
  for (const DoubtfulVoxel& v : work.doubtful)
    if (!mask.test(v.offset) &&
        set_.reaches(set_.buckets().point[v.entry], from_middle(voxel_at(leaf, v.offset), v.entry)))
      mask.set(v.offset);
}

Vec3 ContactLeaves::from_middle(const Coord& voxel, std::size_t entry) const {
  const Columns3& index = set_.buckets().index;
  return {voxel.x - index[0][entry], voxel.y - index[1][entry], voxel.z - index[2][entry]};
}

void ContactLeaves::run(const Coord& origin, const LeafMask& mask, Accumulation how, ContactWork& work) const {
  run_in_single(origin, mask, work);
  if (how == Accumulation::shifted) sum_again(origin, mask, work);
}

void ContactLeaves::run_in_single(const Coord& origin, const LeafMask& mask, ContactWork& work) const {
  find_cells(origin, work);
  collect(origin, work);
  sort_by_rule(work);
  work.values.resize(channels_ * leaf_size);
  sum_branches(work.candidates, work.classes, static_cast<int>(channels_), mask, work.scratch, work.sums);
  const double peak = kernel_.value(0);
  for (std::size_t c = 0; c < channels_; ++c)
    scale_sums(work.sums, {.sum = static_cast<int>(c), .unit = peak * scale_[c]}, mask,
               work.values.data() + c * leaf_size);
}

void ContactLeaves::sum_again(const Coord& origin, const LeafMask& mask, ContactWork& work) const {
  work.faint.resize(leaf_blocks * channels_);
  faint_limits(work.candidates, static_cast<int>(channels_), work.scratch, work.faint.data());
  const bool certain = std::all_of(work.faint.begin(), work.faint.end(), [](float bar) { return bar == 0; });
  if (certain) return;
  // Each channel is judged by itself, so that a sum does not depend on which others are asked for.
  mask.for_each([&](int v) {
    const int block = (v >> 8) * 4 + ((v >> 5) & 1) * 2 + ((v >> 2) & 1);
    const float* bar = work.faint.data() + static_cast<std::size_t>(block) * channels_;
    work.again.clear();
    const float* sum = work.sums.values.data() + work.sums.place(v);
    for (std::size_t c = 0; c < channels_; ++c, sum += work.sums.lanes)
      if (std::abs(*sum) < bar[c]) work.again.push_back(c);
    if (work.again.empty()) return;
    branches_at_voxel(work.candidates, v, work.at_voxel);
    leave_out_large_sums(v, bar, work);
    if (!work.again.empty()) sum_in_double(origin, v, work);
  });
}

/// Leaves only those channels to be summed again whose sum of |terms|, estimated from the middles of the branches, is
/// not large either: most small sums inside the material are differences of large terms.
void ContactLeaves::leave_out_large_sums(int offset, const float* bar, ContactWork& work) const {
  const LeafBranches& all = work.candidates;
  const auto at = [&](int n) { return all.voxel * (static_cast<float>(n) - 3.5F); };
  const float x = at(offset >> 6), y = at((offset >> 3) & 7), z = at(offset & 7);
  work.certain.assign(channels_, 0.0F);
  // The middle of the list holds the branches of the nearest cells.
  const std::size_t count = work.at_voxel.size();
  for (std::size_t n = 0; n < count && !work.again.empty(); ++n) {
    const auto k = static_cast<std::size_t>(work.at_voxel[(n + count / 2) % count]);
    const float dx = x - all.x[k], dy = y - all.y[k], dz = z - all.z[k];
    const float r = std::sqrt(dx * dx + dy * dy + dz * dz);
    if (!(r < 1)) continue;
    const float weight = (1 - r) * (1 - r) * (1 - r) * (1 + 3 * r);
    const float* value = all.records + all.entry[k] * all.stride + 3;
    std::erase_if(work.again, [&](std::size_t c) {
      work.certain[c] += weight * std::abs(value[c]);
      return work.certain[c] > 2 * bar[c];
    });
  }
}

void ContactLeaves::sum_in_double(const Coord& origin, int offset, ContactWork& work) const {
  double* const values = work.values.data() + offset;
  for (const std::size_t c : work.again) values[c * leaf_size] = 0;
  for (const std::int32_t k : work.at_voxel) {
    const std::uint32_t e = work.candidates.entry[static_cast<std::size_t>(k)];
    const std::size_t piece = set_.buckets().point[e];
    const double w = set_.weight(piece, from_middle(voxel_at(origin, offset), e));
    if (w == 0) continue;
    for (const std::size_t c : work.again) values[c * leaf_size] += set_.value(piece, c) * w;
  }
}

}  // namespace grainvdb
