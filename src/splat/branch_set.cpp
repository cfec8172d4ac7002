#include "splat/branch_set.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/parallel.hpp"
#include "base/vec3.hpp"

namespace grainvdb {
namespace {

// What the rules leave of lucy_rule_error, 1e-6 W(0), is spent on wholes: half branches that end off the line of the
// whole by ε cutoffs err by up to 1.8 ε, as 1.8/c bounds |∇W|/W(0), and as much again when the contact point is shifted
// along it; values that differ by a part τ from what their lengths ask for err by τ times the difference of the halves'
// means, which is less than 0.5 W(0).
constexpr double off_line = 2e-7;
constexpr double off_value = 4e-7;

}  // namespace

BranchSet::BranchSet(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches,
                     const BranchValues& values, LineIntegral method, const Region* wanted)
    : lattice_(lattice), kernel_(kernel), branches_(branches), values_(values), method_(method) {
  plan();
  buckets_ = bin_points(lattice, middles(), kernel.cutoff() + longest_half_arm_, wanted);
}

Vec3 BranchSet::half(std::size_t b) const {
  return {branches_.arm[0][b], branches_.arm[1][b], branches_.arm[2][b]};
}

void BranchSet::plan() {
  constexpr double absurd = 1e6;
  const bool adaptive = method_.method == LineIntegral::Method::adaptive;
  if (method_.method == LineIntegral::Method::gauss) only_points_ = method_.gauss_points;
  if (has_curvature()) only_points_ = 1;
  const bool divides = adaptive || has_curvature();
  if (divides) plans_.resize(branches_.size());
  bool halves_only = true;
  std::array<bool, 9> used{};
  const auto note = [&](int points, double length) {
    const auto n = static_cast<std::size_t>(points);
    used[n] = true;
    half_arm_[n] = std::max(half_arm_[n], 0.5 * length);
  };
  std::vector<double> wholes(adaptive ? branches_.size() / 2 : 0);
  parallel_for(wholes.size(), [&](std::size_t contact) { wholes[contact] = whole_length(2 * contact); });
  for (std::size_t b = 0; b < branches_.size(); ++b) {
    const Vec3 a = half(b);
    const double length = std::sqrt(dot(a, a));
    if (!(length <= absurd * kernel_.cutoff())) throw std::invalid_argument("a branch is longer than 1e6 cutoffs");
    if (!divides) {
      note(only_points_, length);
      continue;
    }
    if (const double whole = b % 2 == 0 && b / 2 < wholes.size() ? wholes[b / 2] : 0; whole > 0) {
      plans_[b] = {static_cast<std::uint8_t>(divide_branch(whole / kernel_.cutoff()).points), true, 1};
      note(plans_[b].points, whole);
      halves_only = false;
      ++b;
      continue;
    }
    const LineDivision division = adaptive ? divide_branch(length / kernel_.cutoff())
                                           : LineDivision{curved_branch_parts(length / kernel_.cutoff()), only_points_};
    plans_[b] = {static_cast<std::uint8_t>(division.points), false, static_cast<std::uint32_t>(division.parts)};
    note(division.points, length / division.parts);
    halves_only = halves_only && division.parts == 1;
  }
  if (!halves_only)
    for (std::size_t b = 0; b < branches_.size(); b += plans_[b].whole ? 2 : 1)
      source_.insert(source_.end(), plans_[b].parts, static_cast<std::uint32_t>(b));
  for (int n = 0; n <= 8; ++n)
    if (used[static_cast<std::size_t>(n)]) points_used_.push_back(n);
  longest_half_arm_ = *std::max_element(half_arm_.begin(), half_arm_.end());
}

/// The length of the branch that a half branch and the next make up, or 0 if they do not or are better left apart.
double BranchSet::whole_length(std::size_t b) const {
  // The sums of species, which have the halves apart, must add up to that of all to rounding: the terms are the same.
  if (!branches_.species.empty() && branches_.species[b] != branches_.species[b + 1]) return 0;
  const Vec3 a1 = half(b), a2 = half(b + 1);
  const Vec3 l{a1[0] - a2[0], a1[1] - a2[1], a1[2] - a2[2]};
  const double length = std::sqrt(dot(l, l)), length1 = std::sqrt(dot(a1, a1)), length2 = std::sqrt(dot(a2, a2));
  const double cutoff = kernel_.cutoff();
  if (!(dot(a1, a2) < 0) || length > longest_branch(8) * cutoff) return 0;

  // The contact point is the same, or an image, and lies on the line of centres.
  const double near = off_line * cutoff;
  for (int a = 0; a < 3; ++a) {
    const auto k = static_cast<std::size_t>(a);
    double gap = branches_.start[k][b] - a1[k] - (branches_.start[k][b + 1] - a2[k]);
    if (const auto& period = lattice_.period(a)) {
      const double box = period->length * lattice_.voxel();
      gap -= box * std::round(gap / box);
    }
    if (!(std::abs(gap) <= near)) return 0;
  }
  const Vec3 cross{a1[1] * a2[2] - a1[2] * a2[1], a1[2] * a2[0] - a1[0] * a2[2], a1[0] * a2[1] - a1[1] * a2[0]};
  if (!(dot(cross, cross) <= near * near * length * length)) return 0;

  const double* q1 = values_.of(b);
  const double* q2 = values_.of(b + 1);
  for (std::size_t c = 0; c < values_.channels; ++c)
    if (!(std::abs(q1[c] * length2 - q2[c] * length1) <= off_value * (std::abs(q1[c]) + std::abs(q2[c])) * length))
      return 0;
  return length;
}

Columns3 BranchSet::middles() const {
  const std::size_t pieces = source_.empty() ? branches_.size() : source_.size();
  Columns3 middle;
  for (auto& column : middle) column.resize(pieces);
  std::uint32_t place = 0;  // of the piece in its branch
  for (std::size_t p = 0; p < pieces; ++p) {
    const std::size_t b = branch(p);
    place = p > 0 && branch(p - 1) == b ? place + 1 : 0;
    const Vec3 a = arm(p);
    for (std::size_t k = 0; k < 3; ++k) middle[k][p] = branches_.start[k][b] - (place + 0.5) * a[k];
  }
  return middle;
}

std::span<const LineNode> BranchSet::rule(int points) const {
  return method_.method == LineIntegral::Method::adaptive ? lucy_rule(points) : gauss_rule(points);
}

Vec3 BranchSet::arm(std::size_t piece) const {
  const Plan plan = plan_of(piece);
  const Vec3 a = half(branch(piece));
  if (plan.whole) {
    const Vec3 other = half(branch(piece) + 1);
    return {a[0] - other[0], a[1] - other[1], a[2] - other[2]};
  }
  const double share = 1.0 / plan.parts;
  return {share * a[0], share * a[1], share * a[2]};
}

double BranchSet::value(std::size_t piece, std::size_t channel) const {
  const Plan plan = plan_of(piece);
  const std::size_t b = branch(piece);
  return plan.whole ? values_.of(b)[channel] + values_.of(b + 1)[channel] : values_.of(b)[channel] / plan.parts;
}

std::vector<double> BranchSet::values_of_pieces() const {
  std::vector<double> values(source_.size() * channels());
  parallel_for(source_.size(), [&](std::size_t piece) {
    for (std::size_t c = 0; c < channels(); ++c) values[piece * channels() + c] = value(piece, c);
  });
  return values;
}

Vec3 BranchSet::from_start(const Vec3& d, const Vec3& arm) const {
  // x - x_α = x - middle - a/2
  const double h = lattice_.voxel();
  return {d[0] * h - 0.5 * arm[0], d[1] * h - 0.5 * arm[1], d[2] * h - 0.5 * arm[2]};
}

double BranchSet::weight(std::size_t piece, const Vec3& d) const {
  const Vec3 a = arm(piece);
  const Vec3 p = from_start(d, a);
  if (has_curvature()) return kernel_.line_integral_midpoint_curvature(p, a);
  const int n = points(piece);
  return n == 0 ? kernel_.line_integral(p, a) : kernel_.line_integral(p, a, rule(n));
}

bool BranchSet::reaches(std::size_t piece, const Vec3& d) const {
  const Vec3 a = arm(piece);
  const Vec3 p = from_start(d, a);
  if (!plan_of(piece).whole) return kernel_.reaches(p, a);
  // Each half by itself, as it would be without the other.
  const std::size_t b = branch(piece);
  const Vec3 other_end{p[0] + a[0], p[1] + a[1], p[2] + a[2]};
  return kernel_.reaches(p, half(b)) || kernel_.reaches(other_end, half(b + 1));
}

}  // namespace grainvdb
