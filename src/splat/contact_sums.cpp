#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "splat/contact_bricks.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/contact_sums.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>
//
#include "splat/branch_bricks-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace {

// Weights of so many branches stay in the first-level cache until they are summed.
constexpr std::size_t chunk = 96;

/// The positions p of a brick's voxels relative to the middle of the block.
struct BrickLanes {
  HWY_ALIGN float x[lanes], y[lanes], z[lanes];
  HWY_ALIGN float p2[lanes];  ///< |p|²
};

// q = |p - m ∓ s a|² = |p|² + |m|² - 2 p·m + s² a² ∓ 2 s (p - m)·a costs seven operations for the first node and three
// for each pair, but may round below zero. So ε² is added to q, with ε² beyond any rounding, and with R = √(q + ε²) the
// shape is (1-R)³(1+3R) + 6 ε² (1-R)²: that of √q but for 4 ε³ at the centre and less elsewhere.
constexpr float rounding2 = 2e-6F;  // ε² per (extent of the block)²: 8 roundings by 2^-24 of terms up to 4 extents²

/// Adds weight (1-r)³(1+3r) to sum, r² = q - ε². `w3` is 3 weight, `w6` 6 ε² weight.
HWY_INLINE V add_node(V sum, V q, float w, float w3, float w6) {
  const V one = hn::Set(d, 1.0F);
  const V r = hn::Sqrt(q);
  const V p = hn::Max(hn::Sub(one, r), hn::Zero(d));
  const V core = hn::MulAdd(p, hn::MulAdd(r, hn::Set(d, w3), hn::Set(d, w)), hn::Set(d, w6));
  return hn::MulAdd(hn::Mul(p, p), core, sum);
}

/// weights[k][lane] = Σ_nodes weight (1-r)³(1+3r) of branch chosen[k] at the brick's voxels.
template <int pairs, bool has_middle>
HWY_NOINLINE void weigh(const BranchScratch& b, const std::int32_t* HWY_RESTRICT chosen, std::size_t count,
                        const BrickLanes& at, const BranchRule& rule, float epsilon2, float* HWY_RESTRICT weights) {
  const float* HWY_RESTRICT x = b.x.data();
  const float* HWY_RESTRICT y = b.y.data();
  const float* HWY_RESTRICT z = b.z.data();
  const float* HWY_RESTRICT ax = b.ax.data();
  const float* HWY_RESTRICT ay = b.ay.data();
  const float* HWY_RESTRICT az = b.az.data();
  const float* HWY_RESTRICT middle2 = b.middle2.data();
  const float* HWY_RESTRICT along = b.along.data();
  const float* HWY_RESTRICT arm2 = b.arm2.data();
  const V px = hn::Load(d, at.x), py = hn::Load(d, at.y), pz = hn::Load(d, at.z), p2 = hn::Load(d, at.p2);
  const V minus2 = hn::Set(d, -2.0F);
  const V px2 = hn::Mul(minus2, px), py2 = hn::Mul(minus2, py), pz2 = hn::Mul(minus2, pz);
  const float m6 = 6 * epsilon2 * rule.middle_weight;
  float w6[4];
  for (int n = 0; n < pairs; ++n) w6[n] = 6 * epsilon2 * rule.weight[n];
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(chosen[k]);
    V q = hn::Add(p2, hn::Set(d, middle2[i]));
    q = hn::MulAdd(px2, hn::Set(d, x[i]), q);
    q = hn::MulAdd(py2, hn::Set(d, y[i]), q);
    q = hn::MulAdd(pz2, hn::Set(d, z[i]), q);
    V sum = hn::Zero(d);
    if constexpr (has_middle) sum = add_node(sum, q, rule.middle_weight, 3 * rule.middle_weight, m6);
    if constexpr (pairs > 0) {
      V t = hn::MulAdd(px, hn::Set(d, ax[i]), hn::Set(d, along[i]));
      t = hn::MulAdd(py, hn::Set(d, ay[i]), t);
      t = hn::MulAdd(pz, hn::Set(d, az[i]), t);
      const V a2 = hn::Set(d, arm2[i]);
      HWY_UNROLL(4)
      for (int n = 0; n < pairs; ++n) {
        const float s = rule.offset[n], w = rule.weight[n];
        const V base = hn::MulAdd(hn::Set(d, s * s), a2, q);
        sum = add_node(sum, hn::MulAdd(hn::Set(d, 2 * s), t, base), w, 3 * w, w6[n]);
        sum = add_node(sum, hn::NegMulAdd(hn::Set(d, 2 * s), t, base), w, 3 * w, w6[n]);
      }
    }
    hn::Store(sum, d, weights + k * lanes);
  }
}

using Weigh = void (*)(const BranchScratch&, const std::int32_t*, std::size_t, const BrickLanes&, const BranchRule&,
                       float, float*);
constexpr Weigh weigh_of[9] = {nullptr,         weigh<0, true>,  weigh<1, false>, weigh<1, true>, weigh<2, false>,
                               weigh<2, true>,  weigh<3, false>, weigh<3, true>,  weigh<4, false>};

/// sums[channel][lane] += Σ_k weights[k][lane] q[chosen[k]][channel], all sums in registers.
template <int channels>
HWY_NOINLINE void add_channels(const float* HWY_RESTRICT weights, const float* HWY_RESTRICT q, std::size_t stride,
                               const std::int32_t* HWY_RESTRICT chosen, std::size_t count, float* HWY_RESTRICT sums) {
  V s[channels];
#pragma GCC unroll 32
  for (int c = 0; c < channels; ++c) s[c] = hn::Load(d, sums + c * lanes);
  for (std::size_t k = 0; k < count; ++k) {
    const V w = hn::Load(d, weights + k * lanes);
    const float* HWY_RESTRICT v = q + static_cast<std::size_t>(chosen[k]) * stride;
#pragma GCC unroll 32
    for (int c = 0; c < channels; ++c) s[c] = hn::MulAdd(w, hn::Set(d, v[c]), s[c]);
  }
#pragma GCC unroll 32
  for (int c = 0; c < channels; ++c) hn::Store(s[c], d, sums + c * lanes);
}

using Add = void (*)(const float*, const float*, std::size_t, const std::int32_t*, std::size_t, float*);
template <int... c>
constexpr std::array<Add, sizeof...(c) + 1> adds_for(std::integer_sequence<int, c...>) {
  return {nullptr, add_channels<c + 1>...};
}
constexpr auto add_of = adds_for(std::make_integer_sequence<int, widest>());

// Rounding of positions matters for terms at the rim of their support, which are small. Where the sum of a channel's
// |terms| is at least this part of W(0) times the largest |q| around, they have not enough of a share in it:
constexpr float faint_part = 3e-3F;
// the sum is that large, whatever its terms' signs, where branches nearer than this have enough weight for it.
constexpr float near_by = 0.3F;

/// The branches of one class that can touch a block, relative to its middle. `scratch.largest` and `scratch.near`
/// collect the largest |value| and the sum of |values| of the branches near the middle.
HWY_NOINLINE std::size_t load_block(const LeafBranches& leaf, const BranchClass& members, const CentredBox& box,
                                    float epsilon2, BranchScratch& b) {
  const std::size_t count =
      pick_middles(leaf.x.data(), leaf.y.data(), leaf.z.data(), members.first, members.last, box,
                   1 + members.half_arm + touch, b.chosen.data());
  const std::size_t stride = leaf.stride;
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(b.chosen[k]);
    const float* from = leaf.records + leaf.entry[i] * stride;
    const float x = leaf.x.data()[i] - box.middle[0], y = leaf.y.data()[i] - box.middle[1],
                z = leaf.z.data()[i] - box.middle[2];
    b.x.data()[k] = x;
    b.y.data()[k] = y;
    b.z.data()[k] = z;
    b.ax.data()[k] = from[0];
    b.ay.data()[k] = from[1];
    b.az.data()[k] = from[2];
    float* to = b.records.data() + k * stride;
    const bool near = x * x + y * y + z * z < near_by * near_by;
    for (std::size_t c = 0; c < stride; c += lanes) {
      const V v = hn::LoadU(d, from + c);
      hn::StoreU(v, d, to + c);
      const V size = hn::Abs(v);
      hn::Store(hn::Max(size, hn::Load(d, b.largest.data() + c)), d, b.largest.data() + c);
      if (near) hn::Store(hn::Add(size, hn::Load(d, b.near.data() + c)), d, b.near.data() + c);
    }
  }
  const V e2 = hn::Set(d, epsilon2);
  for (std::size_t k = 0; k < count; k += lanes) {
    const V x = hn::Load(d, b.x.data() + k), y = hn::Load(d, b.y.data() + k), z = hn::Load(d, b.z.data() + k);
    const V ax = hn::Load(d, b.ax.data() + k), ay = hn::Load(d, b.ay.data() + k), az = hn::Load(d, b.az.data() + k);
    hn::Store(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::MulAdd(z, z, e2))), d, b.middle2.data() + k);
    hn::Store(hn::Neg(hn::MulAdd(x, ax, hn::MulAdd(y, ay, hn::Mul(z, az)))), d, b.along.data() + k);
    hn::Store(hn::MulAdd(ax, ax, hn::MulAdd(ay, ay, hn::Mul(az, az))), d, b.arm2.data() + k);
  }
  return count;
}

void SumBranches(const LeafBranches& leaf, std::span<const BranchClass> classes, int channels, const LeafMask& mask,
                 BranchScratch& b, float* HWY_RESTRICT out, float* HWY_RESTRICT faint) {
  const float h = leaf.voxel;
  const std::size_t width = static_cast<std::size_t>(channels), stride = leaf.stride;
  std::size_t most = 0;
  float half_arm = 0;
  for (const BranchClass& members : classes) {
    most = std::max(most, members.last - members.first);
    half_arm = std::max(half_arm, members.half_arm);
  }
  b.chosen.resize(most + 2 * lanes);
  b.in_brick.resize(most + 2 * lanes);
  for (Grow<float>* room : {&b.x, &b.y, &b.z, &b.ax, &b.ay, &b.az, &b.middle2, &b.along, &b.arm2}) room->room(most);
  b.records.room(most * stride);
  b.weights.room(chunk * lanes);
  constexpr std::size_t bricks = block * block * block / lanes;
  b.sums.room(bricks * width * lanes);
  b.largest.room(stride);
  b.near.room(stride);

  const BrickOffsets offsets(h);
  const float diagonal = 0.5F * h * (block - 1) * std::sqrt(3.0F);
  const float extent = diagonal + half_arm;
  const float epsilon2 = rounding2 * extent * extent;
  // What a branch near the middle of a block weighs at least at any of its voxels.
  const float farthest = std::min(near_by + diagonal + half_arm, 1.0F);
  const float least_weight = (1 - farthest) * (1 - farthest) * (1 - farthest) * (1 + 3 * farthest);

  for (int bx = 0; bx < leaf_edge; bx += block)
    for (int by = 0; by < leaf_edge; by += block)
      for (int bz = 0; bz < leaf_edge; bz += block) {
        const CentredBox box = block_box(h, bx, by, bz);
        std::fill_n(b.sums.data(), bricks * width * lanes, 0.0F);
        std::fill_n(b.largest.data(), stride + lanes, 0.0F);
        std::fill_n(b.near.data(), stride + lanes, 0.0F);
        for (const BranchClass& members : classes) {
          const std::size_t count = load_block(leaf, members, box, epsilon2, b);
          const Weigh weigh_chunk =
              weigh_of[2 * members.rule->pairs + (members.rule->has_middle ? 1 : 0)];
          float* HWY_RESTRICT sums = b.sums.data();
          for (int x = 0; x < block; x += brick_x)
            for (int y = 0; y < block; y += brick_y)
              for (int z = 0; z < block; z += brick_z, sums += width * lanes) {
                if (brick_bits(mask, bx + x, by + y, bz + z) == 0) continue;
                const CentredBox brick = brick_box(h, x, y, z);
                const std::size_t n = pick_branches(b, count, brick, b.in_brick.data());
                BrickLanes at;
                for (int l = 0; l < lanes; ++l) {
                  at.x[l] = offsets.at[0][l] + brick.middle[0] - brick.half[0];
                  at.y[l] = offsets.at[1][l] + brick.middle[1] - brick.half[1];
                  at.z[l] = offsets.at[2][l] + brick.middle[2] - brick.half[2];
                  at.p2[l] = at.x[l] * at.x[l] + at.y[l] * at.y[l] + at.z[l] * at.z[l];
                }
                for (std::size_t k = 0; k < n; k += chunk) {
                  const std::size_t now = std::min(chunk, n - k);
                  const std::int32_t* chosen = b.in_brick.data() + k;
                  weigh_chunk(b, chosen, now, at, *members.rule, epsilon2, b.weights.data());
                  for (int first = 0; first < channels; first += widest) {
                    const int group = std::min(widest, channels - first);
                    add_of[static_cast<std::size_t>(group)](b.weights.data(), b.records.data() + 3 + first, stride,
                                                            chosen, now, sums + first * lanes);
                  }
                }
              }
        }
        const float* HWY_RESTRICT sums = b.sums.data();
        for (int x = bx; x < bx + block; x += brick_x)
          for (int y = by; y < by + block; y += brick_y)
            for (int z = bz; z < bz + block; z += brick_z)
              for (int c = 0; c < channels; ++c, sums += lanes)
                for (int i = 0; i < brick_x; ++i)
                  for (int j = 0; j < brick_y; ++j)
                    std::memcpy(out + c * leaf_size + (x + i) * 64 + (y + j) * 8 + z,
                                sums + (i * brick_y + j) * brick_z, brick_z * sizeof(float));
        for (std::size_t c = 0; c < width; ++c, ++faint) {
          const float bar = faint_part * b.largest.data()[3 + c];
          *faint = b.near.data()[3 + c] * least_weight > 4 * bar ? 0 : bar;
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
void sum_branches(const LeafBranches& leaf, std::span<const BranchClass> classes, int channels, const LeafMask& mask,
                  BranchScratch& scratch, float* sums, float* faint) {
  HWY_DYNAMIC_DISPATCH(SumBranches)(leaf, classes, channels, mask, scratch, sums, faint);
}
}  // namespace grainvdb
#endif
