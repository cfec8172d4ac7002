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
//
#include "splat/bricks-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

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
