#include "measure/balance.hpp"

#include <cmath>
#include <numeric>

#include "measure/weighted_line.hpp"

namespace grainvdb {
namespace {

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

std::vector<double> integral(const std::vector<double>& x, const std::vector<double>& f) {
  std::vector<double> sum(x.size());
  for (std::size_t k = 1; k < x.size(); ++k) sum[k] = sum[k - 1] + (x[k] - x[k - 1]) * (f[k] + f[k - 1]) / 2;
  return sum;
}

std::vector<double> balanced_stress(const LayerProfile& layer, double gravity) {
  std::vector<double> stress = integral(layer.z, layer.density);
  for (double& s : stress) s *= gravity;
  const double constant = mean_of(layer.normal) - mean_of(stress);
  for (double& s : stress) s += constant;
  return stress;
}

Balance balance_of(const LayerProfile& layer, double gravity) {
  const WeightedLine shear = weighted_line(layer.z, layer.shear);
  const WeightedLine normal = weighted_line(layer.z, layer.normal);
  const double height = layer.z.empty() ? 0 : layer.z.back() - layer.z.front();
  const std::vector<double> expected = balanced_stress(layer, gravity);
  double squares = 0;
  for (std::size_t k = 0; k < expected.size(); ++k) squares += std::pow(layer.normal[k] - expected[k], 2);
  return {shear.y_mean, shear.slope * height / shear.y_mean,
          weighted_line(integral(layer.z, layer.density), layer.normal).slope, normal.slope * height / normal.y_mean,
          std::sqrt(squares / static_cast<double>(expected.size())) / std::abs(normal.y_mean)};
}

Fit fit_drift(const std::vector<double>& time, const std::vector<double>& energy) {
  const double middle = time.empty() ? 0 : mean_of(time);
  const double level = energy.empty() ? 1 : std::abs(mean_of(energy));
  const double length = time.empty() ? 1 : time.back() - time.front();
  FitProblem problem;
  problem.observed = energy;
  problem.parameters = {{"energy", level, level > 0 ? level : 1},
                        {"drift", 0, level > 0 && length > 0 ? level / length : 1}};
  problem.model = [&](std::size_t k, std::span<const double> p, std::span<double> slopes) {
    slopes[0] = 1;
    slopes[1] = time[k] - middle;
    return p[0] + p[1] * slopes[1];
  };
  return least_squares(problem);
}

}  // namespace grainvdb
