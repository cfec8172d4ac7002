#pragma once
/// Contact forces as a run used them, from those that its dump holds.
#include "grainvdb/frame.hpp"
#include "grainvdb/half_step.hpp"

namespace grainvdb {

/// Dumps evaluate contact forces with the velocities v(n) of the full step, the velocity-Verlet steps of LIGGGHTS and
/// LAMMPS with those of the half step, v(n-½) = v(n) - ½ dt f/m. The normal damping -γ v_n of the run is larger by
/// ½ γ dt (f_i/m_i - f_j/m_j)·n, n from j to i, which is added to the force on i and taken from that on j; the
/// tangential force of a contact that slides follows the normal one. The second particle of a pair across a periodic
/// side is an image, whose dumped velocity is that of the half step already: its part is left out. A wall is taken as
/// one of the same material that does not accelerate: m* and R* are those of the grain, n points from the contact point
/// to its centre, and the overlap is what is missing to its radius there. Needs the columns of half_step_columns().
/// Contacts that name a particle which the frame lacks are left to half_branches() and wall_half_branches(), which
/// refuse them.
void correct_half_step(const HalfStep& spec, Frame& frame);

/// The columns that the correction reads, contacts apart.
ColumnSet half_step_columns(const HalfStep& spec);

}  // namespace grainvdb
