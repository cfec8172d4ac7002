#include "grainvdb/topology.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace grainvdb {

bool LeafMask::none() const {
  return std::all_of(words.begin(), words.end(), [](std::uint64_t w) { return w == 0; });
}

std::size_t LeafMask::count() const {
  std::size_t n = 0;
  for (std::uint64_t w : words) n += static_cast<std::size_t>(std::popcount(w));
  return n;
}

LeafMask& LeafMask::operator|=(const LeafMask& o) {
  for (std::size_t i = 0; i < words.size(); ++i) words[i] |= o.words[i];
  return *this;
}

Topology::Topology(std::vector<Coord> origins, std::vector<LeafMask> masks) {
  if (origins.size() != masks.size()) throw std::invalid_argument("a topology needs one mask per leaf");
  std::vector<std::size_t> order(origins.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return origins[a] < origins[b]; });
  for (std::size_t i : order) {
    if (masks[i].none()) continue;
    if (!origins_.empty() && origins_.back() == origins[i]) {
      masks_.back() |= masks[i];
    } else {
      origins_.push_back(origins[i]);
      masks_.push_back(masks[i]);
    }
  }
}

std::size_t Topology::active_voxel_count() const {
  return std::accumulate(masks_.begin(), masks_.end(), std::size_t{0},
                         [](std::size_t n, const LeafMask& m) { return n + m.count(); });
}

std::optional<std::size_t> Topology::find(const Coord& origin) const {
  const auto it = std::lower_bound(origins_.begin(), origins_.end(), origin);
  if (it == origins_.end() || *it != origin) return std::nullopt;
  return static_cast<std::size_t>(it - origins_.begin());
}

std::optional<Topology::Bounds> Topology::bounds() const {
  if (origins_.empty()) return std::nullopt;
  constexpr auto huge = std::numeric_limits<std::int32_t>::max();
  Bounds b{{huge, huge, huge}, {-huge, -huge, -huge}};
  for (std::size_t l = 0; l < origins_.size(); ++l)
    masks_[l].for_each([&](int offset) {
      const Coord c = voxel_at(origins_[l], offset);
      b.first = {std::min(b.first.x, c.x), std::min(b.first.y, c.y), std::min(b.first.z, c.z)};
      b.last = {std::max(b.last.x, c.x), std::max(b.last.y, c.y), std::max(b.last.z, c.z)};
    });
  return b;
}

}  // namespace grainvdb
