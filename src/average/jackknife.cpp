#include "average/jackknife.hpp"

#include <cmath>
#include <numeric>

#include "base/parallel.hpp"
#include "grainvdb/topology.hpp"

namespace grainvdb {

Jackknife::Jackknife(const SparseField& whole, const std::vector<std::size_t>& frames)
    : whole_(whole), sums_(whole.topology()->leaf_count() * static_cast<std::size_t>(whole.components()) * leaf_size) {
  const auto all = static_cast<double>(std::accumulate(frames.begin(), frames.end(), std::size_t{0}));
  for (const std::size_t m : frames) {
    ratio_.push_back(all / static_cast<double>(m));
    inverse_ += 1 / (ratio_.back() - 1);
  }
}

std::size_t Jackknife::at(std::size_t leaf, int component, int offset) const {
  const auto components = static_cast<std::size_t>(whole_.components());
  return (leaf * components + static_cast<std::size_t>(component)) * leaf_size + static_cast<std::size_t>(offset);
}

void Jackknife::leave_out(std::size_t block, const SparseField& without) {
  const double h = ratio_[block];
  parallel_for(whole_.topology()->leaf_count(), [&](std::size_t leaf) {
    for (int c = 0; c < whole_.components(); ++c) {
      const float* all = whole_.leaf(leaf, c);
      const float* others = without.leaf(leaf, c);
      whole_.topology()->mask(leaf).for_each([&](int v) {
        const double d = static_cast<double>(others[v]) - static_cast<double>(all[v]);
        Sums& sums = sums_[at(leaf, c, v)];
        sums.squares += (h - 1) * d * d;
        sums.plain += d;
        sums.weighed += (1 - 1 / h) * d;
      });
    }
  });
}

double Jackknife::error(std::size_t leaf, int component, int offset) const {
  const Sums& s = sums_[at(leaf, component, offset)];
  const double sum = s.squares - 2 * s.weighed * s.plain + s.weighed * s.weighed * inverse_;
  return std::sqrt((sum < 0 ? 0 : sum) / static_cast<double>(ratio_.size()));
}

}  // namespace grainvdb
