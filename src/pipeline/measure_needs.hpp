#pragma once
/// What the measurements of a pipeline need together.
#include <optional>

#include "grainvdb/measurement.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"

namespace grainvdb {

/// What must be read of every frame for them, what the selection and the half-step correction need included; nothing
/// where none looks at frames.
std::optional<ColumnSet> measured_columns(const Pipeline& pipeline);

/// What is read of frames for fields and measurements.
ColumnSet columns_read(const Plan& plan, const Pipeline& pipeline);

/// Whether one of them needs fields.
bool measures_fields(const Pipeline& pipeline);

/// Whether one of them needs exact averages over planes.
bool measures_planes(const Pipeline& pipeline);

/// Whether one of them needs the lattice and the kernel, though it may need no field.
bool measures_with_kernel(const Pipeline& pipeline);

}  // namespace grainvdb
