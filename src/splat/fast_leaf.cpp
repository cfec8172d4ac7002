#include "splat/fast_leaf.hpp"

#include <algorithm>

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
  return static_cast<float>(faint) * work.records.largest[channel];
}

template <class F>
void for_each_voxel_of(const VoxelBox& box, const LeafMask& mask, const F& f) {
  for (int x = box.x; x < box.x + box.edge; ++x)
    for (int y = box.y; y < box.y + box.edge; ++y)
      for (int z = box.z; z < box.z + box.edge; ++z)
        if (const int offset = (x << 6) | (y << 3) | z; mask.test(offset)) f({x, y, z, 1}, offset);
}

}  // namespace

const double* FastLeafSplat::run(const Coord& origin, const LeafMask& active, LeafWork& work) const {
  gather_candidates(buckets_, origin, cutoff_, work.candidates);
  records_.gather(origin, work.candidates, work.records);
  splat_leaf({&work.candidates, work.records.values.data(), records_.stride(), static_cast<int>(channels_), voxel()},
             active, work.sums);
  scale(active, work);
  sum_again(origin, active, work);
  return work.values.data();
}

void FastLeafSplat::scale(const LeafMask& active, LeafWork& work) const {
  work.values.resize(channels_ * leaf_size);
  const double peak = kernel_.value(0);
  for (std::size_t c = 0; c < channels_; ++c) {
    const std::size_t w = records_.weight(c);
    scale_sums(
        {sum(work, c), peak * records_.scale(c), sum(work, w), peak * records_.scale(w) * work.records.reference[c]},
        active, work.values.data() + c * leaf_size);
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
  const auto enough = [&](std::size_t c) { return work.few[c] + static_cast<float>(faint / small); };
  float most = static_cast<float>(rim);
  for (std::size_t c = 0; c < channels_; ++c) most = std::max(most, enough(c));
  LeafMask any;
  if (least_of(work.sums.plain.data(), active) >= most) return any;

  work.faint.resize(channels_);
  for (std::size_t c = 0; c < channels_; ++c) {
    const float small_sum = work.records.reference[c] == 0 ? least(work, c) : 0.0F;
    work.faint[c] =
        faint_voxels(sum(work, c), small_sum, work.sums.plain.data(), static_cast<float>(rim), enough(c), active);
    any |= work.faint[c];
  }
  return any;
}

void FastLeafSplat::sum_again(const Coord& origin, const LeafMask& active, LeafWork& work) const {
  const LeafMask any = find_faint(active, work);
  if (any.none()) return;
  for (int x = 0; x < leaf_edge; x += 4)
    for (int y = 0; y < leaf_edge; y += 4)
      for (int z = 0; z < leaf_edge; z += 4) {
        const VoxelBox block{x, y, z, 4};
        bool begun = false;
        for_each_voxel_of(block, any, [&](const VoxelBox& v, int offset) {
          if (!begun) pick_near(work.candidates, block, voxel(), work.near);
          begun = true;
          const std::size_t count = pick_places(work.near, v, voxel(), work.places);
          sum_in_double(voxel_at(origin, offset), static_cast<std::size_t>(offset), count, work);
        });
      }
}

// Positions in double; the values in single precision are exact enough.
void FastLeafSplat::sum_in_double(const Coord& at, std::size_t offset, std::size_t near, LeafWork& work) const {
  const double h = lattice_.voxel();
  std::vector<ExactTerm>& terms = work.terms;
  terms.clear();
  for (std::size_t k = 0; k < near; ++k) {
    const auto in_leaf = static_cast<std::size_t>(work.near.at[static_cast<std::size_t>(work.places[k])]);
    const std::size_t e = work.candidates.entry[in_leaf];
    double r2 = 0;
    for (int a = 0; a < 3; ++a) {
      const double d = (at[a] - buckets_.index[a][e]) * h;
      r2 += d * d;
    }
    if (const double w = kernel_.value(r2); w > 0)
      terms.push_back({w, work.records.values.data() + in_leaf * records_.stride()});
  }
  work.exact.resize(records_.stride());
  sum_terms(terms.data(), terms.size(), records_.stride(), work.exact.data());
  for (std::size_t c = 0; c < channels_; ++c) {
    if (!work.faint[c].test(static_cast<int>(offset))) continue;
    const std::size_t w = records_.weight(c);
    work.values[c * leaf_size + offset] =
        records_.scale(c) * work.exact[c] + work.records.reference[c] * records_.scale(w) * work.exact[w];
  }
}

}  // namespace grainvdb
