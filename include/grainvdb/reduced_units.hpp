#pragma once
/// Units that the grains and gravity make, in which results of different set-ups can be compared.
#include <string>

#include "grainvdb/units.hpp"

namespace grainvdb {

/// Lengths in units of d, times of √(d/g), masses of ρ_p d³: numbers as in a simulation with d = g = ρ_p = 1.
struct ReducedUnits {
  double diameter = 0;  ///< d > 0 [length]
  double gravity = 0;   ///< g > 0 [length/time²]
  double density = 0;   ///< ρ_p > 0, of the grains [mass/length³]

  /// One unit of a quantity, in units of the dump: what its values are divided by.
  double size(const Dimension& quantity) const;
  /// Made of rho_p, g, d and a root: "rho_p g d" for a stress, "sqrt(d/g)" for a time, "1" for a pure number.
  static std::string symbol(const Dimension& quantity);
};

}  // namespace grainvdb
