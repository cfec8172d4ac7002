#pragma once
/// Standard errors of fields: each is derived again without each block of frames.
#include <cstddef>

#include "average/moment_sums.hpp"
#include "average/window_sums.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/units.hpp"
#include "pipeline/derive_fields.hpp"
#include "pipeline/wall_treatment.hpp"

namespace grainvdb {

/// What fields are derived with, apart from the sums.
struct DeriveSetting {
  const Pipeline& pipeline;
  const ErrorPlan& errors;
  const Lattice& lattice;
  const UnitSystem& units;
  WallTreatment* walls;  ///< nullptr: none
};

/// Adds the standard errors of the setting to `all`, which holds the fields that they are of, derived from
/// `means` as the walls leave them. An error is undefined where its field is and, with Reason::few_blocks, where the
/// field is without one of the blocks or only one of them reaches the voxel. Blocks without a frame do not count.
void derive_errors(const DeriveSetting& setting, const WindowSums& sums, const MomentMeans& means, DerivedFields& all);

/// Bytes that a leaf takes while it works, apart from the sums.
std::size_t error_bytes_per_leaf(const Plan& plan);

}  // namespace grainvdb
