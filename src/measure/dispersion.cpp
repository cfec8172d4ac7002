#include "measure/dispersion.hpp"

#include <algorithm>
#include <cmath>

#include "base/nan.hpp"
#include "measure/grains.hpp"

namespace grainvdb {
namespace {

/// Slope of the least-squares line; through the origin for a single point.
double slope(const std::vector<double>& x, const std::vector<double>& y) {
  if (x.empty()) return nan;
  if (x.size() == 1) return y[0] / x[0];
  const auto n = static_cast<double>(x.size());
  double mx = 0, my = 0, xx = 0, xy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    mx += x[k] / n;
    my += y[k] / n;
  }
  for (std::size_t k = 0; k < x.size(); ++k) {
    xx += (x[k] - mx) * (x[k] - mx);
    xy += (x[k] - mx) * (y[k] - my);
  }
  return xx > 0 ? xy / xx : nan;
}

}  // namespace

void Dispersion::add(const Frame& frame, const MeanMotion& motion) {
  if (!slabs_) slabs_.emplace(region_.within(frame.box, frame.particles.position));
  if (follows_ && is_too_long(frame)) {
    ++refused_;
    follows_ = false;
  }
  if (follows_) {
    take_step(frame);
    record(frame, motion);
    follows_ = lags_ == 0 || lag_ < lags_;
  }
  if (!follows_) begin(frame);
  last_time_ = frame.time;
  has_speeds_ = !frame.particles.velocity[0].empty();
  last_speeds_ = largest_speeds(frame);
}

void Dispersion::begin(const Frame& frame) {
  id_.clear();
  start_ = last_ = moved_ = {};
  lag_ = 0;
  start_time_ = frame.time;
  for (std::size_t i = 0; i < frame.particles.size(); ++i) {
    const Vec3 x = wrapped(frame.box, frame.particles.position, i);
    if (!region_.holds(x)) continue;
    id_.push_back(frame.particles.id[i]);
    push_back(start_, x);
    push_back(last_, x);
    push_back(moved_, {});
  }
  follows_ = true;
}

bool Dispersion::is_too_long(const Frame& frame) const {
  const auto& velocity = frame.particles.velocity;
  if (!frame.time || !last_time_ || velocity[0].empty() || !has_speeds_) return false;
  const double dt = std::abs(*frame.time - *last_time_);
  const Vec3 speeds = largest_speeds(frame);
  for (std::size_t a = 0; a < 3; ++a)
    if (frame.box.periodic[a] &&
        dt * std::max(last_speeds_[a], speeds[a]) > 0.5 * frame.box.length(static_cast<int>(a)))
      return true;
  return false;
}

Vec3 Dispersion::largest_speeds(const Frame& frame) const {
  const Particles& now = frame.particles;
  Vec3 most{};
  if (now.velocity[0].empty()) return most;
  std::size_t k = 0;
  for (const std::int64_t id : id_) {
    while (k < now.size() && now.id[k] < id) ++k;
    if (k == now.size()) break;
    if (now.id[k] != id) continue;
    for (std::size_t a = 0; a < 3; ++a) most[a] = std::max(most[a], std::abs(now.velocity[a][k]));
  }
  return most;
}

void Dispersion::take_step(const Frame& frame) {
  const Particles& now = frame.particles;
  std::size_t kept = 0, k = 0;
  for (std::size_t i = 0; i < id_.size(); ++i) {
    while (k < now.size() && now.id[k] < id_[i]) ++k;
    if (k == now.size() || now.id[k] != id_[i]) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = now.position[a][k];
      const double step = frame.box.minimum_image(static_cast<int>(a), x - last_[a][i]);
      start_[a][kept] = start_[a][i];
      moved_[a][kept] = moved_[a][i] + step;
      last_[a][kept] = x;
    }
    id_[kept++] = id_[i];
  }
  id_.resize(kept);
  for (Columns3* columns : {&start_, &last_, &moved_})
    for (auto& column : *columns) column.resize(kept);
}

void Dispersion::record(const Frame& frame, const MeanMotion& motion) {
  if (sums_.size() <= lag_) sums_.emplace_back();
  Sums& s = sums_[lag_++];
  if (id_.empty()) return;
  const Columns3 rest = fluctuations(motion, start_, moved_);
  Vec3 mean{};
  for (std::size_t i = 0; i < id_.size(); ++i) {
    const std::size_t slab = slabs_->of(vector_at(start_, i));
    ++s.grains[slab];
    for (std::size_t a = 0; a < 3; ++a) {
      s.squares[slab][a] += rest[a][i] * rest[a][i];
      mean[a] += moved_[a][i] / static_cast<double>(id_.size());
    }
  }
  ++s.windows;
  s.travelled += std::hypot(mean[0], mean[1], mean[2]);
  s.time += frame.time && start_time_ ? *frame.time - *start_time_ : nan;
}

double Dispersion::time(std::size_t k) const {
  return sums_[k].time / sums_[k].windows;
}

double Dispersion::travelled(std::size_t k) const {
  return sums_[k].travelled / sums_[k].windows;
}

double Dispersion::grains(std::size_t k) const {
  double sum = 0;
  for (const double n : sums_[k].grains) sum += n;
  return sum;
}

double Dispersion::variance(std::size_t k, std::size_t axis, std::size_t without) const {
  double squares = 0, n = 0;
  for (std::size_t slab = 0; slab < Slabs::count; ++slab) {
    if (slab == without) continue;
    squares += sums_[k].squares[slab][axis];
    n += sums_[k].grains[slab];
  }
  return squares / n;
}

double Dispersion::half_slope(std::size_t axis, Against against, double from, std::size_t without) const {
  std::vector<double> x, y;
  for (std::size_t k = 0; k < lags(); ++k) {
    const double at = against == Against::time ? time(k) : travelled(k), v = variance(k, axis, without);
    if (time(k) < from || !std::isfinite(at) || !std::isfinite(v)) continue;
    x.push_back(at);
    y.push_back(v);
  }
  return 0.5 * slope(x, y);
}

Diffusivity Dispersion::diffusivity(std::size_t axis, Against against, double from) const {
  std::vector<double> left_out;
  for (std::size_t slab = 0; slab < Slabs::count; ++slab)
    if (lags() > 0 && sums_[0].grains[slab] > 0) left_out.push_back(half_slope(axis, against, from, slab));
  return {half_slope(axis, against, from, Slabs::count), jackknife_error(left_out)};
}

}  // namespace grainvdb
