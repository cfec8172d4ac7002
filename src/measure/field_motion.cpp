#include "measure/field_motion.hpp"

#include <algorithm>

#include "grainvdb/run.hpp"

namespace grainvdb {

void FieldMotion::take(const OutputFields& output) {
  if (output.time.frame_count == 0) return;
  spans_.push_back({output.time.first_step, output.time.last_step,
                    FlowGrid(lattice_, output.fields.at("velocity"), nullptr, Interpolation::trilinear)});
}

const FieldMotion::Span* FieldMotion::at_step(std::int64_t step) const {
  const auto it = std::find_if(spans_.begin(), spans_.end(),
                               [step](const Span& span) { return span.first <= step && step <= span.last; });
  return it == spans_.end() ? nullptr : &*it;
}

std::optional<Vec3> FieldMotion::at(std::int64_t step, const Vec3& x) const {
  const Span* span = at_step(step);
  if (span == nullptr) return {};
  const std::optional<FlowValue> value = span->velocity.at(x);
  if (!value) return {};
  return value->velocity;
}

}  // namespace grainvdb
