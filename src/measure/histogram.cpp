#include "measure/histogram.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace grainvdb {

Histogram::Histogram(double lo, double hi, std::size_t bins)
    : lo_(lo), width_((hi - lo) / static_cast<double>(bins)), weights_(bins) {
  if (bins == 0 || !(lo < hi)) throw std::invalid_argument("a histogram needs lo < hi and a bin at least");
}

void Histogram::add(double value, double weight) {
  if (std::isnan(value) || !(weight > 0)) return;
  total_ += weight;
  const double hi = lo_ + width_ * static_cast<double>(bins());
  if (value < lo_ || value > hi) {
    outside_ += weight;
  } else {
    weights_[std::min(bins() - 1, static_cast<std::size_t>((value - lo_) / width_))] += weight;
  }
}

double Histogram::density(std::size_t bin) const {
  return weights_[bin] / (total_ * width_);
}

double Histogram::outside() const {
  return outside_ / total_;
}

std::vector<double> Histogram::centres() const {
  std::vector<double> all;
  for (std::size_t k = 0; k < bins(); ++k) all.push_back(centre(k));
  return all;
}

std::vector<double> Histogram::densities() const {
  std::vector<double> all;
  for (std::size_t k = 0; k < bins(); ++k) all.push_back(density(k));
  return all;
}

}  // namespace grainvdb
