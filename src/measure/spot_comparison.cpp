#include "measure/spot_comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace grainvdb {
namespace {

constexpr auto slowness = static_cast<std::size_t>(SpotObservable::slowness);
constexpr std::array<const char*, spot_observable_count> observable_names{"radius", "b", "diffusion_length", "outflow",
                                                                          "speed"};
// Slopes of what was seen against what made it lie between 0.5 and 1.4 in runs of docs/spot_calibration.md.
constexpr double slope_error = 0.3;

/// Errors of what is compared, of logarithms but for the slowness.
std::vector<double> errors_of(const SpotObservations& o) {
  const auto relative = [](const Estimate& e) { return e.error / e.value; };
  return {relative(o.radius), relative(o.b), relative(o.grain_diffusion), relative(o.outflow),
          std::abs(o.speed.error / (o.speed.value * o.speed.value))};
}

double on_scale(std::size_t observable, double value) {
  return observable == slowness ? value : std::log(value);
}

double larger_known(double a, double b) {
  return std::isfinite(a) ? std::max(a, b) : b;
}

Estimate from_logarithm(const Estimate& e) {
  return {std::exp(e.value), std::exp(e.value) * e.error};
}

Estimate speed_of(const Estimate& slow) {
  if (!(slow.value > 0)) return {};
  return {1 / slow.value, std::min(1 / slow.value, slow.error / (slow.value * slow.value))};
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
  std::vector<std::vector<Run>> with = runs_;
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < spot_observable_count; ++i) {
    bool told = true;
    for (const SpotObservations& run : runs) {
      const double seen = on_scale(i, observed(run)[i]);
      told = told && std::isfinite(seen);
      with[i].push_back({rounds_, on_scale(i, truth[i]), seen, errors_of(run)[i]});
    }
    if (!told) missing.emplace_back(observable_names[i]);
  }
  if (!missing.empty()) return missing;
  runs_ = std::move(with);
  ++rounds_;
  return {};
}

// Within all rounds, or what the estimators state, where that is more. What these state of a slowness near 0 is
// anything.
double SpotComparison::scatter(std::size_t observable) const {
  const std::vector<Run>& runs = runs_[observable];
  double squares = 0, stated = 0;
  for (const Run& run : runs) {
    double sum = 0, count = 0;
    for (const Run& other : runs) {
      if (other.round != run.round) continue;
      sum += other.seen;
      ++count;
    }
    squares += (run.seen - sum / count) * (run.seen - sum / count);
    if (std::isfinite(run.stated)) stated += run.stated * run.stated;
  }
  const double among = std::sqrt(squares / static_cast<double>(runs.size() - rounds_));
  return observable == slowness ? among : std::max(among, std::sqrt(stated / static_cast<double>(runs.size())));
}

std::vector<Estimate> SpotComparison::biases() const {
  std::vector<Estimate> all;
  for (std::size_t i = 0; i < spot_observable_count; ++i) {
    double sum = 0, count = 0;
    for (const Run& run : runs_[i]) {
      if (run.round + 1 != rounds_) continue;
      sum += run.seen - run.made;
      ++count;
    }
    const Estimate mean{sum / count, scatter(i) / std::sqrt(count)};
    all.push_back(i == slowness ? mean : from_logarithm(mean));
  }
  return all;
}

// From the mean of the last round along a line. Its slope is that through the last two rounds, drawn towards 1 by as
// much as they leave open. Other parameters change from round to round as well, so that it is never known well.
Estimate SpotComparison::inverted(std::size_t observable, double seen, double error) const {
  struct Mean {
    double count = 0, made = 0, seen = 0;
  };
  std::array<Mean, 2> rounds;  // the last one first
  for (const Run& run : runs_[observable]) {
    const std::size_t age = rounds_ - 1 - run.round;
    if (age >= rounds.size()) continue;
    ++rounds[age].count;
    rounds[age].made += run.made;
    rounds[age].seen += run.seen;
  }
  for (Mean& mean : rounds)
    for (double* sum : {&mean.made, &mean.seen}) *sum /= std::max(1.0, mean.count);
  const auto& [last, before] = rounds;
  const double noise = scatter(observable), weight = noise * noise / (slope_error * slope_error);
  double slope = 1;
  if (before.count > 0) {
    const double pairs = 1 / (1 / last.count + 1 / before.count), made = last.made - before.made;
    slope = (pairs * made * (last.seen - before.seen) + weight) / (pairs * made * made + weight);
    slope = std::clamp(slope, 1 - 2 * slope_error, 1 + 2 * slope_error);
  }
  const double away = seen - last.seen;
  return {last.made + away / slope,
          std::hypot(error, noise / std::sqrt(last.count), slope_error * away / slope) / slope};
}

SpotObservations SpotComparison::corrected(double duration_ratio) const {
  const std::vector<double> seen = observed(seen_), stated = errors_of(seen_);
  std::vector<Estimate> made;
  for (std::size_t i = 0; i < spot_observable_count; ++i) {
    const double error = larger_known(stated[i], scatter(i) * std::sqrt(duration_ratio));
    made.push_back(inverted(i, on_scale(i, seen[i]), error));
  }
  SpotObservations o = seen_;
  o.radius = from_logarithm(made[0]);
  o.b = from_logarithm(made[1]);
  o.grain_diffusion = from_logarithm(made[2]);
  o.outflow = from_logarithm(made[3]);
  o.speed = speed_of(made[slowness]);
  return o;
}

}  // namespace grainvdb
