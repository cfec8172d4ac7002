#include "tune/profile_error.hpp"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "grainvdb/error.hpp"

namespace grainvdb::profile_error_test {
namespace {

/// Planes at 1, 2, 3 with phi and the three components of velocity.
Table table(const std::string& name, std::vector<double> phi, std::vector<double> velocity_x,
            std::vector<double> position = {1, 2, 3}) {
  Table t{name, "", ""};
  const std::vector<double> zero(phi.size(), 0.0);
  const auto add = [&](const std::string& column, std::vector<double> values) {
    t.columns.push_back({column, dimension::none, "", std::move(values)});
  };
  add("z", std::move(position));
  add("phi", std::move(phi));
  add("velocity_x", std::move(velocity_x));
  add("velocity_y", zero);
  add("velocity_z", zero);
  return t;
}

const Table exact = table("plane_profile", {0.5, 0.5, 0.1}, {1, 2, 3});

std::vector<FieldError> errors(const Table& found) {
  return profile_errors({"profile.phi", "profile.velocity"}, {exact}, {found});
}

// phi: 0.01²/(0.5² + 0.5² + 0.1²). velocity, weighted with phi: 0.1 · 1²/(0.5 · 1 + 0.5 · 4 + 0.1 · 9).
TEST(ProfileError, WeighsMeansOverGrainsWithPhi) {
  const auto e = errors(table("profile", {0.5, 0.51, 0.1}, {1, 2, 4}, {1, 2 + 1e-12, 3}));
  EXPECT_EQ(e.at(0).field, "profile.phi");
  EXPECT_EQ(e.at(0).points, 3U);
  EXPECT_NEAR(e.at(0).rms, std::sqrt(1e-4 / 0.51), 1e-12);
  EXPECT_NEAR(e.at(0).largest, 0.01 / std::sqrt(0.51 / 3), 1e-12);
  EXPECT_NEAR(e.at(1).rms, std::sqrt(0.1 / 3.4), 1e-12);
  EXPECT_EQ(errors(exact).at(1).rms, 0);
}

TEST(ProfileError, CountsPlanesThatTheExactOneAloneHas) {
  const auto e = errors(table("profile", {0.5, std::nan("")}, {1, 2}, {1, 2}));
  EXPECT_EQ(e.at(0).points, 1U);
  EXPECT_EQ(e.at(0).undefined, 2U);
  EXPECT_EQ(profile_errors({"profile.phi"}, {exact}, {}).at(0).undefined, 3U);
}

TEST(ProfileError, AxesAreNotCompared) {
  const auto along = [](const std::string& measurement, const std::string& axis) {
    Pipeline p;
    p.measure[measurement] = {{"axis", axis}};
    return p;
  };
  EXPECT_NO_THROW(require_same_axis(along("profile", "z"), along("plane_profile", "z")));
  EXPECT_NO_THROW(require_same_axis(along("profile", "z"), Pipeline()));
  EXPECT_THROW(require_same_axis(along("profile", "z"), along("profile", "x")), ConfigError);
}

}  // namespace
}  // namespace grainvdb::profile_error_test
