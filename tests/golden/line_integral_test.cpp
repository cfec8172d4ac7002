// The contact stress of the sample shear cell: the default rules, and the second derivative, against the closed form.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/line_rule.hpp"
#include "support/kernel_sums.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::testing::line_integral_test {
namespace {

Result contact_stress(const std::string& line_integral) {
  Pipeline p = shear_cell_pipeline({"contact_stress"});
  p.frames = {0, 1, 1};
  if (!line_integral.empty()) set_option(p, "contact_stress", "line_integral", line_integral);
  return run(p, *open_dumps(p.input));
}

// Each half branch may be off by the bound of its method times W(0), sums in single precision by `gauss_sum_rounding`
// of Σ |terms|, and floats by half an ulp.
void expect_near_the_closed_form(const std::string& method, double error) {
  SCOPED_TRACE(method);
  const Result approximate = contact_stress(method);
  const Result exact = contact_stress("exact");
  const Pipeline p = shear_cell_pipeline({"contact_stress"});
  const Frame frame = open_dumps(p.input)->read(0, Column::radius | Column::contacts);
  const VoxelBox box({frame}, p.voxel, p.origin, p.cutoff);
  const Branches b = branches_of(frame);
  std::vector<double> q;
  for (std::size_t k = 0; k < b.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) q.push_back(-b.force[k][i] * b.arm[k][j]);
  const Sums reaching = branch_magnitudes(box, p.cutoff, b, q, 9);
  const Sums sums = branch_sums(box, p.cutoff, b, q, 9, 3);

  const FieldCopy& found = approximate.only().field("contact_stress");
  const FieldCopy& expected = exact.only().field("contact_stress");
  EXPECT_EQ(found.topology->origins(), expected.topology->origins());
  std::size_t differ = 0;
  found.for_each_active([&](const Coord& c) {
    const std::size_t n = box.index(c).value();
    for (int k = 0; k < 9; ++k) {
      const auto a = static_cast<double>(found.at(c, k)), e = static_cast<double>(expected.at(c, k));
      const double bound = error * lucy(0, p.cutoff) * reaching.size(n, k) + gauss_sum_rounding * sums.size(n, k) +
                           2 * float_rounding * std::abs(e);
      EXPECT_NEAR(a, e, bound);
      differ += a != e ? 1U : 0U;
    }
  });
  EXPECT_GT(differ, 0U);
}

TEST(DefaultLineIntegral, DiffersFromTheClosedFormByNoMoreThanItsBound) {
  expect_near_the_closed_form("", lucy_rule_error);
}

TEST(CurvatureInTheMiddle, DiffersFromTheClosedFormByNoMoreThanItsBound) {
  expect_near_the_closed_form("midpoint_curvature", curved_branch_error);
}

}  // namespace
}  // namespace grainvdb::testing::line_integral_test
