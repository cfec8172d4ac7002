#include "splat/bricks.hpp"

#include <array>
#include <cstring>

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
namespace {

/// (1-r)³(1+3r) of a candidate at the brick's voxels, 0 outside the support. The factored form never turns positive
/// outside.
HWY_INLINE V weight(const Voxels& at, float x, float y, float z) {
  const V one = hn::Set(d, 1.0F), three = hn::Set(d, 3.0F);
  const V dx = hn::Sub(at.x, hn::Set(d, x)), dy = hn::Sub(at.y, hn::Set(d, y)), dz = hn::Sub(at.z, hn::Set(d, z));
  const V r2 = hn::Min(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))), one);
  const V r = hn::Sqrt(r2);
  const V p = hn::Sub(one, r);
  return hn::Mul(hn::Mul(hn::Mul(p, p), p), hn::MulAdd(three, r, one));
}

/// weights[k][lane] of candidate chosen[k]. Returns their sum.
HWY_NOINLINE V weigh(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y, const float* HWY_RESTRICT z,
                     const std::int32_t* HWY_RESTRICT chosen, std::size_t count, Voxels at,
                     float* HWY_RESTRICT weights) {
  V sum = hn::Zero(d);
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(chosen[k]);
    const V w = weight(at, x[i], y[i], z[i]);
    sum = hn::Add(sum, w);
    hn::Store(w, d, weights + k * lanes);
  }
  return sum;
}

/// Weights and sums of few channels in one loop: it saves storing the weights, where with more channels the square root
/// would wait for the sums.
template <int channels>
HWY_NOINLINE void weigh_and_sum(const Picked& near, const float* HWY_RESTRICT q,
                                const std::int32_t* HWY_RESTRICT chosen, std::size_t count, Voxels at,
                                float* HWY_RESTRICT plain, float* HWY_RESTRICT sums) {
  const float *HWY_RESTRICT x = near.x.data(), *HWY_RESTRICT y = near.y.data(), *HWY_RESTRICT z = near.z.data();
  V all = hn::Zero(d);
  V s[channels];
#pragma GCC unroll 4
  for (int c = 0; c < channels; ++c) s[c] = hn::Zero(d);
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(chosen[k]);
    const V w = weight(at, x[i], y[i], z[i]);
    all = hn::Add(all, w);
#pragma GCC unroll 4
    for (int c = 0; c < channels; ++c)
      s[c] = hn::MulAdd(w, hn::Set(d, q[i * record_stride(channels) + static_cast<std::size_t>(c)]), s[c]);
  }
  hn::Store(all, d, plain);
#pragma GCC unroll 4
  for (int c = 0; c < channels; ++c) hn::Store(s[c], d, sums + c * lanes);
}
using WeighAndSum = void (*)(const Picked&, const float*, const std::int32_t*, std::size_t, Voxels, float*, float*);
constexpr std::array<WeighAndSum, 5> weigh_and_sum_of{nullptr, weigh_and_sum<1>, weigh_and_sum<2>, weigh_and_sum<3>,
                                                      weigh_and_sum<4>};

/// Copies the lanes of a brick to their voxels.
HWY_INLINE void put(const float* HWY_RESTRICT lane, const VoxelBox& brick, float* HWY_RESTRICT voxels) {
  for (int i = 0; i < brick_x; ++i)
    for (int j = 0; j < brick_y; ++j)
      std::memcpy(voxels + (brick.x + i) * 64 + (brick.y + j) * 8 + brick.z, lane + (i * brick_y + j) * brick_z,
                  brick_z * sizeof(float));
}

void SumBrick(const LeafSplat& leaf, const VoxelBox& brick, LeafSums& out) {
  const float h = leaf.voxel;
  const Picked& near = out.near;
  const auto half = [&](int edge) { return 0.5F * h * static_cast<float>(edge - 1); };
  const auto middle = [&](int first, int edge) { return h * (static_cast<float>(first) - 3.5F) + half(edge); };
  const BoxTest test{{middle(brick.x, brick_x), middle(brick.y, brick_y), middle(brick.z, brick_z)},
                     {half(brick_x), half(brick_y), half(brick_z)},
                     1.0F};
  std::int32_t* const chosen = out.chosen.data();
  const std::size_t m = pick(near.x.data(), near.y.data(), near.z.data(), near.count, test, chosen);
  const Voxels at = brick_voxels(brick, h);
  HWY_ALIGN float plain[lanes];
  HWY_ALIGN float sums[widest * lanes];
  const auto deliver = [&](int first, int count) {
    for (int c = 0; c < count; ++c) put(sums + c * lanes, brick, out.sums.data() + (first + c) * leaf_size);
  };
  if (const auto channels = static_cast<std::size_t>(leaf.channels); channels < weigh_and_sum_of.size()) {
    weigh_and_sum_of[channels](near, out.values.data(), chosen, m, at, plain, sums);
    deliver(0, leaf.channels);
  } else {
    float* const weights = out.weights.data();
    hn::Store(weigh(near.x.data(), near.y.data(), near.z.data(), chosen, m, at, weights), d, plain);
    for (int first = 0; first < leaf.channels; first += widest) {
      const int now = leaf.channels - first < widest ? leaf.channels - first : widest;
      sum_of(static_cast<std::size_t>(now), leaf.stride)(weights, out.values.data() + first, leaf.stride, chosen, m,
                                                         sums);
      deliver(first, now);
    }
  }
  put(plain, brick, out.plain.data());
}

bool any_active(const LeafMask& active, const VoxelBox& box, int nx, int ny, int nz) {
  std::uint64_t row = 0;
  for (int j = 0; j < ny; ++j) row |= ((std::uint64_t{1} << nz) - 1) << ((box.y + j) * 8 + box.z);
  std::uint64_t any = 0;
  for (int i = 0; i < nx; ++i) any |= active.words[static_cast<std::size_t>(box.x + i)] & row;
  return any != 0;
}

/// Brings the values of a block's candidates together: they are read once for each of its bricks.
void copy_values(const LeafSplat& leaf, const Picked& near, float* HWY_RESTRICT to) {
  const hn::CappedTag<float, 4> d4;  // records are padded to four
  for (std::size_t k = 0; k < near.count; ++k, to += leaf.stride) {
    const float* HWY_RESTRICT from = leaf.values + static_cast<std::size_t>(near.at[k]) * leaf.stride;
    std::size_t c = 0;
    for (; c + lanes <= leaf.stride; c += lanes) hn::StoreU(hn::LoadU(d, from + c), d, to + c);
    for (; c < leaf.stride; c += hn::Lanes(d4)) hn::StoreU(hn::LoadU(d4, from + c), d4, to + c);
  }
}

void SplatLeaf(const LeafSplat& leaf, const LeafMask& active, LeafSums& out) {
  out.sums.room(static_cast<std::size_t>(leaf.channels) * leaf_size);
  out.plain.room(leaf_size);
  const LeafCandidates& all = *leaf.candidates;
  for (int bx = 0; bx < 8; bx += block)
    for (int by = 0; by < 8; by += block)
      for (int bz = 0; bz < 8; bz += block) {
        if (!any_active(active, {bx, by, bz}, block, block, block)) continue;
        pick_near(all, {bx, by, bz, block}, leaf.voxel, out.near);
        float* const values = out.values.room(out.near.count * leaf.stride);
        copy_values(leaf, out.near, values);
        out.chosen.room(out.near.count);
        out.weights.room(out.near.count * lanes);
        for (int x = bx; x < bx + block; x += brick_x)
          for (int y = by; y < by + block; y += brick_y)
            for (int z = bz; z < bz + block; z += brick_z)
              if (any_active(active, {x, y, z}, brick_x, brick_y, brick_z)) SumBrick(leaf, {x, y, z}, out);
      }
}

void ScaleSums(const ScaledSum& from, const LeafMask& active, double* HWY_RESTRICT to) {
  const hn::CappedTag<double, 8> d8;
  const hn::Rebind<float, decltype(d8)> f8;
  const auto scale = hn::Set(d8, from.unit), mean = hn::Set(d8, from.reference);
  for (std::size_t v = 0; v < leaf_size; v += hn::Lanes(d8)) {
    const auto about = hn::Mul(scale, hn::PromoteTo(d8, hn::LoadU(f8, from.sum + v)));
    const auto value = hn::MulAdd(mean, hn::PromoteTo(d8, hn::LoadU(f8, from.weight + v)), about);
    const std::uint8_t bits[8] = {static_cast<std::uint8_t>(active.words[v / 64] >> (v % 64))};
    hn::StoreU(hn::IfThenElseZero(hn::LoadMaskBits(d8, bits), value), d8, to + v);
  }
}

void Narrow(const double* HWY_RESTRICT from, std::size_t count, float* HWY_RESTRICT to) {
  const hn::CappedTag<double, 8> d8;
  const hn::Rebind<float, decltype(d8)> f8;
  for (std::size_t v = 0; v < count; v += hn::Lanes(d8))
    hn::StoreU(hn::DemoteTo(f8, hn::LoadU(d8, from + v)), f8, to + v);
}

LeafMask FaintVoxels(const float* sum, float least, const float* plain, float rim, float enough,
                     const LeafMask& active) {
  const V small = hn::Set(d, least), edge = hn::Set(d, rim), plenty = hn::Set(d, enough);
  LeafMask faint;
  for (int v = 0; v < leaf_size; v += lanes) {
    const V p = hn::LoadU(d, plain + v);
    const auto few = hn::And(hn::Lt(hn::Abs(hn::LoadU(d, sum + v)), small), hn::Lt(p, plenty));
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, hn::Or(hn::Lt(p, edge), few), bytes);
    const std::uint64_t bits = bytes[0] | static_cast<unsigned>(bytes[1]) << 8U;
    faint.words[static_cast<std::size_t>(v / 64)] |= bits << (v % 64);
  }
  for (std::size_t w = 0; w < faint.words.size(); ++w) faint.words[w] &= active.words[w];
  return faint;
}

float LeastOf(const float* values, const LeafMask& active) {
  V least = hn::Set(d, hwy::HighestValue<float>());
  for (int v = 0; v < leaf_size; v += lanes) {
    const std::uint64_t bits = active.words[static_cast<std::size_t>(v / 64)] >> (v % 64);
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8U)};
    const V value = hn::LoadU(d, values + v);
    least = hn::IfThenElse(hn::LoadMaskBits(d, bytes), hn::Min(least, value), least);
  }
  return hn::GetLane(hn::MinOfLanes(d, least));
}

template <class Tag>
void CountPart(const float* HWY_RESTRICT values, std::size_t stride, std::size_t count, Tag tag, const float* limit,
               float* few) {
  const auto least = hn::LoadU(tag, limit), one = hn::Set(tag, 1.0F);
  auto n = hn::Zero(tag);
  for (std::size_t k = 0; k < count; ++k)
    n = hn::Add(n, hn::IfThenElseZero(hn::Lt(hn::Abs(hn::LoadU(tag, values + k * stride)), least), one));
  hn::StoreU(n, tag, few);
}

void CountBelow(const float* values, std::size_t stride, std::size_t count, const float* limit, float* few) {
  const hn::CappedTag<float, 4> d4;  // records are padded to four
  std::size_t c = 0;
  for (; c + lanes <= stride; c += lanes) CountPart(values + c, stride, count, d, limit + c, few + c);
  for (; c < stride; c += hn::Lanes(d4)) CountPart(values + c, stride, count, d4, limit + c, few + c);
}

template <class Tag>
void SumTermsPart(const ExactTerm* HWY_RESTRICT terms, std::size_t count, std::size_t c, Tag tag, double* sums) {
  const hn::Rebind<float, Tag> floats;
  auto sum = hn::Zero(tag);
  for (std::size_t k = 0; k < count; ++k)
    sum = hn::MulAdd(hn::Set(tag, terms[k].w), hn::PromoteTo(tag, hn::LoadU(floats, terms[k].record + c)), sum);
  hn::StoreU(sum, tag, sums + c);
}

void SumTerms(const ExactTerm* terms, std::size_t count, std::size_t stride, double* sums) {
  const hn::CappedTag<double, 8> d8;
  const hn::CappedTag<double, 2> d2;  // records are padded to four
  std::size_t c = 0;
  for (; c + hn::Lanes(d8) <= stride; c += hn::Lanes(d8)) SumTermsPart(terms, count, c, d8, sums);
  for (; c < stride; c += hn::Lanes(d2)) SumTermsPart(terms, count, c, d2, sums);
}

const char* TargetName() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {
HWY_EXPORT(SplatLeaf);
HWY_EXPORT(ScaleSums);
HWY_EXPORT(Narrow);
HWY_EXPORT(FaintVoxels);
HWY_EXPORT(LeastOf);
HWY_EXPORT(CountBelow);
HWY_EXPORT(SumTerms);
HWY_EXPORT(TargetName);
void splat_leaf(const LeafSplat& leaf, const LeafMask& active, LeafSums& out) {
  HWY_DYNAMIC_DISPATCH(SplatLeaf)(leaf, active, out);
}
void scale_sums(const ScaledSum& from, const LeafMask& active, double* to) {
  HWY_DYNAMIC_DISPATCH(ScaleSums)(from, active, to);
}
void narrow(const double* from, std::size_t count, float* to) {
  HWY_DYNAMIC_DISPATCH(Narrow)(from, count, to);
}
LeafMask faint_voxels(const float* sum, float least, const float* plain, float rim, float enough,
                      const LeafMask& active) {
  return HWY_DYNAMIC_DISPATCH(FaintVoxels)(sum, least, plain, rim, enough, active);
}
float least_of(const float* values, const LeafMask& active) {
  return HWY_DYNAMIC_DISPATCH(LeastOf)(values, active);
}
void count_below(const float* values, std::size_t stride, std::size_t count, const float* limit, float* few) {
  HWY_DYNAMIC_DISPATCH(CountBelow)(values, stride, count, limit, few);
}
void sum_terms(const ExactTerm* terms, std::size_t count, std::size_t stride, double* sums) {
  HWY_DYNAMIC_DISPATCH(SumTerms)(terms, count, stride, sums);
}
const char* splat_target() {
  return HWY_DYNAMIC_DISPATCH(TargetName)();
}
}  // namespace grainvdb
#endif
