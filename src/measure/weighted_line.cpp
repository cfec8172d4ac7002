#include "measure/weighted_line.hpp"

#include <cstddef>

namespace grainvdb {

WeightedLine weighted_line(std::span<const double> x, std::span<const double> y, std::span<const double> error) {
  const auto weight = [&](std::size_t k) { return error.empty() ? 1 : 1 / (error[k] * error[k]); };
  double all = 0;
  WeightedLine line{0, 0, 0, 0};
  for (std::size_t k = 0; k < x.size(); ++k) {
    all += weight(k);
    line.x_mean += weight(k) * x[k];
    line.y_mean += weight(k) * y[k];
  }
  line.x_mean /= all;
  line.y_mean /= all;
  double squares = 0, products = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    squares += weight(k) * (x[k] - line.x_mean) * (x[k] - line.x_mean);
    products += weight(k) * (x[k] - line.x_mean) * (y[k] - line.y_mean);
  }
  line.slope = products / squares;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double residual = y[k] - line.at(x[k]);
    line.chi_square += weight(k) * residual * residual;
  }
  return line;
}

}  // namespace grainvdb
