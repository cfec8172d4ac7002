#pragma once
/// Runs stages on averaged moments.
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "average/moment_sums.hpp"
#include "grainvdb/mask.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/sparse_field.hpp"
#include "grainvdb/stage.hpp"
#include "grainvdb/units.hpp"

namespace grainvdb {

struct DerivedFields {
  std::map<std::string, SparseField> fields;  ///< those that were to be kept
  Mask mask;
  std::size_t grids = 0;  ///< OpenVDB grids that were allocated
};

/// Runs stages, each of which comes after its needs. Each field lives until the last stage that needs it has run; only
/// those named in `kept` stay.
DerivedFields derive_fields(const Pipeline& pipeline, const std::vector<const Stage*>& stages,
                            const std::set<std::string>& kept, const Lattice& lattice, const UnitSystem& units,
                            const MomentMeans& means);

/// What a field says of itself.
FieldMeta meta_of(const Stage& stage, const UnitSystem& units);

}  // namespace grainvdb
