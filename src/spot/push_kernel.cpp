#include "spot/push_kernel.hpp"

#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spot/push_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/cache_control.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace grainvdb::spot {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, 8>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using VI = hn::Vec<DI>;
constexpr D d;
constexpr DI di;
constexpr std::size_t lanes = hn::MaxLanes(D());

struct Sites {
  VI x, y, z, mark;
};

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Sites load_sites(const Site* sites, const std::int32_t* index) {
  const Site& site = sites[static_cast<std::size_t>(*index)];
  return {hn::Set(di, site.at[0]), hn::Set(di, site.at[1]), hn::Set(di, site.at[2]), hn::Set(di, site.mark)};
}
#else
using Quad = hn::FixedTag<std::int32_t, 4>;
constexpr Quad quad;
static_assert(lanes == 4 || lanes == 8);

HWY_INLINE hn::Vec<Quad> load_site(const Site* sites, std::int32_t index) {
  return hn::Load(quad, sites[static_cast<std::size_t>(index)].at.data());
}

/// Row k of a transposition: site k, beside site k+4 where registers hold eight.
HWY_INLINE VI load_row(const Site* sites, const std::int32_t* index) {
#if HWY_MAX_BYTES >= 32
  return hn::Combine(di, load_site(sites, index[4]), load_site(sites, index[0]));
#else
  return load_site(sites, index[0]);
#endif
}

HWY_INLINE Sites load_sites(const Site* sites, const std::int32_t* index) {
  const VI a = load_row(sites, index), b = load_row(sites, index + 1), c = load_row(sites, index + 2),
           e = load_row(sites, index + 3);
  const VI ac = hn::InterleaveLower(di, a, c), be = hn::InterleaveLower(di, b, e);
  const VI ac_high = hn::InterleaveUpper(di, a, c), be_high = hn::InterleaveUpper(di, b, e);
  return {hn::InterleaveLower(di, ac, be), hn::InterleaveUpper(di, ac, be), hn::InterleaveLower(di, ac_high, be_high),
          hn::InterleaveUpper(di, ac_high, be_high)};
}
#endif

/// Differences from a point, in counts.
struct Differences {
  V x, y, z;
};
HWY_INLINE Differences differences(const std::array<std::int32_t, 3>& from, const Sites& s) {
  return {hn::ConvertTo(d, hn::Sub(hn::Set(di, from[0]), s.x)), hn::ConvertTo(d, hn::Sub(hn::Set(di, from[1]), s.y)),
          hn::ConvertTo(d, hn::Sub(hn::Set(di, from[2]), s.z))};
}
HWY_INLINE V squared_length(const Differences& n, const std::array<float, 3>& unit) {
  const V x = hn::Mul(n.x, hn::Set(d, unit[0])), y = hn::Mul(n.y, hn::Set(d, unit[1])),
          z = hn::Mul(n.z, hn::Set(d, unit[2]));
  return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
}

/// Sums of pushes over neighbours, lane by lane.
struct Sums {
  VI x, y, z;
};

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void store_sums(const Sums& sums, Site* to) {
  *to = {{hn::GetLane(sums.x), hn::GetLane(sums.y), hn::GetLane(sums.z)}};
}
#else
HWY_INLINE hn::Vec<Quad> four_lanes(VI v) {
#if HWY_MAX_BYTES >= 32
  return hn::Add(hn::LowerHalf(quad, v), hn::UpperHalf(quad, v));
#else
  return v;
#endif
}
/// Sums of pairs of lanes of two registers, beside each other.
HWY_INLINE hn::Vec<Quad> halved(hn::Vec<Quad> a, hn::Vec<Quad> b) {
  return hn::Add(hn::InterleaveLower(quad, a, b), hn::InterleaveUpper(quad, a, b));
}
HWY_INLINE void store_sums(const Sums& sums, Site* to) {
  const auto xz = halved(four_lanes(sums.x), four_lanes(sums.z)), y = halved(four_lanes(sums.y), hn::Zero(quad));
  hn::Store(halved(xz, y), quad, to->at.data());
}
#endif

HWY_INLINE void add_pushes(const Site* sites, const Site& self, const std::int32_t* near, const PushLaw& law,
                           Sums& sums) {
  const V diameter = hn::Set(d, law.diameter), limit = hn::Set(d, law.diameter * law.diameter);
  const V whole = hn::Set(d, law.strength), half = hn::Set(d, 0.5F * law.strength), one = hn::Set(d, 1.0F);
  for (std::size_t k = 0; k < NearView::group; k += lanes) {
    const Sites other = load_sites(sites, near + k);
    const Differences n = differences(self.at, other);
    const V r2 = squared_length(n, law.unit);
    const auto overlap = hn::And(hn::Lt(r2, limit), hn::Gt(r2, hn::Zero(d)));
    const V weight = hn::IfThenElse(hn::RebindMask(d, hn::Eq(other.mark, hn::Set(di, law.mark))), half, whole);
    const V f = hn::IfThenElseZero(overlap, hn::Mul(weight, hn::Sub(hn::Div(diameter, hn::Sqrt(r2)), one)));
    sums.x = hn::Add(sums.x, hn::NearestInt(hn::Mul(f, n.x)));
    sums.y = hn::Add(sums.y, hn::NearestInt(hn::Mul(f, n.y)));
    sums.z = hn::Add(sums.z, hn::NearestInt(hn::Mul(f, n.z)));
  }
}

constexpr std::size_t ahead = 12;

// Few have more than eight neighbours, and nobody can guess who: theirs come afterwards.
void PushApart(const Site* sites, const NearView& near, std::span<const std::int32_t> places, const PushLaw& law,
               Site* pushes, std::int32_t* many) {
  std::size_t with_many = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto i = static_cast<std::size_t>(places[k]);
    // Lists lie farther apart than the processor reads ahead.
    if (k + ahead < places.size()) {
      const auto later = static_cast<std::size_t>(places[k + ahead]);
      hwy::Prefetch(near.group_of(later, 0));
      hwy::Prefetch(near.counts + later);
    }
    Sums sums{hn::Zero(di), hn::Zero(di), hn::Zero(di)};
    add_pushes(sites, sites[i], near.group_of(i, 0), law, sums);
    store_sums(sums, pushes + k);
    many[with_many] = static_cast<std::int32_t>(k);
    with_many += near.counts[i] > static_cast<std::int32_t>(NearView::group) ? 1U : 0U;
  }
  for (std::size_t m = 0; m < with_many; ++m) {
    const auto k = static_cast<std::size_t>(many[m]), i = static_cast<std::size_t>(places[k]);
    if (m + ahead < with_many)
      hwy::Prefetch(near.group_of(static_cast<std::size_t>(places[static_cast<std::size_t>(many[m + ahead])]), 1));
    Sums sums{hn::Zero(di), hn::Zero(di), hn::Zero(di)};
    for (std::size_t g = 1; g * NearView::group < static_cast<std::size_t>(near.counts[i]); ++g)
      add_pushes(sites, sites[i], near.group_of(i, g), law, sums);
    Site rest;
    store_sums(sums, &rest);
    for (std::size_t a = 0; a < 3; ++a) pushes[k].at[a] += rest.at[a];
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb::spot
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb::spot {
HWY_EXPORT(PushApart);
void push_apart(const Site* sites, const NearView& near, std::span<const std::int32_t> places, const PushLaw& law,
                Site* pushes) {
  thread_local std::vector<std::int32_t> many;
  many.resize(places.size() + 1);
  HWY_DYNAMIC_DISPATCH(PushApart)(sites, near, places, law, pushes, many.data());
}
}  // namespace grainvdb::spot
#endif
