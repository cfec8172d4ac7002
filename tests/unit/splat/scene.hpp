#pragma once
/// Small random scenes and an independent brute force over all their voxels, for the tests of the splat.
#include <cstdint>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/leaf_buffers.hpp"

namespace grainvdb {

/// A box on a lattice, and a kernel cutoff.
struct Scene {
  std::string name;
  Box box;
  double voxel = 0;
  Vec3 origin{};
  double cutoff = 0;

  Lattice lattice() const;
  /// The shortest difference from b to a, written out by trying the neighbouring images.
  Vec3 shortest(const Vec3& a, const Vec3& b) const;
  /// All voxels of the stored period, along open axes those of the box and a margin of `margin` around it.
  std::vector<Coord> voxels(double margin) const;
  /// Positions in the box, on its bounds and voxel centres, slightly outside, and along periodic axes many periods
  /// away.
  Columns3 random_positions(std::size_t n, std::uint64_t seed) const;
};
std::ostream& operator<<(std::ostream& out, const Scene& scene);

/// Periodic, mixed and open boxes; numbers of voxels that are no multiples of 8; lattices that are not aligned with the
/// box; negative indices; a reach of a little more than a leaf and a half voxel (8.7 voxels).
const std::vector<Scene>& scenes();

/// q values between -1 and 1.
std::vector<double> random_values(std::size_t n, std::uint64_t seed);

Vec3 row(const Columns3& columns, std::size_t k);
double norm(const Vec3& v);

/// The value at a voxel, 0 outside the topology.
double value_at(const LeafBuffers& buffers, const Coord& c, int channel);
bool is_active(const Topology& topology, const Coord& c);

/// Checks that nothing was written to voxels that are not active.
void expect_zero_where_inactive(const LeafBuffers& buffers);
/// Checks that f gives the same bytes with one thread and with two.
void expect_same_bytes_for_any_threads(const std::function<LeafBuffers()>& f);

/// The kernel of physics eq. (9), its largest gradient 3.7136/c⁴ and largest second derivative 1260/(16 π c⁵).
double lucy(double r, double c);
double lucy_peak(double c);
double largest_gradient(double c);
double largest_curvature(double c);
/// How far rounding may move a voxel against a particle: some units of the largest coordinate.
double position_error(const Columns3& position);

}  // namespace grainvdb
