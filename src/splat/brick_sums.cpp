#include "splat/brick_sums.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>

#include "splat/splat.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/brick_sums.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>
//
#include "splat/bricks-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace {

constexpr hn::CappedTag<float, 8> of_row;  // at most a row of a leaf
constexpr hn::CappedTag<double, 8> doubles;
constexpr hn::Rebind<float, decltype(doubles)> singles;

/// Rows of eight voxels along z, as many as bricks side by side hold.
struct RowsOfVoxels {
  HWY_ALIGN float of[4][leaf_edge];
};

/// Puts the lanes of bricks that follow each other along z, `apart` from each other, in rows.
template <class Tag, hwy::EnableIf<hn::MaxLanes(Tag()) != 8>* = nullptr>
HWY_INLINE void to_rows(Tag, const float* HWY_RESTRICT brick, std::size_t apart, RowsOfVoxels& rows) {
  using B = Brick<Tag>;
  for (int b = 0; b < leaf_edge / B::z; ++b)
    for (int row = 0; row < B::x * B::y; ++row)
      std::memcpy(rows.of[row] + b * B::z, brick + static_cast<std::size_t>(b) * apart + row * B::z,
                  B::z * sizeof(float));
}

#if HWY_TARGET != HWY_SCALAR
/// Bricks of 2×2×2 are transposed by pairs of voxels along z.
template <class Tag, hwy::EnableIf<hn::MaxLanes(Tag()) == 8>* = nullptr>
HWY_INLINE void to_rows(const Tag& tag, const float* HWY_RESTRICT brick, std::size_t apart, RowsOfVoxels& rows) {
  const hn::Repartition<double, Tag> pairs;
  const auto load = [&](std::size_t b) { return hn::BitCast(pairs, hn::Load(tag, brick + b * apart)); };
  const auto b0 = load(0), b1 = load(1), b2 = load(2), b3 = load(3);
  const auto lower01 = hn::InterleaveLower(pairs, b0, b1), upper01 = hn::InterleaveUpper(pairs, b0, b1);
  const auto lower23 = hn::InterleaveLower(pairs, b2, b3), upper23 = hn::InterleaveUpper(pairs, b2, b3);
  hn::Store(hn::BitCast(tag, hn::ConcatLowerLower(pairs, lower23, lower01)), tag, rows.of[0]);
  hn::Store(hn::BitCast(tag, hn::ConcatLowerLower(pairs, upper23, upper01)), tag, rows.of[1]);
  hn::Store(hn::BitCast(tag, hn::ConcatUpperUpper(pairs, lower23, lower01)), tag, rows.of[2]);
  hn::Store(hn::BitCast(tag, hn::ConcatUpperUpper(pairs, upper23, upper01)), tag, rows.of[3]);
}
#endif

/// The active ones of some lanes, 0 in the others.
template <class Tag>
HWY_INLINE hn::Vec<Tag> only(Tag tag, std::uint64_t bits, hn::Vec<Tag> v) {
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits)};
  return hn::IfThenElseZero(hn::LoadMaskBits(tag, bytes), v);
}

HWY_INLINE void store_as(hn::Vec<decltype(doubles)> v, double* to) {
  hn::StoreU(v, doubles, to);
}
HWY_INLINE void store_as(hn::Vec<decltype(doubles)> v, float* to) {
  hn::StoreU(hn::DemoteTo(singles, v), singles, to);
}

/// One row, by arithmetic in double precision.
struct InDouble {
  explicit InDouble(const ScaledSum& what) : unit(what.unit), reference(what.reference) {}
  template <class T>
  HWY_INLINE void operator()(const float* sum, const float* weight, std::uint64_t active, T* HWY_RESTRICT to) const {
    for (std::size_t z = 0; z < leaf_edge; z += hn::Lanes(doubles)) {
      auto v = hn::Mul(hn::Set(doubles, unit), hn::PromoteTo(doubles, hn::LoadU(singles, sum + z)));
      if (weight != nullptr)
        v = hn::MulAdd(hn::Set(doubles, reference), hn::PromoteTo(doubles, hn::LoadU(singles, weight + z)), v);
      store_as(only(doubles, active >> z, v), to + z);
    }
  }
  double unit, reference;
};

/// One row, in single precision: one more rounding of a result that is rounded to it anyway.
struct InSingle {
  explicit InSingle(const ScaledSum& what)
      : unit(static_cast<float>(what.unit)), reference(static_cast<float>(what.reference)) {}
  HWY_INLINE void operator()(const float* sum, const float* weight, std::uint64_t active,
                             float* HWY_RESTRICT to) const {
    for (std::size_t z = 0; z < leaf_edge; z += hn::Lanes(of_row)) {
      auto v = hn::Mul(hn::Set(of_row, unit), hn::LoadU(of_row, sum + z));
      if (weight != nullptr) v = hn::MulAdd(hn::Set(of_row, reference), hn::LoadU(of_row, weight + z), v);
      hn::StoreU(only(of_row, active >> z, v), of_row, to + z);
    }
  }
  float unit, reference;
};

template <class Row, class Tag, class T>
void scale_bricks(Tag tag, const BrickSums& from, const ScaledSum& what, const LeafMask& active, T* HWY_RESTRICT to) {
  using B = Brick<Tag>;
  const Row scale(what);
  const std::size_t apart = static_cast<std::size_t>(from.rows * B::lanes);
  const float* HWY_RESTRICT sum = from.values.data() + what.sum * B::lanes;
  const float* HWY_RESTRICT weight = from.values.data() + what.weight * B::lanes;
  const bool weighed = what.reference != 0;
  RowsOfVoxels sums, weights;
  for (int x = 0; x < leaf_edge; x += B::x)
    for (int y = 0; y < leaf_edge; y += B::y) {
      to_rows(tag, sum, apart, sums);
      if (weighed) to_rows(tag, weight, apart, weights);
      sum += apart * (leaf_edge / B::z);
      weight += apart * (leaf_edge / B::z);
      for (int row = 0; row < B::x * B::y; ++row) {
        const int i = x + row / B::y, j = y + row % B::y;
        scale(sums.of[row], weighed ? weights.of[row] : nullptr,
              active.words[static_cast<std::size_t>(i)] >> (leaf_edge * j), to + leaf_edge * (leaf_edge * i + j));
      }
    }
}

template <class Row, class T>
void scale_with(const BrickSums& from, const ScaledSum& what, const LeafMask& active, T* to) {
  if (from.lanes == lanes) return scale_bricks<Row>(d, from, what, active, to);
  if constexpr (lanes == 16) scale_bricks<Row>(hn::Half<D>(), from, what, active, to);
}

void ScaleToDouble(const BrickSums& from, const ScaledSum& what, const LeafMask& active, double* to) {
  scale_with<InDouble>(from, what, active, to);
}
void ScaleToSingle(const BrickSums& from, const ScaledSum& what, const LeafMask& active, float* to) {
  const auto fits = [](double x) { return x == 0 || (std::abs(x) > 1e-30 && std::abs(x) < 1e30); };
  if (fits(what.unit) && fits(what.reference)) return scale_with<InSingle>(from, what, active, to);
  scale_with<InDouble>(from, what, active, to);
}

void Narrow(const double* HWY_RESTRICT from, std::size_t count, float* HWY_RESTRICT to) {
  for (std::size_t v = 0; v < count; v += hn::Lanes(doubles)) store_as(hn::LoadU(doubles, from + v), to + v);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {
HWY_EXPORT(ScaleToDouble);
HWY_EXPORT(ScaleToSingle);
HWY_EXPORT(Narrow);
void scale_sums(const BrickSums& from, const ScaledSum& what, const LeafMask& active, double* to) {
  HWY_DYNAMIC_DISPATCH(ScaleToDouble)(from, what, active, to);
}
void scale_sums(const BrickSums& from, const ScaledSum& what, const LeafMask& active, float* to) {
  HWY_DYNAMIC_DISPATCH(ScaleToSingle)(from, what, active, to);
}
void narrow(const double* from, std::size_t count, float* to) {
  HWY_DYNAMIC_DISPATCH(Narrow)(from, count, to);
}
}  // namespace grainvdb
#endif
