#include "measure/spot_comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/nan.hpp"

namespace grainvdb {
namespace {

constexpr auto slowness = static_cast<std::size_t>(SpotObservable::slowness);
constexpr std::array<const char*, spot_observable_count> observable_names{"radius", "b", "diffusion_length", "outflow",
                                                                          "speed"};

/// Errors of what observed() gives, relative but for the slowness.
std::vector<double> observed_errors(const SpotObservations& o) {
  const auto relative = [](const Estimate& e) { return e.error / e.value; };
  return {relative(o.radius), relative(o.b), relative(o.grain_diffusion), relative(o.outflow),
          std::abs(o.speed.error / (o.speed.value * o.speed.value))};
}

double mean_of_values(const std::vector<double>& x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

double sum_of_squares_about_mean(const std::vector<double>& x) {
  const double mean = mean_of_values(x);
  double sum = 0;
  for (const double y : x) sum += (y - mean) * (y - mean);
  return sum;
}

/// Root of the mean of the squares of those that are known; 0 without any.
double root_mean_square(const std::vector<double>& x) {
  double sum = 0;
  std::size_t known = 0;
  for (const double y : x) {
    if (!std::isfinite(y)) continue;
    sum += y * y;
    ++known;
  }
  return known == 0 ? 0 : std::sqrt(sum / static_cast<double>(known));
}

double larger_known(double a, double b) {
  return std::isfinite(a) ? std::max(a, b) : b;
}

Estimate divided(const Estimate& seen, const SpotBias& by, double duration_ratio) {
  const double own = larger_known(seen.error / seen.value, by.scatter * std::sqrt(duration_ratio));
  const double value = seen.value / by.bias.value;
  return {value, value * std::hypot(own, by.bias.error / by.bias.value)};
}

}  // namespace

std::vector<double> SpotComparison::expected(const SpotTruth& made) const {
  SpotObservations o = seen_;
  o.radius.value = made.radius;
  o.b.value = made.b;
  o.speed.value = made.speed;
  const SpotParameterEstimates p = spot_parameters(o);
  return {made.radius, made.b, p.share.value * made.b / made.influence,
          made.insertion_rate * p.grains.value / made.influence, 1 / made.speed};
}

std::vector<double> SpotComparison::observed(const SpotObservations& seen) {
  return {seen.radius.value, seen.b.value, seen.grain_diffusion.value, seen.outflow.value, 1 / seen.speed.value};
}

std::vector<std::string> SpotComparison::add_round(const SpotTruth& made, const std::vector<SpotObservations>& runs) {
  const std::vector<double> truth = expected(made);
  Round round;
  round.biases.resize(spot_observable_count);
  std::vector<std::vector<double>> stated = stated_;
  stated.resize(spot_observable_count);
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < spot_observable_count; ++i) {
    bool told = true;
    for (const SpotObservations& run : runs) {
      const double seen = observed(run)[i];
      told = told && std::isfinite(seen) && (i == slowness || seen > 0);
      round.biases[i].push_back(i == slowness ? seen - truth[i] : std::log(seen / truth[i]));
      stated[i].push_back(observed_errors(run)[i]);
    }
    if (!told) missing.emplace_back(observable_names[i]);
  }
  if (!missing.empty()) return missing;
  rounds_.push_back(std::move(round));
  stated_ = std::move(stated);
  return {};
}

std::vector<SpotBias> SpotComparison::biases() const {
  std::vector<SpotBias> all;
  for (std::size_t i = 0; i < spot_observable_count; ++i) {
    const std::vector<double>& last = rounds_.back().biases[i];
    double squares = 0;
    std::size_t freedom = 0;
    for (const Round& round : rounds_) {
      squares += sum_of_squares_about_mean(round.biases[i]);
      freedom += round.biases[i].size() - 1;
    }
    const double of_runs = freedom == 0 ? nan : std::sqrt(squares / static_cast<double>(freedom));
    const double scatter = larger_known(of_runs, root_mean_square(stated_[i]));
    const double error = scatter / std::sqrt(static_cast<double>(last.size())), mean = mean_of_values(last);
    if (i == slowness)
      all.push_back({{mean, error}, scatter});
    else
      all.push_back({{std::exp(mean), std::exp(mean) * error}, scatter});
  }
  return all;
}

SpotObservations SpotComparison::corrected(double duration_ratio) const {
  const std::vector<SpotBias> by = biases();
  SpotObservations o = seen_;
  o.radius = divided(seen_.radius, by[0], duration_ratio);
  o.b = divided(seen_.b, by[1], duration_ratio);
  o.grain_diffusion = divided(seen_.grain_diffusion, by[2], duration_ratio);
  o.outflow = divided(seen_.outflow, by[3], duration_ratio);
  const double own = larger_known(observed_errors(seen_)[slowness], by[slowness].scatter * std::sqrt(duration_ratio));
  const double left = 1 / seen_.speed.value - by[slowness].bias.value;
  o.speed = left > 0 ? Estimate{1 / left, std::hypot(own, by[slowness].bias.error) / (left * left)} : Estimate{};
  return o;
}

}  // namespace grainvdb
