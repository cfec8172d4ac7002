#include "splat/gather.hpp"

#include <limits>

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

std::vector<Coord> leaves_in_reach(const Lattice& lattice, const Buckets& buckets, double reach) {
  std::vector<Coord> leaves;
  // Cells come ascending in z within a row of the same x and y: each row of leaves they reach is added to where it
  // ended, so that neighbours in a row add little twice.
  struct Row {
    std::int32_t x, y, end;
  };
  std::vector<Row> rows;
  const auto row = [&](std::int32_t x, std::int32_t y) -> Row& {
    for (Row& r : rows)
      if (r.x == x && r.y == y) return r;
    return rows.emplace_back(Row{x, y, std::numeric_limits<std::int32_t>::min()});
  };
  struct Range {
    std::array<std::int32_t, 3> low, high;
  };
  std::vector<Range> reached(buckets.cells.size());
  parallel_for(reached.size(), [&](std::size_t cell) {
    for (int a = 0; a < 3; ++a) {
      auto& low = reached[cell].low[a];
      auto& high = reached[cell].high[a];
      const double* index = buckets.index[a].data();
      const auto [least, greatest] = std::minmax_element(index + buckets.start[cell], index + buckets.start[cell + 1]);
      low = static_cast<std::int32_t>(std::floor(*least - reach));
      high = static_cast<std::int32_t>(std::ceil(*greatest + reach));
      if (const auto& period = lattice.period(a)) {
        low = std::max(low, period->first);
        high = std::min(high, period->first + period->count - 1);
      }
    }
  });
  for (std::size_t cell = 0; cell < buckets.cells.size(); ++cell) {
    if (cell == 0 || buckets.cells[cell - 1].x != buckets.cells[cell].x ||
        buckets.cells[cell - 1].y != buckets.cells[cell].y)
      rows.clear();
    const auto& [low, high] = reached[cell];
    if (low[0] > high[0] || low[1] > high[1] || low[2] > high[2]) continue;
    const Coord first = leaf_origin({low[0], low[1], low[2]});
    for (std::int32_t x = first.x; x <= high[0]; x += leaf_edge)
      for (std::int32_t y = first.y; y <= high[1]; y += leaf_edge) {
        Row& r = row(x, y);
        for (std::int32_t z = std::max(first.z, r.end); z <= high[2]; z += leaf_edge) {
          leaves.push_back({x, y, z});
          r.end = z + leaf_edge;
        }
      }
  }
  std::sort(leaves.begin(), leaves.end());
  leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
  return leaves;
}

}  // namespace grainvdb
