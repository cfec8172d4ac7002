#include "trace/advance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "trace/spline.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/advance.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>
//
#include "trace/flow_at-inl.hpp"
#include "trace/runge_kutta-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace {

/// A step that would leave the material or the domain is tried again with halves, down to this part of it.
constexpr int finest = 128;

/// Decides whether a tracer may be where a step has brought it.
class Gate {
 public:
  explicit Gate(const Leg& leg) : needs_strain_(leg.needs_strain) {
    for (std::size_t a = 0; a < 3; ++a) {
      lo_[a] = leg.lo[a];
      hi_[a] = leg.hi[a];
    }
    lo_[3] = -std::numeric_limits<double>::infinity();
    hi_[3] = std::numeric_limits<double>::infinity();
  }

  HWY_INLINE bool passes(const Four& y) const {
    bool good = true;
    for (std::size_t p = 0; p < parts; ++p) {
      const auto lo = hn::Load(d, lo_ + p * lanes), hi = hn::Load(d, hi_ + p * lanes);
      good = good && hn::AllTrue(d, hn::And(hn::Ge(y.part[p], lo), hn::Le(y.part[p], hi)));
    }
    return HWY_LIKELY(good) || (!needs_strain_ && why_not(y) == TracerStop::masked);
  }

  /// Why the rates at a place do not carry a tracer on; moving where they do.
  TracerStop obstacle(const Four& rates) const {
    double value[flow_lanes];
    store(rates, value);
    if (is_nowhere(value)) return TracerStop::left_material;
    return needs_strain_ && std::isnan(value[3]) ? TracerStop::masked : TracerStop::moving;
  }

  /// Of a state that does not pass.
  TracerStop why_not(const Four& y) const {
    double value[flow_lanes];
    store(y, value);
    if (is_nowhere(value)) return TracerStop::left_material;
    for (std::size_t a = 0; a < 3; ++a)
      if (!(value[a] >= lo_[a] && value[a] <= hi_[a])) return TracerStop::left_domain;
    return TracerStop::masked;
  }

 private:
  static bool is_nowhere(const double* value) {
    return std::isnan(value[0]) || std::isnan(value[1]) || std::isnan(value[2]);
  }

  HWY_ALIGN double lo_[flow_lanes];
  HWY_ALIGN double hi_[flow_lanes];
  bool needs_strain_;
};

HWY_INLINE Four load_tracer(const TracerColumns& tracers, std::size_t i) {
  HWY_ALIGN const double y[flow_lanes] = {tracers.x[i], tracers.y[i], tracers.z[i], tracers.strain[i]};
  return load(y);
}
void store_tracer(const Four& state, const TracerColumns& tracers, std::size_t i) {
  double y[flow_lanes];
  store(state, y);
  tracers.x[i] = y[0];
  tracers.y[i] = y[1];
  tracers.z[i] = y[2];
  tracers.strain[i] = y[3];
}
void stop_tracer(TracerStop why, double when, const TracerColumns& tracers, std::size_t i) {
  tracers.stop[i] = why;
  tracers.stop_time[i] = when;
}

/// Equal steps of the classic method.
template <class Field>
class Fixed {
 public:
  Fixed(const Leg& leg, std::size_t count, const TracerColumns& tracers)
      : leg_(leg),
        field_(leg.flow),
        gate_(leg),
        count_(count),
        dt_((leg.until - leg.from) / static_cast<double>(count)),
        tracers_(tracers) {}

  /// Moves the tracers who[0] … who[n-1], or fewer of them where the last ones repeat. Returns the steps taken.
  template <std::size_t n>
  std::size_t move(const std::array<std::size_t, n>& who, std::size_t different) {
    typename Field::template At<n> u(field_);
    Group<n> y = make_group<n>([&](std::size_t i) HWY_ATTR { return load_tracer(tracers_, who[i]); });
    std::array<bool, n> moving{};
    std::fill_n(moving.begin(), different, true);
    std::size_t left = different, steps = 0;
    for (std::size_t s = 0; s < count_ && left > 0; ++s) {
      const double t = leg_.from + static_cast<double>(s) * dt_;
      Group<n> next = rk4_step(u, t, y, dt_);
      bool good = true;
#pragma GCC unroll 8
      for (std::size_t i = 0; i < n; ++i) good = gate_.passes(next.tracer[i]) && good;
      if (HWY_UNLIKELY(!good)) {
        for (std::size_t i = 0; i < n; ++i) {
          if (!moving[i] || gate_.passes(next.tracer[i])) continue;
          next.tracer[i] = y.tracer[i];
          if (creep(t, next.tracer[i], who[i])) continue;
          store_tracer(next.tracer[i], tracers_, who[i]);
          moving[i] = false;
          --left;
        }
        // The places of those that stopped are filled by one that moves.
        const auto any = static_cast<std::size_t>(std::find(moving.begin(), moving.end(), true) - moving.begin());
        if (left > 0)
          for (std::size_t i = 0; i < n; ++i)
            if (!moving[i]) next.tracer[i] = next.tracer[any];
      }
      y = next;
      steps += left;
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (!moving[i]) continue;
      store_tracer(y.tracer[i], tracers_, who[i]);
    }
    for (std::size_t i = 0; i < different; ++i) tracers_.longest_step[who[i]] = dt_;
    return steps;
  }

 private:
  /// Makes one step in pieces that halve wherever they fail. False when the tracer has stopped on the way.
  HWY_NOINLINE bool creep(double t, Four& y, std::size_t tracer) {
    typename Field::template At<1> u(field_);
    for (int done = 0, piece = finest / 2; done < finest;) {
      const double now = t + dt_ * done / finest;
      const Four next = rk4_step(u, now, Group<1>{{y}}, dt_ * piece / finest).tracer[0];
      if (gate_.passes(next)) {
        y = next;
        done += piece;
      } else if (piece > 1) {
        piece /= 2;
      } else {
        stop_tracer(gate_.why_not(next), now, tracers_, tracer);
        return false;
      }
    }
    return true;
  }

  const Leg& leg_;
  Field field_;
  Gate gate_;
  std::size_t count_;
  double dt_;
  const TracerColumns& tracers_;
};

constexpr std::size_t together = 4;

struct MoveFixed {
  std::size_t count;
  template <class Field>
  LegCounts operator()(const Leg& leg, const TracerColumns& tracers, std::size_t begin, std::size_t end) const {
    Fixed<Field> fixed(leg, count, tracers);
    LegCounts counts;
    for (std::size_t next = begin; next < end;) {
      std::array<std::size_t, together> who{};
      std::size_t n = 0;
      for (; next < end && n < together; ++next)
        if (tracers.stop[next] == TracerStop::moving) who[n++] = next;
      if (n == 0) break;
      std::fill(who.begin() + static_cast<std::ptrdiff_t>(n), who.end(), who[0]);
      counts.steps += fixed.move(who, n);
    }
    return counts;
  }
};

/// Steps of the embedded pair, each as long as its error allows.
template <class Field>
class Adaptive {
 public:
  Adaptive(const Leg& leg, const AdaptiveSteps& steps, const TracerColumns& tracers)
      : leg_(leg),
        field_(leg.flow),
        gate_(leg),
        steps_(steps),
        voxel_(leg.flow.first().lattice().voxel()),
        shortest_(8 * std::numeric_limits<double>::epsilon() * std::max(std::abs(leg.from), std::abs(leg.until))),
        tracers_(tracers) {}

  LegCounts move(std::size_t tracer) {
    typename Field::template At<1> u(field_);
    LegCounts counts;
    double t = leg_.from;
    Group<1> y{{load_tracer(tracers_, tracer)}};
    Group<1> k = u(t, y);
    double step = tracers_.next_step[tracer] > 0 ? tracers_.next_step[tracer] : first_step(k.tracer[0]);
    double longest = 0;
    while (t < leg_.until) {
      const double rest = leg_.until - t;
      const double now =
          std::min({std::max(std::min(step, voxel_ / speed_of(k.tracer[0])), shortest_), steps_.longest, rest});
      const EmbeddedStep<Group<1>> next = bogacki_shampine_step(u, t, y, k, now);
      const TracerStop obstacle =
          gate_.passes(next.y.tracer[0]) ? gate_.obstacle(next.last.tracer[0]) : gate_.why_not(next.y.tracer[0]);
      if (obstacle != TracerStop::moving) {
        ++counts.rejected;
        if (is_fine(now, k.tracer[0])) {
          stop_tracer(obstacle, t, tracers_, tracer);
          break;
        }
        step = now / 2;
        continue;
      }
      const double error = error_of(next);
      const double factor = std::clamp(0.9 * std::cbrt(1 / error), 0.2, 5.0);
      if (error > 1 && now > shortest_) {
        ++counts.rejected;
        step = now * factor;
        continue;
      }
      ++counts.steps;
      longest = std::max(longest, now);
      t = now == rest ? leg_.until : t + now;
      y = next.y;
      k = next.last;
      step = now < step ? std::max(step, now * factor) : now * factor;
    }
    store_tracer(y.tracer[0], tracers_, tracer);
    tracers_.next_step[tracer] = step;
    tracers_.longest_step[tracer] = longest;
    return counts;
  }

 private:
  static double speed_of(const Four& k) {
    double value[flow_lanes];
    store(k, value);
    return std::hypot(value[0], value[1], value[2]);
  }

  /// A tenth of a voxel; the error estimate corrects it soon.
  double first_step(const Four& k) const {
    const double speed = speed_of(k);
    return speed > 0 ? 0.1 * voxel_ / speed : leg_.until - leg_.from;
  }

  /// Whether a step that fails is too short to be halved: the tracer is at the edge.
  bool is_fine(double step, const Four& k) const {
    return !(step * speed_of(k) > voxel_ / finest) && step <= (leg_.until - leg_.from) / finest;
  }

  /// In units of what is tolerated. An undefined strain has no error.
  double error_of(const EmbeddedStep<Group<1>>& step) const {
    double error[flow_lanes], y[flow_lanes];
    store(step.error.tracer[0], error);
    store(step.y.tracer[0], y);
    double worst = 0;
    for (std::size_t i = 0; i < flow_lanes; ++i) {
      const double tolerated = i < 3 ? steps_.tolerance : steps_.tolerance / voxel_;
      const double rounding = 4 * std::numeric_limits<double>::epsilon() * std::abs(y[i]);
      if (!std::isnan(error[i])) worst = std::max(worst, std::abs(error[i]) / std::max(tolerated, rounding));
    }
    return worst;
  }

  const Leg& leg_;
  Field field_;
  Gate gate_;
  AdaptiveSteps steps_;
  double voxel_, shortest_;
  const TracerColumns& tracers_;
};

struct MoveAdaptive {
  AdaptiveSteps steps;
  template <class Field>
  LegCounts operator()(const Leg& leg, const TracerColumns& tracers, std::size_t begin, std::size_t end) const {
    Adaptive<Field> adaptive(leg, steps, tracers);
    LegCounts counts;
    for (std::size_t i = begin; i < end; ++i) {
      if (tracers.stop[i] != TracerStop::moving) continue;
      const LegCounts more = adaptive.move(i);
      counts.steps += more.steps;
      counts.rejected += more.rejected;
    }
    return counts;
  }
};

/// Calls f<Field>(...) for the kind of field that the flow is.
template <class F>
LegCounts with_field(const F& f, const Leg& leg, const TracerColumns& tracers, std::size_t begin, std::size_t end) {
  const bool linear = leg.flow.first().blocks().interpolation == Interpolation::trilinear;
  constexpr auto trilinear = Interpolation::trilinear, tricubic = Interpolation::tricubic;
  if (leg.flow.steady())
    return linear ? f.template operator()<MeanFlow<trilinear>>(leg, tracers, begin, end)
                  : f.template operator()<MeanFlow<tricubic>>(leg, tracers, begin, end);
  return linear ? f.template operator()<FrameFlow<trilinear>>(leg, tracers, begin, end)
                : f.template operator()<FrameFlow<tricubic>>(leg, tracers, begin, end);
}

LegCounts AdvanceFixed(const Leg& leg, std::size_t count, const TracerColumns& tracers, std::size_t begin,
                       std::size_t end) {
  return with_field(MoveFixed{count}, leg, tracers, begin, end);
}
LegCounts AdvanceAdaptive(const Leg& leg, const AdaptiveSteps& steps, const TracerColumns& tracers, std::size_t begin,
                          std::size_t end) {
  return with_field(MoveAdaptive{steps}, leg, tracers, begin, end);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {
HWY_EXPORT(AdvanceFixed);
HWY_EXPORT(AdvanceAdaptive);
LegCounts advance_fixed(const Leg& leg, std::size_t count, const TracerColumns& tracers, std::size_t begin,
                        std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(AdvanceFixed)(leg, count, tracers, begin, end);
}
LegCounts advance_adaptive(const Leg& leg, const AdaptiveSteps& steps, const TracerColumns& tracers, std::size_t begin,
                           std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(AdvanceAdaptive)(leg, steps, tracers, begin, end);
}
}  // namespace grainvdb
#endif
