#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "splat/contact_bricks.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/contact_sums.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>
//
#include "splat/branch_bricks-inl.hpp"
#include "splat/branch_curvature-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace {

// Weights of so many branches stay in the first-level cache until they are summed.
constexpr std::size_t chunk = 96;

// Of the node at the middle m, q = |p - m|², and of a pair at m ± s a, q = |p - m|² + s² a² ∓ 2 s (p - m)·a: that takes
// three operations a pair, but may round below zero. So ε² is added to q, with ε² beyond any rounding, and with
// R = √(q + ε²) the shape is (1-R)³(1+3R) + 6 ε² (1-R)²: that of √q but for 4 ε³ at the centre and less elsewhere.
/// weights[k][lane] = Σ_nodes weight (1-r)³(1+3r) of branch chosen[k] at the brick's voxels.
template <int pairs, bool has_middle>
HWY_NOINLINE void weigh(const LeafBranches& b, const std::int32_t* HWY_RESTRICT chosen, std::size_t count,
                        const Voxels at, const BranchRule& rule, float epsilon2, float* HWY_RESTRICT weights) {
  const float* HWY_RESTRICT x = b.x.data();
  const float* HWY_RESTRICT y = b.y.data();
  const float* HWY_RESTRICT z = b.z.data();
  const float* HWY_RESTRICT ax = b.ax.data();
  const float* HWY_RESTRICT ay = b.ay.data();
  const float* HWY_RESTRICT az = b.az.data();
  const float* HWY_RESTRICT arm2 = b.arm2.data();
  const V one = hn::Set(d, 1.0F), zero = hn::Zero(d), e2 = hn::Set(d, epsilon2);
  V s1[pairs + 1], s2[pairs + 1], w1[pairs + 1], w3[pairs + 1], w6[pairs + 1];
  for (int n = 0; n <= pairs; ++n) {
    const float w = n < pairs ? rule.weight[n] : rule.middle_weight;
    w1[n] = hn::Set(d, w);
    w3[n] = hn::Set(d, 3 * w);
    w6[n] = hn::Set(d, 6 * epsilon2 * w);
    if (n == pairs) break;
    s1[n] = hn::Set(d, 2 * rule.offset[n]);
    s2[n] = hn::Set(d, rule.offset[n] * rule.offset[n]);
  }
  const auto add_node = [&](V sum, V q, int n) HWY_ATTR {
    const V r = hn::Sqrt(q);
    const V p = hn::Max(hn::Sub(one, r), zero);
    return hn::MulAdd(hn::Mul(p, p), hn::MulAdd(p, hn::MulAdd(r, w3[n], w1[n]), w6[n]), sum);
  };
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(chosen[k]);
    const V dx = hn::Sub(at.x, hn::Set(d, x[i])), dy = hn::Sub(at.y, hn::Set(d, y[i])),
            dz = hn::Sub(at.z, hn::Set(d, z[i]));
    const V q = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::MulAdd(dz, dz, e2)));
    V sum = zero;
    if constexpr (has_middle) sum = add_node(sum, q, pairs);
    if constexpr (pairs > 0) {
      const V t = hn::MulAdd(dx, hn::Set(d, ax[i]), hn::MulAdd(dy, hn::Set(d, ay[i]), hn::Mul(dz, hn::Set(d, az[i]))));
      const V a2 = hn::Set(d, arm2[i]);
#pragma GCC unroll 4
      for (int n = 0; n < pairs; ++n) {
        const V base = hn::MulAdd(s2[n], a2, q);
        sum = add_node(sum, hn::MulAdd(s1[n], t, base), n);
        sum = add_node(sum, hn::NegMulAdd(s1[n], t, base), n);
      }
    }
    hn::Store(sum, d, weights + k * lanes);
  }
}

using Weigh = void (*)(const LeafBranches&, const std::int32_t*, std::size_t, Voxels, const BranchRule&, float, float*);
constexpr Weigh weigh_of[9] = {nullptr,        weigh<0, true>,  weigh<1, false>, weigh<1, true>, weigh<2, false>,
                               weigh<2, true>, weigh<3, false>, weigh<3, true>,  weigh<4, false>};
HWY_INLINE Weigh weigher_of(const BranchRule& rule) {
  return rule.has_curvature ? weigh_with_curvature : weigh_of[2 * rule.pairs + (rule.has_middle ? 1 : 0)];
}

/// sums[channel][lane] += Σ_k weights[k][lane] q[entry[chosen[k]]][channel], all sums in registers.
template <int channels>
HWY_NOINLINE void add_channels(const float* HWY_RESTRICT weights, const float* HWY_RESTRICT q, std::size_t stride,
                               const std::uint32_t* HWY_RESTRICT entry, const std::int32_t* HWY_RESTRICT chosen,
                               std::size_t count, float* HWY_RESTRICT sums) {
  // Loads limit the speed; see sum_channels.
  constexpr int permuted = lanes == 16 && channels <= 16 ? (channels / 3 < 4 ? channels / 3 : 4) : 0;
  constexpr int loaded = channels - permuted;
  V s[channels];
#pragma GCC unroll 32
  for (int c = 0; c < channels; ++c) s[c] = hn::Load(d, sums + c * lanes);
  for (std::size_t k = 0; k < count; ++k) {
    const V w = hn::Load(d, weights + k * lanes);
    const float* HWY_RESTRICT v = q + entry[static_cast<std::size_t>(chosen[k])] * stride;
#pragma GCC unroll 32
    for (int c = 0; c < loaded; ++c) s[c] = hn::MulAdd(w, hn::Set(d, v[c]), s[c]);
    if constexpr (permuted > 0) {
      const V record = hn::LoadU(d, v);
#pragma GCC unroll 32
      for (int c = loaded; c < channels; ++c)
        s[c] = hn::MulAdd(w, hn::TableLookupLanes(record, hn::IndicesFromVec(d, hn::Set(di, c))), s[c]);
    }
  }
#pragma GCC unroll 32
  for (int c = 0; c < channels; ++c) hn::Store(s[c], d, sums + c * lanes);
}

using Add = void (*)(const float*, const float*, std::size_t, const std::uint32_t*, const std::int32_t*, std::size_t,
                     float*);
template <int... c>
constexpr std::array<Add, sizeof...(c) + 1> adds_for(std::integer_sequence<int, c...>) {
  return {nullptr, add_channels<c + 1>...};
}
constexpr auto add_of = adds_for(std::make_integer_sequence<int, widest>());

// ε² per (extent of the brick)²: twice 4 roundings by 2^-24 of terms that are at most 4 extents² where q is near zero.
constexpr float rounding2 = 2e-6F;

/// Adds the sums over one class at the voxels of a brick.
HWY_INLINE void add_class(const LeafBranches& leaf, const BranchClass& members, const VoxelBox& brick, int channels,
                          BranchScratch& scratch, float* HWY_RESTRICT sums) {
  const float h = leaf.voxel;
  const CentredBox box = centres_of(brick, brick_x, brick_y, brick_z, h);
  const std::size_t n = pick_branches(leaf, members.first, members.last, box, scratch.chosen.data());
  const float extent = box.half[0] + box.half[1] + box.half[2] + members.half_arm;
  const float epsilon2 = rounding2 * extent * extent;
  const Weigh weigh_chunk = weigher_of(*members.rule);
  const Voxels at = brick_voxels(brick, h);
  for (std::size_t k = 0; k < n; k += chunk) {
    const std::size_t now = std::min(chunk, n - k);
    const std::int32_t* chosen = scratch.chosen.data() + k;
    weigh_chunk(leaf, chosen, now, at, *members.rule, epsilon2, scratch.weights.data());
    for (int first = 0; first < channels; first += widest)
      add_of[static_cast<std::size_t>(std::min(widest, channels - first))](
          scratch.weights.data(), leaf.records + 3 + first, leaf.stride, leaf.entry.data(), chosen, now,
          sums + first * lanes);
  }
}

void SumBranches(const LeafBranches& leaf, std::span<const BranchClass> classes, int channels, const LeafMask& mask,
                 BranchScratch& scratch, BrickSums& out) {
  const std::size_t width = static_cast<std::size_t>(channels);
  scratch.chosen.resize(leaf.size() + 2 * lanes);
  scratch.weights.room(chunk * lanes);
  float* const all = out.room(lanes, channels);
  for_each_brick_of_leaf([&](const VoxelBox& brick) HWY_ATTR {
    if (brick_bits(mask, brick) == 0) return;
    float* const sums = all + brick_number(brick) * width * lanes;
    std::fill_n(sums, width * lanes, 0.0F);
    for (const BranchClass& members : classes) add_class(leaf, members, brick, channels, scratch, sums);
  });
}

// Rounding of positions matters for terms at the rim of their support, which are small. Where the sum of a channel's
// |terms| is less than this part of W(0) times the largest |q| around, they may have too much of a share in it.
constexpr float faint_part = 3e-3F;

void FaintLimits(const LeafBranches& leaf, int channels, BranchScratch& scratch, float* faint) {
  const auto width = static_cast<std::size_t>(channels);
  scratch.chosen.resize(leaf.size() + 2 * lanes);
  float* const largest = scratch.sums.room(2 * width + 2 * lanes);
  float* const certain = largest + width + lanes;
  const auto values = [&](std::size_t k) { return leaf.records + 3 + leaf.entry[k] * leaf.stride; };
  for (std::size_t c = 0; c < width; c += lanes) {
    V most = hn::Zero(d);
    for (std::size_t k = 0; k < leaf.size(); ++k) most = hn::Max(most, hn::Abs(hn::LoadU(d, values(k) + c)));
    hn::StoreU(most, d, largest + c);
  }
  // The sum of |terms| at any voxel of a block, whatever their signs, is about that of the branches near its middle at
  // least, each weighed as far from it as the voxels go.
  const float farther = 0.5F * leaf.voxel * (block - 1) * std::sqrt(3.0F);
  for (int b = 0; b < leaf_blocks; ++b) {
    CentredBox box = centres_of(block_box(b), block, block, block, leaf.voxel);
    std::fill_n(box.half, 3, 0.0F);
    const std::size_t n = farther < 1 ? pick_middles(leaf, box, 1 - farther, scratch.chosen.data()) : 0;
    std::fill_n(certain, width + lanes, 0.0F);
    for (std::size_t k = 0; k < n; ++k) {
      const auto i = static_cast<std::size_t>(scratch.chosen[k]);
      const float x = leaf.x[i] - box.middle[0], y = leaf.y[i] - box.middle[1], z = leaf.z[i] - box.middle[2];
      const float r = std::min(std::sqrt(x * x + y * y + z * z) + farther, 1.0F);
      const V weight = hn::Set(d, (1 - r) * (1 - r) * (1 - r) * (1 + 3 * r));
      for (std::size_t c = 0; c < width; c += lanes)
        hn::StoreU(hn::MulAdd(weight, hn::Abs(hn::LoadU(d, values(i) + c)), hn::LoadU(d, certain + c)), d, certain + c);
    }
    for (std::size_t c = 0; c < width; ++c, ++faint) {
      const float bar = faint_part * largest[c];
      *faint = certain[c] > 2 * bar ? 0 : bar;
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {
BranchRule::BranchRule(std::span<const LineNode> nodes)
    : pairs(static_cast<int>(nodes.size()) / 2), has_middle(nodes.size() % 2 == 1) {
  // Nodes are ascending in [-1, 1] with weights that add up to 2; the upper half is the mirror of the lower.
  for (int n = 0; n < pairs; ++n) {
    offset[n] = static_cast<float>(-0.5 * nodes[static_cast<std::size_t>(n)].x);
    weight[n] = static_cast<float>(0.5 * nodes[static_cast<std::size_t>(n)].weight);
  }
  if (has_middle) middle_weight = static_cast<float>(0.5 * nodes[static_cast<std::size_t>(pairs)].weight);
}

HWY_EXPORT(SumBranches);
HWY_EXPORT(FaintLimits);
void sum_branches(const LeafBranches& leaf, std::span<const BranchClass> classes, int channels, const LeafMask& mask,
                  BranchScratch& scratch, BrickSums& sums) {
  HWY_DYNAMIC_DISPATCH(SumBranches)(leaf, classes, channels, mask, scratch, sums);
}
void faint_limits(const LeafBranches& leaf, int channels, BranchScratch& scratch, float* faint) {
  HWY_DYNAMIC_DISPATCH(FaintLimits)(leaf, channels, scratch, faint);
}
}  // namespace grainvdb
#endif
