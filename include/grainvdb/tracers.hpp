#pragma once
/// Points that are carried by the velocity: dx/dt = u(x,t), with the strain ∫|γ̇|dt along the way.
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <variant>
#include <vector>

#include "grainvdb/box.hpp"
#include "grainvdb/flow.hpp"
#include "grainvdb/frame.hpp"
#include "grainvdb/seeds.hpp"
#include "grainvdb/tracer_sink.hpp"

namespace grainvdb {

/// The classic Runge-Kutta method of order 4 with equal steps of at most `longest` > 0 [time].
struct FixedSteps {
  double longest = 0;
};

/// The embedded Runge-Kutta pair 3(2) of Bogacki and Shampine, one step length per tracer. The estimated error of a
/// step is at most `tolerance` > 0 along each axis [length], and at most tolerance/h in the strain [1]; where rounding
/// of the position is coarser than that, it is the bound. Between voxels a trilinear velocity bends, and there the
/// error may be up to 3.2 times its estimate (pairs of higher order are out by 20 to 80). Errors of steps add up along
/// the way.
struct AdaptiveSteps {
  double tolerance = 0;
  double longest = std::numeric_limits<double>::infinity();  ///< of a step, > 0 [time]
};

/// What becomes of a tracer where a quantity that is recorded is undefined but the velocity is not.
enum class OnUndefined : std::uint8_t {
  stop,      ///< it stops: TracerStop::masked
  carry_on,  ///< it moves on, with NaN for that quantity (the strain stays NaN from there on)
};

/// Beyond these, histories through frames mean nothing.
struct StepLimits {
  double courant = 1;            ///< of Co = |u|Δt/h
  double gradient_number = 0.3;  ///< of K = |∇u|Δt
};

struct TracerSettings {
  std::variant<FixedSteps, AdaptiveSteps> stepping;
  OnUndefined on_undefined = OnUndefined::stop;
  bool step_numbers = false;  ///< whether Co and K are computed
  StepLimits limits{};        ///< above which they are counted
};

/// One entry per tracer.
struct TracerState {
  std::vector<std::int64_t> id;                    ///< ascending
  Columns3 seed;                                   ///< unwrapped [length]
  Columns3 position;                               ///< wrapped into the box along its periodic axes [length]
  std::array<std::vector<std::int32_t>, 3> image;  ///< unwrapped = position + image × period
  std::vector<double> strain;                      ///< ∫|γ̇|dt [1]; 0 where the flow has no shear rate
  std::vector<double> courant, gradient_number;    ///< of the last advance; NaN before, empty unless asked for
  std::vector<TracerStop> stop;
  std::vector<double> stop_time;  ///< of the position at which a tracer stopped; NaN while it moves [time]
};

/// What an advance did.
struct AdvanceReport {
  std::size_t moving = 0;                ///< tracers that still move
  std::size_t steps = 0;                 ///< taken, over all tracers
  std::size_t rejected = 0;              ///< of the adaptive method, to be tried again with a shorter step
  std::size_t above_courant_limit = 0;   ///< moving tracers with Co above its limit; 0 unless asked for
  std::size_t above_gradient_limit = 0;  ///< moving tracers with K above its limit; 0 unless asked for
};

/// A set of tracers at one time. Memory: at most 118 bytes per tracer, whatever the length of the
/// histories.
class Tracers {
 public:
  /// Seeds outside an open side of the box have left the domain, seeds without velocity the material: they are kept,
  /// with that stop code. Throws std::invalid_argument when there are no seeds, a coordinate or the time is not finite,
  /// a step or tolerance is not positive, or the periods of the flow's lattice are not those of the box.
  Tracers(const TracerSeeds& seeds, const Box& box, const Flow& flow, double start, const TracerSettings& settings);

  /// Moves the tracers on to the time `until` > time(). A step that would leave the material or the domain is halved up
  /// to seven times, so that a tracer stops within 1/128 of a step of the edge (fixed steps), or within 1/128 voxel
  /// (adaptive). The result has the same bytes for any number of threads. Co and K are taken where an advance begins,
  /// with Δt the time between the frames of the flow, or the longest step of the advance when the flow is steady; |∇u|
  /// = √(∇u:∇u). Throws std::invalid_argument when `until` is not later, or not within the frames of the flow.
  AdvanceReport advance(const Flow& flow, double until);

  std::size_t size() const { return state_.id.size(); }
  double time() const { return time_; }
  const Box& box() const { return box_; }
  const TracerSettings& settings() const { return settings_; }
  const TracerState& state() const { return state_; }

  /// Stops a tracer that moves, here and now.
  void stop(std::size_t tracer, TracerStop why);

 private:
  Box box_;
  TracerSettings settings_;
  double time_;
  TracerState state_;
  std::vector<double> next_step_;  ///< that the adaptive method would try [time]
};

}  // namespace grainvdb
