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

/// The candidates that may lie within the cutoff of a voxel, by the precision of their positions.
std::size_t FindNear(const Picked& from, const VoxelBox& voxel, float h, std::int32_t* HWY_RESTRICT of) {
  const auto at = [&](int offset) { return hn::Set(d, h * (static_cast<float>(offset) - 3.5F)); };
  const V x = at(voxel.x), y = at(voxel.y), z = at(voxel.z), limit = hn::Set(d, 1 + margin);
  std::size_t n = 0;
  for (std::size_t i = 0; i < from.count; i += lanes) {
    const V dx = hn::Sub(x, hn::Load(d, from.x.data() + i)), dy = hn::Sub(y, hn::Load(d, from.y.data() + i)),
            dz = hn::Sub(z, hn::Load(d, from.z.data() + i));
    const V r2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
    const auto near = hn::And(hn::Lt(r2, limit), hn::FirstN(d, from.count - i));
    n += store_some(hn::Load(di, from.at.data() + i), hn::RebindMask(di, near), di, of + n);
  }
  return n;
}

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
HWY_EXPORT(FindNear);
HWY_EXPORT(WeighTerms);
HWY_EXPORT(SumTerms);

void find_terms(const Buckets& buckets, const LeafCandidates& candidates, const Picked& picked, const Coord& leaf,
                int voxel, double h, const LucyKernel& kernel, ExactTerms& out) {
  const Coord at = voxel_at(leaf, voxel);
  const Coord in_leaf = voxel_at({0, 0, 0}, voxel);
  double* const w = out.w.room(picked.count);
  std::int32_t* const of = out.of.room(picked.count);
  out.count = HWY_DYNAMIC_DISPATCH(FindNear)(picked, {in_leaf.x, in_leaf.y, in_leaf.z, 1},
                                             static_cast<float>(h / kernel.cutoff()), of);
  // The squared distances are those that decide whether a voxel is active, to the last bit.
  for (std::size_t k = 0; k < out.count; ++k) {
    const std::size_t e = candidates.entry[static_cast<std::size_t>(of[k])];
    double r2 = 0;
    for (int a = 0; a < 3; ++a) {
      const double distance = (at[a] - buckets.index[static_cast<std::size_t>(a)][e]) * h;
      r2 += distance * distance;
    }
    w[k] = r2;
  }
  // So are the roots, and thus W to its last few bits.
  const double inverse = 1 / kernel.cutoff();
  HWY_DYNAMIC_DISPATCH(WeighTerms)(inverse, kernel.value(0), out.count, w);
}

void sum_terms(const ExactTerms& terms, const float* values, std::size_t stride, double* sums) {
  HWY_DYNAMIC_DISPATCH(SumTerms)(terms, values, stride, sums);
}

}  // namespace grainvdb
#endif
