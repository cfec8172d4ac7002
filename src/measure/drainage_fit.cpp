#include "measure/drainage_fit.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "grainvdb/kinematic.hpp"

namespace grainvdb {
namespace {

/// What errors for independent points are too small by.
double dependence(std::span<const DrainagePoint> points) {
  double independent = 0;
  for (const DrainagePoint& p : points) independent += p.independent;
  return std::sqrt(static_cast<double>(points.size()) / independent);
}

Estimate estimate(const Fit& fit, std::size_t parameter, double factor) {
  return {fit.parameters[parameter], factor * fit.errors[parameter]};
}

/// Weighted by v, which must be positive somewhere.
struct Moments {
  double sum = 0, mean = 0, variance = 0;
};
std::optional<Moments> moments(std::span<const DrainagePoint> points) {
  Moments m;
  for (const DrainagePoint& p : points) m.sum += p.v;
  if (!(m.sum > 0)) return std::nullopt;
  for (const DrainagePoint& p : points) m.mean += p.v * p.x / m.sum;
  for (const DrainagePoint& p : points) m.variance += p.v * (p.x - m.mean) * (p.x - m.mean) / m.sum;
  return m;
}

/// A e^(-(x-m)²/(2s²)) with the parameters A, m, s².
double gaussian(double x, std::span<const double> p, std::span<double> slopes) {
  const double from_middle = x - p[1];
  const double shape = std::exp(-from_middle * from_middle / (2 * p[2]));
  slopes[0] = shape;
  slopes[1] = p[0] * shape * from_middle / p[2];
  slopes[2] = p[0] * shape * from_middle * from_middle / (2 * p[2] * p[2]);
  return p[0] * shape;
}

DrainageProfile fit_profile(double z, std::span<const DrainagePoint> points) {
  DrainageProfile profile;
  profile.z = z;
  const auto start = moments(points);
  if (!start || !(start->variance > 0)) return profile;
  profile.moment_variance = start->variance;
  double peak = 0;
  FitProblem problem;
  for (const DrainagePoint& p : points) {
    problem.observed.push_back(p.v);
    peak = std::max(peak, p.v);
  }
  // Without a positive variance there is no Gaussian: the logarithm is what is fitted.
  problem.parameters = {{"the peak", peak, peak},
                        {"the middle", start->mean, std::sqrt(start->variance)},
                        {"the logarithm of the variance", std::log(start->variance), 1}};
  problem.model = [&](std::size_t k, std::span<const double> p, std::span<double> slopes) {
    const double natural[] = {p[0], p[1], std::exp(p[2])};
    const double v = gaussian(points[k].x, natural, slopes);
    slopes[2] *= natural[2];
    return v;
  };
  const Fit fit = least_squares(problem);
  if (!fit.fitted()) return profile;
  const double factor = dependence(points);
  const double variance = std::exp(fit.parameters[2]);
  profile.variance = {variance, factor * variance * fit.errors[2]};
  profile.middle = estimate(fit, 1, factor);
  profile.peak = estimate(fit, 0, factor);
  return profile;
}

}  // namespace

std::vector<DrainageProfile> fit_profiles(std::span<const DrainagePoint> points) {
  std::map<double, std::vector<DrainagePoint>> rows;
  for (const DrainagePoint& p : points) rows[p.z].push_back(p);
  std::vector<DrainageProfile> profiles;
  for (const auto& [z, row] : rows) profiles.push_back(fit_profile(z, row));
  return profiles;
}

WidthGrowth fit_width(std::span<const DrainageProfile> profiles) {
  constexpr double rounding = 1e-12;  // no variance is known better
  FitProblem problem;
  std::vector<double> heights;
  double highest = 0;
  double widest = 0;
  for (const DrainageProfile& p : profiles) {
    if (!std::isfinite(p.variance.value) || !std::isfinite(p.variance.error)) continue;
    heights.push_back(p.z);
    problem.observed.push_back(p.variance.value);
    problem.error.push_back(std::max(p.variance.error, rounding * p.variance.value));
    highest = std::max(highest, std::abs(p.z));
    widest = std::max(widest, p.variance.value);
  }
  WidthGrowth growth;
  if (heights.size() < 3) {
    growth.refusal = std::to_string(heights.size()) + " heights have a profile with a width: at least 3 are needed";
    return growth;
  }
  problem.parameters = {{"b", widest / (2 * highest), widest / (2 * highest)}, {"the offset", 0, widest}};
  problem.model = [&](std::size_t k, std::span<const double> p, std::span<double> slopes) {
    slopes[0] = 2 * heights[k];
    slopes[1] = 1;
    return 2 * p[0] * heights[k] + p[1];
  };
  const Fit fit = least_squares(problem);
  growth.refusal = fit.refusal;
  growth.reduced_chi_square = fit.reduced_chi_square();
  const double factor = std::max(1.0, std::sqrt(growth.reduced_chi_square));
  growth.b = estimate(fit, 0, factor);
  growth.offset = estimate(fit, 1, factor);
  return growth;
}

KinematicEstimate fit_kinematic(std::span<const DrainagePoint> points, Origin origin) {
  KinematicEstimate result;
  const auto start = moments(points);
  if (!start || !(start->variance > 0)) {
    result.refusal = "there is no downward flow to fit";
    return result;
  }
  // Σv x²/Σv is of the order of 2bz, and Σv over the points of the order of Q by peak and width.
  double height = 0;
  double peak = 0;
  for (const DrainagePoint& p : points) {
    height += p.z / static_cast<double>(points.size());
    peak = std::max(peak, p.v);
  }
  const double b = start->variance / (2 * height);
  const double discharge = peak * std::sqrt(2 * std::numbers::pi * start->variance);
  FitProblem problem;
  for (const DrainagePoint& p : points) problem.observed.push_back(p.v);
  problem.parameters = {{"ln b", std::log(b), 1}, {"Q", discharge, discharge}};
  if (origin == Origin::fitted) problem.parameters.push_back({"the rise", 0, height});
  const double lowest =
      std::min_element(points.begin(), points.end(), [](const auto& a, const auto& c) { return a.z < c.z; })->z;
  problem.model = [&](std::size_t k, std::span<const double> p, std::span<double> slopes) {
    const DrainagePoint& at = points[k];
    const double rise = origin == Origin::fitted ? p[2] : 0;
    // Steps of the solver that put points below the origin are turned away by a flow that is zero there.
    const double z = at.z + rise;
    std::fill(slopes.begin(), slopes.end(), 0.0);
    if (!(lowest + rise > 0)) return 0.0;
    const KinematicFlow unit{std::exp(p[0]), 1};
    const double v = unit.downward(at.x, z);
    const double spread = at.x * at.x / (4 * unit.b * z);  // v ~ (bz)^-½ e^-spread
    slopes[0] = p[1] * v * (spread - 0.5);
    slopes[1] = v;
    if (origin == Origin::fitted) slopes[2] = slopes[0] / z;
    return p[1] * v;
  };
  const Fit fit = least_squares(problem);
  result.refusal = fit.refusal;
  if (!fit.fitted()) return result;
  const double factor = dependence(points);
  result.b = {std::exp(fit.parameters[0]), factor * std::exp(fit.parameters[0]) * fit.errors[0]};
  result.discharge = estimate(fit, 1, factor);
  result.rise = origin == Origin::fitted ? estimate(fit, 2, factor) : Estimate{0, 0};
  result.rms = std::sqrt(fit.chi_square / static_cast<double>(points.size()));
  return result;
}

}  // namespace grainvdb
