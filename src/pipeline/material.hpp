#pragma once
/// What is splatted of one frame, whatever the lattice: the particles that count as material, and the contacts.
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>

#include "grainvdb/frame.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/pipeline.hpp"
#include "pipeline/branch_sets.hpp"

namespace grainvdb {

struct Material {
  std::string file;
  std::int64_t step = 0;
  Box box;
  Particles particles;  ///< those that the selection keeps
  BranchSets branches;  ///< those that are wanted
};

/// Keeps the particles that the selection counts as material.
void apply_selection(const Selection& selection, const Box& box, Particles& particles);

/// Makes of dumped contact forces those of the run, where the input says how; nothing else needs the forces on
/// particles, which are dropped.
void use_forces_of_run(const Pipeline& pipeline, Frame& frame);

/// The material by the pipeline's selection and walls, with the sets of half branches that are wanted. Throws
/// InputError for contacts that do not fit the particles, and for a particle that belongs to two species.
Material make_material(Frame frame, const Pipeline& pipeline, const std::set<BranchKind>& wanted);

}  // namespace grainvdb
