// Fields of the sample shear cell against numbers that an independent program computed from the same dumps (README.md).
//
// What is defined alike must agree to the rounding of floats and of ten digits. What is not, velocities at the
// particles themselves and derivatives of the kernel instead of differences, must agree within the interpolation error
// that the voxel size explains; those bounds are derived here from the curvature of the fields.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "golden/snapshot.hpp"

namespace grainvdb::testing::reference_numbers_test {
namespace {

const char axes[] = "xyz";

/// Σ of the branch terms by the 24-point rule of the table.
Sums contact_by_24_points(const Snapshot& s) {
  const Branches b = branches_of(s.frame);
  std::vector<double> q;
  for (std::size_t k = 0; k < b.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) q.push_back(-b.force[k][i] * b.arm[k][j]);
  return branch_sums(s.reference->box, s.pipeline.cutoff, b, q, 9, 24);
}

class ReferenceNumbers : public ::testing::TestWithParam<std::int64_t> {
 protected:
  void same_definitions_agree_to_rounding();
  void twenty_four_points_are_nearly_exact();
  void time_mean_of_one_frame_is_the_frame();
  const Snapshot s{GetParam(), "kernel"};
  const Sums contact = contact_by_24_points(s);
};

// The table's kernel is written as the expanded polynomial 1 - 6q² + 8q³ - 3q⁴, which loses up to 2e-15 W(0) near the
// rim: relative to φ that is `weights`, and as much of every sum of terms. Add the program's own errors of sums and of
// terms, half an ulp of float for its value, ten digits for the table's, and rounding in double.
void ReferenceNumbers::same_definitions_agree_to_rounding() {
  const double peak = lucy(0, s.pipeline.cutoff);
  const double largest = 4.0 / 3 * std::numbers::pi * std::pow(0.48e-3, 3);
  std::map<std::string, double> worst;
  for (std::size_t row = 0; row < s.table.rows(); ++row) {
    const auto index = s.index_of(row);
    if (!index || s.reference->fields.at("phi").value[*index] == 0) {
      EXPECT_EQ(s.table.at(row, "phi"), 0);
      EXPECT_EQ(s.found("phi", row), 0);
      EXPECT_TRUE(std::isnan(s.found("velocity", row)));
      EXPECT_TRUE(std::isnan(s.table.at(row, "ux")));
      continue;
    }
    const std::size_t n = *index;
    const double phi = s.reference->fields.at("phi").value[n];
    const double weights = 688 * 2e-15 * peak * largest / phi;
    if (weights > 1e-3) continue;  // nothing but the rim: the table has no digits there
    const auto check = [&](const std::string& column, const std::string& field, int c, double slack) {
      const ReferenceField& f = s.reference->fields.at(field == "velocity_gradient" ? "gradient_by_kernel" : field);
      const double magnitude = f.magnitude[f.index(n, c)];
      const double error = std::abs(s.found(field, row, c) - s.table.at(row, column));
      const double bound =
          (float_rounding + f.rounding + 1e-10 + 2 * weights) * magnitude + f.floor[f.index(n, c)] + slack;
      EXPECT_LE(error, bound) << column << " row " << row << " magnitude " << magnitude;
      if (weights < 1e-9) worst[field] = std::max(worst[field], std::max(0.0, error - slack) / magnitude);
    };
    check("phi", "phi", 0, 0);
    check("density", "density", 0, 0);
    check("mean_diameter", "mean_diameter", 0, 0);
    check("T_u_trilinear", "temperature", 0, 0);
    check("domega2_trilinear", "rotational_fluctuation", 0, 0);
    for (int a = 0; a < 3; ++a) {
      check(std::string("u") + axes[a], "velocity", a, 0);
      check(std::string("w") + axes[a], "angular_velocity", a, 0);
    }
    for (int c = 0; c < 9; ++c) {
      check(tensor_column("kinetic_u_trilinear", c), "kinetic_stress", c, 0);
      check(tensor_column("gradu", c), "velocity_gradient", c, 0);
      // The table's rule has 24 points, the program's integral is exact: the brute force says how much that makes.
      const ReferenceField& exact = s.reference->fields.at("contact_stress");
      check(tensor_column("contact", c), "contact_stress", c,
            std::abs(contact.at(n, c) - exact.value[exact.index(n, c)]));
    }
  }
  if (std::getenv("GRAINVDB_AGREEMENT") != nullptr)
    for (const auto& [field, value] : worst) std::printf("%-24s %9.2e of magnitude\n", field.c_str(), value);
}

// Half branches are shorter than c/4, and the kernel is smooth along them but for its centre and its rim, so 24 points
// come within 1e-7 of the sum of the terms wherever there is more than the rim of one branch.
void ReferenceNumbers::twenty_four_points_are_nearly_exact() {
  const ReferenceField& exact = s.reference->fields.at("contact_stress");
  double largest = 0;
  for (double m : exact.magnitude) largest = std::max(largest, m);
  for (std::size_t i = 0; i < exact.value.size(); ++i)
    EXPECT_LE(std::abs(contact.value[i] - exact.value[i]), 1e-7 * exact.magnitude[i] + 1e-9 * largest);
}

// With one frame the time mean is the frame.
void ReferenceNumbers::time_mean_of_one_frame_is_the_frame() {
  Pipeline p = s.pipeline;
  set_option(p, "kinetic_stress", "reference", std::string("time_mean"));
  p.fields = {"kinetic_stress"};
  const auto source = open_dumps(p.input);
  const Result r = run(p, *source);
  for (std::size_t row = 0; row < s.table.rows(); ++row)
    for (int c = 0; c < 9; ++c)
      EXPECT_EQ(static_cast<double>(r.only().field("kinetic_stress").at(s.voxel_of(row), c)),
                s.found("kinetic_stress", row, c));
}

TEST_P(ReferenceNumbers, Agree) {
  same_definitions_agree_to_rounding();
  twenty_four_points_are_nearly_exact();
  time_mean_of_one_frame_is_the_frame();
}

INSTANTIATE_TEST_SUITE_P(ShearCell, ReferenceNumbers, ::testing::Values(60000, 76000));

}  // namespace
}  // namespace grainvdb::testing::reference_numbers_test
