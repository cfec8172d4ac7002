// Weights of particles at the voxels of a brick and their sums, compiled once for every instruction set (see
// bricks-inl.hpp).
#if defined(GRAINVDB_SPLAT_PARTICLE_BRICKS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINVDB_SPLAT_PARTICLE_BRICKS_INL_HPP
#undef GRAINVDB_SPLAT_PARTICLE_BRICKS_INL_HPP
#else
#define GRAINVDB_SPLAT_PARTICLE_BRICKS_INL_HPP
#endif

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <hwy/highway.h>

#include "splat/bricks-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {

/// Candidates of a leaf and their values.
struct Sources {
  const float* HWY_RESTRICT x;
  const float* HWY_RESTRICT y;
  const float* HWY_RESTRICT z;
  const float* HWY_RESTRICT values;  ///< [candidate][stride]
  std::size_t stride;
};

/// Distance of a candidate from a brick's voxels.
template <class Tag>
HWY_INLINE hn::Vec<Tag> distance(Tag tag, const VoxelsOf<Tag>& at, const Sources& from, std::size_t i) {
  const auto dx = hn::Sub(at.x, hn::Set(tag, from.x[i]));
  const auto dy = hn::Sub(at.y, hn::Set(tag, from.y[i]));
  const auto dz = hn::Sub(at.z, hn::Set(tag, from.z[i]));
  return hn::Sqrt(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))));
}

/// A third of (1-r)³(1+3r), 0 outside the support. The factored form never turns positive outside. A third, and
/// integers for the maximum, because multipliers are what the loops wait for.
template <class Tag>
HWY_INLINE hn::Vec<Tag> third_of_weight(Tag tag, hn::Vec<Tag> r) {
  const hn::RebindToSigned<Tag> integers;
  const auto inside = hn::BitCast(integers, hn::Sub(hn::Set(tag, 1.0F), r));
  const auto p = hn::BitCast(tag, hn::Max(inside, hn::Zero(integers)));
  return hn::Mul(hn::Mul(p, p), hn::Mul(p, hn::Add(r, hn::Set(tag, 1.0F / 3))));
}

/// weights[k][lane] of candidate chosen[k], a third of each. Returns their sum.
inline HWY_NOINLINE V weigh(const Sources& from, const std::int32_t* HWY_RESTRICT chosen, std::size_t count, Voxels at,
                            float* HWY_RESTRICT weights) {
  V sum = hn::Zero(d);
  for (std::size_t k = 0; k < count; ++k) {
    const V w = third_of_weight(d, distance(d, at, from, static_cast<std::size_t>(chosen[k])));
    sum = hn::Add(sum, w);
    hn::Store(w, d, weights + k * lanes);
  }
  return sum;
}

/// How many candidates weigh_and_sum looks at beyond the last: chosen[count …] must be places in the list.
constexpr std::size_t look_ahead = 5;

/// Sums of thirds of the weights, [0], and of the channels times them, [1 + channel][lane]. All sums stay in registers,
/// and while those of one candidate grow, the distances and weights of the next ones are under way: what takes long
/// (the square root) is ready when it is needed.
template <class Tag, int channels>
HWY_NOINLINE void weigh_and_sum(const Sources& from, const std::int32_t* HWY_RESTRICT chosen, std::size_t count,
                                VoxelsOf<Tag> at, float* HWY_RESTRICT sums) {
  constexpr Tag tag;
  const float* HWY_RESTRICT q = from.values;
  const auto place = [&](std::size_t k) { return static_cast<std::size_t>(chosen[k]); };
  const auto distance_to = [&](std::size_t k) { return distance(tag, at, from, place(k)); };
  auto all = hn::Zero(tag);
  hn::Vec<Tag> s[channels];
#pragma GCC unroll 32
  for (int c = 0; c < channels; ++c) s[c] = hn::Zero(tag);
  auto w0 = third_of_weight(tag, distance_to(0)), w1 = third_of_weight(tag, distance_to(1));
  auto r2 = distance_to(2), r3 = distance_to(3), r4 = distance_to(4);
  for (std::size_t k = 0; k < count; ++k) {
    const auto r5 = distance_to(k + 5);
    const auto w2 = third_of_weight(tag, r2);
    const float* HWY_RESTRICT v = q + place(k) * record_stride(channels);
    all = hn::Add(all, w0);
#pragma GCC unroll 32
    for (int c = 0; c < channels; ++c) s[c] = hn::MulAdd(w0, hn::Set(tag, v[c]), s[c]);
    w0 = w1;
    w1 = w2;
    r2 = r3;
    r3 = r4;
    r4 = r5;
  }
  hn::Store(all, tag, sums);
#pragma GCC unroll 32
  for (int c = 0; c < channels; ++c) hn::Store(s[c], tag, sums + (1 + c) * Brick<Tag>::lanes);
}

template <class Tag>
using WeighAndSum = void (*)(const Sources&, const std::int32_t*, std::size_t, VoxelsOf<Tag>, float*);
/// As many channels as leave registers for the rest.
constexpr int most_at_once = HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86 ? 20 : HWY_ARCH_ARM_A64 ? 16 : 4;
template <class Tag, int... c>
constexpr std::array<WeighAndSum<Tag>, sizeof...(c) + 1> weigh_and_sum_for(std::integer_sequence<int, c...>) {
  return {nullptr, weigh_and_sum<Tag, c + 1>...};
}
template <class Tag>
constexpr auto weigh_and_sum_of = weigh_and_sum_for<Tag>(std::make_integer_sequence<int, most_at_once>());

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#endif
