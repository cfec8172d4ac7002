#pragma once
/// The contacts of a frame as half branches, from each particle's centre to the contact point.
#include <cstddef>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/moment.hpp"

namespace grainvdb {

/// Two half branches per contact, in the order of the contacts, id1's before id2's: start x_α, arm a = x_α - c (physics
/// eq. 8) as the minimum image, force F on id1 and -F on id2. Without contact points the radius-weighted point of the
/// line of centres is taken: with l = x_1 - x_2, a_12 = l r₁/(r₁+r₂), a_21 = -l r₂/(r₁+r₂).
/// Needs the particles' ids and positions, and radii where there are no contact points; with radii no arm may be longer
/// than two radii of its particle. Throws InputError when a contact names a particle that the frame lacks, joins a
/// particle with itself, has an arm that is too long, or has neither a point nor radii.
HalfBranches half_branches(const Frame& frame);

/// One half branch per wall contact, in their order: from the particle's centre to the contact point, with the force of
/// the wall. Its partner, of length zero in the wall, carries no stress and is left out. Throws InputError as
/// half_branches does.
HalfBranches wall_half_branches(const Frame& frame);

/// The row of the particle in which each half branch lies, of a frame that half_branches accepts.
std::vector<std::size_t> branch_particles(const Frame& frame);
/// The same for wall_half_branches.
std::vector<std::size_t> wall_branch_particles(const Frame& frame);

}  // namespace grainvdb
