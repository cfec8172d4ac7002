#include "pipeline/measure_needs.hpp"

#include <algorithm>

#include "bin/half_step.hpp"
#include "pipeline/plane_runs.hpp"

namespace grainvdb {
namespace {

template <class F>
bool any_needs(const Pipeline& pipeline, F&& f) {
  return std::any_of(pipeline.measure.begin(), pipeline.measure.end(),
                     [&](const auto& entry) { return f(find_measurement(entry.first)->needs(entry.second)); });
}

}  // namespace

std::optional<ColumnSet> measured_columns(const Pipeline& pipeline) {
  std::optional<ColumnSet> all;
  for (const auto& [name, options] : pipeline.measure)
    if (const auto columns = find_measurement(name)->needs(options).particles)
      all = all.value_or(ColumnSet()) | *columns;
  if (!all) return all;
  if (!pipeline.select.types.empty()) *all |= Column::type;
  const auto& half_step = pipeline.input.contacts.half_step;
  if (half_step && all->has(Column::contacts)) *all |= half_step_columns(*half_step);
  return all;
}

ColumnSet columns_read(const Plan& plan, const Pipeline& pipeline) {
  return all_columns(plan) | measured_columns(pipeline).value_or(ColumnSet()) | plane_columns(pipeline);
}

bool measures_fields(const Pipeline& pipeline) {
  return any_needs(pipeline, [](const MeasurementNeeds& needs) { return !needs.fields.empty(); });
}

bool measures_planes(const Pipeline& pipeline) {
  return any_needs(pipeline, [](const MeasurementNeeds& needs) { return needs.planes.has_value(); });
}

bool measures_with_kernel(const Pipeline& pipeline) {
  return any_needs(pipeline, [](const MeasurementNeeds& needs) { return needs.kernel || needs.planes; });
}

}  // namespace grainvdb
