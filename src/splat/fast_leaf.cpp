#include "splat/fast_leaf.hpp"

#include <algorithm>
#include <type_traits>

namespace grainvdb {
namespace {

// Rounding of positions and squared distances moves the rim of a support by some δ = 6e-8 c, which changes W by a
// factor 3 δ/(1-r): more than 5e-6 for the terms with 1-r < 0.036, each of which is less than 1.9e-4 W(0). They matter
// only where a sum has little else, and there the voxel is summed again in double:

/// where the sum of W/W(0) is less than this (the outermost voxels of the material),
constexpr double rim = 0.01;
/// and where the sum of a channel is less than this part of W(0) times the largest |q| of the leaf (its larger values
/// are far away), unless the candidates with small values are too few to be most of what the voxel sees.
constexpr double faint = 1e-3;
/// A value is small below this part of the largest. Where Σ W/W(0) exceeds their number n, Σ |q| W is at least
/// small (Σ W - n W(0)) max |q|.
constexpr double small = 1e-2;

float least(const LeafWork& work, std::size_t channel) {
  return static_cast<float>(summed_part * faint) * work.records.largest[channel];
}

/// The voxels of a mask that lie in a box.
LeafMask within(const LeafMask& mask, const VoxelBox& box) {
  std::uint64_t plane = 0;
  for (int y = box.y; y < box.y + box.edge; ++y)
    plane |= ((std::uint64_t{1} << box.edge) - 1) << (y * leaf_edge + box.z);
  LeafMask some;
  for (auto x = static_cast<std::size_t>(box.x); x < static_cast<std::size_t>(box.x + box.edge); ++x)
    some.words[x] = mask.words[x] & plane;
  return some;
}

}  // namespace

const double* FastLeafSplat::run(const Coord& origin, const LeafMask& active, LeafWork& work) const {
  work.values.resize(channels_ * leaf_size);
  run_to(origin, active, work, {}, [&](std::size_t c) { return work.values.data() + c * leaf_size; });
  return work.values.data();
}

void FastLeafSplat::run(const Coord& origin, const LeafMask& active, LeafWork& work, std::span<float* const> to) const {
  run_to(origin, active, work, to, [&](std::size_t c) { return to[c]; });
}

template <class To>
void FastLeafSplat::run_to(const Coord& origin, const LeafMask& active, LeafWork& work, std::span<float* const> far,
                           const To& to) const {
  gather_candidates(buckets_, origin, cutoff_, work.candidates);
  if (work.candidates.count == 0) {  // a species is not everywhere that there are voxels
    for (std::size_t c = 0; c < channels_; ++c) std::fill_n(to(c), leaf_size, 0);
    return;
  }
  records_.gather(origin, work.candidates, work.records);
  LeafSplat leaf{&work.candidates, work.records.values.data(), records_.stride(), static_cast<int>(channels_), voxel()};
  leaf.to = far;
  splat_leaf(leaf, active, work.sums);
  scale(active, work, to);
  sum_again(origin, active, work, to);
}

template <class To>
void FastLeafSplat::scale(const LeafMask& active, const LeafWork& work, const To& to) const {
  const double peak = kernel_.value(0) / summed_part;
  for (std::size_t c = 0; c < channels_; ++c) {
    const std::size_t w = records_.weight(c);
    scale_sums(
        {sum(work, c), peak * records_.scale(c), sum(work, w), peak * records_.scale(w) * work.records.reference[c]},
        active, to(c));
  }
}

// The voxels where a channel's sum cannot be trusted. Each channel is judged by itself, so that a sum does not depend
// on which others are asked for. Sums about a reference are small against the reference, whose own sum is right.
LeafMask FastLeafSplat::find_faint(const LeafMask& active, LeafWork& work) const {
  work.limits.assign(records_.stride(), 0.0F);
  work.few.resize(records_.stride());
  for (std::size_t c = 0; c < channels_; ++c)
    if (work.records.reference[c] == 0) work.limits[c] = static_cast<float>(small) * work.records.largest[c];
  count_below(work.records.values.data(), records_.stride(), work.candidates.count, work.limits.data(),
              work.few.data());
  const auto enough = [&](std::size_t c) {
    return static_cast<float>(summed_part * (static_cast<double>(work.few[c]) + faint / small));
  };
  float most = static_cast<float>(summed_part * rim);
  for (std::size_t c = 0; c < channels_; ++c) most = std::max(most, enough(c));
  LeafMask any;
  if (least_of(work.sums.plain.data(), active) >= most) return any;

  work.faint.resize(channels_);
  for (std::size_t c = 0; c < channels_; ++c) {
    const float small_sum = work.records.reference[c] == 0 ? least(work, c) : 0.0F;
    work.faint[c] = faint_voxels(sum(work, c), small_sum, work.sums.plain.data(), static_cast<float>(summed_part * rim),
                                 enough(c), active);
    any |= work.faint[c];
  }
  return any;
}

template <class To>
void FastLeafSplat::sum_again(const Coord& origin, const LeafMask& active, LeafWork& work, const To& to) const {
  const LeafMask any = find_faint(active, work);
  if (any.none()) return;
  work.exact.resize(records_.stride());
  for (int x = 0; x < leaf_edge; x += 4)
    for (int y = 0; y < leaf_edge; y += 4)
      for (int z = 0; z < leaf_edge; z += 4) {
        const VoxelBox block{x, y, z, 4};
        const LeafMask again = within(any, block);
        if (again.none()) continue;
        pick_near(work.candidates, block, voxel(), work.near);
        again.for_each([&](int offset) { sum_in_double(origin, offset, work, to); });
      }
}

// Positions in double; the values in single precision are exact enough.
template <class To>
void FastLeafSplat::sum_in_double(const Coord& origin, int offset, LeafWork& work, const To& to) const {
  find_terms(buckets_, work.candidates, work.near, origin, offset, lattice_.voxel(), kernel_, work.terms);
  sum_terms(work.terms, work.records.values.data(), records_.stride(), work.exact.data());
  for (std::size_t c = 0; c < channels_; ++c) {
    if (!work.faint[c].test(offset)) continue;
    const std::size_t w = records_.weight(c);
    const double sum = records_.scale(c) * work.exact[c];
    const double mean = work.records.reference[c] * records_.scale(w) * work.exact[w];
    to(c)[offset] = static_cast<std::remove_pointer_t<decltype(to(c))>>(sum + mean);
  }
}

}  // namespace grainvdb
