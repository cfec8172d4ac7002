#include "spot/zone_kernels.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spot/zone_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace grainvdb::spot {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// The cells of one axis that an interval touches: `count` of them from `first`, which may lie outside [0, n) along a
/// periodic axis.
struct CellRange {
  int first = 0;
  int count = 0;
};
/// Of a number that is not below -n.
HWY_INLINE int rounded_down(double x, int n) {
  return static_cast<int>(x + n) - n;
}
HWY_INLINE CellRange cells_between(double lo, double hi, int n, bool periodic) {
  int first = rounded_down(std::max<double>(lo, -n), n), last = rounded_down(hi, n);
  if (periodic) return {first, std::min(last - first + 1, n)};
  first = std::clamp(first, 0, n - 1);
  last = std::clamp(last, 0, n - 1);
  return {first, last - first + 1};
}
HWY_INLINE int wrapped(int cell, int n) {
  return cell < 0 ? cell + n : cell >= n ? cell - n : cell;
}

/// Distance from a coordinate to a cell, in cells.
HWY_INLINE double distance_to(double u, double cell) {
  return std::max({0.0, cell - u, u - cell - 1});
}
/// The same along an axis on which the ball may touch all n cells: either way round, if it is periodic.
HWY_INLINE double distance_in(double u, int cell, int n, bool periodic) {
  const double there = distance_to(u, cell);
  return periodic ? std::min({there, distance_to(u, cell - n), distance_to(u, cell + n)}) : there;
}

void find_cells(const CellView& cells, Ball& ball) {
  ball.runs.clear();
  const double radius = ball.radius + cells.slack;
  std::array<double, 3> u{};  // the centre in cells
  for (std::size_t a = 0; a < 3; ++a)
    u[a] = static_cast<double>(static_cast<std::uint32_t>(ball.centre.at[a])) / cells.per_cell[a];
  const auto range = [&](std::size_t a, double half) HWY_ATTR {
    const double cells_away = half / cells.edge[a];
    return cells_between(u[a] - cells_away, u[a] + cells_away, cells.cells[a], cells.periodic[a]);
  };
  const CellRange along_x = range(0, radius), along_y = range(1, radius);
  for (int i = along_x.first; i < along_x.first + along_x.count; ++i) {
    const double dx = distance_in(u[0], i, cells.cells[0], cells.periodic[0]) * cells.edge[0];
    for (int j = along_y.first; j < along_y.first + along_y.count; ++j) {
      const double dy = distance_in(u[1], j, cells.cells[1], cells.periodic[1]) * cells.edge[1];
      const double rest = radius * radius - dx * dx - dy * dy;
      if (rest <= 0) continue;
      const auto layers = static_cast<std::size_t>(cells.cells[2]);
      const auto column =
          layers * static_cast<std::size_t>(wrapped(i, cells.cells[0]) * cells.cells[1] + wrapped(j, cells.cells[1]));
      const CellRange along_z = range(2, std::sqrt(rest));
      const auto first = static_cast<std::size_t>(wrapped(along_z.first, cells.cells[2]));
      const auto count = static_cast<std::size_t>(along_z.count), before_end = std::min(count, layers - first);
      ball.runs.push_back({column + first, before_end});
      if (before_end < count) ball.runs.push_back({column, count - before_end});
    }
  }
}

HWY_INLINE float square(double radius) {
  return static_cast<float>(radius * radius);
}

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE float squared_distance(const CellView& cells, const Site& centre, const Site& site) {
  float r2[4] = {};
  for (std::size_t a = 0; a < 4; ++a) {
    const std::int32_t from = a < 3 ? centre.at[a] : 0, to = a < 3 ? site.at[a] : site.mark;
    const auto difference =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(to) - static_cast<std::uint32_t>(from));
    const float x = static_cast<float>(difference) * cells.unit[a];
    r2[a] = x * x;
  }
  return (r2[0] + r2[1]) + (r2[2] + r2[3]);
}
HWY_INLINE Site moved_between(const Site& site, const Site& step, const MoveLimits& limits) {
  Site moved = site;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t sum = static_cast<std::uint32_t>(site.at[a]) + static_cast<std::uint32_t>(step.at[a]);
    moved.at[a] = std::clamp(static_cast<std::int32_t>(sum), limits.lowest[a], limits.highest[a]);
  }
  return moved;
}
HWY_INLINE bool is_away(const Site& site, const Site& from, const MoveLimits& limits) {
  bool away = false;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t distance =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(site.at[a]) - static_cast<std::uint32_t>(from.at[a]));
    away |= std::abs(distance) > limits.trigger[a] || site.at[a] < limits.exit[a];
  }
  return away;
}
template <class F>
HWY_INLINE void for_each_place(const CellView& cells, const Ball& ball, const F& f) {
  for (const CellRun& run : ball.runs)
    for (std::size_t cell = run.first; cell < run.first + run.count; ++cell)
      for (std::size_t k = 0; k < static_cast<std::size_t>(cells.rows[cell]) * row_size; ++k)
        f(cell * cells.capacity + k, cell);
}
std::size_t FindWithin(const CellView& cells, Ball& ball, std::int32_t* found) {
  find_cells(cells, ball);
  const auto r2 = square(ball.radius);
  std::size_t count = 0;
  for_each_place(cells, ball, [&](std::size_t i, std::size_t) {
    if (squared_distance(cells, ball.centre, cells.sites[i]) < r2) found[count++] = static_cast<std::int32_t>(i);
  });
  return count;
}
template <bool zoned, bool kept, bool limited>
std::size_t sweep(const CellView& cells, Ball& ball, const Passage& passage, const MoveLimits& limits, Lists& lists) {
  find_cells(cells, ball);
  std::size_t count = 0;
  for_each_place(cells, ball, [&](std::size_t i, std::size_t cell) {
    Site& site = cells.sites[i];
    const float r2 = squared_distance(cells, ball.centre, site);
    if (zoned && r2 < square(ball.radius)) {
      site.mark = Site::in_zone;
      lists.zone[lists.zone_count++] = static_cast<std::int32_t>(i);
    }
    if (!(r2 < square(passage.radius))) return;
    ++count;
    site = moved_between(site, passage.displacement, limits);
    if (is_away(site, kept ? cells.listed_at[i] : cells.middles[cell], limits))
      lists.away[lists.away_count++] = static_cast<std::int32_t>(i);
  });
  return count;
}
std::size_t MoveEach(Site* sites, const Site* listed_at, std::span<const std::int32_t> places,
                     const Site* displacements, const MoveLimits& limits, std::int32_t* away) {
  std::size_t found = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto i = static_cast<std::size_t>(places[k]);
    sites[i] = moved_between(sites[i], displacements[k], limits);
    sites[i].mark = 0;
    if (is_away(sites[i], listed_at[i], limits)) away[found++] = places[k];
  }
  return found;
}

#else

/// One to four sites beside each other in a register: x, y, z, mark, x, y, …
using DI = hn::CappedTag<std::int32_t, 4 * row_size>;
using DF = hn::RebindToFloat<DI>;
using VI = hn::Vec<DI>;
using VF = hn::Vec<DF>;
constexpr DI di;
constexpr DF df;
constexpr std::size_t step = hn::MaxLanes(DI()) / 4;  // sites in a register

HWY_INLINE VI load_sites_at(const Site* site) {
  return hn::LoadU(di, site->at.data());
}
HWY_INLINE VI same(const Site& site) {
  return hn::LoadDup128(di, site.at.data());
}
HWY_INLINE VI same(const std::array<std::int32_t, 4>& values) {
  return hn::LoadDup128(di, values.data());
}
/// |site - centre|² in every lane of a site, (x² + y²) + (z² + mark²).
HWY_INLINE VF squared_distance(VI sites, VI centre, VF unit) {
  const VF x = hn::Mul(hn::ConvertTo(df, hn::Sub(sites, centre)), unit);
  const VF squares = hn::Mul(x, x);
  const VF pairs = hn::Add(squares, hn::Shuffle2301(squares));
  return hn::Add(pairs, hn::Shuffle1032(pairs));
}
HWY_INLINE VI site_numbers() {
  return hn::ShiftRight<2>(hn::Iota(di, 0));
}
HWY_INLINE hn::Mask<DI> first_lanes() {
  return hn::Eq(hn::And(hn::Iota(di, 0), hn::Set(di, 3)), hn::Zero(di));
}
/// Writes the places, from `first` on, of the sites whose lanes are set.
HWY_INLINE std::size_t append(hn::Mask<DI> lanes, std::size_t first, std::int32_t* to) {
  const auto chosen = hn::And(lanes, first_lanes());
  const VI places = hn::Add(site_numbers(), hn::Set(di, static_cast<std::int32_t>(first)));
  hn::StoreU(hn::Compress(places, chosen), di, to);
  return hn::CountTrue(di, chosen);
}

/// Calls f(first place of a register, cell).
template <class F>
HWY_INLINE void for_each_register(const CellView& cells, const Ball& ball, const F& f) {
  for (const CellRun& run : ball.runs)
    for (std::size_t cell = run.first; cell < run.first + run.count; ++cell) {
      const std::size_t first = cell * cells.capacity;
      const std::size_t end = first + static_cast<std::size_t>(cells.rows[cell]) * row_size;
      for (std::size_t place = first; place < end; place += step) f(place, cell);
    }
}

std::size_t FindWithin(const CellView& cells, Ball& ball, std::int32_t* found) {
  find_cells(cells, ball);
  const VI centre = same(ball.centre);
  const VF unit = hn::LoadDup128(df, cells.unit.data());
  const VF r2 = hn::Set(df, square(ball.radius));
  std::int32_t* to = found;
  for_each_register(cells, ball, [&](std::size_t place, std::size_t) HWY_ATTR {
    const auto within = hn::Lt(squared_distance(load_sites_at(cells.sites + place), centre, unit), r2);
    to += append(hn::RebindMask(di, within), place, to);
  });
  return static_cast<std::size_t>(to - found);
}

template <bool zoned, bool kept, bool limited>
std::size_t sweep(const CellView& cells, Ball& ball, const Passage& passage, const MoveLimits& limits, Lists& lists) {
  find_cells(cells, ball);
  const VI centre = same(ball.centre), by = same(passage.displacement), trigger = same(limits.trigger);
  const VI lowest = same(limits.lowest), highest = same(limits.highest), exit = same(limits.exit);
  const VI marked = same(Site{{}, Site::in_zone});
  const VF unit = hn::LoadDup128(df, cells.unit.data());
  const VF inner2 = hn::Set(df, square(passage.radius)), outer2 = hn::Set(df, square(ball.radius));
  const VI one = hn::Set(di, 1);
  VI count = hn::Zero(di);  // of the sites moved, in every lane of a site
  std::int32_t* zone = lists.zone;
  for_each_register(cells, ball, [&](std::size_t place, std::size_t cell) HWY_ATTR {
    const VI sites = load_sites_at(cells.sites + place);
    const VF r2 = squared_distance(sites, centre, unit);
    const auto inner = hn::RebindMask(di, hn::Lt(r2, inner2));
    count = hn::IfThenElse(inner, hn::Add(count, one), count);
    VI moved = hn::IfThenElse(inner, hn::Add(sites, by), sites);
    if constexpr (limited) moved = hn::Min(hn::Max(moved, lowest), highest);
    const VI from = kept ? load_sites_at(cells.listed_at + place) : same(cells.middles[cell]);
    auto away = hn::Gt(hn::Abs(hn::Sub(moved, from)), trigger);
    if constexpr (limited) away = hn::Or(away, hn::And(inner, hn::Lt(moved, exit)));
    if constexpr (zoned) {
      const auto outer = hn::RebindMask(di, hn::Lt(r2, outer2));
      moved = hn::Add(moved, hn::IfThenElseZero(outer, marked));
      zone += append(outer, place, zone);
    }
    hn::StoreU(moved, di, cells.sites[place].at.data());
    if (HWY_UNLIKELY(!hn::AllFalse(di, away)))
      for (std::size_t k = 0; k < step; ++k) {
        const auto lanes_of_site = hn::Eq(site_numbers(), hn::Set(di, static_cast<std::int32_t>(k)));
        if (!hn::AllFalse(di, hn::And(away, lanes_of_site)))
          lists.away[lists.away_count++] = static_cast<std::int32_t>(place + k);
      }
  });
  if constexpr (zoned) lists.zone_count = static_cast<std::size_t>(zone - lists.zone);
  return static_cast<std::size_t>(hn::GetLane(hn::SumOfLanes(di, count))) / 4;
}

using Quad = hn::FixedTag<std::int32_t, 4>;
constexpr Quad quad;

std::size_t MoveEach(Site* sites, const Site* listed_at, std::span<const std::int32_t> places,
                     const Site* displacements, const MoveLimits& limits, std::int32_t* away) {
  const auto lowest = hn::Load(quad, limits.lowest.data()), highest = hn::Load(quad, limits.highest.data()),
             trigger = hn::Load(quad, limits.trigger.data()), exit = hn::Load(quad, limits.exit.data());
  const auto unmarked = hn::FirstN(quad, 3);
  std::size_t found = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto i = static_cast<std::size_t>(places[k]);
    const auto by = hn::Load(quad, displacements[k].at.data());
    const auto sum = hn::IfThenElseZero(unmarked, hn::Add(hn::Load(quad, sites[i].at.data()), by));
    const auto moved = hn::Min(hn::Max(sum, lowest), highest);
    hn::Store(moved, quad, sites[i].at.data());
    const auto distance = hn::Abs(hn::Sub(moved, hn::Load(quad, listed_at[i].at.data())));
    away[found] = places[k];
    found += hn::AllFalse(quad, hn::Or(hn::Gt(distance, trigger), hn::Lt(moved, exit))) ? 0U : 1U;
  }
  return found;
}
#endif

template <bool zoned, bool kept>
std::size_t sweep_limited(const CellView& cells, Ball& ball, const Passage& passage, const MoveLimits& limits,
                          Lists& lists) {
  return passage.limited ? sweep<zoned, kept, true>(cells, ball, passage, limits, lists)
                         : sweep<zoned, kept, false>(cells, ball, passage, limits, lists);
}
std::size_t MoveWithin(const CellView& cells, Ball& ball, const Passage& passage, const MoveLimits& limits,
                       Lists& lists) {
  return cells.listed_at != nullptr ? sweep_limited<false, true>(cells, ball, passage, limits, lists)
                                    : sweep_limited<false, false>(cells, ball, passage, limits, lists);
}
std::size_t MoveAndMark(const CellView& cells, Ball& ball, const Passage& passage, const MoveLimits& limits,
                        Lists& lists) {
  return cells.listed_at != nullptr ? sweep_limited<true, true>(cells, ball, passage, limits, lists)
                                    : sweep_limited<true, false>(cells, ball, passage, limits, lists);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb::spot
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb::spot {
HWY_EXPORT(FindWithin);
HWY_EXPORT(MoveWithin);
HWY_EXPORT(MoveAndMark);
HWY_EXPORT(MoveEach);
std::size_t find_within(const CellView& cells, Ball& ball, std::int32_t* found) {
  return HWY_DYNAMIC_DISPATCH(FindWithin)(cells, ball, found);
}
std::size_t move_within(const CellView& cells, Ball& ball, const Passage& passage, const MoveLimits& limits,
                        Lists& lists) {
  return HWY_DYNAMIC_DISPATCH(MoveWithin)(cells, ball, passage, limits, lists);
}
std::size_t move_and_mark(const CellView& cells, Ball& ball, const Passage& passage, const MoveLimits& limits,
                          Lists& lists) {
  return HWY_DYNAMIC_DISPATCH(MoveAndMark)(cells, ball, passage, limits, lists);
}
std::size_t move_each(Site* sites, const Site* listed_at, std::span<const std::int32_t> places,
                      const Site* displacements, const MoveLimits& limits, std::int32_t* away) {
  return HWY_DYNAMIC_DISPATCH(MoveEach)(sites, listed_at, places, displacements, limits, away);
}
}  // namespace grainvdb::spot
#endif
