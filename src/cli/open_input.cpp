#include "cli/open_input.hpp"

#include "pipeline/measure_needs.hpp"

namespace grainvdb::cli {

InputSpec needed_input(const Pipeline& pipeline, const Plan& plan) {
  InputSpec spec = pipeline.input;
  const ColumnSet columns = columns_read(plan, pipeline);
  if (!columns.has(Column::contacts)) spec.contacts = {};
  if (!columns.has(Column::wall_contacts)) spec.wall_contacts = {};
  return spec;
}

std::unique_ptr<FrameSource> open_input(const Pipeline& pipeline, const Plan& plan) {
  return open_dumps(needed_input(pipeline, plan));
}

}  // namespace grainvdb::cli
