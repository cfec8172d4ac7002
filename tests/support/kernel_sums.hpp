#pragma once
/// Kernel sums over particles and contacts by brute force: every voxel against every particle and all its images, in
/// double precision, with the sum of the magnitudes of the terms alongside.
#include <cstddef>
#include <vector>

#include "grainvdb/frame.hpp"
#include "support/voxel_box.hpp"

namespace grainvdb::testing {

/// Values per voxel, laid out [voxel][channel].
struct Sums {
  Sums(std::size_t voxels, int n) : channels(n), value(voxels * static_cast<std::size_t>(n)), magnitude(value.size()) {
    reached.resize(voxels);
  }
  double& at(std::size_t voxel, int channel = 0) { return value[index(voxel, channel)]; }
  double at(std::size_t voxel, int channel = 0) const { return value[index(voxel, channel)]; }
  double size(std::size_t voxel, int channel = 0) const { return magnitude[index(voxel, channel)]; }
  std::size_t index(std::size_t voxel, int channel) const {
    return voxel * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel);
  }
  Sums& operator+=(const Sums& o);

  int channels;
  std::vector<double> value;
  std::vector<double> magnitude;  ///< Σ |terms|
  std::vector<int> reached;       ///< frames in which a kernel reached the voxel
};

/// Σ W(|d|) over the images of the difference d.
double lucy_of_images(const Box& box, const Vec3& d, double cutoff);

/// Lucy's W at distance r, written as in physics eq. (9).
double lucy(double r, double cutoff);

/// Nodes on [0, 1] and weights that add up to 1.
struct Quadrature {
  std::vector<double> node, weight;
};
Quadrature gauss_legendre(int n);

/// ∫₀¹ W(|d + s a|) ds by Gauss-Legendre quadrature of 20 points on each piece between the rim of the support, the foot
/// of the perpendicular and points near it, where the odd power of r bends most. The error is of the order of rounding.
double line_mean(const Vec3& d, const Vec3& a, double cutoff);

/// Half branches of a frame's contacts, both of each contact: start x_α, arm a = x_α - c as the minimum image, force on
/// α.
struct Branches {
  std::vector<Vec3> start, arm, force;
  std::size_t size() const { return start.size(); }
};
Branches branches_of(const Frame& frame);

/// Σ q_α W. `q` is laid out [particle][channel].
Sums particle_sums(const VoxelBox& box, double cutoff, const Particles& p, const std::vector<double>& q, int channels);
/// Σ q_α W².
Sums square_sums(const VoxelBox& box, double cutoff, const Particles& p, const std::vector<double>& q, int channels);
/// Σ q_α ∂_j W, channel 3 v + j.
Sums gradient_sums(const VoxelBox& box, double cutoff, const Particles& p, const std::vector<double>& q, int values);
/// Σ q ∫₀¹ W(x - x_α + s a) ds; gauss_points 0 is the integral itself, otherwise the rule of so many points.
Sums branch_sums(const VoxelBox& box, double cutoff, const Branches& b, const std::vector<double>& q, int channels,
                 int gauss_points);
/// Σ |q| over the branches that reach a voxel, for bounds on errors of their integrals.
Sums branch_magnitudes(const VoxelBox& box, double cutoff, const Branches& b, const std::vector<double>& q,
                       int channels);

}  // namespace grainvdb::testing
