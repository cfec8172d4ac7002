#pragma once
/// The partial fields of species as stages: each is made as the field of all grains is, from sums over the grains of
/// the species alone.
#include <string>
#include <vector>

#include "grainvdb/pipeline.hpp"
#include "grainvdb/stage.hpp"

namespace grainvdb {

/// The field of a species: "phi_small".
std::string name_of_partial(const std::string& field, const std::string& species);

/// The names of the fields that there are of each species.
std::vector<std::string> fields_by_species(const StageRegistry& registry);

/// The stages of the registry, then for each of the pipeline's species its fields and their standard errors. Throws
/// ConfigError for a species whose name would make a name of a field that there is already.
StageRegistry with_species(const StageRegistry& registry, const Pipeline& pipeline);

/// Σ over the grains, or half branches, of species number `index` alone of a moment of particles or contacts. What the
/// moment is measured from, as the mean velocity in u' = v - u(x_α), stays that of all grains: so moments of species
/// add up to that of all.
MomentPtr moment_of_species(const MomentPtr& all, const Species& species, int index);

}  // namespace grainvdb
