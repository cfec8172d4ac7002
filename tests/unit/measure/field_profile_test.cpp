#include "measure/field_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "unit/measure/synthetic.hpp"

namespace grainvdb::field_profile_test {
namespace {

using testing::scalar;
using testing::synthetic_output;
using testing::SyntheticField;

// Fields are floats: relative rounding 2^-24, of sums of few of them no more.
constexpr double rounding = 1e-6;
const Lattice lattice(0.5, {0, 0, 0});

SyntheticField vector(const std::string& name, std::function<Vec3(const Vec3&)> value) {
  return {name, 3, [value](const Vec3& x, std::span<double> out) {
            const Vec3 v = value(x);
            std::copy(v.begin(), v.end(), out.begin());
          }};
}

TEST(Jackknife, ErrorOfAMeanIsTheTextbooks) {
  const std::vector<double> x{1, 2, 4, 9};
  const auto mean = jackknife(4, 1, [&](std::optional<std::size_t> without, std::span<double> out) {
    double sum = 0, count = 0;
    for (std::size_t t = 0; t < 4; ++t)
      if (t != without) sum += x[t], ++count;
    out[0] = sum / count;
  });
  EXPECT_DOUBLE_EQ(mean[0].value, 4);
  EXPECT_DOUBLE_EQ(mean[0].error, std::sqrt((9.0 + 4 + 0 + 25) / 3 / 4));
  EXPECT_TRUE(std::isnan(jackknife(1, 1, [](auto, std::span<double> out) { out[0] = 1; })[0].error));
}

TEST(TimeSums, AddsOverTimes) {
  TimeSums sums(2);
  sums.begin_time();
  sums.at(3)[0] = 1;
  sums.begin_time();
  sums.at(3)[1] = 5;
  sums.at(-2)[0] = 7;
  sums.begin_time();
  EXPECT_EQ(sums.bins(), (std::vector<std::int64_t>{-2, 3}));
  EXPECT_EQ(sums.total(3), (std::vector<double>{1, 5}));
  EXPECT_EQ(sums.total(3, 1), (std::vector<double>{1, 0}));
  EXPECT_EQ(sums.total(-2, 1), (std::vector<double>{0, 0}));
  EXPECT_EQ(sums.total(99), (std::vector<double>{0, 0}));
}

TEST(FlowState, SimpleShearHasItsInvariants) {
  FlowState s;
  s.phi = 0.6;
  s.density = 1500;
  s.diameter = 1e-3;
  s.temperature = 4e-4;
  s.spin_fluctuation = 100;
  s.gradient = {0, 0, 20, 0, 0, 0, 0, 0, 0};
  s.stress = {-250, 0, 100, 0, -250, 0, 100, 0, -250};
  EXPECT_DOUBLE_EQ(s.shear_rate(), 20);
  EXPECT_DOUBLE_EQ(s.pressure(), 250);
  EXPECT_DOUBLE_EQ(s.shear_stress(), 100);
  EXPECT_DOUBLE_EQ(s.mu(), 0.4);
  EXPECT_DOUBLE_EQ(s.inertial_number(), 20e-3 * std::sqrt(10));
  EXPECT_DOUBLE_EQ(s.fluidity(), 50);
  EXPECT_DOUBLE_EQ(s.gd_over_dv(), 50e-3 / 0.02);
  EXPECT_DOUBLE_EQ(s.g_over_domega(), 5);
  EXPECT_DOUBLE_EQ(s.dv_over_d_domega(), 2);
  s.least_temperature = 4e-4;
  EXPECT_TRUE(std::isnan(s.gd_over_dv()));
  s.least_pressure = 250;
  EXPECT_TRUE(std::isnan(s.mu()) && std::isnan(s.inertial_number()) && std::isnan(s.fluidity()));
}

TEST(FieldProfile, PlanesOfUniformShear) {
  FieldProfile profile({}, lattice, {"phi", "velocity"});
  profile.take(
      synthetic_output(lattice, {0, 0, -2}, {3, 5, 2},
                       {scalar("phi", [](const Vec3&) { return 0.5; }), vector("velocity", [](const Vec3& x) -> Vec3 {
                          return {8 * x[2], 0, 1};
                        })}));
  ASSERT_EQ(profile.bins(), (std::vector<std::int64_t>{-2, -1, 0, 1, 2}));
  for (const std::int64_t bin : profile.bins()) {
    const FieldProfile::Means means(profile, bin);
    EXPECT_DOUBLE_EQ(means.position(), lattice.centre(2, static_cast<std::int32_t>(bin)));
    EXPECT_EQ(means.voxels(), 24);
    EXPECT_DOUBLE_EQ(means.value("phi"), 0.5);
    EXPECT_DOUBLE_EQ(means.value("velocity", 0), 8 * means.position());
    EXPECT_DOUBLE_EQ(means.value("velocity", 2), 1);
  }
}

// u = Ω e × (x - centre): u_θ = Ω r and nothing else, about any axis.
TEST(FieldProfile, ShellsOfRigidRotation) {
  const Vec3 centre{0.25, -0.5, 0.75};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis), p = (a + 1) % 3, q = (a + 2) % 3;
    BinSpec spec;
    spec.geometry = BinSpec::Geometry::shells;
    spec.axis = axis;
    spec.centre = centre;
    FieldProfile profile(spec, lattice, {"phi", "velocity"});
    profile.take(
        synthetic_output(lattice, {-6, -6, -6}, {6, 6, 6},
                         {scalar("phi", [](const Vec3&) { return 0.5; }), vector("velocity", [&](const Vec3& x) {
                            Vec3 u{};
                            u[p] = -3 * (x[q] - centre[q]);
                            u[q] = 3 * (x[p] - centre[p]);
                            return u;
                          })}));
    for (const std::int64_t bin : profile.bins()) {
      const FieldProfile::Means means(profile, bin);
      EXPECT_GE(means.position(), 0.5 * static_cast<double>(bin));
      EXPECT_LT(means.position(), 0.5 * static_cast<double>(bin + 1));
      EXPECT_NEAR(means.value("velocity", 0), 0, rounding * 3 * means.position());
      EXPECT_NEAR(means.value("velocity", 1), 3 * means.position(), rounding * 3 * means.position());
      EXPECT_EQ(means.value("velocity", 2), 0);
    }
    EXPECT_EQ(profile.geometry().directions()[2], std::string(1, static_cast<char>('x' + axis)));
  }
}

// σ = a e_r e_r + b e_θ e_θ + c (e_r e_θ) + s e_z e_z, given in x, y, z, comes back as it was made.
TEST(FieldProfile, TensorsAreRotatedBeforeTheyAreAveraged) {
  BinSpec spec;
  spec.geometry = BinSpec::Geometry::shells;
  FieldProfile profile(spec, lattice, {"stress"});
  profile.take(synthetic_output(lattice, {-4, -4, 0}, {4, 4, 1},
                                {{"stress", 9, [](const Vec3& x, std::span<double> out) {
                                    const double r = std::hypot(x[0], x[1]), co = x[0] / r, si = x[1] / r;
                                    const Vec3 er{co, si, 0}, et{-si, co, 0};
                                    for (std::size_t i = 0; i < 3; ++i)
                                      for (std::size_t j = 0; j < 3; ++j)
                                        out[3 * i + j] = -5 * er[i] * er[j] - 3 * et[i] * et[j] + 2 * er[i] * et[j] +
                                                         (i == 2 && j == 2 ? -7 : 0);
                                  }}}));
  const double expected[9] = {-5, 2, 0, 0, -3, 0, 0, 0, -7};
  for (const std::int64_t bin : profile.bins())
    for (int c = 0; c < 9; ++c)
      EXPECT_NEAR(FieldProfile::Means(profile, bin).value("stress", c), expected[c], 10 * rounding) << bin << ' ' << c;
}

// Two output times of 1 and 3 frames with φ = 0.2, 0.6 and u = 1, 2: ⟨φ⟩ = (0.2 + 3·0.6)/4, ⟨u⟩ = Σ φ u/Σ φ.
TEST(FieldProfile, MeansOverVolumeAreWeighedByIt) {
  FieldProfile profile({}, lattice, {"phi", "velocity"});
  for (const auto& [frames, phi, u] : {std::tuple{1U, 0.2, 1.0}, std::tuple{3U, 0.6, 2.0}})
    profile.take(
        synthetic_output(lattice, {0, 0, 0}, {1, 1, 0},
                         {scalar("phi", [phi = phi](const Vec3&) { return phi; }), vector("velocity",
                                                                                          [u = u](const Vec3&) -> Vec3 {
                                                                                            return {u, 0, 0};
                                                                                          })},
                         frames));
  const FieldProfile::Means means(profile, 0);
  EXPECT_NEAR(means.value("phi"), 0.5, rounding);
  EXPECT_NEAR(means.value("velocity", 0), (0.2 + 3 * 0.6 * 2) / (0.2 + 3 * 0.6), rounding);
  EXPECT_EQ(means.voxels(), 4);
  EXPECT_EQ(profile.times(), 2U);
}

TEST(FieldProfile, MaskedVoxelsDoNotEnter) {
  FieldProfile profile({}, lattice, {"phi", "temperature"});
  profile.take(synthetic_output(
      lattice, {0, 0, 0}, {1, 0, 0},
      {scalar("phi", [](const Vec3& x) { return x[0] < 0.5 ? 0.25 : 0.75; }), scalar("temperature", [](const Vec3& x) {
         return x[0] < 0.5 ? std::numeric_limits<double>::quiet_NaN() : 3;
       })}));
  const FieldProfile::Means means(profile, 0);
  EXPECT_EQ(means.value("phi"), 0.5);
  EXPECT_EQ(means.value("temperature"), 3);
  EXPECT_TRUE(std::isnan(means.value("velocity")));
}

TEST(Bins, HeightsAndPointsAreCut) {
  BinSpec spec;
  spec.from = 0.5;
  spec.to = 2;
  spec.points = 4;
  spec.width = 1;
  FieldProfile profile(spec, lattice, {"phi"});
  // 8 × 8 voxels a plane: the points are the voxels 2 and 6 along x and y. Heights 0.75, 1.25 and 1.75 are left.
  profile.take(synthetic_output(lattice, {0, 0, 0}, {7, 7, 7}, {scalar("phi", [](const Vec3& x) {
                                  return x[0] == 1.25 || x[0] == 3.25 ? 1.0 : 0.0;
                                })}));
  ASSERT_EQ(profile.bins(), (std::vector<std::int64_t>{0, 1}));
  EXPECT_EQ(FieldProfile::Means(profile, 0).voxels(), 4);
  EXPECT_EQ(FieldProfile::Means(profile, 1).voxels(), 8);
  EXPECT_EQ(FieldProfile::Means(profile, 1).value("phi"), 1);
  EXPECT_EQ(FieldProfile::Means(profile, 1).position(), 1.5);
}

// φ = r + 100 z comes back from every shell of every slab: 8 heights in slabs of two.
TEST(Bins, ShellsAreCutIntoSlabs) {
  BinSpec spec;
  spec.geometry = BinSpec::Geometry::shells;
  spec.slab = 1;
  FieldProfile profile(spec, lattice, {"phi"});
  profile.take(synthetic_output(lattice, {-3, -3, -4}, {2, 2, 3},
                                {scalar("phi", [](const Vec3& x) { return std::hypot(x[0], x[1]) + 100 * x[2]; })}));
  std::set<double> heights;
  double before = -3;
  for (const std::int64_t bin : profile.bins()) {
    const FieldProfile::Means means(profile, bin);
    EXPECT_NEAR(means.value("phi"), means.position() + 100 * means.height(), 200 * rounding);
    EXPECT_GE(means.height(), before);
    before = means.height();
    heights.insert(before);
  }
  EXPECT_EQ(heights, (std::set<double>{-1.5, -0.5, 0.5, 1.5}));
}

TEST(Bins, RefusesWhatMakesNoSense) {
  OptionValues values;
  for (const OptionInfo& option : bin_options()) values[option.name] = option.default_value;
  EXPECT_FALSE(bin_conflict(values));
  OptionValues heights = values;
  heights["from"] = 2.0;
  EXPECT_EQ(bin_conflict(heights)->option, "to");
  OptionValues points = values;
  points["points"] = std::int64_t{15};
  EXPECT_EQ(bin_conflict(points)->option, "points");
  points["points"] = std::int64_t{16};
  EXPECT_FALSE(bin_conflict(points));
  points["geometry"] = std::string("shells");
  EXPECT_EQ(bin_conflict(points)->option, "points");
  OptionValues slab = values;
  slab["slab"] = 1.0;
  EXPECT_EQ(bin_conflict(slab)->option, "slab");
  values["centre"] = std::vector<double>{1, 2};
  EXPECT_EQ(bin_conflict(values)->option, "centre");
}

}  // namespace
}  // namespace grainvdb::field_profile_test
