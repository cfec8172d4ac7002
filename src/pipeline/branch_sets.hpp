#pragma once
/// The sets of half branches that moments sum over.
#include <cstddef>
#include <map>
#include <set>

#include "grainvdb/frame.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/walls.hpp"

namespace grainvdb {

using BranchSets = std::map<BranchKind, HalfBranches>;

/// Whether the selection keeps particle i.
bool is_selected(const Selection& selection, const Box& box, const Particles& particles, std::size_t i);
/// Whether it is a wall grain: one of walls.types or, where none are named, one that the selection leaves out.
bool is_wall_grain(const WallSpec& walls, const Selection& selection, const Box& box, const Particles& particles,
                   std::size_t i);

/// The wanted sets of the half branches of a frame's contacts, those with walls that are no grains behind the others.
/// Throws InputError as half_branches does, whatever is wanted.
BranchSets make_branch_sets(const Frame& frame, const Pipeline& pipeline, const std::set<BranchKind>& wanted);

}  // namespace grainvdb
