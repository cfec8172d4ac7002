#pragma once
/// Quadrature rules for the mean of the Lucy kernel along a straight branch.
#include <span>

namespace grainvdb {

struct LineNode {
  double x = 0;       ///< on [-1, 1]: the ends of the branch are -1 and 1
  double weight = 0;  ///< those of a rule add up to 2
};

/// The n nodes of the Gauss-Legendre rule, ascending; throws std::invalid_argument unless 1 ≤ n ≤ 8.
std::span<const LineNode> gauss_rule(int n);

/// The n nodes of the rule made for the Lucy kernel, ascending; throws std::invalid_argument unless 1 ≤ n ≤ 8. W is
/// smooth along a branch but for r³ near the centre and for the rim of the support. Nodes and weights minimise the
/// largest error over all positions of a branch of length longest_branch(n), where Gauss-Legendre rules, made for
/// polynomials, err more: 3 nodes serve branches of up to 0.2 c instead of 0.15 c.
std::span<const LineNode> lucy_rule(int n);

/// The error in units of W(0) that lucy_rule(n) keeps on every branch of at most longest_branch(n) cutoffs.
inline constexpr double lucy_rule_error = 3e-5;

/// The longest branch, in units of the cutoff, for which lucy_rule(n) keeps to lucy_rule_error.
double longest_branch(int n);

/// The longest branch, in units of the cutoff, that LineIntegral::midpoint_curvature takes in one piece, and the error
/// in units of W(0) that it keeps by it: (|a|/c)³/4, which is 1.16e-3 at a sixth of the cutoff.
inline constexpr double longest_curved_branch = 0.2;
inline constexpr double curved_branch_error = 2e-3;

/// Into how many equal parts it divides a branch of the given length (in units of the cutoff).
int curved_branch_parts(double length);

/// How a branch of the given length (in units of the cutoff) is integrated to within lucy_rule_error: in `parts` equal
/// parts by lucy_rule(points) each. One part and the fewest points that do; only branches beyond longest_branch(8) are
/// divided.
struct LineDivision {
  int parts = 1;
  int points = 1;
};
LineDivision divide_branch(double length);

}  // namespace grainvdb
