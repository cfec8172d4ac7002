#pragma once
/// Tracers through a sampled velocity.
#include "sizes.hpp"

namespace grainvdb::bench {

/// tracers/…: steps of the classic Runge-Kutta method through the mean of a run, of other kinds, and the baseline.
void register_tracers(const Sizes& sizes);

/// Checks that the library's steps and those of the baseline lead to the same places.
void check_tracers(const Sizes& sizes);

}  // namespace grainvdb::bench
