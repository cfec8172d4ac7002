#include "splat/gather.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>

namespace grainvdb {

LeafWindow::LeafWindow(const Lattice& lattice, const Coord& leaf) : origin(leaf) {
  for (int a = 0; a < 3; ++a) {
    last[a] = leaf_edge - 1;
    if (const auto& period = lattice.period(a)) {
      first[a] = std::max(0, period->first - leaf[a]);
      last[a] = std::min(last[a], period->first + period->count - 1 - leaf[a]);
    }
  }
}

LeafMask LeafWindow::mask() const {
  LeafMask mask;
  if (first == std::array{0, 0, 0} && last == std::array{leaf_edge - 1, leaf_edge - 1, leaf_edge - 1}) {
    mask.words.fill(~std::uint64_t{0});
    return mask;
  }
  for (int i = first[0]; i <= last[0]; ++i)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int k = first[2]; k <= last[2]; ++k) mask.set((i << 6) | (j << 3) | k);
  return mask;
}

namespace {

// Leaves of one row along z, from the first to before the end.
struct LeafRun {
  std::int32_t x, y, first, end;
  auto operator<=>(const LeafRun&) const = default;
};

struct Extent {
  double least, greatest;
};

// In four strands: the next comparison need not wait for the last one.
Extent extent(std::span<const double> x) {
  std::array<double, 4> least{x[0], x[0], x[0], x[0]}, greatest = least;
  for (std::size_t i = 0; i < x.size(); i += 4)
    for (std::size_t k = 0; k < 4; ++k) {
      const double value = x[std::min(i + k, x.size() - 1)];
      least[k] = value < least[k] ? value : least[k];
      greatest[k] = value > greatest[k] ? value : greatest[k];
    }
  return {*std::min_element(least.begin(), least.end()), *std::max_element(greatest.begin(), greatest.end())};
}

// The voxels that the entries of a cell may reach, a box.
struct Reached {
  std::array<std::int32_t, 3> low, high;
  bool none() const { return low[0] > high[0] || low[1] > high[1] || low[2] > high[2]; }
};

Reached reached_by(const Lattice& lattice, const Buckets& buckets, std::size_t cell, double reach) {
  Reached box{};
  for (int a = 0; a < 3; ++a) {
    const auto& index = buckets.index[a];
    const Extent entries = extent(std::span(index.data(), index.size())
                                      .subspan(buckets.start[cell], buckets.start[cell + 1] - buckets.start[cell]));
    box.low[a] = static_cast<std::int32_t>(std::floor(entries.least - reach));
    box.high[a] = static_cast<std::int32_t>(std::ceil(entries.greatest + reach));
    if (const auto& period = lattice.period(a)) {
      box.low[a] = std::max(box.low[a], period->first);
      box.high[a] = std::min(box.high[a], period->first + period->count - 1);
    }
  }
  return box;
}

// Runs in the rows about a row of cells, ascending in z within each. Some leaves are in several.
std::vector<LeafRun> runs_in_reach(const Buckets& buckets, std::span<const Reached> reached) {
  std::vector<LeafRun> runs;
  std::size_t row = 0;  // where the runs about this row of cells begin
  for (std::size_t cell = 0; cell < reached.size(); ++cell) {
    if (cell == 0 || buckets.cells[cell - 1].x != buckets.cells[cell].x ||
        buckets.cells[cell - 1].y != buckets.cells[cell].y)
      row = runs.size();
    if (reached[cell].none()) continue;
    const auto& [low, high] = reached[cell];
    const Coord first = leaf_origin({low[0], low[1], low[2]}), last = leaf_origin({high[0], high[1], high[2]});
    for (std::int32_t x = first.x; x <= last.x; x += leaf_edge)
      for (std::int32_t y = first.y; y <= last.y; y += leaf_edge) {
        const auto same = [&](const LeafRun& r) { return r.x == x && r.y == y && r.end >= first.z; };
        const auto it = std::find_if(runs.begin() + static_cast<std::ptrdiff_t>(row), runs.end(), same);
        if (it == runs.end())
          runs.push_back({x, y, first.z, last.z + leaf_edge});
        else
          it->end = std::max(it->end, last.z + leaf_edge);
      }
  }
  return runs;
}

}  // namespace

std::vector<Coord> leaves_in_reach(const Lattice& lattice, const Buckets& buckets, double reach) {
  std::vector<Reached> reached(buckets.cells.size());
  parallel_for(reached.size(), [&](std::size_t cell) { reached[cell] = reached_by(lattice, buckets, cell, reach); });
  std::vector<LeafRun> runs = runs_in_reach(buckets, reached);
  std::sort(runs.begin(), runs.end());
  std::vector<Coord> leaves;
  for (const LeafRun& run : runs) {
    const bool same_row = !leaves.empty() && leaves.back().x == run.x && leaves.back().y == run.y;
    const std::int32_t first = same_row ? std::max(run.first, leaves.back().z + leaf_edge) : run.first;
    for (std::int32_t z = first; z < run.end; z += leaf_edge) leaves.push_back({run.x, run.y, z});
  }
  return leaves;
}

}  // namespace grainvdb
