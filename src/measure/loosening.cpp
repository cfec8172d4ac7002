#include "measure/loosening.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "measure/grains.hpp"
#include "measure/time_groups.hpp"
#include "measure/weighted_line.hpp"

namespace grainvdb {
namespace {

constexpr double face_width = 2;  // mean diameters

/// From 0 at t ≤ 0 to 1 at t ≥ 1, odd about the middle.
double smooth_step(double t) {
  const double s = std::clamp(t, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

double mean_volume(const std::vector<double>& radius) {
  double sum = 0;
  for (const double r : radius) sum += 4 * std::numbers::pi / 3 * r * r * r;
  return sum / static_cast<double>(radius.size());
}

}  // namespace

double SmoothBox::weight(const Box& box, const Vec3& x, double diameter) const {
  double product = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    const double length = hi[a] - lo[a];
    if (box.periodic[a] && length >= (1 - 1e-9) * box.length(axis)) continue;
    const double inside = 0.5 * length - std::abs(box.minimum_image(axis, x[a] - 0.5 * (lo[a] + hi[a])));
    product *= smooth_step(inside / std::min(face_width * diameter, length) + 0.5);
  }
  return product;
}

Loosening::Sums Loosening::sums_of(const Frame& frame) {
  const Particles& p = frame.particles;
  if (p.size() == 0) return {};
  if (!(diameter_ > 0)) {
    diameter_ = mean_diameter(p.radius);
    grain_volume_ = mean_volume(p.radius);
  }
  Sums sums;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double weight = box_.weight(frame.box, wrapped(frame.box, p.position, i), diameter_) / box_.volume();
    sums.density += weight;
    sums.flux -= weight * p.velocity[up_][i];
  }
  return sums;
}

void Loosening::rest(const Frame& frame) {
  at_rest_ = sums_of(frame).density;
}

void Loosening::add(const Frame& frame) {
  const Sums sums = sums_of(frame);
  density_.push_back(sums.density);
  flux_.push_back(sums.flux);
}

double Loosening::density_at_rest() const {
  if (phi_at_rest_) return *phi_at_rest_ / grain_volume_;
  return at_rest_.value_or(std::numeric_limits<double>::quiet_NaN());
}

Estimate Loosening::number_density() const {
  return mean_by_time_groups(density_);
}

Estimate Loosening::flux() const {
  return mean_by_time_groups(flux_);
}

// About a straight line, for a silo that drains loosens slowly, too.
double Loosening::scatter() const {
  constexpr std::size_t fewest = 4;
  if (density_.size() < fewest) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> index(density_.size());
  for (std::size_t k = 0; k < index.size(); ++k) index[k] = static_cast<double>(k);
  const WeightedLine line = weighted_line(index, density_);
  return std::sqrt(line.chi_square / static_cast<double>(density_.size() - 2));
}

Estimate Loosening::drop() const {
  const Estimate flowing = number_density();
  const double of_rest = phi_at_rest_ ? 0 : scatter();
  return {density_at_rest() - flowing.value, std::hypot(of_rest, flowing.error)};
}

Estimate Loosening::speed() const {
  const double rest = density_at_rest();
  const Estimate speed = by_time_groups(density_.size(), [&](const std::function<bool(std::size_t)>& keeps) {
    double missing = 0, flux = 0;
    for (std::size_t k = 0; k < density_.size(); ++k) {
      if (!keeps(k)) continue;
      missing += rest - density_[k];
      flux += flux_[k];
    }
    return flux / missing;
  });
  const double of_rest = phi_at_rest_ ? 0 : scatter() / drop().value;
  return {speed.value, std::hypot(speed.error, speed.value * of_rest)};
}

}  // namespace grainvdb
