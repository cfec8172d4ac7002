#pragma once
/// The species of the particles of a frame.
#include <string>
#include <vector>

#include "grainvdb/species.hpp"

namespace grainvdb {

/// The number of the species of every particle of the frame, as Particles has it. Throws InputError for a particle that
/// belongs to two.
std::vector<int> species_of_particles(const Frame& frame, const std::vector<Species>& species);

/// "small: types 1, 2 and diameter 0.001 to 0.002".
std::string to_string(const Species& species);

}  // namespace grainvdb
