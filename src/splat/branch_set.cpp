#include "splat/branch_set.hpp"

#include <cmath>
#include <stdexcept>

namespace grainvdb {

BranchSet::BranchSet(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches,
                     LineIntegral method)
    : kernel_(kernel), branches_(branches), method_(method), voxel_(lattice.voxel()) {
  constexpr double absurd = 1e6;
  bool divided = false;
  for (std::size_t b = 0; b < branches.size(); ++b) {
    if (!(length(b) <= absurd)) throw std::invalid_argument("a branch is longer than 1e6 cutoffs");
    divided = divided || division(b).parts > 1;
  }
  if (divided)
    for (std::size_t b = 0; b < branches.size(); ++b)
      source_.insert(source_.end(), static_cast<std::size_t>(division(b).parts), static_cast<std::uint32_t>(b));

  const std::size_t pieces = divided ? source_.size() : branches.size();
  half_arm_.fill(-1);
  Columns3 middle;
  for (auto& column : middle) column.resize(pieces);
  std::size_t piece = 0;
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const LineDivision now = division(b);
    for (int k = 0; k < now.parts; ++k, ++piece)
      for (int a = 0; a < 3; ++a) middle[a][piece] = branches.start[a][b] - (k + 0.5) / now.parts * branches.arm[a][b];
    double& half = half_arm_[static_cast<std::size_t>(points(piece - 1))];
    half = std::max(half, 0.5 * length(b) * kernel.cutoff() / now.parts);
  }
  buckets_ = bin_points(lattice, middle, kernel.cutoff() + std::max(longest_half_arm(), 0.0));
}

double BranchSet::length(std::size_t b) const {
  return std::hypot(branches_.arm[0][b], branches_.arm[1][b], branches_.arm[2][b]) / kernel_.cutoff();
}

LineDivision BranchSet::division(std::size_t b) const {
  switch (method_.method) {
    case LineIntegral::Method::exact:
      return {1, 0};
    case LineIntegral::Method::gauss:
      return {1, method_.gauss_points};
    default:
      return divide_branch(length(b));
  }
}

int BranchSet::points(std::size_t piece) const {
  return division(branch(piece)).points;
}

std::span<const LineNode> BranchSet::rule(int points) const {
  return method_.method == LineIntegral::Method::gauss ? gauss_rule(points) : lucy_rule(points);
}

Vec3 BranchSet::arm(std::size_t piece) const {
  const std::size_t b = branch(piece);
  const double part = share(piece);
  return {part * branches_.arm[0][b], part * branches_.arm[1][b], part * branches_.arm[2][b]};
}

Vec3 BranchSet::from_start(const Vec3& d, const Vec3& arm) const {
  // x - x_α = x - middle - a/2
  return {d[0] * voxel_ - 0.5 * arm[0], d[1] * voxel_ - 0.5 * arm[1], d[2] * voxel_ - 0.5 * arm[2]};
}

double BranchSet::weight(std::size_t piece, const Vec3& d) const {
  const Vec3 a = arm(piece);
  const Vec3 p = from_start(d, a);
  const int n = points(piece);
  return n == 0 ? kernel_.line_integral(p, a) : kernel_.line_integral(p, a, rule(n));
}

bool BranchSet::reaches(std::size_t piece, const Vec3& d) const {
  const Vec3 a = arm(piece);
  return kernel_.reaches(from_start(d, a), a);
}

}  // namespace grainvdb
