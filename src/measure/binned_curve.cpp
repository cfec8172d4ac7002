#include "measure/binned_curve.hpp"

#include <cmath>
#include <stdexcept>

#include "base/nan.hpp"

namespace grainvdb {
namespace {}  // namespace

void RunningMoments::add(double value) {
  ++count_;
  const double before = value - mean_;
  mean_ += before / static_cast<double>(count_);
  squares_ += before * (value - mean_);
}

double RunningMoments::spread() const {
  return count_ > 1 ? std::sqrt(squares_ / static_cast<double>(count_ - 1)) : nan;
}

BinnedCurve::BinnedCurve(double width) : width_(width) {
  if (!(width > 0)) throw std::invalid_argument("bins need a width > 0");
}

void BinnedCurve::add(double x, double y) {
  const double bin = std::floor(x / width_);
  if (!(std::abs(bin) < 1e15) || !std::isfinite(y)) return;
  all_.add(y);
  bins_[static_cast<std::int64_t>(bin)].add(y);
}

std::vector<BinnedCurve::Bin> BinnedCurve::bins() const {
  std::vector<Bin> all;
  for (const auto& [number, moments] : bins_) all.push_back({(static_cast<double>(number) + 0.5) * width_, moments});
  return all;
}

double BinnedCurve::scatter() const {
  if (count() <= bins_.size()) return nan;
  double squares = 0;
  for (const auto& [number, moments] : bins_) squares += moments.squares();
  return std::sqrt(squares / static_cast<double>(count() - bins_.size()));
}

double BinnedCurve::collapse() const {
  const double all = spread();
  const double left = scatter();
  return all > 0 ? 1 - left * left / (all * all) : nan;
}

double BinnedCurve::collapse_noise() const {
  if (count() <= bins_.size()) return nan;
  const auto n = static_cast<double>(count());
  const auto b = static_cast<double>(bins_.size());
  return std::sqrt(2 * (b - 1) / ((n - b) * (n + 1)));
}

}  // namespace grainvdb
