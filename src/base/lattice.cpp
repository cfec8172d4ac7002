#include "grainvdb/lattice.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace grainvdb {
namespace {

constexpr double max_index = 1 << 30;

}  // namespace

Lattice::Lattice(double voxel, const Vec3& origin) : voxel_(voxel), origin_(origin) {
  if (!(voxel > 0) || !std::isfinite(voxel)) throw std::invalid_argument("the voxel size must be positive and finite");
  for (double x : origin)
    if (!std::isfinite(x)) throw std::invalid_argument("the lattice origin must be finite");
}

void Lattice::set_periods(const Box& box) {
  static constexpr char axes[] = "xyz";
  for (int a = 0; a < 3; ++a) {
    period_[a].reset();
    if (!box.periodic[a]) continue;
    const double n = box.length(a) / voxel_;
    const double whole = std::round(n);
    if (whole < 1 || std::abs(n - whole) > 1e-6 * n) {
      std::ostringstream text;
      text.precision(9);
      text << "the periodic length " << box.length(a) << " along " << axes[a] << " is " << n
           << " voxels, not a whole number; voxel sizes that fit are " << box.length(a) / std::ceil(n);
      if (std::floor(n) >= 1) text << " and " << box.length(a) / std::floor(n);
      throw std::invalid_argument(text.str());
    }
    if (!(whole < max_index) || !(std::abs(to_index(a, box.lo[a])) < max_index)) {
      std::ostringstream text;
      text << "the periodic box is " << n << " voxels long along " << axes[a] << " and begins at voxel "
           << to_index(a, box.lo[a]) << "; at most " << max_index << " can be indexed";
      throw std::invalid_argument(text.str());
    }
    // The first voxel whose centre is inside the box; the small allowance keeps it when rounding puts it below lo.
    const double first = std::ceil(to_index(a, box.lo[a]) - 1e-6);
    period_[a] = Period{static_cast<std::int32_t>(first), static_cast<std::int32_t>(whole), n};
  }
}

Lattice Lattice::in_unit(double size) const {
  Lattice lattice(voxel_ / size, {origin_[0] / size, origin_[1] / size, origin_[2] / size});
  lattice.period_ = period_;
  return lattice;
}

double Lattice::wrap_index(int axis, double u) const {
  if (!period_[axis]) return u;
  const double lo = period_[axis]->first - 0.5;
  const double l = period_[axis]->length;
  const double v = u - l * std::floor((u - lo) / l);
  // Rounding can leave v a hair outside when u lies at a bound.
  return v < lo || v >= lo + l ? lo : v;
}

std::int32_t Lattice::wrap(int axis, std::int32_t i) const {
  if (!period_[axis]) return i;
  const auto& p = *period_[axis];
  const std::int32_t k = (i - p.first) % p.count;
  return p.first + (k < 0 ? k + p.count : k);
}

bool Lattice::contains(int axis, std::int32_t i) const {
  return !period_[axis] || (i >= period_[axis]->first && i < period_[axis]->first + period_[axis]->count);
}

}  // namespace grainvdb
