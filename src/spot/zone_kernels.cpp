#include "spot/zone_kernels.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spot/zone_kernels.cpp"
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
  VI x, y, z, stamp;
};

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Sites load_sites(const Site* sites, const std::int32_t* index) {
  const Site& site = sites[static_cast<std::size_t>(*index)];
  return {hn::Set(di, site.at[0]), hn::Set(di, site.at[1]), hn::Set(di, site.at[2]), hn::Set(di, site.stamp)};
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

/// The cells of one axis that an interval touches: `count` of them from `first`, which may lie outside [0, n) along a
/// periodic axis.
struct CellRange {
  int first = 0;
  int count = 0;
};
HWY_INLINE CellRange cells_between(double lo, double hi, int n, bool periodic) {
  int first = static_cast<int>(std::floor(lo)), last = static_cast<int>(std::floor(hi));
  if (periodic) return {first, std::min(last - first + 1, n)};
  first = std::clamp(first, 0, n - 1);
  last = std::clamp(last, 0, n - 1);
  return {first, last - first + 1};
}
HWY_INLINE int wrapped(int cell, int n) {
  return cell < 0 ? cell + n : cell >= n ? cell - n : cell;
}

/// Distance from a coordinate to a cell, in cells.
HWY_INLINE double distance_to(double u, int cell) {
  return std::max({0.0, cell - u, u - cell - 1});
}

/// Calls f with every cell that a ball may touch.
template <class F>
HWY_INLINE void for_each_cell(const CellView& cells, const std::array<std::int32_t, 3>& centre, double radius,
                              const F& f) {
  const double reach = radius + cells.slack;
  std::array<double, 3> u{};  // the centre in cells
  for (std::size_t a = 0; a < 3; ++a)
    u[a] = static_cast<double>(static_cast<std::uint32_t>(centre[a])) / cells.per_cell[a];
  const auto range = [&](std::size_t a, double half) {
    const double cells_away = half / cells.edge[a];
    return cells_between(u[a] - cells_away, u[a] + cells_away, cells.cells[a], cells.periodic[a]);
  };
  const CellRange along_x = range(0, reach), along_y = range(1, reach);
  for (int i = along_x.first; i < along_x.first + along_x.count; ++i) {
    // All cells of a short period are visited: their distance the long way round says nothing.
    const double dx = along_x.count == cells.cells[0] ? 0 : distance_to(u[0], i) * cells.edge[0];
    for (int j = along_y.first; j < along_y.first + along_y.count; ++j) {
      const double dy = along_y.count == cells.cells[1] ? 0 : distance_to(u[1], j) * cells.edge[1];
      const double rest = reach * reach - dx * dx - dy * dy;
      if (rest <= 0) continue;
      const auto column =
          static_cast<std::size_t>(wrapped(i, cells.cells[0]) * cells.cells[1] + wrapped(j, cells.cells[1]));
      const CellRange along_z = range(2, std::sqrt(rest));
      for (int k = 0; k < along_z.count; ++k)
        f(column * static_cast<std::size_t>(cells.cells[2]) +
          static_cast<std::size_t>(wrapped(along_z.first + k, cells.cells[2])));
    }
  }
}

template <class M>
HWY_INLINE std::int32_t* append(VI index, M mask, std::int32_t* to) {
  const auto chosen = hn::RebindMask(di, mask);
  hn::StoreU(hn::Compress(index, chosen), di, to);
  return to + hn::CountTrue(di, chosen);
}

/// Divides candidates at two radii.
void divide(const CellView& cells, const std::array<std::int32_t, 3>& centre, double inner, double outer,
            std::size_t candidates, Found& found) {
  const V inner2 = hn::Set(d, static_cast<float>(inner * inner)),
          outer2 = hn::Set(d, static_cast<float>(outer * outer));
  std::int32_t *to_inner = found.inner.data(), *to_outer = found.outer.data();
  // The last group is filled up with a particle that is there; the lanes do not count.
  for (std::size_t k = 0; k < lanes; ++k) found.candidates[candidates + k] = candidates > 0 ? found.candidates[0] : 0;
  for (std::size_t k = 0; k < candidates; k += lanes) {
    const std::int32_t* members = found.candidates.data() + k;
    const V r2 = squared_length(differences(centre, load_sites(cells.sites, members)), cells.unit);
    const auto valid = hn::FirstN(d, std::min(candidates - k, lanes));
    const auto near = hn::And(hn::Lt(r2, inner2), valid), within = hn::And(hn::Lt(r2, outer2), valid);
    const VI index = hn::LoadU(di, members);
    to_inner = append(index, near, to_inner);
    to_outer = append(index, hn::AndNot(near, within), to_outer);
  }
  found.inner_count = static_cast<std::size_t>(to_inner - found.inner.data());
  found.outer_count = static_cast<std::size_t>(to_outer - found.outer.data());
}

void FindWithin(const CellView& cells, const std::array<std::int32_t, 3>& centre, double inner, double outer,
                Found& found) {
  // Cells are copied in full, which needs no branch; what is too much is written over by the next.
  std::int32_t* to = found.candidates.data();
  for_each_cell(cells, centre, outer, [&](std::size_t cell) HWY_ATTR {
    const std::int32_t* members = cells.members + cell * cells.capacity;
    for (std::size_t m = 0; m < cells.capacity; m += lanes) hn::StoreU(hn::LoadU(di, members + m), di, to + m);
    to += cells.counts[cell];
  });
  divide(cells, centre, inner, outer, static_cast<std::size_t>(to - found.candidates.data()), found);
}

void FetchWithin(const CellView& cells, const std::array<std::int32_t, 3>& centre, double radius) {
  for_each_cell(cells, centre, radius, [&](std::size_t cell) HWY_ATTR {
    hwy::Prefetch(cells.members + cell * cells.capacity);
    hwy::Prefetch(cells.counts + cell);
  });
}

HWY_INLINE Site push_of(const Site* sites, const Site& self, const std::int32_t* near, std::size_t count,
                        const PushLaw& law) {
  const V diameter = hn::Set(d, law.diameter), limit = hn::Set(d, law.diameter * law.diameter);
  const V whole = hn::Set(d, law.strength), half = hn::Set(d, 0.5F * law.strength), one = hn::Set(d, 1.0F);
  const VI stamp = hn::Set(di, law.stamp);
  VI x = hn::Zero(di), y = hn::Zero(di), z = hn::Zero(di);
  for (std::size_t k = 0; k < count; k += lanes) {
    const Sites other = load_sites(sites, near + k);
    const Differences n = differences(self.at, other);
    const V r2 = squared_length(n, law.unit);
    const auto overlap = hn::And(hn::Lt(r2, limit), hn::Gt(r2, hn::Zero(d)));
    const V weight = hn::IfThenElse(hn::RebindMask(d, hn::Eq(other.stamp, stamp)), half, whole);
    const V f = hn::IfThenElseZero(overlap, hn::Mul(weight, hn::Sub(hn::Div(diameter, hn::Sqrt(r2)), one)));
    x = hn::Add(x, hn::NearestInt(hn::Mul(f, n.x)));
    y = hn::Add(y, hn::NearestInt(hn::Mul(f, n.y)));
    z = hn::Add(z, hn::NearestInt(hn::Mul(f, n.z)));
  }
  return {{hn::GetLane(hn::SumOfLanes(di, x)), hn::GetLane(hn::SumOfLanes(di, y)), hn::GetLane(hn::SumOfLanes(di, z))}};
}

void PushApart(const Site* sites, const NearView& near, const std::int32_t* indices, std::size_t count,
               const PushLaw& law, Site* pushes) {
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(indices[k]);
    pushes[k] =
        push_of(sites, sites[i], near.members + i * near.capacity, static_cast<std::size_t>(near.counts[i]), law);
  }
}

#if HWY_TARGET == HWY_SCALAR
std::size_t MoveSites(Site* sites, const Site* listed_at, const std::int32_t* indices, std::size_t count,
                      const Site* displacements, std::size_t stride, const MoveLimits& limits, std::int32_t* renewed) {
  const auto bits = [](std::int32_t a) { return static_cast<std::uint32_t>(a); };
  std::size_t found = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(indices[k]);
    bool away = false;
    for (std::size_t a = 0; a < 3; ++a) {
      std::int32_t& at = sites[i].at[a];
      at = std::clamp(static_cast<std::int32_t>(bits(at) + bits(displacements[stride * k].at[a])), limits.lowest[a],
                      limits.highest[a]);
      const std::int64_t moved = static_cast<std::int32_t>(bits(at) - bits(listed_at[i].at[a]));
      away |= std::abs(moved) > limits.trigger[a];
    }
    renewed[found] = indices[k];
    found += away ? 1U : 0U;
  }
  return found;
}
#else
std::size_t MoveSites(Site* sites, const Site* listed_at, const std::int32_t* indices, std::size_t count,
                      const Site* displacements, std::size_t stride, const MoveLimits& limits, std::int32_t* renewed) {
  const auto lowest = hn::Load(quad, limits.lowest.data()), highest = hn::Load(quad, limits.highest.data()),
             trigger = hn::Load(quad, limits.trigger.data());
  std::size_t found = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(indices[k]);
    const auto step = hn::Load(quad, displacements[stride * k].at.data());
    const auto moved = hn::Min(hn::Max(hn::Add(hn::Load(quad, sites[i].at.data()), step), lowest), highest);
    hn::Store(moved, quad, sites[i].at.data());
    const auto away = hn::Abs(hn::Sub(moved, hn::Load(quad, listed_at[i].at.data())));
    renewed[found] = indices[k];
    found += hn::AllFalse(quad, hn::Gt(away, trigger)) ? 0U : 1U;
  }
  return found;
}
#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb::spot
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb::spot {
HWY_EXPORT(FindWithin);
HWY_EXPORT(FetchWithin);
HWY_EXPORT(PushApart);
HWY_EXPORT(MoveSites);
void find_within(const CellView& cells, const std::array<std::int32_t, 3>& centre, double inner, double outer,
                 Found& found) {
  HWY_DYNAMIC_DISPATCH(FindWithin)(cells, centre, inner, outer, found);
}
void fetch_within(const CellView& cells, const std::array<std::int32_t, 3>& centre, double radius) {
  HWY_DYNAMIC_DISPATCH(FetchWithin)(cells, centre, radius);
}
void push_apart(const Site* sites, const NearView& near, const std::int32_t* indices, std::size_t count,
                const PushLaw& law, Site* pushes) {
  HWY_DYNAMIC_DISPATCH(PushApart)(sites, near, indices, count, law, pushes);
}
std::size_t move_sites(Site* sites, const Site* listed_at, const std::int32_t* indices, std::size_t count,
                       const Site* displacements, std::size_t stride, const MoveLimits& limits, std::int32_t* renewed) {
  return HWY_DYNAMIC_DISPATCH(MoveSites)(sites, listed_at, indices, count, displacements, stride, limits, renewed);
}
}  // namespace grainvdb::spot
#endif
