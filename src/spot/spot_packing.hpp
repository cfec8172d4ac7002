#pragma once
/// The grains that a spot run starts from: of a dump, random, or on a lattice.
#include <string>
#include <vector>

#include "spot/spot_file.hpp"
#include "spot/spot_values.hpp"

namespace grainvdb::spot {

/// The dumps that packing.dump names, by their whole paths.
std::vector<std::string> packing_dumps(const Values& v, const std::string& file);

/// The lattice of packing.lattice in that box. Throws ConfigError for one that does not fit.
StaggeredLattice read_lattice(const Values& v, const Box& box);

/// The packing of the file in run.container; counts the grains that are left out, and takes the unit system of a dump
/// where run.units is empty. Throws ConfigError, InputError, IoError or LimitError as load_spot_run does.
Packing make_packing(const Values& v, const std::string& file, SpotRun& run);

}  // namespace grainvdb::spot
