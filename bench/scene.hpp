#pragma once
/// The material that all benchmarks share: spheres in an open box, a stand-in for a dense packing that needs no
/// simulation, the same on every machine.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/moment.hpp"

namespace grainvdb::bench {

/// V, V u (3), V d, V ω (3), V u u (xx, yy, zz, xy, xz, yz): what the fields from the grains need.
inline constexpr int all_channels = 14;

/// The mean diameter is 1 and the cutoff 3; diameters are uniform in 0.8 … 1.2 and the packing fraction is 0.6.
struct Scene {
  Columns3 position;
  Columns3 velocity;  ///< shear in x along z, and fluctuations
  Columns3 spin;
  std::vector<double> diameter;
  double edge = 0;  ///< of the cube that holds the centres, but for their jitter
  std::size_t size() const { return diameter.size(); }
};
inline constexpr double cutoff = 3;

/// About `particles` spheres on a face-centred cubic lattice, stretched to the packing fraction, each displaced by up
/// to 0.08 along each axis, in random order.
Scene make_scene(std::size_t particles);

/// The first `channels` of all_channels for every particle, [particle][channel].
std::vector<double> moments(const Scene& scene, int channels);

struct Branches : HalfBranches {
  std::vector<std::uint32_t> particle;  ///< where each starts
};

/// Contacts between the three nearest pairs per particle: two half branches each, one after the other, from both
/// centres to the point that divides the line of centres as the radii do, with random forces.
Branches make_branches(const Scene& scene);

/// -F_i a_j of every half branch, [branch][3 i + j].
std::vector<double> stress_values(const HalfBranches& branches);

}  // namespace grainvdb::bench
