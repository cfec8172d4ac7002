#pragma once
/// Runs the stages of a plan on averaged moments.
#include <cstddef>
#include <map>
#include <string>

#include "average/moment_sums.hpp"
#include "grainvdb/mask.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/sparse_field.hpp"
#include "grainvdb/units.hpp"

namespace grainvdb {

struct DerivedFields {
  std::map<std::string, SparseField> fields;  ///< those that the pipeline wants
  Mask mask;
  std::size_t grids = 0;  ///< OpenVDB grids that were allocated
};

/// Each field lives until the last stage that needs it has run; only those in pipeline.fields are kept.
DerivedFields derive_fields(const Pipeline& pipeline, const Plan& plan, const Lattice& lattice, const UnitSystem& units,
                            const MomentMeans& means);

}  // namespace grainvdb
