// The values per particle and per half branch, from a frame made by hand.
#include <array>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_view.hpp"

namespace grainvdb::testing::moments_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const StageRegistry registry = make_registry();
constexpr double four_pi_over_three = 4 * std::numbers::pi / 3;

/// Two particles: V = 4π/3 and 8 · 4π/3.
FakeView two_particles() {
  FakeView view;
  view.p.id = {4, 9};
  view.p.position = {{{0, 1}, {0, 1}, {0, 1}}};
  view.p.velocity = {{{1, 4}, {2, 5}, {3, 6}}};
  view.p.angular_velocity = {{{-1, 0}, {0, 2}, {1, 0}}};
  view.p.radius = {1, 2};
  view.p.mass = {3, 5};
  view.mean = {1, 1, 1};
  return view;
}

std::vector<double> values(const std::string& stage, std::size_t moment,
                           const std::vector<std::array<std::string, 3>>& changes, const FakeView& view) {
  return values_of(*moments_of(registry, stage, settings_with(registry, changes)).at(moment), view);
}

void expect_near(const std::vector<double>& found, std::vector<double> expected, double factor) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], factor * expected[i], 1e-13) << i;
}

TEST(MomentValues, SumsOverParticles) {
  const FakeView view = two_particles();
  expect_near(values("phi", 0, {}, view), {1, 8}, four_pi_over_three);
  EXPECT_THAT(values("density", 0, {}, view), ElementsAre(3, 5));
  expect_near(values("velocity", 0, {}, view), {1, 2, 3, 32, 40, 48}, four_pi_over_three);
  expect_near(values("velocity", 1, {}, view), {1, 8}, four_pi_over_three);
  EXPECT_THAT(values("velocity", 0, {{"velocity", "weighting", "mass"}}, view), ElementsAre(3, 6, 9, 20, 25, 30));
  EXPECT_THAT(values("velocity", 1, {{"velocity", "weighting", "mass"}}, view), ElementsAre(3, 5));
  expect_near(values("mean_diameter", 0, {}, view), {2, 32}, four_pi_over_three);
  expect_near(values("angular_velocity", 0, {}, view), {-1, 0, 1, 0, 16, 0}, four_pi_over_three);
}

// About the mean (1, 1, 1): |v - u|² is 0 + 1 + 4 = 5 and 9 + 16 + 25 = 50, |ω - ω̄|² is 4 + 1 + 0 = 5 and 1 + 1 + 1
// = 3.
TEST(MomentValues, FluctuationsAboutTheFramesMean) {
  const FakeView view = two_particles();
  expect_near(values("temperature", 0, {}, view), {5, 8 * 50}, four_pi_over_three);
  EXPECT_EQ(view.asked, "frame: volume velocity / volume");
  expect_near(values("temperature", 0, {{"velocity", "weighting", "mass"}}, view), {5, 8 * 50}, four_pi_over_three);
  EXPECT_EQ(view.asked, "frame: mass velocity / mass");
  expect_near(values("rotational_fluctuation", 0, {}, view), {5, 8 * 3}, four_pi_over_three);
  EXPECT_EQ(view.asked, "frame: volume angular velocity / volume");
}

TEST(MomentValues, FluctuationsAboutTheProfile) {
  const FakeView view = two_particles();
  expect_near(values("temperature", 0, {{"temperature", "mode", "two_pass_profile"}}, view), {5, 8 * 50},
              four_pi_over_three);
  EXPECT_THAT(view.asked, HasSubstr("profile: "));
  EXPECT_THAT(view.homogeneous, ElementsAre(true, true, false));
  StageSettings s = settings_with(registry, {{"rotational_fluctuation", "mode", "two_pass_profile"}});
  s.at("rotational_fluctuation").at("homogeneous") = std::vector<std::string>{"z"};
  values_of(*moments_of(registry, "rotational_fluctuation", s).at(0), view);
  EXPECT_THAT(view.homogeneous, ElementsAre(false, false, true));
}

// One pass: Σ V v·v W - |Σ V v W|²/Σ V W at the voxel; zero, not negative, where rounding leaves a hair less.
TEST(MomentValues, OnePassVariance) {
  const FakeView view = two_particles();
  const MomentPtr variance =
      moments_of(registry, "temperature", settings_with(registry, {{"temperature", "mode", "one_pass"}})).at(0);
  ASSERT_EQ(variance->frame_needs.size(), 1U);
  expect_near(values_of(*variance->frame_needs[0], view), {14, 1, 2, 3, 1, 8 * 77, 32, 40, 48, 8}, four_pi_over_three);

  std::array<std::array<double, leaf_size>, 5> in{};
  std::array<double, leaf_size> out{};
  // Voxel 0: two unit weights with v = (1, 2, 2) and (3, 2, 2): variance of the sum 2 · 1. Voxel 1: one weight whose
  // squares lost a digit. Voxel 2: nothing there.
  in[0][0] = 9 + 17;
  in[1][0] = 4;
  in[2][0] = 4;
  in[3][0] = 4;
  in[4][0] = 2;
  in[0][1] = 1 - 1e-16;
  in[1][1] = 1;
  in[4][1] = 1;
  std::vector<const double*> from;
  for (const auto& channel : in) from.push_back(channel.data());
  std::vector<double*> to{out.data()};
  variance->voxels(from, to);
  EXPECT_DOUBLE_EQ(out[0], 2);
  EXPECT_EQ(out[1], 0);
  EXPECT_EQ(out[2], 0);
}

// What the deviations keep of a variance: V Σ (δ - w)² for the mean at the particle, Σ V W - Σ V² W²/Σ V W at the
// voxel.
TEST(MomentValues, SharesOfTheVariance) {
  FakeView view = two_particles();
  view.factors = {0.5, 0.25};
  const auto divisor = [](const std::string& stage, const std::string& mode) {
    return moments_of(registry, stage,
                      settings_with(registry, {{stage, "mode", mode}, {stage, "self_weight", "corrected"}}))
        .at(2);
  };
  expect_near(values_of(*divisor("temperature", "two_pass"), view), {0.5, 2}, four_pi_over_three);
  EXPECT_EQ(view.asked, "factors: volume");
  EXPECT_EQ(divisor("temperature", "two_pass")->name, divisor("rotational_fluctuation", "two_pass")->name);

  const MomentPtr at_voxel = divisor("temperature", "one_pass");
  ASSERT_EQ(at_voxel->frame_needs.size(), 2U);
  EXPECT_EQ(at_voxel->frame_needs[1]->kind, Moment::Kind::particle_squares);
  expect_near(values_of(*at_voxel->frame_needs[1], view), {1, 64}, four_pi_over_three * four_pi_over_three);
  std::array<std::array<double, leaf_size>, 6> in{};
  std::array<double, leaf_size> out{};
  in[4][0] = 2;  // two equal volumes: half of the variance about their mean is theirs
  in[5][0] = 2;
  in[4][1] = 3;  // one alone
  in[5][1] = 9;
  std::vector<const double*> from;
  for (const auto& channel : in) from.push_back(channel.data());
  std::vector<double*> to{out.data()};
  at_voxel->voxels(from, to);
  EXPECT_DOUBLE_EQ(out[0], 1);
  EXPECT_EQ(out[1], 0);
  EXPECT_EQ(out[2], 0);
}

// -m u'_i u'_j in the order xx xy xz yy yz zz, u' = v - (1, 1, 1).
TEST(MomentValues, KineticStress) {
  const FakeView view = two_particles();
  EXPECT_THAT(values("kinetic_stress", 0, {}, view), ElementsAre(0, 0, 0, -3, -6, -12, -45, -60, -75, -80, -100, -125));
  EXPECT_EQ(view.asked, "mean: volume velocity / volume");
  values("kinetic_stress", 0, {{"kinetic_stress", "reference", "instantaneous"}}, view);
  EXPECT_EQ(view.asked, "frame: volume velocity / volume");
}

// -F_i a_j row by row.
TEST(MomentValues, ContactStress) {
  FakeView view;
  view.b.start = {{{0}, {0}, {0}}};
  view.b.arm = {{{1}, {2}, {3}}};
  view.b.force = {{{10}, {20}, {30}}};
  EXPECT_THAT(values("contact_stress", 0, {}, view), ElementsAre(-10, -20, -30, -20, -40, -60, -30, -60, -90));
  std::map<std::string, LineIntegral> methods{{"adaptive", LineIntegral::adaptive()},
                                              {"exact", LineIntegral::exact()},
                                              {"midpoint_curvature", LineIntegral::midpoint_curvature()}};
  for (int n = 1; n <= 8; ++n) methods["gauss" + std::to_string(n)] = LineIntegral::gauss(n);
  for (const auto& [name, method] : methods) {
    const MomentPtr m =
        moments_of(registry, "contact_stress", settings_with(registry, {{"contact_stress", "line_integral", name}}))
            .at(0);
    EXPECT_EQ(m->line_integral, method) << name;
    EXPECT_EQ(m->kind, Moment::Kind::contacts);
  }
}

}  // namespace
}  // namespace grainvdb::testing::moments_test
