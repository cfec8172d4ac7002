#pragma once
#include <algorithm>
#include <string>

#include "grainvdb/plan.hpp"

namespace grainvdb {

inline bool runs_stage(const Plan& plan, const std::string& stage) {
  return std::any_of(plan.stages.begin(), plan.stages.end(), [&](const Stage* s) { return s->name == stage; });
}

}  // namespace grainvdb
