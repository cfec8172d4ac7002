// The velocity at several tracers at once, compiled once for every instruction set: include it from files that
// hwy/foreach_target.h compiles again and again, after hwy/highway.h.
#if defined(GRAINVDB_TRACE_FLOW_SAMPLER_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINVDB_TRACE_FLOW_SAMPLER_INL_HPP
#undef GRAINVDB_TRACE_FLOW_SAMPLER_INL_HPP
#else
#define GRAINVDB_TRACE_FLOW_SAMPLER_INL_HPP
#endif

#include <cstddef>
#include <cstdint>
#include <limits>

#include <hwy/highway.h>

#include "trace/flow_blocks.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A tracer's position and strain, or velocity and shear rate, fill one register, or two or four narrow ones.
using D = hn::CappedTag<double, flow_lanes>;
using DF = hn::Rebind<float, D>;
using DI = hn::Rebind<std::int32_t, D>;
constexpr D d;
constexpr std::size_t lanes = hn::MaxLanes(D());
constexpr std::size_t parts = flow_lanes / lanes;

struct Four {
  hn::Vec<D> part[parts];
};
template <class F>
HWY_INLINE Four make_four(F&& f) {
  Four v;
  for (std::size_t p = 0; p < parts; ++p) v.part[p] = f(p);
  return v;
}
HWY_INLINE Four load(const double* from) {
  return make_four([&](std::size_t p) HWY_ATTR { return hn::LoadU(d, from + p * lanes); });
}
HWY_INLINE Four load(const float* from) {
  return make_four([&](std::size_t p) HWY_ATTR { return hn::PromoteTo(d, hn::LoadU(DF(), from + p * lanes)); });
}
HWY_INLINE void store(const Four& v, double* to) {
  for (std::size_t p = 0; p < parts; ++p) hn::StoreU(v.part[p], d, to + p * lanes);
}
/// y + a k.
HWY_INLINE Four moved(const Four& y, double a, const Four& k) {
  return make_four([&](std::size_t p) HWY_ATTR { return hn::MulAdd(hn::Set(d, a), k.part[p], y.part[p]); });
}
HWY_INLINE Four scaled(double a, const Four& k) {
  return make_four([&](std::size_t p) HWY_ATTR { return hn::Mul(hn::Set(d, a), k.part[p]); });
}
/// a + s (b - a): exactly a where both are equal.
HWY_INLINE Four between(const Four& a, const Four& b, double s) {
  return make_four([&](std::size_t p)
                       HWY_ATTR { return hn::MulAdd(hn::Set(d, s), hn::Sub(b.part[p], a.part[p]), a.part[p]); });
}
HWY_INLINE bool any_nan(const Four& v) {
  bool any = false;
  for (std::size_t p = 0; p < parts; ++p) any = any || !hn::AllFalse(d, hn::IsNaN(v.part[p]));
  return any;
}

/// The block that a tracer was in last.
struct LastBlock {
  std::int32_t origin[3];  ///< of its leaf
  const float* block;
};

/// Samples one grid. A value is NaN where one of the voxels around is undefined.
template <Interpolation interpolation>
class GridSampler {
 public:
  explicit GridSampler(const FlowBlocks& blocks) : blocks_(blocks) {
    const Lattice& lattice = blocks.lattice;
    for (int a = 0; a < 3; ++a) {
      per_length_[a] = 1 / lattice.voxel();
      origin_[a] = lattice.origin()[static_cast<std::size_t>(a)];
      last_[a] = std::numeric_limits<double>::max();
      if (const auto& period = lattice.period(a)) {
        first_[a] = period->first;
        length_[a] = period->length;
        per_period_[a] = 1 / period->length;
        last_[a] = period->first + period->count - 1;
      }
    }
  }

  /// Where no leaf is: voxels have 31-bit indices.
  LastBlock nowhere() const {
    constexpr std::int32_t far = std::numeric_limits<std::int32_t>::max() & ~(leaf_edge - 1);
    return {{far, far, far}, blocks_.block(blocks_.index.leaf_count())};
  }

  HWY_INLINE Four operator()(const Four& x, LastBlock& last) const {
    HWY_ALIGN std::int32_t cell[flow_lanes];
    HWY_ALIGN double within[flow_lanes];
    for (std::size_t p = 0; p < parts; ++p) {
      const auto get = [p](const double* from) HWY_ATTR { return hn::Load(d, from + p * lanes); };
      // The strain has a length of 0 here, but may be NaN: it is taken for a place that nobody reads.
      auto u = hn::Sub(hn::Mul(hn::Sub(x.part[p], get(origin_)), get(per_length_)), hn::Set(d, 0.5));
      u = hn::NegMulAdd(get(length_), hn::Floor(hn::Mul(hn::Sub(u, get(first_)), get(per_period_))), u);
      const auto whole = hn::Min(hn::Floor(u), get(last_));
      hn::Store(hn::DemoteTo(DI(), whole), DI(), cell + p * lanes);
      hn::Store(hn::Sub(u, whole), d, within + p * lanes);
    }
    constexpr std::int32_t in_leaf = leaf_edge - 1;
    if (HWY_UNLIKELY(
            (((cell[0] ^ last.origin[0]) | (cell[1] ^ last.origin[1]) | (cell[2] ^ last.origin[2])) & ~in_leaf) != 0)) {
      for (int a = 0; a < 3; ++a) last.origin[a] = cell[a] & ~in_leaf;
      last.block = blocks_.block(blocks_.index.find({last.origin[0], last.origin[1], last.origin[2]}));
    }
    const float* const at = last.block + blocks_.offset({cell[0] & in_leaf, cell[1] & in_leaf, cell[2] & in_leaf});
    if constexpr (interpolation == Interpolation::trilinear) {
      return linear<leaf_edge + 1>(at, within);
    } else {
      const Four value = cubic(at, within);
      return HWY_UNLIKELY(any_nan(value)) ? linear<leaf_edge + 3>(at + step<leaf_edge + 3>(1, 1, 1), within) : value;
    }
  }

 private:
  template <int edge>
  static constexpr std::size_t step(std::size_t x, std::size_t y, std::size_t z) {
    return ((x * edge + y) * edge + z) * flow_lanes;
  }

  template <int edge>
  HWY_INLINE Four linear(const float* at, const double* within) const {
    const auto row = [&](std::size_t x, std::size_t y) HWY_ATTR {
      return between(load(at + step<edge>(x, y, 0)), load(at + step<edge>(x, y, 1)), within[2]);
    };
    return between(between(row(0, 0), row(0, 1), within[1]), between(row(1, 0), row(1, 1), within[1]), within[0]);
  }

  HWY_INLINE Four cubic(const float* at, const double* within) const {
    const auto wx = cubic_weights(within[0]), wy = cubic_weights(within[1]), wz = cubic_weights(within[2]);
    Four sum{};
    for (std::size_t x = 0; x < 4; ++x) {
      Four plane{};
      for (std::size_t y = 0; y < 4; ++y) {
        Four row = scaled(wz[0], load(at + step<leaf_edge + 3>(x, y, 0)));
        for (std::size_t z = 1; z < 4; ++z) row = moved(row, wz[z], load(at + step<leaf_edge + 3>(x, y, z)));
        plane = y == 0 ? scaled(wy[0], row) : moved(plane, wy[y], row);
      }
      sum = x == 0 ? scaled(wx[0], plane) : moved(sum, wx[x], plane);
    }
    return sum;
  }

  const FlowBlocks& blocks_;
  HWY_ALIGN double origin_[flow_lanes] = {}, per_length_[flow_lanes] = {}, first_[flow_lanes] = {},
                   length_[flow_lanes] = {}, per_period_[flow_lanes] = {}, last_[flow_lanes] = {};
};

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#endif
