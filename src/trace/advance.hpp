#pragma once
/// Moves tracers through a flow over a span of time, several at once with vector instructions.
#include <cstddef>

#include "grainvdb/tracers.hpp"

namespace grainvdb {

/// Where and when tracers move.
struct Leg {
  const Flow& flow;
  double from, until;  ///< [time]
  Vec3 lo, hi;         ///< of the open sides of the box; finite and never reached along periodic axes [length]
  bool needs_strain;   ///< whether tracers stop where the shear rate is undefined
};

/// What moves, one entry per tracer.
struct TracerColumns {
  double *x, *y, *z;  ///< may leave the box along periodic axes [length]
  double* strain;
  TracerStop* stop;      ///< those that stand still are left alone
  double* stop_time;     ///< set where a tracer stops
  double* next_step;     ///< of the adaptive method: what it would try, 0 at first [time]
  double* longest_step;  ///< that was taken [time]
};

struct LegCounts {
  std::size_t steps = 0;     ///< taken, over all tracers
  std::size_t rejected = 0;  ///< of the adaptive method
};

/// Moves the tracers begin … end-1 with `count` equal steps.
LegCounts advance_fixed(const Leg& leg, std::size_t count, const TracerColumns& tracers, std::size_t begin,
                        std::size_t end);
LegCounts advance_adaptive(const Leg& leg, const AdaptiveSteps& steps, const TracerColumns& tracers, std::size_t begin,
                           std::size_t end);

}  // namespace grainvdb
