#pragma once
#include <algorithm>
#include <string>

#include "grainvdb/plan.hpp"

namespace grainvdb {

/// Also of a species alone.
inline bool runs_stage(const Plan& plan, const std::string& stage) {
  return std::any_of(plan.stages.begin(), plan.stages.end(),
                     [&](const Stage* s) { return s->name == stage || s->species_of == stage; });
}

}  // namespace grainvdb
