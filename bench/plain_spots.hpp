#pragma once
/// The spot model as one would write it down, for comparison: positions in double precision, a vector of indices for
/// each cell, every search anew from the cells.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "spot/container.hpp"
#include "spot/particle_store.hpp"
#include "spot/random.hpp"
#include "spot/spot_model.hpp"

namespace grainvdb::bench {

/// The particles by cells of at least that edge. One longer than the box makes one cell: every search looks at all.
class PlainCells {
 public:
  PlainCells(const Box& box, const std::vector<Vec3>& positions, double edge);

  /// Calls f(index) for all particles of the cells that a ball touches.
  template <class F>
  void visit(const Vec3& centre, double radius, F f) const;
  void move(std::size_t i, const Vec3& x);
  void take_out(std::size_t i);

 private:
  std::size_t cell_at(const Vec3& x) const;

  Box box_;
  std::size_t count_[3]{};
  double edge_[3]{};
  std::vector<std::vector<std::size_t>> cells_;
  std::vector<std::size_t> cell_of_;
};

/// Draws the same random numbers as spot::SpotModel, and so makes the same run, but for rounding and for the height at
/// which spots are removed.
class PlainSpots {
 public:
  struct Start {
    spot::Packing packing;
    std::vector<Vec3> spots;
    double top = 0;  ///< where spots are removed
  };
  PlainSpots(const spot::Container& container, Start start, const spot::SpotParameters& parameters, std::uint64_t seed,
             double cell_edge);

  void run_events(std::size_t count);
  const std::vector<std::int64_t>& ids() const { return start_.packing.id; }
  const std::vector<Vec3>& positions() const { return start_.packing.position; }
  bool holds(std::size_t i) const { return here_[i] != 0; }
  const std::vector<Vec3>& spots() const { return start_.spots; }

 private:
  struct Event {
    bool entry = true;
    std::size_t spot = 0;
    Vec3 step{};
  };
  Event draw();
  void enter();
  void step(const Event& event);
  std::vector<std::size_t> within(const Vec3& centre, double radius) const;
  void displace(const Vec3& centre, const Vec3& step);
  void relax(const std::vector<std::size_t>& zone);
  Vec3 difference(const Vec3& from, const Vec3& to) const;
  void put(std::size_t i, Vec3 x);

  spot::Container container_;
  Start start_;
  spot::SpotParameters parameters_;
  spot::Random random_;
  PlainCells cells_;
  std::vector<char> here_, inside_;
  Event next_;
};

template <class F>
void PlainCells::visit(const Vec3& centre, double radius, F f) const {
  std::size_t first[3], number[3];
  for (int a = 0; a < 3; ++a) {
    const auto n = static_cast<std::ptrdiff_t>(count_[a]);
    auto lo = static_cast<std::ptrdiff_t>(std::floor((centre[a] - radius - box_.lo[a]) / edge_[a]));
    auto hi = static_cast<std::ptrdiff_t>(std::floor((centre[a] + radius - box_.lo[a]) / edge_[a]));
    if (!box_.periodic[a]) {
      lo = std::clamp<std::ptrdiff_t>(lo, 0, n - 1);
      hi = std::clamp<std::ptrdiff_t>(hi, 0, n - 1);
    }
    first[a] = static_cast<std::size_t>(((lo % n) + n) % n);
    number[a] = static_cast<std::size_t>(std::min(hi - lo + 1, n));
  }
  for (std::size_t i = 0; i < number[0]; ++i)
    for (std::size_t j = 0; j < number[1]; ++j)
      for (std::size_t k = 0; k < number[2]; ++k) {
        const std::size_t x = (first[0] + i) % count_[0], y = (first[1] + j) % count_[1],
                          z = (first[2] + k) % count_[2];
        for (const std::size_t particle : cells_[(x * count_[1] + y) * count_[2] + z]) f(particle);
      }
}

}  // namespace grainvdb::bench
