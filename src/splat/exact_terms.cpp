#include "splat/exact_terms.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/exact_terms.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>
//
#include "splat/bricks-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace {

constexpr hn::CappedTag<double, 8> doubles;

/// Turns squared distances, whose roots times `unit` are in units of the cutoff, into peak (1-r)³(1+3r), 0 outside the
/// support.
void WeighTerms(double unit, double peak, std::size_t count, double* HWY_RESTRICT w) {
  const auto one = hn::Set(doubles, 1.0), three = hn::Set(doubles, 3.0);
  for (std::size_t k = 0; k < count; k += hn::Lanes(doubles)) {
    const auto r = hn::Mul(hn::Sqrt(hn::Load(doubles, w + k)), hn::Set(doubles, unit));
    const auto p = hn::Max(hn::Sub(one, r), hn::Zero(doubles));
    hn::Store(hn::Mul(hn::Mul(hn::Set(doubles, peak), hn::Mul(hn::Mul(p, p), p)), hn::MulAdd(three, r, one)), doubles,
              w + k);
  }
}

template <class Tag>
void SumPart(const ExactTerms& terms, const float* HWY_RESTRICT values, std::size_t stride, Tag tag,
             double* HWY_RESTRICT sums) {
  const hn::Rebind<float, Tag> floats;
  const double* HWY_RESTRICT w = terms.w.data();
  const std::int32_t* HWY_RESTRICT of = terms.of.data();
  auto sum = hn::Zero(tag);
  for (std::size_t k = 0; k < terms.count; ++k) {
    const float* from = values + static_cast<std::size_t>(of[k]) * stride;
    sum = hn::MulAdd(hn::Set(tag, w[k]), hn::PromoteTo(tag, hn::LoadU(floats, from)), sum);
  }
  hn::StoreU(sum, tag, sums);
}

void SumTerms(const ExactTerms& terms, const float* values, std::size_t stride, double* sums) {
  const hn::CappedTag<double, 2> d2;  // records are padded to four
  std::size_t c = 0;
  for (; c + hn::Lanes(doubles) <= stride; c += hn::Lanes(doubles))
    SumPart(terms, values + c, stride, doubles, sums + c);
  for (; c < stride; c += hn::Lanes(d2)) SumPart(terms, values + c, stride, d2, sums + c);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {
HWY_EXPORT(WeighTerms);
HWY_EXPORT(SumTerms);

void find_terms(const Buckets& buckets, const LeafCandidates& candidates, std::span<const std::int32_t> chosen,
                const Coord& leaf, int voxel, double h, const LucyKernel& kernel, ExactTerms& out) {
  const Coord at = voxel_at(leaf, voxel);
  const double* const x = buckets.index[0].data();
  const double* const y = buckets.index[1].data();
  const double* const z = buckets.index[2].data();
  const double reach2 = kernel.cutoff() * kernel.cutoff();
  double* const w = out.w.room(chosen.size());
  std::int32_t* const of = out.of.room(chosen.size());
  // The squared distances are those that decide whether a voxel is active, to the last bit.
  std::size_t n = 0;
  for (const std::int32_t k : chosen) {
    const std::size_t e = candidates.entry[static_cast<std::size_t>(k)];
    const double dx = (at.x - x[e]) * h, dy = (at.y - y[e]) * h, dz = (at.z - z[e]) * h;
    w[n] = dx * dx + dy * dy + dz * dz;
    of[n] = k;
    n += w[n] < reach2 ? 1 : 0;
  }
  out.count = n;
  // So are the roots, and thus W to its last few bits.
  const double inverse = 1 / kernel.cutoff();
  HWY_DYNAMIC_DISPATCH(WeighTerms)(inverse, kernel.value(0), out.count, w);
}

void sum_terms(const ExactTerms& terms, const float* values, std::size_t stride, double* sums) {
  HWY_DYNAMIC_DISPATCH(SumTerms)(terms, values, stride, sums);
}

}  // namespace grainvdb
#endif
