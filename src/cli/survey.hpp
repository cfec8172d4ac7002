#pragma once
/// What a frame says about the grains in it, and the kernel and lattice that suit them.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "grainvdb/frame_source.hpp"

namespace grainvdb::cli {

enum class Motion {
  unknown,  ///< the dump has no velocities
  at_rest,  ///< no particle of the type moves
  rigid,    ///< all have one velocity, as the grains of a driven wall have
  flowing
};

/// As `info` prints it: "flowing", "at rest", …
const char* name_of(Motion motion);

/// The particles of one type.
struct Kind {
  int type = 0;
  std::size_t count = 0;
  double least = 0, mean = 0, greatest = 0;  ///< diameter [length]; 0 where the dump has no sizes
  Motion motion = Motion::unknown;
};

struct Survey {
  bool has_types = false;  ///< otherwise there is one kind
  bool has_sizes = false;
  std::vector<Kind> kinds;              ///< in ascending order of type
  std::optional<std::size_t> contacts;  ///< nothing where there are none, or their columns are not known
  std::vector<int> material() const;    ///< the types that flow; all where none is known to
  double mean_diameter() const;         ///< of these [length]; 0 without sizes
};

/// Reads what frame k has of types, sizes, velocities and contacts. Throws InputError or IoError.
Survey survey(FrameSource& source, std::size_t k);

/// c of the kernel: three diameters, or half the shortest periodic length where that is less; rounded down to three
/// digits [length].
double suggested_cutoff(double diameter, const Box& box);

/// The edge of voxels nearest to half a diameter that a whole number of times makes up each periodic length, between a
/// quarter and 0.6 of a diameter; nothing where there is none. Without periodic sides half a diameter, to three digits.
std::optional<double> suggested_voxel(double diameter, const Box& box);

}  // namespace grainvdb::cli
