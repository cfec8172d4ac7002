#include "grainvdb/seeds.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>

#include "grainvdb/error.hpp"

namespace grainvdb {
namespace {

constexpr char axes[] = "xyz";

[[noreturn]] void refuse(int axis, const std::string& what, double found) {
  std::ostringstream text;
  text << what << " along " << axes[axis] << ", found " << found;
  throw std::invalid_argument(text.str());
}

/// Places along one axis: `count` of them, `spacing` apart, from `first`.
struct Row {
  double first = 0, spacing = 0, count = 1;
};

Row row_of(const SeedGrid& grid, int axis) {
  const auto a = static_cast<std::size_t>(axis);
  const double lo = grid.lo[a], hi = grid.hi[a], spacing = grid.spacing[a];
  if (!std::isfinite(lo)) refuse(axis, "the bounds of the seeds must be finite", lo);
  if (!std::isfinite(hi)) refuse(axis, "the bounds of the seeds must be finite", hi);
  if (hi < lo) refuse(axis, "the upper bound of the seeds must not be below the lower one", hi);
  if (lo == hi) return {lo, 0, 1};
  if (!(spacing > 0) || !std::isfinite(spacing))
    refuse(axis, "the spacing of the seeds must be positive and finite", spacing);
  // The small allowance keeps a length that is a whole number of spacings but for rounding.
  const double count = std::max(1.0, std::floor((hi - lo) / spacing * (1 + 1e-9)));
  return {lo + (hi - lo - (count - 1) * spacing) / 2, spacing, count};
}

std::vector<std::int64_t> numbers(std::size_t n) {
  std::vector<std::int64_t> id(n);
  std::iota(id.begin(), id.end(), std::int64_t{1});
  return id;
}

}  // namespace

TracerSeeds seeds_on_grid(const SeedGrid& grid) {
  const std::array<Row, 3> rows{row_of(grid, 0), row_of(grid, 1), row_of(grid, 2)};
  const double total = rows[0].count * rows[1].count * rows[2].count;
  if (!(total <= static_cast<double>(grid.most))) {
    std::ostringstream found;
    found << total << " (" << rows[0].count << " × " << rows[1].count << " × " << rows[2].count << ")";
    throw LimitError({{},
                      "too many tracers",
                      found.str(),
                      "at most " + std::to_string(grid.most),
                      "Choose a wider spacing or a smaller region"});
  }
  const auto n = static_cast<std::size_t>(total);
  TracerSeeds seeds{numbers(n), {}};
  std::size_t stride = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const Row& row = rows[a];
    const auto count = static_cast<std::size_t>(row.count);
    seeds.position[a].resize(n);
    for (std::size_t i = 0; i < n; ++i)
      seeds.position[a][i] = row.first + static_cast<double>(i / stride % count) * row.spacing;
    stride *= count;
  }
  return seeds;
}

TracerSeeds seeds_at(std::span<const Vec3> positions) {
  if (positions.empty()) throw std::invalid_argument("there are no seeds");
  TracerSeeds seeds{numbers(positions.size()), {}};
  for (std::size_t i = 0; i < positions.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a) {
      if (!std::isfinite(positions[i][a]))
        refuse(static_cast<int>(a), "the coordinates of seed " + std::to_string(i + 1) + " must be finite",
               positions[i][a]);
      seeds.position[a].push_back(positions[i][a]);
    }
  return seeds;
}

TracerSeeds seeds_on_particles(const Particles& particles, std::span<const std::int64_t> ids) {
  if (ids.empty()) throw std::invalid_argument("there are no seeds");
  TracerSeeds seeds;
  seeds.id.assign(ids.begin(), ids.end());
  std::sort(seeds.id.begin(), seeds.id.end());
  seeds.id.erase(std::unique(seeds.id.begin(), seeds.id.end()), seeds.id.end());
  for (const std::int64_t id : seeds.id) {
    const auto it = std::lower_bound(particles.id.begin(), particles.id.end(), id);
    if (it == particles.id.end() || *it != id)
      throw std::invalid_argument("tracers are to start on particle " + std::to_string(id) +
                                  ", which is not in the frame");
    const auto row = static_cast<std::size_t>(it - particles.id.begin());
    for (std::size_t a = 0; a < 3; ++a) seeds.position[a].push_back(particles.position[a][row]);
  }
  return seeds;
}

}  // namespace grainvdb
