#include "splat/plane_sums.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include "base/parallel.hpp"
#include "grainvdb/moment.hpp"

namespace grainvdb {
namespace {

// Sums over so many parts of the entries at most are added up in their order, whatever threads make them.
constexpr std::size_t most_parts = 16;
constexpr std::size_t least_per_part = 2048;

/// Planes first … last, not wrapped.
struct PlaneRange {
  std::int32_t first, last;
};

class PlaneGather {
 public:
  explicit PlaneGather(const PlaneSources& entries)
      : entries_(entries), h_(entries.lattice.voxel()), reach_(entries.kernel.cutoff() / entries.lattice.voxel()) {
    const auto& period = entries.lattice.period(entries.axis);
    all_ = period ? PlaneRange{period->first, period->first + period->count - 1}
                  : PlaneRange{std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min()};
    if (period) return;
    for (std::size_t e = 0; e < size(); ++e) {
      const PlaneRange own = range(e, place(e));
      all_.first = std::min(all_.first, own.first);
      all_.last = std::max(all_.last, own.last);
    }
  }

  std::size_t size() const { return entries_.start.size(); }
  std::int32_t first() const { return all_.first; }
  std::size_t planes() const {
    return size() == 0 || all_.last < all_.first ? 0 : static_cast<std::size_t>(all_.last - all_.first) + 1;
  }

  /// Calls f(row, z), z from the entry's start to the plane [length], for the planes that entry e reaches.
  template <class F>
  void for_each_plane(std::size_t e, const F& f) const {
    const double at = place(e);
    const PlaneRange own = range(e, at);
    for (std::int32_t plane = own.first; plane <= own.last; ++plane)
      f(static_cast<std::size_t>(entries_.lattice.wrap(entries_.axis, plane) - all_.first), (plane - at) * h_);
  }

  /// add(e, z, sums of the plane) for every entry and plane.
  template <class Add>
  PlaneSums sums(int channels, const Add& add) const {
    const auto width = static_cast<std::size_t>(channels);
    PlaneSums result;
    result.channels = channels;
    result.first = first();
    result.values.resize(planes() * width);
    const std::size_t per_part = std::max(least_per_part, (size() + most_parts - 1) / most_parts);
    std::vector<std::vector<double>> parts((size() + per_part - 1) / per_part);
    parallel_for(parts.size(), [&](std::size_t n) {
      parts[n].resize(result.values.size());
      const std::size_t end = std::min(size(), (n + 1) * per_part);
      for (std::size_t e = n * per_part; e < end; ++e)
        for_each_plane(e, [&](std::size_t row, double z) { add(e, z, parts[n].data() + row * width); });
    });
    for (const std::vector<double>& some : parts)
      for (std::size_t n = 0; n < some.size(); ++n) result.values[n] += some[n];
    return result;
  }

 private:
  double arm(std::size_t e) const { return entries_.arm == nullptr ? 0 : (*entries_.arm)[e]; }
  double place(std::size_t e) const {
    return entries_.lattice.wrap_index(entries_.axis, entries_.lattice.to_index(entries_.axis, entries_.start[e]));
  }
  PlaneRange range(std::size_t e, double at) const {
    const double end = at - arm(e) / h_;
    const double low = std::min(at, end) - reach_, high = std::max(at, end) + reach_;
    if (!(low > std::numeric_limits<std::int32_t>::min() / 2 && high < std::numeric_limits<std::int32_t>::max() / 2))
      throw std::invalid_argument("position " + std::to_string(entries_.start[e]) +
                                  " does not fit the voxel index range");
    return {static_cast<std::int32_t>(std::floor(low)) + 1, static_cast<std::int32_t>(std::ceil(high)) - 1};
  }

  const PlaneSources& entries_;
  double h_;
  double reach_;
  PlaneRange all_{};
};

void require_values(const PlaneSources& entries, std::span<const double> q, int channels) {
  if (channels < 1 || q.size() != entries.start.size() * static_cast<std::size_t>(channels))
    throw std::invalid_argument("the splat needs one value per entry and channel");
}

/// Σ q weight(entry, z).
template <class Weight>
PlaneSums weighed_sums(const PlaneSources& entries, std::span<const double> q, int channels, const Weight& weight) {
  require_values(entries, q, channels);
  const auto width = static_cast<std::size_t>(channels);
  return PlaneGather(entries).sums(channels, [&](std::size_t e, double z, double* sums) {
    const double w = weight(e, z);
    for (std::size_t c = 0; c < width; ++c) sums[c] += q[e * width + c] * w;
  });
}

}  // namespace

ReachedPlanes reached_planes(const PlaneSources& entries) {
  const PlaneGather gather(entries);
  ReachedPlanes planes{gather.first(), std::vector<char>(gather.planes())};
  for (std::size_t e = 0; e < gather.size(); ++e)
    gather.for_each_plane(e, [&](std::size_t row, double) { planes.reached[row] = 1; });
  return planes;
}

PlaneSums sum_on_planes(const PlaneSources& points, std::span<const double> q, int channels) {
  return weighed_sums(points, q, channels, [&](std::size_t, double z) { return points.kernel.marginal(z); });
}

PlaneSums sum_gradients_on_planes(const PlaneSources& points, std::span<const double> q, int channels) {
  return weighed_sums(points, q, channels, [&](std::size_t, double z) { return points.kernel.marginal_gradient(z); });
}

PlaneSums sum_branches_on_planes(const PlaneSources& branches, std::span<const double> q, int channels) {
  if (branches.arm == nullptr || branches.arm->size() != branches.start.size())
    throw std::invalid_argument("the splat needs one arm per branch");
  return weighed_sums(branches, q, channels, [&](std::size_t e, double z) {
    return branches.kernel.marginal_line_integral(z, (*branches.arm)[e]);
  });
}

PlaneSums sum_second_moments_on_planes(const PlaneSources& points, std::span<const double> q) {
  using SM = SecondMoments;
  require_values(points, q, 4);
  const auto axis = static_cast<std::size_t>(points.axis);
  return PlaneGather(points).sums(SM::channels, [&](std::size_t e, double z, double* sums) {
    const double* value = q.data() + 4 * e;
    const double w = value[0] * points.kernel.marginal(z), r = -z;
    sums[SM::weight] += w;
    sums[SM::place + axis] += w * r;
    sums[SM::place_square + SM::pair(axis, axis)] += w * r * r;
    for (std::size_t i = 0; i < 3; ++i) {
      const double v = value[1 + i] / value[0];
      sums[SM::velocity + i] += w * v;
      sums[SM::velocity_place + 3 * i + axis] += w * v * r;
      for (std::size_t j = i; j < 3; ++j)
        sums[SM::velocity_square + SM::pair(i, j)] += w * v * (value[1 + j] / value[0]);
    }
  });
}

}  // namespace grainvdb
