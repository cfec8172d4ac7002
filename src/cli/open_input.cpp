#include "cli/open_input.hpp"

#include <algorithm>

namespace grainvdb::cli {

InputSpec needed_input(const Pipeline& pipeline, const Plan& plan) {
  InputSpec spec = pipeline.input;
  if (std::none_of(plan.sweeps.begin(), plan.sweeps.end(),
                   [](const Sweep& sweep) { return sweep.columns.has(Column::contacts); }))
    spec.contacts = {};
  return spec;
}

std::unique_ptr<FrameSource> open_input(const Pipeline& pipeline, const Plan& plan) {
  return open_dumps(needed_input(pipeline, plan));
}

}  // namespace grainvdb::cli
