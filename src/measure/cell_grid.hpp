#pragma once
/// Who is near whom: the one neighbour search of the measurements of packing structure.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "grainvdb/frame.hpp"

namespace grainvdb {

/// Points sorted into cells that are at least as wide as the search reaches. A search visits all periodic images within
/// reach, in an order that depends on the points alone; for a reach that does not grow with their number its cost does
/// not either. Memory: 32 bytes per point and 4 bytes per cell, of which there are not many more than points.
class CellGrid {
 public:
  /// `reach` > 0 [length]; positions must be finite (std::invalid_argument otherwise).
  CellGrid(const Box& box, const Columns3& position, double reach);

  std::size_t size() const { return point_.size(); }
  double reach() const { return reach_; }
  const Box& box() const { return box_; }
  /// Where point i is, wrapped into the box along periodic axes.
  Vec3 position(std::size_t i) const { return at_[slot_[i]]; }

  /// Calls f(j, r, r²) for every image of a point j within reach of x, r the vector from x to the image.
  template <class F>
  void around(const Vec3& x, const F& f) const {
    search(x, [&](std::size_t slot, const Vec3& r, double r2) { f(static_cast<std::size_t>(point_[slot]), r, r2); });
  }

  /// The same around point i, which is left out; its own periodic images are not.
  template <class F>
  void neighbours(std::size_t i, const F& f) const {
    const std::size_t self = slot_[i];
    search(at_[self], [&](std::size_t slot, const Vec3& r, double r2) {
      if (slot != self || r2 > 0) f(static_cast<std::size_t>(point_[slot]), r, r2);
    });
  }

 private:
  struct Cells {
    std::int64_t first = 0, last = 0;
  };
  Cells range(std::size_t axis, double x) const;

  template <class F>
  void search(const Vec3& x, const F& f) const {
    Vec3 home{};
    for (std::size_t a = 0; a < 3; ++a) home[a] = box_.wrap(static_cast<int>(a), x[a]);
    const std::array<Cells, 3> near{range(0, home[0]), range(1, home[1]), range(2, home[2])};
    const double reach2 = reach_ * reach_;
    Vec3 shift{};
    for (std::int64_t i = near[0].first; i <= near[0].last; ++i) {
      const std::int64_t row = image(0, i, shift) * count_[1];
      for (std::int64_t j = near[1].first; j <= near[1].last; ++j) {
        const std::int64_t column = (row + image(1, j, shift)) * count_[2];
        for (std::int64_t k = near[2].first; k <= near[2].last; ++k) {
          const auto cell = static_cast<std::size_t>(column + image(2, k, shift));
          for (std::size_t slot = start_[cell]; slot < start_[cell + 1]; ++slot) {
            const Vec3& y = at_[slot];
            const Vec3 r{y[0] - home[0] + shift[0], y[1] - home[1] + shift[1], y[2] - home[2] + shift[2]};
            const double r2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
            if (r2 <= reach2) f(slot, r, r2);
          }
        }
      }
    }
  }

  /// The stored cell that cell number n is an image of, and how far the image is from it.
  std::int64_t image(std::size_t axis, std::int64_t n, Vec3& shift) const {
    if (!box_.periodic[axis]) return n;
    const std::int64_t count = count_[axis];
    const std::int64_t periods = n >= 0 ? n / count : -((count - 1 - n) / count);
    shift[axis] = static_cast<double>(periods) * box_.length(static_cast<int>(axis));
    return n - periods * count;
  }

  Box box_;
  double reach_;
  Vec3 origin_{}, width_{};
  std::array<std::int64_t, 3> count_{1, 1, 1};
  std::vector<std::uint32_t> start_;  ///< of each cell, in slots
  std::vector<std::uint32_t> point_;  ///< of each slot
  std::vector<std::uint32_t> slot_;   ///< of each point
  std::vector<Vec3> at_;              ///< of each slot
};

/// How many cells fit along each axis that are at least as wide as `width` [length], wider ones where there would be
/// more than `most` ≥ 1 in all.
std::array<std::int64_t, 3> cell_counts(const Vec3& length, double width, std::size_t most);

/// Whether r is the one image of a difference that counts where every pair counts once: within half a period of the
/// box, -length/2 ≤ r < length/2, along each periodic axis. Rounding at either end, as in crystals, does not change
/// which.
inline bool is_nearest_image(const Box& box, const Vec3& r) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (!box.periodic[a]) continue;
    const double half = 0.5 * box.length(static_cast<int>(a)), hair = 1e-9 * half;
    if (r[a] < -half - hair || r[a] >= half - hair) return false;
  }
  return true;
}

}  // namespace grainvdb
