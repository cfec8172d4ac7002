#include "dense_sums.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "exact_contacts.hpp"
#include "lucy.hpp"

namespace grainvdb::bench {

DenseSums::DenseSums(const Columns3& position, double h, int channels)
    : h_(h), channels_(static_cast<std::size_t>(channels)) {
  openvdb::Coord lo, hi;
  for (int a = 0; a < 3; ++a) {
    const auto& x = position[static_cast<std::size_t>(a)];
    const auto [least, greatest] = std::minmax_element(x.begin(), x.end());
    lo[a] = static_cast<int>(std::floor((*least - 2 * cutoff) / h));
    hi[a] = static_cast<int>(std::ceil((*greatest + 2 * cutoff) / h));
  }
  box_ = {lo, hi};
  const std::size_t voxels = box_.volume();
  count_.resize(voxels);
  sum_.resize(voxels * channels_);
  magnitude_.resize(voxels * channels_);
  values_.resize(voxels * channels_);
}

std::size_t DenseSums::at(int i, int j, int k) const {
  const openvdb::Coord size = box_.dim();
  const openvdb::Coord at = openvdb::Coord(i, j, k) - box_.min();
  return (static_cast<std::size_t>(at.x()) * static_cast<std::size_t>(size.y()) + static_cast<std::size_t>(at.y())) *
             static_cast<std::size_t>(size.z()) +
         static_cast<std::size_t>(at.z());
}

void DenseSums::add(int i, int j, int k, double weight, const double* values) {
  const std::size_t voxel = at(i, j, k);
  ++terms_;
  ++count_[voxel];
  for (std::size_t c = 0; c < channels_; ++c) {
    const double term = weight * values[c];
    sum_[voxel * channels_ + c] += term;
    magnitude_[voxel * channels_ + c] += std::abs(term);
    values_[voxel * channels_ + c] += std::abs(values[c]);
  }
}

double DenseSums::disagreement(const Grids& grids, const Tolerance& tolerance) const {
  // Single precision has no digits below this.
  constexpr double tiny = std::numeric_limits<float>::min();
  double worst = 0;
  if (grids.size() != channels_) return std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < channels_; ++c) {
    const auto accessor = grids[c]->getConstAccessor();
    const openvdb::Coord first = grids[c]->transform().worldToIndexCellCentered({h_ / 2, h_ / 2, h_ / 2});
    std::size_t active = 0;
    for (auto voxel = box_.beginZYX(); voxel; ++voxel) {
      const openvdb::Coord& here = *voxel;
      const std::size_t v = at(here.x(), here.y(), here.z());
      const openvdb::Coord p = here + first;
      const bool reached = count_[v] > 0;
      const bool on = accessor.isValueOn(p);
      active += on ? 1 : 0;
      if (reached != on && !(tolerance.absolute > 0)) return std::numeric_limits<double>::infinity();
      if (!reached && !on) continue;
      const std::size_t n = v * channels_ + c;
      const double allowed = (tolerance.relative + tolerance.per_term * count_[v]) * magnitude_[n] +
                             tolerance.absolute * values_[n] + tiny;
      const double error = std::abs(static_cast<double>(accessor.getValue(p)) - sum_[n]);
      worst = std::max(worst, error / allowed);
      if (std::isnan(error)) return std::numeric_limits<double>::infinity();
    }
    if (active != grids[c]->activeVoxelCount()) return std::numeric_limits<double>::infinity();
  }
  return worst;
}

DenseSums sum_particles(const Scene& scene, double h, std::span<const double> q, int channels) {
  DenseSums sums(scene.position, h, channels);
  for (std::size_t p = 0; p < scene.size(); ++p)
    for_each_weight(scene.position[0][p] / h - 0.5, scene.position[1][p] / h - 0.5, scene.position[2][p] / h - 0.5,
                    cutoff, h, [&](int i, int j, int k, double w) {
                      sums.add(i, j, k, w, q.data() + p * static_cast<std::size_t>(channels));
                    });
  return sums;
}

DenseSums sum_branches(const HalfBranches& branches, double h, std::span<const double> q, int channels) {
  DenseSums sums(branches.start, h, channels);
  for (std::size_t b = 0; b < branches.size(); ++b)
    for_each_line_weight(branches, b, h, [&](int i, int j, int k, double w) {
      sums.add(i, j, k, w, q.data() + b * static_cast<std::size_t>(channels));
    });
  return sums;
}

}  // namespace grainvdb::bench
