#include "splat/bricks.hpp"

#include <array>
#include <cstring>
#include <utility>

#include "splat/brick_scratch.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/bricks.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A brick is the block of voxels that fills a register: 2×2×(N/4), or one voxel without vectors.
using D = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
constexpr D d;
constexpr DI di;
constexpr int lanes = static_cast<int>(hn::MaxLanes(D()));
constexpr int brick_x = lanes >= 4 ? 2 : 1, brick_y = brick_x, brick_z = lanes / (brick_x * brick_y);
constexpr int block = 4;  // voxels along the edge of a block, whose candidates are picked once for its bricks

/// Collects the candidates whose support touches the box of voxel centres [lo, lo + extent], in their order.
HWY_NOINLINE std::size_t pick(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y, const float* HWY_RESTRICT z,
                              std::size_t count, const float* lo, const float* extent, std::int32_t* HWY_RESTRICT out) {
  const V hx = hn::Set(d, 0.5F * extent[0]), hy = hn::Set(d, 0.5F * extent[1]), hz = hn::Set(d, 0.5F * extent[2]);
  const V cx = hn::Set(d, lo[0] + 0.5F * extent[0]), cy = hn::Set(d, lo[1] + 0.5F * extent[1]),
          cz = hn::Set(d, lo[2] + 0.5F * extent[2]);
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  std::size_t n = 0;
  auto index = hn::Iota(di, 0);
  const auto step = hn::Set(di, lanes);
  for (std::size_t i = 0; i < count; i += lanes, index = hn::Add(index, step)) {
    const V dx = hn::Max(hn::Sub(hn::Abs(hn::Sub(hn::Load(d, x + i), cx)), hx), zero);
    const V dy = hn::Max(hn::Sub(hn::Abs(hn::Sub(hn::Load(d, y + i), cy)), hy), zero);
    const V dz = hn::Max(hn::Sub(hn::Abs(hn::Sub(hn::Load(d, z + i), cz)), hz), zero);
    const V r2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
    auto near = hn::Lt(r2, one);
    if (i + lanes > count) near = hn::And(near, hn::FirstN(d, count - i));
    n += hn::CompressStore(index, hn::RebindMask(di, near), di, out + n);
  }
  return n;
}

/// weights[k][lane] = (1-r)³(1+3r) of candidate chosen[k] at the brick's voxels, 0 outside the support. The factored
/// form never turns positive outside.
HWY_NOINLINE void weigh(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y, const float* HWY_RESTRICT z,
                        const std::int32_t* HWY_RESTRICT chosen, std::size_t count, V px, V py, V pz,
                        float* HWY_RESTRICT weights) {
  const V one = hn::Set(d, 1.0F), three = hn::Set(d, 3.0F);
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(chosen[k]);
    const V dx = hn::Sub(px, hn::Set(d, x[i])), dy = hn::Sub(py, hn::Set(d, y[i])), dz = hn::Sub(pz, hn::Set(d, z[i]));
    const V r2 = hn::Min(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))), one);
    const V r = hn::Sqrt(r2);
    const V p = hn::Sub(one, r);
    hn::Store(hn::Mul(hn::Mul(hn::Mul(p, p), p), hn::MulAdd(three, r, one)), d, weights + k * lanes);
  }
}

/// sums[channel][lane] = Σ_k weights[k][lane] q[chosen[k]][channel], all sums in registers.
template <int channels>
HWY_NOINLINE void sum_channels(const float* HWY_RESTRICT weights, const float* HWY_RESTRICT q, std::size_t stride,
                               const std::int32_t* HWY_RESTRICT chosen, std::size_t count, float* HWY_RESTRICT sums) {
  V s[channels];
#pragma GCC unroll 32
  for (int c = 0; c < channels; ++c) s[c] = hn::Zero(d);
  for (std::size_t k = 0; k < count; ++k) {
    const V w = hn::Load(d, weights + k * lanes);
    const float* HWY_RESTRICT v = q + static_cast<std::size_t>(chosen[k]) * stride;
#pragma GCC unroll 32
    for (int c = 0; c < channels; ++c) s[c] = hn::MulAdd(w, hn::Set(d, v[c]), s[c]);
  }
#pragma GCC unroll 32
  for (int c = 0; c < channels; ++c) hn::Store(s[c], d, sums + c * lanes);
}

using Sum = void (*)(const float*, const float*, std::size_t, const std::int32_t*, std::size_t, float*);
// Accumulators that fit the registers (16, or 32 with AVX-512) beside the weight and the broadcast.
constexpr int widest = lanes == 16 ? 24 : 14;

template <int... c>
constexpr std::array<Sum, sizeof...(c) + 1> sums_for(std::integer_sequence<int, c...>) {
  return {nullptr, sum_channels<c + 1>...};
}
constexpr auto sum_of = sums_for(std::make_integer_sequence<int, widest>());

void SplatLeaf(const LeafSplat& leaf, BrickScratch& scratch, float* HWY_RESTRICT out) {
  scratch.reserve(leaf.count, leaf.stride);
  const float h = leaf.voxel;
  HWY_ALIGN float offset[3][lanes];
  for (int l = 0; l < lanes; ++l) {
    offset[0][l] = h * static_cast<float>(l / (brick_y * brick_z));
    offset[1][l] = h * static_cast<float>(l / brick_z % brick_y);
    offset[2][l] = h * static_cast<float>(l % brick_z);
  }
  const V ox = hn::Load(d, offset[0]), oy = hn::Load(d, offset[1]), oz = hn::Load(d, offset[2]);
  const float block_extent[3] = {h * (block - 1), h * (block - 1), h * (block - 1)};
  const float brick_extent[3] = {h * (brick_x - 1), h * (brick_y - 1), h * (brick_z - 1)};
  HWY_ALIGN float sums[widest * lanes];

  for (int bx = 0; bx < 8; bx += block)
    for (int by = 0; by < 8; by += block)
      for (int bz = 0; bz < 8; bz += block) {
        const float lo[3] = {h * static_cast<float>(bx), h * static_cast<float>(by), h * static_cast<float>(bz)};
        const std::size_t n = pick(leaf.x, leaf.y, leaf.z, leaf.count, lo, block_extent, scratch.chosen.get());
        for (std::size_t k = 0; k < n; ++k) {
          const auto i = static_cast<std::size_t>(scratch.chosen[k]);
          scratch.x[k] = leaf.x[i];
          scratch.y[k] = leaf.y[i];
          scratch.z[k] = leaf.z[i];
          std::memcpy(scratch.q.get() + k * leaf.stride, leaf.q + i * leaf.stride, leaf.stride * sizeof(float));
        }
        for (int x = bx; x < bx + block; x += brick_x)
          for (int y = by; y < by + block; y += brick_y)
            for (int z = bz; z < bz + block; z += brick_z) {
              const float at[3] = {h * static_cast<float>(x), h * static_cast<float>(y), h * static_cast<float>(z)};
              const std::size_t m =
                  pick(scratch.x.get(), scratch.y.get(), scratch.z.get(), n, at, brick_extent, scratch.in_brick.get());
              weigh(scratch.x.get(), scratch.y.get(), scratch.z.get(), scratch.in_brick.get(), m,
                    hn::Add(ox, hn::Set(d, at[0])), hn::Add(oy, hn::Set(d, at[1])), hn::Add(oz, hn::Set(d, at[2])),
                    scratch.weights.get());
              for (int first = 0; first < leaf.channels; first += widest) {
                const int now = leaf.channels - first < widest ? leaf.channels - first : widest;
                sum_of[static_cast<std::size_t>(now)](scratch.weights.get(), scratch.q.get() + first, leaf.stride,
                                                      scratch.in_brick.get(), m, sums);
                for (int c = 0; c < now; ++c)
                  for (int i = 0; i < brick_x; ++i)
                    for (int j = 0; j < brick_y; ++j)
                      std::memcpy(out + (first + c) * 512 + (x + i) * 64 + (y + j) * 8 + z,
                                  sums + c * lanes + (i * brick_y + j) * brick_z, brick_z * sizeof(float));
              }
            }
      }
}

const char* TargetName() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {
HWY_EXPORT(SplatLeaf);
HWY_EXPORT(TargetName);
void splat_leaf(const LeafSplat& leaf, BrickScratch& scratch, float* out) {
  HWY_DYNAMIC_DISPATCH(SplatLeaf)(leaf, scratch, out);
}
const char* splat_target() {
  return HWY_DYNAMIC_DISPATCH(TargetName)();
}
}  // namespace grainvdb
#endif
