#include "measure/pair_correlation.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "measure/ball_in_box.hpp"
#include "measure/cell_grid.hpp"

namespace grainvdb {
namespace {

/// Grains that one thread takes at a time. Sums of chunks are added in their order, whoever made them.
constexpr std::size_t chunk = 512;

struct Sums {
  explicit Sums(std::size_t bins) : pairs(bins), squares(bins), volume(bins) {}
  std::vector<double> pairs, squares, volume;
  double closest = std::numeric_limits<double>::infinity();
};

/// Where shells about a point end.
FaceDistances faces_about(const Vec3& x, const Box& material) {
  FaceDistances faces{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double half = 0.5 * material.length(static_cast<int>(a));
    if (material.periodic[a])
      faces[a] = {half, half};
    else
      faces[a] = {x[a] - material.lo[a], material.hi[a] - x[a]};
  }
  return faces;
}

void add_shells(const PairCounts& counts, const FaceDistances& faces, std::vector<double>& volume) {
  double inner = 0;
  for (std::size_t k = 0; k < volume.size(); ++k) {
    const double outer = ball_in_box(counts.edge(k + 1), faces);
    volume[k] += outer - inner;
    inner = outer;
  }
}

}  // namespace

PairCounts::PairCounts(double reach, std::size_t bins) : reach_(reach), pairs_(bins), squares_(bins), expected_(bins) {}

void PairCounts::add(const Box& box, const Columns3& position, const CountedRegion& region) {
  ++frames_;
  if (position[0].empty()) return;
  const CellGrid grid(box, position, reach_);
  const Box material = CountedRegion().within(box, position), counted = region.within(box, position);
  std::vector<std::size_t> members;
  std::vector<bool> is_member(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    is_member[i] = region.holds(grid.position(i));
    if (is_member[i]) members.push_back(i);
  }
  const double per_length = static_cast<double>(bins()) / reach_;

  std::vector<Sums> sums((members.size() + chunk - 1) / chunk, Sums(bins()));
  parallel_for(sums.size(), [&](std::size_t c) {
    Sums& mine = sums[c];
    const std::size_t end = std::min(members.size(), (c + 1) * chunk);
    for (std::size_t m = c * chunk; m < end; ++m) {
      grid.neighbours(members[m], [&](std::size_t j, const Vec3& r, double r2) {
        if (!is_nearest_image(box, r)) return;
        const double distance = std::sqrt(r2);
        const std::size_t k = std::min(bins() - 1, static_cast<std::size_t>(distance * per_length));
        mine.closest = std::min(mine.closest, distance);
        ++mine.pairs[k];
        // A pair of counted grains is met twice: one event of weight 2, whose square is 4.
        mine.squares[k] += is_member[j] ? 2 : 1;
      });
      add_shells(*this, faces_about(grid.position(members[m]), material), mine.volume);
    }
  });

  double volume = 1;
  for (int a = 0; a < 3; ++a) volume *= counted.length(a);
  const double density = (static_cast<double>(members.size()) - 1) / volume;
  for (const Sums& s : sums) {
    closest_ = std::min(closest_, s.closest);
    for (std::size_t k = 0; k < bins(); ++k) {
      pairs_[k] += s.pairs[k];
      squares_[k] += s.squares[k];
      expected_[k] += density * s.volume[k];
    }
  }
  grains_ += static_cast<double>(members.size());
  density_ += density;
}

double PairCounts::error(std::size_t k) const {
  return std::sqrt(squares_[k]) / expected_[k];
}

double PairCounts::neighbours(std::size_t k) const {
  double sum = 0;
  for (std::size_t j = 0; j <= k; ++j) sum += pairs_[j];
  return sum / grains_;
}

}  // namespace grainvdb
