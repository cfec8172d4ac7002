#include "measure/loosening.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/nan.hpp"
#include "measure/grains.hpp"
#include "measure/time_groups.hpp"
#include "measure/weighted_line.hpp"

namespace grainvdb {
namespace {

constexpr double face_width = 2;       // mean diameters
constexpr double layer_thickness = 2;  // mean diameters, at least
constexpr double fewest_layers = 3;

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

/// Of a series about a straight line: a silo that drains loosens slowly, too. NaN for fewer than four values.
double scatter(const std::vector<double>& series) {
  if (series.size() < 4) return nan;
  std::vector<double> index(series.size());
  for (std::size_t k = 0; k < index.size(); ++k) index[k] = static_cast<double>(k);
  return std::sqrt(weighted_line(index, series).chi_square / static_cast<double>(series.size() - 2));
}

}  // namespace

SmoothBox SmoothBox::within(const Box& box) const {
  SmoothBox cut = *this;
  for (std::size_t a = 0; a < 3; ++a) {
    cut.lo[a] = std::max(lo[a], box.lo[a]);
    cut.hi[a] = std::min(hi[a], box.hi[a]);
  }
  return cut;
}

double SmoothBox::weight(const Box& box, const Vec3& x, double diameter) const {
  double product = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const double width = std::min(face_width * diameter, hi[a] - lo[a]);
    if (lo[a] > box.lo[a]) product *= smooth_step((x[a] - lo[a]) / width + 0.5);
    if (hi[a] < box.hi[a]) product *= smooth_step((hi[a] - x[a]) / width + 0.5);
  }
  return product;
}

void BoxFlow::add(const Frame& frame, double diameter) {
  if (!is_cut_) box_ = box_.within(frame.box);
  is_cut_ = true;
  const Particles& p = frame.particles;
  double density = 0, flux = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double weight = box_.weight(frame.box, wrapped(frame.box, p.position, i), diameter) / box_.volume();
    density += weight;
    flux -= weight * p.velocity[up_][i];
  }
  density_.push_back(density);
  flux_.push_back(flux);
}

Loosening::Loosening(const SmoothBox& box, std::size_t up, Reference reference)
    : box_(box), up_(up), reference_(reference), whole_(box, up) {}

void Loosening::learn_sizes(const Frame& frame) {
  if (diameter_ > 0 || frame.particles.size() == 0) return;
  diameter_ = mean_diameter(frame.particles.radius);
  grain_volume_ = mean_volume(frame.particles.radius);
  if (reference_ != Reference::layers) return;
  box_ = box_.within(frame.box);
  const double length = box_.hi[up_] - box_.lo[up_];
  const auto count = static_cast<std::size_t>(std::max(fewest_layers, length / (layer_thickness * diameter_)));
  const auto end = [&](std::size_t k) {
    return box_.lo[up_] + length * static_cast<double>(k) / static_cast<double>(count);
  };
  for (std::size_t k = 0; k < count; ++k) {
    SmoothBox layer = box_;
    layer.lo[up_] = end(k);
    layer.hi[up_] = end(k + 1);
    layers_.emplace_back(layer, up_);
  }
}

void Loosening::rest(const Frame& frame) {
  learn_sizes(frame);
  BoxFlow at_rest(box_, up_);
  at_rest.add(frame, diameter_);
  at_rest_ = at_rest.density().front();
}

void Loosening::add(const Frame& frame) {
  learn_sizes(frame);
  whole_.add(frame, diameter_);
  for (BoxFlow& layer : layers_) layer.add(frame, diameter_);
}

Loosening::Result Loosening::result() const {
  if (frames() == 0) return {};
  Result result = reference_ == Reference::rest ? against_rest() : between_layers();
  result.density = mean_by_time_groups(whole_.density());
  result.flux = mean_by_time_groups(whole_.flux());
  result.drop = {result.at_rest.value - result.density.value, std::hypot(result.at_rest.error, result.density.error)};
  return result;
}

Loosening::Result Loosening::against_rest() const {
  Result result;
  if (phi_at_rest_)
    result.at_rest = {*phi_at_rest_ / grain_volume_, 0};
  else
    result.at_rest = {at_rest_.value(), scatter(whole_.density())};
  result.speed = by_time_groups(frames(), [&](const Keeps& keeps) {
    return mean_of(whole_.flux(), keeps) / (result.at_rest.value - mean_of(whole_.density(), keeps));
  });
  const double missing = result.at_rest.value - mean_of(whole_.density(), [](std::size_t) { return true; });
  result.speed.error = std::hypot(result.speed.error, result.speed.value * result.at_rest.error / missing);
  return result;
}

Loosening::Result Loosening::between_layers() const {
  const auto line = [&](const Keeps& keeps) {
    std::vector<double> flux, density;
    for (const BoxFlow& layer : layers_) {
      flux.push_back(mean_of(layer.flux(), keeps));
      density.push_back(mean_of(layer.density(), keeps));
    }
    return std::pair{weighted_line(flux, density), flux};
  };
  const auto [all, flux] = line([](std::size_t) { return true; });
  double squares = 0;
  for (const double j : flux) squares += (j - all.x_mean) * (j - all.x_mean);
  const double of_layers = std::sqrt(all.chi_square / static_cast<double>(layers_.size() - 2) / squares);
  const Estimate slope = by_time_groups(frames(), [&](const Keeps& keeps) { return line(keeps).first.slope; });
  const double error = std::max(of_layers, std::isfinite(slope.error) ? slope.error : 0);
  Result result;
  result.speed = {-1 / slope.value, error / (slope.value * slope.value)};
  result.at_rest = {
      all.at(0), std::hypot(all.x_mean * error, of_layers * std::sqrt(squares / static_cast<double>(layers_.size())))};
  return result;
}

}  // namespace grainvdb
