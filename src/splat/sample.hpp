#pragma once
/// Fields sampled at particles: the inverse of the splat, for fluctuations about the local mean.
#include <array>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/leaf_buffers.hpp"

namespace grainvdb {

/// A voxel beside a position and its trilinear weight there. The voxel may lie one outside the stored period.
struct Surrounding {
  Coord voxel;
  double weight = 0;
};
/// The eight voxels around a position, the lowest first; the weights add up to 1.
using Surroundings = std::array<Surrounding, 8>;
Surroundings surroundings(const Lattice& lattice, const Vec3& position);

/// Throws std::logic_error unless the sum of weights at a voxel that is sampled is positive.
void require_reached(const Coord& voxel, double total);
/// What is made of a position that is not surrounded by voxels with a positive denominator.
enum class Outside {
  refuse,    ///< it is a mistake: std::logic_error
  undefined  ///< the ratio is NaN there: not all leaves were computed
};

/// A vector ratio on leaves: channels first … first+2 of `numerator` over one channel of `denominator`. Their
/// topologies may differ.
struct RatioView {
  LeafBlocks numerator;
  int first = 0;
  LeafBlocks denominator;
  int channel = 0;
  Outside outside = Outside::refuse;
};

/// The ratio formed at the eight voxels around each position and interpolated trilinearly, with periodic wrap. Every
/// position must be surrounded by voxels with a positive denominator (true for c > √3 h and particles that were
/// splatted), but as `outside` says.
std::vector<Vec3> sample_trilinear(const Lattice& lattice, const RatioView& ratio, const Columns3& position);

/// Numerator and denominator are summed over the homogeneous axes first; then the ratio is interpolated linearly along
/// the others (a constant when all three are homogeneous).
std::vector<Vec3> sample_profile(const Lattice& lattice, const RatioView& ratio, const Columns3& position,
                                 std::array<bool, 3> homogeneous);

}  // namespace grainvdb
