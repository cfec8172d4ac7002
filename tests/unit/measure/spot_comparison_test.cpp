// Estimators that are wrong in a known way: comparison finds what made what was seen, and says how well.
#include "measure/spot_comparison.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace grainvdb::testing::spot_comparison_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const SpotTruth published{2.6, 2.285, 399, 375, 2.8};

/// What right estimators would make of spots, without errors.
SpotObservations right(const SpotTruth& made) {
  SpotObservations o;
  o.number_density = {1.1, 0};
  o.times = {0.1, 0.2, 0.3};
  o.rise = 0.1;
  for (Estimate* e : {&o.radius, &o.b, &o.grain_diffusion, &o.outflow, &o.speed}) *e = {1, 0};
  const std::vector<double> x = SpotComparison(o).expected(made);
  o.radius.value = x[0];
  o.b.value = x[1];
  o.grain_diffusion.value = x[2];
  o.outflow.value = x[3];
  o.speed.value = 1 / x[4];
  return o;
}

// R too large by a fifth, b by a tenth, b_p by a quarter, Q too small by a fifth; a part of the looseness is missing.
// `noise` times numbers that make no mean: +1 and -1.
SpotObservations wrong(const SpotTruth& made, double noise) {
  SpotObservations o = right(made);
  o.radius.value *= 1.2 * std::exp(noise);
  o.b.value *= 1.1 * std::exp(noise);
  o.grain_diffusion.value *= 1.25 * std::exp(noise);
  o.outflow.value *= 0.8 * std::exp(noise);
  o.speed.value = 1 / (1 / o.speed.value - 0.2 + 0.1 * noise);
  return o;
}

/// With the errors that an estimator states.
SpotObservations stating(SpotObservations o, double relative) {
  for (Estimate* e : {&o.radius, &o.b, &o.grain_diffusion, &o.outflow, &o.speed}) e->error = relative * e->value;
  return o;
}

std::vector<SpotObservations> noisy_runs(const SpotTruth& made, double noise) {
  return {wrong(made, noise), wrong(made, -noise)};
}

void expect_published(const SpotComparison& c, double tolerance) {
  const SpotObservations o = c.corrected();
  const SpotParameterEstimates p = spot_parameters(o);
  EXPECT_NEAR(o.radius.value, 2.6, tolerance * 2.6);
  EXPECT_NEAR(o.b.value, 2.285, tolerance * 2.285);
  EXPECT_NEAR(o.speed.value, 2.8, tolerance * 2.8);
  EXPECT_NEAR(p.influence.value, 399, tolerance * 399);
  EXPECT_NEAR(p.insertion_rate.value, 375, tolerance * 375);
}

// Biases that are the same for all spots are gone after one round, whatever spots that has: to rounding.
TEST(SpotComparison, TakesOffWhatIsTheSameForAllSpots) {
  SpotComparison c(wrong(published, 0));
  ASSERT_THAT(c.add_round({3, 2.5, 350, 160, 8}, noisy_runs({3, 2.5, 350, 160, 8}, 1e-9)), IsEmpty());
  expect_published(c, 1e-6);
  const std::vector<Estimate> bias = c.biases();
  EXPECT_NEAR(bias[0].value, 1.2, 1e-6);
  EXPECT_NEAR(bias[3].value, 0.8, 1e-6);
  EXPECT_NEAR(bias[4].value, -0.2, 1e-6);
}

// Seen ∝ made^0.7: the first round takes the slope for 1, the second one knows it, and what follows is exact.
TEST(SpotComparison, LearnsHowBiasesChange) {
  const auto bent = [](const SpotTruth& made, double noise) {
    SpotObservations o = wrong(made, noise);
    o.radius.value = 1.7 * std::pow(made.radius, 0.7) * std::exp(noise);
    return o;
  };
  SpotComparison c(bent(published, 0));
  const SpotTruth first{3.3, 2.5, 350, 160, 8};
  c.add_round(first, {bent(first, 1e-9), bent(first, -1e-9)});
  const double once = c.corrected().radius.value;
  EXPECT_NEAR(once, 3.3 * std::pow(2.6 / 3.3, 0.7), 1e-6);
  const SpotTruth second{once, 2.3, 400, 370, 2.9};
  c.add_round(second, {bent(second, 1e-9), bent(second, -1e-9)});
  expect_published(c, 1e-6);
}

// Two runs with the parameters of the dumps that scatter by ±δ, a standard deviation of √2 δ: √2 δ of what was seen in
// the dumps, and √2 δ/√2 of the mean. What the estimators state counts where it is more.
TEST(SpotComparison, ErrorsHoldWhatRunsScatterBy) {
  const double noise = 0.03;
  SpotComparison c(stating(wrong(published, 0), 1e-3));
  c.add_round(published, noisy_runs(published, noise));
  const double expected = noise * std::sqrt(2 + 1);
  SpotObservations o = c.corrected();
  EXPECT_NEAR(o.radius.error / o.radius.value, expected, 1e-9);
  EXPECT_NEAR(o.outflow.error / o.outflow.value, expected, 1e-9);
  EXPECT_NEAR(o.speed.error / (o.speed.value * o.speed.value), 0.1 * expected, 1e-9);
  // Runs four times as long as the dumps scatter by half of what the dumps do.
  o = c.corrected(4);
  EXPECT_NEAR(o.radius.error / o.radius.value, noise * std::sqrt(4 * 2 + 1), 1e-9);

  SpotComparison stated(stating(wrong(published, 0), 0.1));
  stated.add_round(published, {stating(wrong(published, noise), 0.1), stating(wrong(published, -noise), 0.1)});
  o = stated.corrected();
  EXPECT_NEAR(o.radius.error / o.radius.value, 0.1 * std::sqrt(1 + 0.5), 1e-9);
}

// Spots far from those of the dumps tell less: the slope is known to 0.3 only.
TEST(SpotComparison, ErrorsGrowWithTheDistance) {
  SpotComparison c(wrong(published, 0));
  const SpotTruth far{2 * published.radius, 2.285, 399, 375, 2.8};
  c.add_round(far, noisy_runs(far, 1e-9));
  const SpotObservations o = c.corrected();
  EXPECT_NEAR(o.radius.error / o.radius.value, 0.3 * std::log(2), 1e-6);
  EXPECT_LT(o.outflow.error / o.outflow.value, 0.3 * std::log(8) + 1e-6);
}

TEST(SpotComparison, SaysWhatRunsDoNotTell) {
  SpotComparison c(wrong(published, 0));
  std::vector<SpotObservations> runs = noisy_runs(published, 0.1);
  runs[1].b.value = -1;
  runs[0].radius.value = std::nan("");
  EXPECT_THAT(c.add_round(published, runs), ElementsAre("radius", "b"));
  // A flow that is no looser is seen, for it is compared with others.
  runs = noisy_runs(published, 0.1);
  runs[0].speed.value = -30;
  EXPECT_THAT(c.add_round(published, runs), IsEmpty());
}

TEST(SpotComparison, NoSpeedIsLeftWhereTheFlowIsDenserThanRunsMakeIt) {
  SpotObservations seen = wrong(published, 0);
  seen.speed.value = 1 / (1 / seen.speed.value - 1);
  SpotComparison c(seen);
  c.add_round(published, noisy_runs(published, 0.1));
  EXPECT_TRUE(std::isnan(c.corrected().speed.value));
}

TEST(SpotObservations, ComeBackFromATable) {
  SpotObservations o = stating(right(published), 0.05);
  o.number_density.error = 0.02;
  Table t{"spot_calibration", "", ""};
  t.columns = {{"time", dimension::time, "", o.times}};
  t.numbers = spot_quantities(o, spot_parameters(o));
  t.numbers.push_back({.name = "phi", .value = 0.55, .error = 0.01, .description = ""});
  const SpotObservations back = spot_observations(t);
  EXPECT_EQ(back.radius.value, o.radius.value);
  EXPECT_EQ(back.b.error, o.b.error);
  EXPECT_EQ(back.grain_diffusion.value, o.grain_diffusion.value);
  EXPECT_EQ(back.outflow.value, o.outflow.value);
  EXPECT_EQ(back.speed.error, o.speed.error);
  EXPECT_EQ(back.times, o.times);
  EXPECT_EQ(back.rise, 0.1);
  EXPECT_NEAR(back.number_density.value, 1.1, 1e-12);
  EXPECT_NEAR(back.number_density.error, 0.02, 1e-12);
  t.numbers.clear();
  EXPECT_THROW(spot_observations(t), std::out_of_range);
}

}  // namespace
}  // namespace grainvdb::testing::spot_comparison_test
