#include <cmath>
#include <limits>
#include <span>

#include "base/nan.hpp"
#include "grainvdb/spot_diffusion.hpp"
#include "measure/least_squares.hpp"
#include "measure/velocity_correlation.hpp"

namespace grainvdb {
namespace {

/// The radius of a number of them that fits best, with its best amplitude: where the descent starts.
SphereFit best_of_many(const std::vector<double>& r, const std::vector<double>& c) {
  constexpr int tries = 64;
  SphereFit best{1, r.back() / 2};
  double least = std::numeric_limits<double>::infinity();
  for (int t = 1; t <= tries; ++t) {
    const double radius = r.back() * t / tries;
    double ff = 0, fc = 0, cc = 0;
    for (std::size_t k = 0; k < r.size(); ++k) {
      const double f = sphere_law(r[k], radius);
      ff += f * f;
      fc += f * c[k];
      cc += c[k] * c[k];
    }
    if (!(ff > 0) || !(cc - fc * fc / ff < least)) continue;
    least = cc - fc * fc / ff;
    best = {fc / ff, radius};
  }
  return best;
}

}  // namespace

double sphere_law(double r, double radius) {
  return ball_overlap(r, radius);
}

SphereFit fit_sphere_law(const std::vector<double>& r, const std::vector<double>& c) {
  if (r.empty()) return {nan, nan};
  const SphereFit start = best_of_many(r, c);
  FitProblem problem;
  problem.observed = c;
  problem.parameters = {{"amplitude", start.amplitude, 1}, {"radius", start.radius, r.back()}};
  problem.model = [&](std::size_t k, std::span<const double> p, std::span<double> slopes) {
    const double q = r[k] / p[1];
    slopes[0] = sphere_law(r[k], p[1]);
    slopes[1] = q >= 0 && q < 2 ? p[0] * (0.75 * q - 0.1875 * q * q * q) / p[1] : 0;
    return p[0] * slopes[0];
  };
  const Fit fit = least_squares(problem);
  return {fit.parameters[0], fit.parameters[1]};
}

}  // namespace grainvdb
