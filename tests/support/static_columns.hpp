#pragma once
/// Columns of grains at rest on wall grains, whose stress is known.
#include <vector>

#include "grainvdb/frame.hpp"
#include "support/random.hpp"

namespace grainvdb::testing {

/// Three leaning columns of grains of type 1, each on a fixed grain of type 2 that carries it, in a box that is
/// periodic in x and y. Each contact carries the weight above it, straight up.
struct StaticColumns {
  explicit StaticColumns(std::uint64_t seed);

  Frame frame;
  double gravity = 9.81;
  std::vector<double> height, weight;          ///< of each grain of type 1
  std::vector<double> foot_height, foot_load;  ///< contact points with the wall grains, and the forces there
  double total_weight() const;
  double area() const { return frame.box.length(0) * frame.box.length(1); }
};

/// ∫ of the kernel's marginal from -∞ to ζ cutoffs (physics section 2).
double marginal_cdf(double zeta);

}  // namespace grainvdb::testing
