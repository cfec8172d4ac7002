#include "bin/buckets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/parallel.hpp"
#include "grainvdb/topology.hpp"

namespace grainvdb {
namespace {

// The images of one coordinate: u + k n for k = first … last.
struct Images {
  double u = 0;
  std::int64_t first = 0;
  std::int64_t last = 0;
};

[[noreturn]] void refuse(double x) {
  throw std::invalid_argument("position " + std::to_string(x) + " does not fit the voxel index range");
}

// Whether the leaves within `reach` (in voxels) of index position u can be numbered.
bool fits(double u, double reach) {
  constexpr double largest = std::numeric_limits<std::int32_t>::max() - 4 * leaf_edge;
  return std::abs(u) + 2 * reach < largest;
}

// The wrapped coordinate, and those of its images from which a voxel of the stored period is within `reach` (in
// voxels).
Images images(const Lattice& lattice, int axis, double x, double reach) {
  const double u = lattice.wrap_index(axis, lattice.to_index(axis, x));
  if (!fits(u, reach)) refuse(x);
  const auto& period = lattice.period(axis);
  if (!period) return {u, 0, 0};
  const double n = period->count;
  return {u, static_cast<std::int64_t>(std::ceil((period->first - reach - u) / n)),
          static_cast<std::int64_t>(std::floor((period->first + n - 1 + reach - u) / n))};
}

// The voxel that holds index position u.
std::int32_t voxel(double u) {
  // What std::floor gives, which is a call where the processor has no instruction for it by default.
  const double x = u + 0.5;
  const auto toward_zero = static_cast<std::int32_t>(x);
  return toward_zero - (toward_zero > x ? 1 : 0);
}
// Origin of its leaf cell.
std::int32_t cell(double u) {
  return voxel(u) & ~(leaf_edge - 1);
}

using Order = std::vector<std::uint32_t>;

// An image of a point. What belongs to one lies together: sorted order jumps from one to another.
struct Image {
  Vec3 index;
  std::uint32_t point;
};

// Images of all points before they are sorted, in ascending order of their points.
struct Unsorted {
  explicit Unsorted(std::size_t entries) : count(entries), image(std::make_unique_for_overwrite<Image[]>(entries)) {}
  std::size_t count;
  std::unique_ptr<Image[]> image;
};

/// The images of a point: calls f(u) with the index position of each one that is wanted.
class PointImages {
 public:
  PointImages(const Lattice& lattice, const Columns3& position, double reach, const std::optional<Region>& cells)
      : lattice_(lattice), position_(position), reach_(reach), cells_(cells) {}

  template <class F>
  void for_each(std::size_t p, const F& f) const {
    std::array<Images, 3> image;
    for (int a = 0; a < 3; ++a) image[a] = images(lattice_, a, position_[a][p], reach_);
    std::array<std::int64_t, 3> k{};
    for (k[0] = image[0].first; k[0] <= image[0].last; ++k[0])
      for (k[1] = image[1].first; k[1] <= image[1].last; ++k[1])
        for (k[2] = image[2].first; k[2] <= image[2].last; ++k[2]) {
          Vec3 u;
          for (int a = 0; a < 3; ++a) {
            const auto& period = lattice_.period(a);
            u[a] = period ? image[a].u + static_cast<double>(k[a]) * period->count : image[a].u;
          }
          if (!cells_ || cells_->holds({cell(u[0]), cell(u[1]), cell(u[2])})) f(u);
        }
  }
  bool one_each() const { return !cells_ && !lattice_.period(0) && !lattice_.period(1) && !lattice_.period(2); }
  /// The only one of each point.
  Vec3 only(std::size_t p) const {
    Vec3 u;
    for (int a = 0; a < 3; ++a) {
      u[a] = lattice_.to_index(a, position_[a][p]);
      if (!fits(u[a], reach_)) refuse(position_[a][p]);
    }
    return u;
  }

 private:
  const Lattice& lattice_;
  const Columns3& position_;
  double reach_;  // in voxels
  const std::optional<Region>& cells_;
};

Unsorted all_images(const PointImages& images, std::size_t points) {
  if (images.one_each()) {
    Unsorted all(points);
    parallel_for(points, [&](std::size_t p) { all.image[p] = {images.only(p), static_cast<std::uint32_t>(p)}; });
    return all;
  }
  std::vector<std::size_t> start(points + 1);
  parallel_for(points, [&](std::size_t p) { images.for_each(p, [&](const Vec3&) { ++start[p + 1]; }); });
  std::partial_sum(start.begin(), start.end(), start.begin());
  if (start.back() > std::numeric_limits<std::uint32_t>::max()) throw std::invalid_argument("too many periodic images");

  Unsorted all(start.back());
  parallel_for(points, [&](std::size_t p) {
    std::size_t e = start[p];
    images.for_each(p, [&](const Vec3& u) { all.image[e++] = {u, static_cast<std::uint32_t>(p)}; });
  });
  return all;
}

// The cells along one axis as numbers from 0.
struct Axis {
  Axis(std::size_t which, const Unsorted& all) : axis(which) {
    double least = all.image[0].index[axis], greatest = least;
    for (std::size_t e = 1; e < all.count; ++e) {
      least = std::min(least, all.image[e].index[axis]);
      greatest = std::max(greatest, all.image[e].index[axis]);
    }
    base = cell(least);
    count = static_cast<std::uint64_t>(std::int64_t{cell(greatest)} - base) / leaf_edge + 1;
  }
  // Of the half of a cell that holds an entry: twice its cell's number, and one in the upper half.
  std::uint64_t half(const Image& image) const {
    return static_cast<std::uint64_t>(std::int64_t{voxel(image.index[axis])} - base) / (leaf_edge / 2);
  }
  std::uint64_t number(const Image& image) const { return half(image) / 2; }
  std::size_t axis;
  std::int64_t base = 0;
  std::uint64_t count = 0;
};

// Stable sort of `order` by key(entry) < range.
template <class Key>
void counting_sort(std::size_t range, const Key& key, Order& order) {
  Order sorted(order.size());
  std::vector<std::uint32_t> begin(range + 1);
  for (const std::uint32_t e : order) ++begin[key(e) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  for (const std::uint32_t e : order) sorted[begin[key(e)]++] = e;
  order.swap(sorted);
}

// The entries ordered by cell and eighth. One counting sort does where the cells are not many more than the entries;
// where material is spread thinly, digits of 16 bits of one axis after the other keep the memory in proportion to the
// entries.
Order by_cell(const Unsorted& all) {
  Order order(all.count);
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  const std::array<Axis, 3> axis{Axis(0, all), Axis(1, all), Axis(2, all)};
  const double cells =
      static_cast<double>(axis[0].count) * static_cast<double>(axis[1].count) * static_cast<double>(axis[2].count);
  if (cells <= 128 + static_cast<double>(order.size())) {
    std::vector<std::uint32_t> number(order.size());
    parallel_for(number.size(), [&](std::size_t e) {
      const Image& image = all.image[e];
      const std::array<std::uint64_t, 3> half{axis[0].half(image), axis[1].half(image), axis[2].half(image)};
      const std::uint64_t cell_number = ((half[0] / 2) * axis[1].count + half[1] / 2) * axis[2].count + half[2] / 2;
      number[e] = static_cast<std::uint32_t>(8 * cell_number + 4 * (half[0] % 2) + 2 * (half[1] % 2) + half[2] % 2);
    });
    counting_sort(
        8 * static_cast<std::size_t>(cells), [&](std::uint32_t e) { return number[e]; }, order);
    return order;
  }
  const auto eighth = [&](std::uint32_t e) {
    const Image& image = all.image[e];
    return 4 * (axis[0].half(image) % 2) + 2 * (axis[1].half(image) % 2) + axis[2].half(image) % 2;
  };
  counting_sort(8, eighth, order);
  for (std::size_t a = 3; a-- > 0;)
    for (unsigned shift = 0; shift < 32 && ((axis[a].count - 1) >> shift) != 0; shift += 16)
      counting_sort(
          std::size_t{1} << 16, [&](std::uint32_t e) { return (axis[a].number(all.image[e]) >> shift) & 0xffff; },
          order);
  return order;
}

// Fills in the cells of entries that are in their order, and where cells and their eighths begin.
Buckets with_cells(Buckets b) {
  const std::size_t entries = b.point.size();
  for (std::size_t k = 0; k < entries; ++k) {
    const Coord at{voxel(b.index[0][k]), voxel(b.index[1][k]), voxel(b.index[2][k])};
    if (const Coord c = leaf_origin(at); b.cells.empty() || c != b.cells.back()) {
      b.cells.push_back(c);
      b.start.push_back(k);
    }
    const auto upper = [](std::int32_t x) { return (static_cast<std::uint32_t>(x) >> 2U) & 1U; };
    const std::size_t eighth = 8 * (b.cells.size() - 1) + 4 * upper(at.x) + 2 * upper(at.y) + upper(at.z);
    while (b.eighth.size() <= eighth) b.eighth.push_back(k);
  }
  b.start.push_back(entries);
  b.eighth.resize(8 * b.cells.size() + 1, entries);
  return b;
}

}  // namespace

Buckets bin_points(const Lattice& lattice, const Columns3& position, double reach, const Region* wanted) {
  if (!(reach >= 0) || !std::isfinite(reach)) throw std::invalid_argument("the reach must be finite and not negative");
  if (position[0].size() > std::numeric_limits<std::uint32_t>::max()) throw std::invalid_argument("too many points");

  if (position[0].empty()) return with_cells({});
  const double voxels = reach / lattice.voxel();
  const std::optional<Region> cells = wanted == nullptr ? std::nullopt : std::optional(wanted->grown(voxels));
  const Unsorted all = all_images({lattice, position, voxels, cells}, position[0].size());
  const std::size_t entries = all.count;
  if (entries == 0) return with_cells({});
  const Order order = by_cell(all);

  Buckets b;
  b.point.resize(entries);
  for (auto& column : b.index) column.resize(entries);
  for (auto& column : b.local) column.resize(entries + Buckets::padding);
  parallel_for(entries, [&](std::size_t k) {
    constexpr std::size_t ahead = 16;
    if (k + ahead < entries) __builtin_prefetch(&all.image[order[k + ahead]]);
    const Image& image = all.image[order[k]];
    b.point[k] = image.point;
    for (std::size_t a = 0; a < 3; ++a) {
      b.index[a][k] = image.index[a];
      b.local[a][k] = static_cast<float>(image.index[a] - (cell(image.index[a]) + 3.5));
    }
  });
  return with_cells(std::move(b));
}

Buckets keep_points(const Buckets& all, std::span<const int> number, int wanted) {
  std::vector<std::uint32_t> place(number.size());  // of each point among those that are kept
  std::uint32_t kept = 0;
  for (std::size_t p = 0; p < number.size(); ++p)
    if (number[p] == wanted) place[p] = kept++;
  Buckets some;
  for (std::size_t e = 0; e < all.point.size(); ++e) {
    const std::uint32_t p = all.point[e];
    if (number[p] != wanted) continue;
    some.point.push_back(place[p]);
    for (std::size_t a = 0; a < 3; ++a) {
      some.index[a].push_back(all.index[a][e]);
      some.local[a].push_back(all.local[a][e]);
    }
  }
  for (auto& column : some.local) column.resize(some.point.size() + Buckets::padding);
  return with_cells(std::move(some));
}

}  // namespace grainvdb
