#pragma once
/// From the columns of a particle dump to particles.
#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "grainvdb/frame.hpp"
#include "grainvdb/frame_source.hpp"
#include "read/dump_file.hpp"

namespace grainvdb {

/// Which columns of a table become which quantity: indices into DumpTable::real, or DumpTable::whole for id and type.
struct ParticleLayout {
  TableRequest request;
  std::size_t id = 0;
  std::optional<std::size_t> type;
  std::array<std::size_t, 3> position{};
  bool scaled = false;  ///< positions are fractions of the box: x = lo + xs (hi - lo)
  std::optional<std::array<std::size_t, 3>> velocity;
  std::optional<std::array<std::size_t, 3>> angular_velocity;
  std::optional<std::array<std::size_t, 3>> force;
  std::optional<std::size_t> radius;
  double radius_factor = 1;  ///< ½ for a column of diameters
  double common_radius = 0;  ///< where the dump has no radii [length]
  std::optional<std::size_t> mass;
  std::optional<std::size_t> density;  ///< a column of the dump, for m = ρ 4/3 π r³
  double common_density = 0;           ///< where the dump has neither masses nor densities [mass/length³]
  ColumnSet wanted;
};

/// Finds the columns that the wanted quantities need. Throws InputError that names all that are missing.
ParticleLayout particle_layout(const FrameHeader& header, const std::string& file, const InputSpec& spec,
                               ColumnSet wanted);

/// Checks and converts a table: ids unique, radii and masses positive, rows in ascending order of id. Throws
/// InputError.
Particles make_particles(const ParticleLayout& layout, DumpTable table, const FrameHeader& header,
                         const std::string& file);

}  // namespace grainvdb
