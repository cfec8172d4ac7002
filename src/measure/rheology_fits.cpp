#include "measure/rheology_fits.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/nan.hpp"
#include "measure/weighted_line.hpp"

namespace grainvdb {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double pressure_of(const RheologyData& data, std::size_t k) {
  return data.soft_pressure.empty() ? 0 : data.soft_pressure[k];
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

/// Whether p* is given and differs from 0 anywhere: else nothing tells of softness.
bool soft(const RheologyData& data) {
  return largest(data.soft_pressure) > 0;
}

/// I/(I₀+I), which μ is linear in.
double share(double inertial_number, double log_i_0) {
  return inertial_number / (std::exp(log_i_0) + inertial_number);
}

/// What the fit of μ(I) starts from: the best line against I/(I₀+I) over a table of I₀.
struct FrictionStart {
  double mu_0 = 0, mu_infinity = 0, log_i_0 = 0;
  double chi_square = infinity;
};

FrictionStart friction_start(const RheologyData& data) {
  const auto [low, high] = std::minmax_element(data.inertial_number.begin(), data.inertial_number.end());
  FrictionStart best;
  constexpr int places = 60;
  for (int i = 0; i <= places; ++i) {
    const double q = std::log(*low / 10) + std::log(100 * *high / *low) * i / places;
    std::vector<double> shares;
    for (const double inertial_number : data.inertial_number) shares.push_back(share(inertial_number, q));
    const WeightedLine line = weighted_line(shares, data.value, data.error);
    if (line.chi_square < best.chi_square) best = {line.at(0), line.at(1), q, line.chi_square};
  }
  return best;
}

/// Refuses a fit whose parameter j, the inverse of what is wanted, cannot be told from 0.
void need_positive(Fit& fit, std::size_t j, const std::string& name) {
  if (fit.fitted() && !(fit.parameters[j] > 2 * fit.errors[j]))
    fit.refusal = "the data show no finite " + name + ": its inverse is less than two standard errors above 0";
}

bool too_few(const RheologyData& data, std::size_t parameters, Fit& fit) {
  if (data.value.size() > parameters) return false;
  fit.refusal = std::to_string(data.value.size()) + " values for " + std::to_string(parameters) +
                " parameters: at least " + std::to_string(parameters + 1) + " are needed";
  return true;
}

}  // namespace

FrictionLawFit fit_friction_law(const RheologyData& data, double condition_limit) {
  FrictionLawFit result;
  result.law = result.error = {{nan, nan, nan}, nan};
  const bool with_pressure = soft(data);
  if (too_few(data, with_pressure ? 4 : 3, result.fit)) return result;

  const FrictionStart start = friction_start(data);
  const double scale = largest(data.value);
  FitProblem problem;
  problem.observed = data.value;
  problem.error = data.error;
  problem.condition_limit = condition_limit;
  problem.parameters = {
      {"mu_0", start.mu_0, scale}, {"mu_infinity", start.mu_infinity, scale}, {"ln I_0", start.log_i_0, 1}};
  if (with_pressure) problem.parameters.push_back({"p_0^-1/2", 0, 1 / std::sqrt(largest(data.soft_pressure))});
  problem.model = [&](std::size_t k, std::span<const double> p, std::span<double> slopes) {
    const double s = share(data.inertial_number[k], p[2]);
    const double hard = p[0] + (p[1] - p[0]) * s;
    const double root = std::sqrt(pressure_of(data, k));
    const double softness = with_pressure ? 1 - p[3] * root : 1;
    slopes[0] = (1 - s) * softness;
    slopes[1] = s * softness;
    slopes[2] = -(p[1] - p[0]) * s * (1 - s) * softness;  // ∂s/∂ln I₀ = -s(1-s)
    if (with_pressure) slopes[3] = -hard * root;
    return hard * softness;
  };
  result.fit = least_squares(problem);
  if (with_pressure) need_positive(result.fit, 3, "p_0*");
  if (!result.fit.fitted()) return result;

  const std::vector<double>& p = result.fit.parameters;
  const std::vector<double>& e = result.fit.errors;
  const double i_0 = std::exp(p[2]);
  result.law = {{p[0], p[1], i_0}, with_pressure ? 1 / (p[3] * p[3]) : infinity};
  result.error = {{e[0], e[1], i_0 * e[2]}, with_pressure ? 2 * e[3] / std::pow(p[3], 3) : 0};
  return result;
}

PackingLawFit fit_packing_law(const RheologyData& data, double condition_limit) {
  PackingLawFit result;
  result.law = result.error = {nan, nan, nan};
  const bool with_pressure = soft(data);
  if (too_few(data, with_pressure ? 3 : 2, result.fit)) return result;

  const double most = largest(data.value);
  FitProblem problem;
  problem.observed = data.value;
  problem.error = data.error;
  problem.condition_limit = condition_limit;
  problem.parameters = {{"nu_c", most, most}, {"1/I_c", 0, 1 / largest(data.inertial_number)}};
  if (with_pressure) problem.parameters.push_back({"1/p_c*", 0, 1 / largest(data.soft_pressure)});
  problem.model = [&](std::size_t k, std::span<const double> p, std::span<double> slopes) {
    const double i = data.inertial_number[k], pressure = pressure_of(data, k);
    const double a = p[0] * (1 + (with_pressure ? p[2] * pressure : 0));
    const double b = a * p[1] * i;
    // √ν from ν + b√ν = a. A step to a < 0 is a step to ν = 0.
    const double root = a > 0 ? 2 * a / (b + std::sqrt(b * b + 4 * a)) : 0;
    const double nu = root * root;
    // From 0 = ν - a(1 - ib√ν), b here 1/I_c: dν (1 + a i/(2 I_c √ν)) = da (1 - i√ν/I_c) - a i √ν d(1/I_c).
    const double along = root > 0 ? 1 + b / (2 * root) : 1;
    const double with_a = (1 - p[1] * i * root) / along;
    slopes[0] = with_a * (1 + (with_pressure ? p[2] * pressure : 0));
    slopes[1] = -a * i * root / along;
    if (with_pressure) slopes[2] = with_a * p[0] * pressure;
    return nu;
  };
  result.fit = least_squares(problem);
  need_positive(result.fit, 1, "I_c");
  if (with_pressure) need_positive(result.fit, 2, "p_c*");
  if (!result.fit.fitted()) return result;

  const std::vector<double>& p = result.fit.parameters;
  const std::vector<double>& e = result.fit.errors;
  result.law = {1 / p[1], with_pressure ? 1 / p[2] : infinity, p[0]};
  result.error = {e[1] / (p[1] * p[1]), with_pressure ? e[2] / (p[2] * p[2]) : 0, e[0]};
  return result;
}

}  // namespace grainvdb
