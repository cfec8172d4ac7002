#include "grainvdb/tracers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>

#include "base/nan.hpp"
#include "base/parallel.hpp"
#include "trace/advance.hpp"

namespace grainvdb {
namespace {

constexpr double farthest = std::numeric_limits<double>::max();
constexpr double most_images = 1e6;

/// Tracers that one task moves.
constexpr std::size_t chunk = 256;

[[noreturn]] void refuse(const std::string& what, double found) {
  std::ostringstream text;
  text.precision(17);
  text << what << ", found " << found;
  throw std::invalid_argument(text.str());
}

void check(const FixedSteps& steps) {
  if (!(steps.longest > 0) || !std::isfinite(steps.longest))
    refuse("the step of tracers must be positive and finite", steps.longest);
}
void check(const AdaptiveSteps& steps) {
  if (!(steps.tolerance > 0) || !std::isfinite(steps.tolerance))
    refuse("the tolerance of tracers must be positive and finite", steps.tolerance);
  if (!(steps.longest > 0)) refuse("the longest step of tracers must be positive", steps.longest);
}

void check_periods(const Lattice& lattice, const Box& box) {
  for (int a = 0; a < 3; ++a) {
    const auto& period = lattice.period(a);
    const double length = period ? period->length * lattice.voxel() : 0;
    if (period.has_value() != box.periodic[static_cast<std::size_t>(a)] ||
        (period && std::abs(length - box.length(a)) > 1e-9 * length))
      throw std::invalid_argument("the velocity of tracers must have the periods of their box");
  }
}

void check_seeds(const TracerSeeds& seeds, const Box& box) {
  if (seeds.size() == 0) throw std::invalid_argument("there are no seeds");
  for (std::size_t a = 0; a < 3; ++a) {
    if (seeds.position[a].size() != seeds.size())
      throw std::invalid_argument("every seed needs an id and three coordinates");
    const double most = box.periodic[a] ? most_images * box.length(static_cast<int>(a)) : farthest;
    for (std::size_t i = 0; i < seeds.size(); ++i)
      if (!(std::abs(seeds.position[a][i]) <= most))
        refuse("the position of tracer " + std::to_string(seeds.id[i]) + " must be finite, and within " +
                   "a million periods where there are any",
               seeds.position[a][i]);
  }
}

/// Speed and |∇u| at a place; nothing where the velocity is undefined.
struct Pace {
  double speed = nan, gradient = nan;
};

std::optional<FlowValue> value_at(const Flow& flow, double time, const Vec3& x) {
  std::optional<FlowValue> value = flow.first().at(x);
  if (flow.steady() || !value) return value;
  const std::optional<FlowValue> later = flow.second().at(x);
  if (!later) return std::nullopt;
  const double s = (time - flow.t0()) / (flow.t1() - flow.t0());
  for (std::size_t i = 0; i < 3; ++i) value->velocity[i] += s * (later->velocity[i] - value->velocity[i]);
  for (std::size_t i = 0; i < 9; ++i) value->gradient[i] += s * (later->gradient[i] - value->gradient[i]);
  return value;
}

Pace pace_at(const Flow& flow, double time, const Vec3& x) {
  const auto value = value_at(flow, time, x);
  if (!value) return {};
  double sum = 0;
  for (const double g : value->gradient) sum += g * g;
  return {std::hypot(value->velocity[0], value->velocity[1], value->velocity[2]), std::sqrt(sum)};
}

/// Brings coordinates that have left the box along its periodic axes back into it, and counts the periods.
void wrap(const Box& box, int axis, double& x, std::int32_t& image) {
  const double inside = box.wrap(axis, x);
  image += static_cast<std::int32_t>(std::lround((x - inside) / box.length(axis)));
  x = inside;
}

/// Moves some of the tracers at a time.
class Mover {
 public:
  Mover(const Flow& flow, const Box& box, double from, double until, const TracerSettings& settings)
      : box_(box), settings_(settings), leg_{flow,   from,   until,
                                             box.lo, box.hi, settings.on_undefined == OnUndefined::stop} {
    for (std::size_t a = 0; a < 3; ++a)
      if (box.periodic[a]) {
        leg_.lo[a] = -farthest;
        leg_.hi[a] = farthest;
      }
    const double rounding = 8 * std::numeric_limits<double>::epsilon() * std::max(std::abs(from), std::abs(until));
    if (const auto* fixed = std::get_if<FixedSteps>(&settings.stepping)) {
      if (!(fixed->longest > rounding))
        refuse("the step of tracers vanishes in the rounding of their time", fixed->longest);
      // The small allowance keeps a span that is a whole number of steps but for rounding.
      count_ = static_cast<std::size_t>(std::max(1.0, std::ceil((until - from) / fixed->longest * (1 - 1e-9))));
    }
  }

  AdvanceReport move(TracerState& state, const TracerColumns& columns, std::size_t begin, std::size_t end) const {
    if (settings_.step_numbers)
      for (std::size_t i = begin; i < end; ++i) {
        if (state.stop[i] != TracerStop::moving) continue;
        const Pace pace =
            pace_at(leg_.flow, leg_.from, {state.position[0][i], state.position[1][i], state.position[2][i]});
        state.courant[i] = pace.speed / leg_.flow.first().lattice().voxel();
        state.gradient_number[i] = pace.gradient;
      }
    std::vector<TracerStop> before(state.stop.begin() + static_cast<std::ptrdiff_t>(begin),
                                   state.stop.begin() + static_cast<std::ptrdiff_t>(end));
    const auto* const adaptive = std::get_if<AdaptiveSteps>(&settings_.stepping);
    const LegCounts counts = adaptive != nullptr ? advance_adaptive(leg_, *adaptive, columns, begin, end)
                                                 : advance_fixed(leg_, count_, columns, begin, end);
    AdvanceReport report;
    report.steps = counts.steps;
    report.rejected = counts.rejected;
    for (std::size_t i = begin; i < end; ++i) {
      if (before[i - begin] != TracerStop::moving) continue;
      for (std::size_t a = 0; a < 3; ++a)
        if (box_.periodic[a]) wrap(box_, static_cast<int>(a), state.position[a][i], state.image[a][i]);
      if (settings_.step_numbers) {
        const double dt = leg_.flow.steady() ? columns.longest_step[i] : leg_.flow.t1() - leg_.flow.t0();
        report.above_courant_limit += (state.courant[i] *= dt) > settings_.limits.courant ? 1 : 0;
        report.above_gradient_limit += (state.gradient_number[i] *= dt) > settings_.limits.gradient_number ? 1 : 0;
      }
      report.moving += state.stop[i] == TracerStop::moving ? 1 : 0;
    }
    return report;
  }

 private:
  const Box& box_;
  const TracerSettings& settings_;
  Leg leg_;
  std::size_t count_ = 0;
};

template <class F>
void for_each_chunk(std::size_t n, const F& f) {
  parallel_for((n + chunk - 1) / chunk, [&](std::size_t c) { f(c, c * chunk, std::min(n, (c + 1) * chunk)); });
}

}  // namespace

Tracers::Tracers(const TracerSeeds& seeds, const Box& box, const Flow& flow, double start,
                 const TracerSettings& settings)
    : box_(box), settings_(settings), time_(start) {
  check_seeds(seeds, box);
  if (!std::isfinite(start)) refuse("the time at which tracers start must be finite", start);
  std::visit([](const auto& steps) { check(steps); }, settings.stepping);
  check_periods(flow.first().lattice(), box);

  const std::size_t n = seeds.size();
  state_.id = seeds.id;
  state_.seed = seeds.position;
  state_.position = seeds.position;
  for (auto& image : state_.image) image.resize(n);
  state_.strain.resize(n);
  if (settings.step_numbers) {
    state_.courant.assign(n, nan);
    state_.gradient_number.assign(n, nan);
  }
  state_.stop.resize(n);
  state_.stop_time.assign(n, nan);
  next_step_.resize(n);
  for_each_chunk(n, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t a = 0; a < 3; ++a) {
        double& x = state_.position[a][i];
        if (box.periodic[a]) {
          wrap(box, static_cast<int>(a), x, state_.image[a][i]);
        } else if (x < box.lo[a] || x > box.hi[a]) {
          stop(i, TracerStop::left_domain);
        }
      }
      if (!value_at(flow, start, {state_.position[0][i], state_.position[1][i], state_.position[2][i]}))
        stop(i, TracerStop::left_material);
    }
  });
}

void Tracers::stop(std::size_t tracer, TracerStop why) {
  if (state_.stop[tracer] != TracerStop::moving) return;
  state_.stop[tracer] = why;
  state_.stop_time[tracer] = time_;
}

AdvanceReport Tracers::advance(const Flow& flow, double until) {
  if (!(until > time_) || !std::isfinite(until)) refuse("tracers must be moved on to a later time", until);
  if (!flow.steady() && !(time_ >= flow.t0() && until <= flow.t1()))
    refuse("tracers must be moved on between the two frames that carry them", until);
  check_periods(flow.first().lattice(), box_);
  const Mover mover(flow, box_, time_, until, settings_);

  std::vector<double> longest(size());
  const TracerColumns columns{
      state_.position[0].data(), state_.position[1].data(), state_.position[2].data(), state_.strain.data(),
      state_.stop.data(),        state_.stop_time.data(),   next_step_.data(),         longest.data()};
  std::vector<AdvanceReport> reports((size() + chunk - 1) / chunk);
  for_each_chunk(size(), [&](std::size_t c, std::size_t begin, std::size_t end) {
    reports[c] = mover.move(state_, columns, begin, end);
  });
  time_ = until;
  AdvanceReport all;
  for (const AdvanceReport& r : reports) {
    all.moving += r.moving;
    all.steps += r.steps;
    all.rejected += r.rejected;
    all.above_courant_limit += r.above_courant_limit;
    all.above_gradient_limit += r.above_gradient_limit;
  }
  return all;
}

}  // namespace grainvdb
