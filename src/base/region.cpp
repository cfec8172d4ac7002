#include "grainvdb/region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainvdb {
namespace {

constexpr std::int64_t everywhere = std::int64_t{1} << 40;  // beyond all 32-bit indices, with room to grow

std::int64_t leaf_of(std::int64_t voxel) {
  return voxel & ~std::int64_t{leaf_edge - 1};
}

/// Merges intervals that overlap or touch.
template <class Intervals>
Intervals joined(Intervals all) {
  std::sort(all.begin(), all.end());
  Intervals result;
  for (const auto& next : all) {
    if (!result.empty() && next.first <= result.back().second + 1) {
      result.back().second = std::max(result.back().second, next.second);
    } else {
      result.push_back(next);
    }
  }
  return result;
}

/// The first voxel whose centre is at x or beyond.
std::int64_t first_centre(const Lattice& lattice, int axis, double x) {
  const auto far = static_cast<double>(everywhere);
  return static_cast<std::int64_t>(std::ceil(std::clamp(lattice.to_index(axis, x), -far, far)));
}

}  // namespace

Region Region::box(const Lattice& lattice, const Coord& first, const Coord& last) {
  Box box;
  for (int a = 0; a < 3; ++a)
    if (first[a] <= last[a]) box[static_cast<std::size_t>(a)] = wrapped(lattice, a, {{first[a], last[a]}});
  return Region(box);
}

Region Region::box(const Lattice& lattice, const Vec3& lo, const Vec3& hi) {
  Box box;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const Interval interval{first_centre(lattice, a, lo[axis]), first_centre(lattice, a, hi[axis]) - 1};
    if (interval.first <= interval.second) box[axis] = wrapped(lattice, a, {interval});
  }
  return Region(box);
}

Region Region::leaves(std::vector<Coord> origins) {
  std::sort(origins.begin(), origins.end());
  origins.erase(std::unique(origins.begin(), origins.end()), origins.end());
  return Region(std::move(origins));
}

bool Region::empty() const {
  if (const auto* list = std::get_if<List>(&what_)) return list->empty();
  const Box& box = std::get<Box>(what_);
  return std::any_of(box.begin(), box.end(), [](const auto& intervals) { return intervals.empty(); });
}

bool Region::holds(const Coord& leaf) const {
  if (const auto* list = std::get_if<List>(&what_)) return std::binary_search(list->begin(), list->end(), leaf);
  const Box& box = std::get<Box>(what_);
  for (int a = 0; a < 3; ++a) {
    const auto& intervals = box[static_cast<std::size_t>(a)];
    const auto touches = [&](const Interval& i) { return i.first < leaf[a] + leaf_edge && i.second >= leaf[a]; };
    if (std::none_of(intervals.begin(), intervals.end(), touches)) return false;
  }
  return true;
}

Region Region::grown(double voxels) const {
  const auto reach = static_cast<std::int64_t>(std::ceil(voxels));
  if (const auto* list = std::get_if<List>(&what_)) {
    const auto r = static_cast<std::int32_t>(reach);
    List all;
    for (const Coord& leaf : *list) {
      const Coord low = leaf_origin({leaf.x - r, leaf.y - r, leaf.z - r});
      const std::int32_t end = leaf_edge + r;
      for (std::int32_t x = low.x; x < leaf.x + end; x += leaf_edge)
        for (std::int32_t y = low.y; y < leaf.y + end; y += leaf_edge)
          for (std::int32_t z = low.z; z < leaf.z + end; z += leaf_edge) all.push_back({x, y, z});
    }
    return leaves(std::move(all));
  }
  Box box = std::get<Box>(what_);
  for (auto& intervals : box) {
    for (Interval& i : intervals)
      i = {leaf_of(leaf_of(i.first) - reach), leaf_of(leaf_of(i.second) + leaf_edge - 1 + reach) + leaf_edge - 1};
    intervals = joined(std::move(intervals));
  }
  return Region(box);
}

std::vector<Region::Interval> Region::wrapped(const Lattice& lattice, int axis,
                                              const std::vector<Interval>& intervals) {
  const auto& period = lattice.period(axis);
  if (!period) return intervals;
  const std::int64_t begin = period->first;
  const std::int64_t end = begin + period->count;
  std::vector<Interval> all;
  for (const Interval& i : intervals) {
    if (i.second - i.first + 1 >= period->count) return {{begin, end - 1}};
    const std::int64_t behind = (i.first - begin) % period->count;
    const std::int64_t first = begin + behind + (behind < 0 ? period->count : 0);
    const std::int64_t last = first + i.second - i.first;
    all.emplace_back(first, std::min(last, end - 1));
    if (last >= end) all.emplace_back(begin, last - period->count);
  }
  return joined(std::move(all));
}

Region Region::wrapped(const Lattice& lattice) const {
  if (const auto* list = std::get_if<List>(&what_)) {
    List all;
    for (const Coord& leaf : *list) {
      std::array<std::vector<Interval>, 3> along;
      for (int a = 0; a < 3; ++a)
        along[static_cast<std::size_t>(a)] = wrapped(lattice, a, {{leaf[a], leaf[a] + leaf_edge - 1}});
      for (const Interval& x : along[0])
        for (const Interval& y : along[1])
          for (const Interval& z : along[2])
            for (std::int64_t i = leaf_of(x.first); i <= x.second; i += leaf_edge)
              for (std::int64_t j = leaf_of(y.first); j <= y.second; j += leaf_edge)
                for (std::int64_t k = leaf_of(z.first); k <= z.second; k += leaf_edge)
                  all.push_back(
                      {static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), static_cast<std::int32_t>(k)});
    }
    return leaves(std::move(all));
  }
  Box box = std::get<Box>(what_);
  for (int a = 0; a < 3; ++a) {
    auto& intervals = box[static_cast<std::size_t>(a)];
    intervals = wrapped(lattice, a, intervals);
  }
  return Region(box);
}

Region Region::everywhere_along(std::array<bool, 3> axes) const {
  Box box;
  if (const auto* list = std::get_if<List>(&what_)) {
    for (int a = 0; a < 3; ++a) {
      auto& intervals = box[static_cast<std::size_t>(a)];
      for (const Coord& leaf : *list) intervals.emplace_back(leaf[a], leaf[a] + leaf_edge - 1);
      intervals = joined(std::move(intervals));
    }
  } else {
    box = std::get<Box>(what_);
  }
  for (std::size_t a = 0; a < 3; ++a)
    if (axes[a]) box[a] = {{-everywhere, everywhere}};
  return Region(box);
}

Topology Region::clip(const Topology& topology) const {
  std::vector<Coord> origins;
  std::vector<LeafMask> masks;
  const auto* box = std::get_if<Box>(&what_);
  const auto wants = [&](const Coord& voxel) {
    for (int a = 0; a < 3; ++a) {
      const auto& intervals = (*box)[static_cast<std::size_t>(a)];
      const auto has = [&](const Interval& i) { return i.first <= voxel[a] && voxel[a] <= i.second; };
      if (std::none_of(intervals.begin(), intervals.end(), has)) return false;
    }
    return true;
  };
  for (std::size_t l = 0; l < topology.leaf_count(); ++l) {
    const Coord& origin = topology.origin(l);
    if (!holds(origin)) continue;
    LeafMask mask;
    if (box == nullptr) {
      mask = topology.mask(l);
    } else {
      topology.mask(l).for_each([&](int offset) {
        if (wants(voxel_at(origin, offset))) mask.set(offset);
      });
    }
    origins.push_back(origin);
    masks.push_back(mask);
  }
  return {std::move(origins), std::move(masks)};
}

std::optional<Topology::Bounds> Region::clip(const Topology::Bounds& bounds) const {
  Topology::Bounds result = bounds;
  const Box box = std::get<Box>(everywhere_along({false, false, false}).what_);
  std::int32_t* const first[] = {&result.first.x, &result.first.y, &result.first.z};
  std::int32_t* const last[] = {&result.last.x, &result.last.y, &result.last.z};
  for (std::size_t a = 0; a < 3; ++a) {
    if (box[a].empty()) return std::nullopt;
    const std::int64_t low = std::max<std::int64_t>(*first[a], box[a].front().first);
    const std::int64_t high = std::min<std::int64_t>(*last[a], box[a].back().second);
    if (low > high) return std::nullopt;
    *first[a] = static_cast<std::int32_t>(low);
    *last[a] = static_cast<std::int32_t>(high);
  }
  return result;
}

}  // namespace grainvdb
