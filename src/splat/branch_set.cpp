#include "splat/branch_set.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace grainvdb {

BranchSet::BranchSet(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches,
                     LineIntegral method)
    : kernel_(kernel), branches_(branches), method_(method), voxel_(lattice.voxel()) {
  divide();
  buckets_ = bin_points(lattice, middles(), kernel.cutoff() + longest_half_arm_);
}

double BranchSet::length(std::size_t b) const {
  const double x = branches_.arm[0][b], y = branches_.arm[1][b], z = branches_.arm[2][b];
  return std::sqrt(x * x + y * y + z * z) / kernel_.cutoff();
}

void BranchSet::divide() {
  constexpr double absurd = 1e6;
  if (method_.method == LineIntegral::Method::gauss) only_points_ = method_.gauss_points;
  const bool adaptive = method_.method == LineIntegral::Method::adaptive;
  if (adaptive) points_.resize(branches_.size());
  std::array<bool, 9> used{};
  for (std::size_t b = 0; b < branches_.size(); ++b) {
    const double l = length(b);
    if (!(l <= absurd)) throw std::invalid_argument("a branch is longer than 1e6 cutoffs");
    LineDivision division{1, only_points_};
    if (adaptive) {
      division = divide_branch(l);
      points_[b] = static_cast<std::uint8_t>(division.points);
      if (division.parts > 1 && share_.empty()) {
        share_.assign(branches_.size(), 1.0);
        for (std::size_t before = 0; before < b; ++before) source_.push_back(static_cast<std::uint32_t>(before));
      }
      if (!share_.empty()) {
        share_[b] = 1.0 / division.parts;
        source_.insert(source_.end(), static_cast<std::size_t>(division.parts), static_cast<std::uint32_t>(b));
      }
    }
    const auto n = static_cast<std::size_t>(division.points);
    used[n] = true;
    half_arm_[n] = std::max(half_arm_[n], 0.5 * l * kernel_.cutoff() / division.parts);
  }
  for (int n = 0; n <= 8; ++n)
    if (used[static_cast<std::size_t>(n)]) points_used_.push_back(n);
  if (adaptive && points_used_.size() == 1) {
    only_points_ = points_used_[0];
    points_ = {};
  }
  longest_half_arm_ = *std::max_element(half_arm_.begin(), half_arm_.end());
}

Columns3 BranchSet::middles() const {
  const std::size_t pieces = source_.empty() ? branches_.size() : source_.size();
  Columns3 middle;
  for (std::size_t a = 0; a < 3; ++a) {
    middle[a].resize(pieces);
    std::size_t place = 0;  // of the piece in its branch
    for (std::size_t p = 0; p < pieces; ++p) {
      const std::size_t b = branch(p);
      place = p > 0 && branch(p - 1) == b ? place + 1 : 0;
      middle[a][p] = branches_.start[a][b] - (static_cast<double>(place) + 0.5) * share(p) * branches_.arm[a][b];
    }
  }
  return middle;
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
