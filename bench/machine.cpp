#include "machine.hpp"

#include <cstdint>

#include <benchmark/benchmark.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/machine.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace grainvdb::bench {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// As many lanes as the splat uses at most.
using D = hn::CappedTag<float, 16>;

std::size_t MultiplyAdd(std::size_t rounds) {
  // Two units with a latency of four or five need ten registers in flight; with fourteen, two are left for the factors
  // of a machine with sixteen registers.
  constexpr std::size_t registers = 14;
  const D d;
  static volatile float factor = 0.999999F;
  static volatile float addend = 1e-6F;
  const auto x = hn::Set(d, factor);
  const auto y = hn::Set(d, addend);
  hn::Vec<D> a[registers];
#pragma GCC unroll 16
  for (std::size_t i = 0; i < registers; ++i) a[i] = hn::Set(d, static_cast<float>(i));
  for (std::size_t r = 0; r < rounds; ++r) {
#pragma GCC unroll 16
    for (std::size_t i = 0; i < registers; ++i) a[i] = hn::MulAdd(a[i], x, y);
  }
  auto sum = a[0];
#pragma GCC unroll 16
  for (std::size_t i = 1; i < registers; ++i) sum = hn::Add(sum, a[i]);
  benchmark::DoNotOptimize(hn::GetLane(sum));
  return rounds * registers * hn::Lanes(d);
}

void Triad(float* HWY_RESTRICT a, const float* HWY_RESTRICT b, const float* HWY_RESTRICT c, std::size_t n) {
  const D d;
  const auto three = hn::Set(d, 3.0F);
  for (std::size_t i = 0; i + hn::Lanes(d) <= n; i += hn::Lanes(d))
    hn::Store(hn::MulAdd(hn::Load(d, c + i), three, hn::Load(d, b + i)), d, a + i);
}

const char* MultiplyAddTarget() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb::bench {
HWY_EXPORT(MultiplyAdd);
HWY_EXPORT(Triad);
HWY_EXPORT(MultiplyAddTarget);
std::size_t multiply_add(std::size_t rounds) {
  return HWY_DYNAMIC_DISPATCH(MultiplyAdd)(rounds);
}
void triad(float* a, const float* b, const float* c, std::size_t n) {
  HWY_DYNAMIC_DISPATCH(Triad)(a, b, c, n);
}
const char* multiply_add_target() {
  return HWY_DYNAMIC_DISPATCH(MultiplyAddTarget)();
}
}  // namespace grainvdb::bench
#endif
