#pragma once
/// Tiny dumps and a pipeline file that fits them.
#include <string>

#include "cli/command.hpp"

namespace grainvdb::test {

/// A LAMMPS dump of 64 grains of diameter 1 on a cubic lattice in the periodic box [0,4)³, sheared: u_x = z.
std::string dump_text(int step, const std::string& columns = "id type x y z vx vy vz radius mass");

/// Contacts of each grain with its neighbour along z, pressed together by the force 1.
std::string contacts_text(int step);

/// frames/dump<step>.txt and frames/contacts<step>.txt for the steps 0, 100, 200.
void write_dumps(const Folder& folder);

/// p.yaml for these: voxel 0.5, cutoff 1.5, the fields phi and velocity. Line numbers in tests refer to it:
///   1 grainvdb   2 input   3 particles   4 contacts   5 units   6 dt   7 lattice   8 kernel   9 output
std::string pipeline_text();

/// All of the above.
void write_example(const Folder& folder);

}  // namespace grainvdb::test
