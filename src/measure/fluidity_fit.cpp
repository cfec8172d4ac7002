#include "measure/fluidity_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/nan.hpp"
#include "measure/weighted_line.hpp"

namespace grainvdb {
namespace {

/// F as A - k s(φ), s = x + √(x²+w²), x = φ - B.
struct Knee {
  double a = 0, b = 0, w = 0, k = 0;
  double chi_square = std::numeric_limits<double>::infinity();
};

double fall(double phi, double b, double w) {
  const double x = phi - b;
  return x + std::sqrt(x * x + w * w);
}

/// The best A and k for given B and w: a straight line against s.
Knee best_for(const FluidityData& data, double b, double w) {
  std::vector<double> s;
  for (const double phi : data.phi) s.push_back(fall(phi, b, w));
  const WeightedLine line = weighted_line(s, data.value, data.error);
  return {line.at(0), b, w, -line.slope, line.chi_square};
}

/// Where to start from: the best of a table of B and w. B lies within the data, since otherwise they have one branch
/// only; w is between 10⁻³ and 10⁻¹·⁵, which spans those of Table IV.
std::optional<Knee> start_of(const FluidityData& data, std::optional<double> held_w) {
  const auto [low, high] = std::minmax_element(data.phi.begin(), data.phi.end());
  std::optional<Knee> best;
  constexpr int places = 60, widths = 7;
  for (int i = 0; i <= places; ++i)
    for (int j = 0; j < (held_w ? 1 : widths); ++j) {
      const double b = *low + (*high - *low) * i / places;
      const Knee knee = best_for(data, b, held_w.value_or(1e-3 * std::pow(10, 0.25 * j)));
      const bool usable = std::isfinite(knee.chi_square) && knee.k > 0 && knee.a > 0;
      if (usable && (!best || knee.chi_square < best->chi_square)) best = knee;
    }
  return best;
}

/// Parameters 0 A, 1 B, 2 k = 1/D and, unless it is held, 3 w = √C.
FitProblem problem_of(const FluidityData& data, const Knee& start, std::optional<double> held_w) {
  FitProblem problem;
  problem.observed = data.value;
  problem.error = data.error;
  problem.parameters = {{"A", start.a, start.a}, {"B", start.b, start.a / (2 * start.k)}, {"1/D", start.k, start.k}};
  if (!held_w) problem.parameters.push_back({"sqrt(C)", start.w, start.w});
  problem.model = [&phi = data.phi, held_w](std::size_t n, std::span<const double> p, std::span<double> slopes) {
    const double w = held_w ? *held_w : p[3];
    const double x = phi[n] - p[1];
    const double root = std::sqrt(x * x + w * w);
    slopes[0] = 1;
    slopes[1] = root > 0 ? p[2] * (1 + x / root) : p[2];
    slopes[2] = -(x + root);
    if (!held_w) slopes[3] = root > 0 ? -p[2] * w / root : 0;
    return p[0] - p[2] * (x + root);
  };
  return problem;
}

FluidityLawFit fit_law(const FluidityData& data, double condition_limit, std::optional<double> held_w) {
  FluidityLawFit result;
  result.law = result.error = {nan, nan, nan, nan};
  const std::size_t parameters = held_w ? 3 : 4;
  if (data.phi.size() <= parameters) {
    result.fit.refusal = std::to_string(data.phi.size()) + " values of gd/dv for " + std::to_string(parameters) +
                         " parameters: at least " + std::to_string(parameters + 1) + " are needed";
    return result;
  }
  const std::optional<Knee> start = start_of(data, held_w);
  if (!start) {
    result.fit.refusal = "gd/dv does not fall with phi: there is no dense branch, which B, C and D describe";
    return result;
  }
  FitProblem problem = problem_of(data, *start, held_w);
  problem.condition_limit = condition_limit;
  result.fit = least_squares(problem);
  if (!result.fit.fitted()) return result;

  const std::vector<double>& p = result.fit.parameters;
  const std::vector<double>& e = result.fit.errors;
  if (!(p[2] > 0)) {
    result.fit.refusal = "gd/dv does not fall with phi: there is no dense branch, which B, C and D describe";
    return result;
  }
  const double w = held_w ? *held_w : p[3];
  result.law = {p[0], p[1], w * w, 1 / p[2]};
  result.error = {e[0], e[1], held_w ? 0 : 2 * std::abs(w) * e[3], e[2] / (p[2] * p[2])};
  return result;
}

}  // namespace

FluidityLawFit fit_fluidity_law(const FluidityData& data, double condition_limit) {
  return fit_law(data, condition_limit, std::nullopt);
}

FluidityLawFit fit_fluidity_law_with(double c, const FluidityData& data, double condition_limit) {
  return fit_law(data, condition_limit, std::sqrt(c));
}

}  // namespace grainvdb
