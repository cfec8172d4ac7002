#include "measure/spot_parameters.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "base/nan.hpp"
#include "grainvdb/spot_diffusion.hpp"
#include "measure/table_numbers.hpp"
#include "measure/weighted_line.hpp"

namespace grainvdb {
namespace {

struct Inputs {
  double radius, b, grain_diffusion, number_density, outflow, speed;
};
struct Outputs {
  double step = nan, share = nan, influence = nan, grains = nan, volume = nan, hop_rate = nan, insertion_rate = nan;
};

/// s of the slope of t s(t) over the lags, as the slope of the variance is fitted.
double share_of_slope(const DiffusionShare& all, double rate, const std::vector<double>& times) {
  std::vector<double> spread;
  for (const double t : times) spread.push_back(t * all.after(rate * t));
  if (times.empty()) return nan;
  return times.size() == 1 ? spread[0] / times[0] : weighted_line(times, spread).slope;
}

Outputs parameters(const Inputs& x, double rise, const std::vector<double>& times) {
  Outputs y;
  if (x.b > 0) y.step = std::sqrt(2 * x.b * rise);
  if (x.speed > 0) y.hop_rate = x.speed / rise;
  if (x.radius > 0) y.grains = x.number_density * 4 * std::numbers::pi / 3 * x.radius * x.radius * x.radius;
  if (x.b > 0 && x.radius > 0 && x.speed > 0)
    y.share = share_of_slope(DiffusionShare({x.radius, {y.step, y.step, rise}}), y.hop_rate, times);
  if (x.grain_diffusion > 0) y.influence = y.share * x.b / x.grain_diffusion;
  y.volume = y.grains / y.influence;
  y.insertion_rate = x.outflow / y.volume;
  return y;
}

struct Dependence {
  double Inputs::*input;
  Estimate SpotObservations::*observed;
};
constexpr Dependence dependences[] = {{&Inputs::radius, &SpotObservations::radius},
                                      {&Inputs::b, &SpotObservations::b},
                                      {&Inputs::grain_diffusion, &SpotObservations::grain_diffusion},
                                      {&Inputs::number_density, &SpotObservations::number_density},
                                      {&Inputs::outflow, &SpotObservations::outflow},
                                      {&Inputs::speed, &SpotObservations::speed}};

}  // namespace

SpotParameterEstimates spot_parameters(const SpotObservations& o) {
  Inputs x{};
  for (const auto& [input, observed] : dependences) x.*input = (o.*observed).value;
  const Outputs y = parameters(x, o.rise, o.times);
  std::vector<Outputs> low, high;
  for (const auto& [input, observed] : dependences) {
    // Half an error to both sides: the slope where the value is, without leaving the range in which it means something.
    Inputs less = x, more = x;
    less.*input -= 0.5 * (o.*observed).error;
    more.*input += 0.5 * (o.*observed).error;
    low.push_back(parameters(less, o.rise, o.times));
    high.push_back(parameters(more, o.rise, o.times));
  }
  const auto estimate = [&](double Outputs::*output) {
    double variance = 0;
    for (std::size_t i = 0; i < low.size(); ++i)
      variance += (high[i].*output - low[i].*output) * (high[i].*output - low[i].*output);
    return Estimate{y.*output, std::sqrt(variance)};
  };
  return {estimate(&Outputs::step),          estimate(&Outputs::share),  estimate(&Outputs::influence),
          estimate(&Outputs::grains),        estimate(&Outputs::volume), estimate(&Outputs::hop_rate),
          estimate(&Outputs::insertion_rate)};
}

std::vector<Quantity> spot_quantities(const SpotObservations& o, const SpotParameterEstimates& p) {
  std::vector<Quantity> all;
  const auto add = [&](const char* name, const Estimate& e, const Dimension& d, const char* description) {
    all.push_back({.name = name, .value = e.value, .error = e.error, .dimension = d, .description = description});
  };
  add("radius", o.radius, dimension::length, "R_s of spots, from the velocity correlation");
  add("b", o.b, dimension::length, "of dv/dz = b d2v/dx2, from the widths of profiles");
  add("step_side", p.step, dimension::length, "of a spot along x and y, sqrt(2 b step_up)");
  add("step_up", {o.rise}, dimension::length, "of a spot along z; chosen");
  add("diffusion_length", o.grain_diffusion, dimension::length, "b_p of grains along y");
  add("share", p.share, dimension::none, "s, in the slope of the variance over the lags");
  add("influence", p.influence, dimension::none, "w: grains move by 1/w of a spot's step");
  add("grains", p.grains, dimension::none, "N, in a spot");
  add("volume", p.volume, dimension::none, "V_s/V_p = N/w, free volume of a spot in grain volumes");
  add("outflow", o.outflow, dimension::rate, "Q, grains per time, at five heights of the box");
  add("insertion_rate", p.insertion_rate, dimension::rate, "lambda = Q w/N, spots per time");
  add("speed", o.speed, dimension::velocity, "of spots upward, from the density drop");
  add("hop_rate", p.hop_rate, dimension::rate, "mu_s = speed/step_up, steps of a spot per time");
  return all;
}

SpotObservations spot_observations(const Table& table) {
  const auto quantity = [&](const std::string& name) {
    const Quantity& q = number_of(table, name);
    return Estimate{q.value, q.error};
  };
  SpotObservations o;
  o.radius = quantity("radius");
  o.b = quantity("b");
  o.grain_diffusion = quantity("diffusion_length");
  o.outflow = quantity("outflow");
  o.speed = quantity("speed");
  o.rise = quantity("step_up").value;
  const Estimate phi = quantity("phi");
  const double r = o.radius.value, n = quantity("grains").value / (4 * std::numbers::pi / 3 * r * r * r);
  o.number_density = {n, n * phi.error / phi.value};
  if (!table.columns.empty()) o.times = table.columns.front().values;
  return o;
}

}  // namespace grainvdb
