#include "splat/gather.hpp"

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
  for (int i = first[0]; i <= last[0]; ++i)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int k = first[2]; k <= last[2]; ++k) mask.set((i << 6) | (j << 3) | k);
  return mask;
}

std::vector<Coord> leaves_in_reach(const Lattice& lattice, const Buckets& buckets, double reach) {
  std::vector<Coord> leaves;
  for (std::size_t cell = 0; cell < buckets.cells.size(); ++cell) {
    std::array<std::int32_t, 3> low{};
    std::array<std::int32_t, 3> high{};
    for (int a = 0; a < 3; ++a) {
      const double* index = buckets.index[a].data();
      const auto [least, greatest] = std::minmax_element(index + buckets.start[cell], index + buckets.start[cell + 1]);
      low[a] = static_cast<std::int32_t>(std::floor(*least - reach));
      high[a] = static_cast<std::int32_t>(std::ceil(*greatest + reach));
      if (const auto& period = lattice.period(a)) {
        low[a] = std::max(low[a], period->first);
        high[a] = std::min(high[a], period->first + period->count - 1);
      }
    }
    if (low[0] > high[0] || low[1] > high[1] || low[2] > high[2]) continue;
    const Coord first = leaf_origin({low[0], low[1], low[2]});
    for (std::int32_t x = first.x; x <= high[0]; x += leaf_edge)
      for (std::int32_t y = first.y; y <= high[1]; y += leaf_edge)
        for (std::int32_t z = first.z; z <= high[2]; z += leaf_edge) leaves.push_back({x, y, z});
  }
  std::sort(leaves.begin(), leaves.end());
  leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
  return leaves;
}

}  // namespace grainvdb
