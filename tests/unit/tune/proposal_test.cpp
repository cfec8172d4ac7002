#include "tune/proposal.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainvdb::proposal_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Trial trial(std::vector<std::string> set, double seconds, std::vector<std::pair<std::string, double>> errors) {
  Trial t{std::move(set), {seconds + 1, seconds}};
  t.knobs = t.set.size();
  for (const auto& [field, rms] : errors) t.errors.push_back({field, rms, rms, 10, 0});
  return t;
}

Trial refused(const std::string& set) {
  Trial t{{set}, {}, {}, "it cannot be", 1};
  return t;
}

const std::vector<Trial> trials{trial({}, 10, {{"phi", 0.01}, {"mu", 0.05}}),        // 0: as it is
                                trial({"h=2"}, 4, {{"phi", 0.04}, {"mu", 0.06}}),    // 1: faster, phi worse
                                trial({"h=½"}, 40, {{"phi", 0.002}, {"mu", 0.04}}),  // 2: slower, better
                                trial({"l=g"}, 6, {{"phi", 0.01}, {"mu", 0.06}}),    // 3: faster, mu worse
                                trial({"x=y"}, 12, {{"phi", 0.02}, {"mu", 0.06}}),   // 4: worse in all
                                refused("k=9")};                                     // 5
const std::vector<std::string> knobs{"", "h", "h", "l", "x", "k"};

TEST(Proposal, TheFastestRepeatCounts) {
  EXPECT_EQ(trials[1].best_seconds(), 4);
  EXPECT_EQ(trials[0].name(), "as it is");
  EXPECT_EQ(trial({"a=1", "b=2"}, 1, {}).name(), "a=1 b=2");
}

TEST(Proposal, ScoreIsTheWorstOfTheTolerances) {
  EXPECT_DOUBLE_EQ(score(trials[1], {{"phi", 0.02}, {"mu", 0.1}}), 2);
  EXPECT_DOUBLE_EQ(score(trials[1], {}), 0.06);
  EXPECT_TRUE(std::isinf(score(trials[5], {})));
  EXPECT_TRUE(std::isinf(score(trials[1], {{"velocity", 1}}))) << "not measured";
}

TEST(Proposal, TheFrontHoldsWhatNothingBeats) {
  EXPECT_THAT(pareto_front(trials, {{"phi", 1}}), ElementsAre(false, true, true, true, false, false));
  EXPECT_THAT(pareto_front(trials, {{"mu", 1}}), ElementsAre(true, true, true, false, false, false));
}

TEST(Proposal, TheFastestThatIsGoodEnough) {
  EXPECT_EQ(choose(trials, {{"phi", 0.05}}), 1U);
  // What does not change phi is not for its tolerance to allow.
  EXPECT_EQ(choose(trials, {{"phi", 0.01}}), 0U);
  EXPECT_EQ(choose(trials, {{"phi", 0.01}, {"mu", 0.06}}), 3U);
  EXPECT_EQ(choose(trials, {{"phi", 0.005}}), 2U) << "slower, but the current one is not good enough";
  EXPECT_EQ(choose(trials, {}), 0U);
}

// Times that overlap are no reason to change what is good enough as it is; to change what is not, they are.
TEST(Proposal, NothingWithinTheNoiseOfTheTimes) {
  std::vector<Trial> close{trial({}, 0, {{"phi", 0.01}}), trial({"h=2"}, 0, {{"phi", 0.02}})};
  close[0].seconds = {1.0, 1.3};
  close[1].seconds = {0.7, 1.1};
  EXPECT_EQ(choose(close, {{"phi", 0.05}}), 0U) << "the fastest repeat was that of h=2, the slowest was not";
  close[1].seconds = {0.7, 1.0};
  EXPECT_EQ(choose(close, {{"phi", 0.05}}), 0U) << "one as fast as the current one's fastest";
  close[1].seconds = {0.7, 0.99};
  EXPECT_EQ(choose(close, {{"phi", 0.05}}), 1U);
  close[0].errors[0].rms = 0.06;
  close[1].seconds = {0.7, 5.0};
  EXPECT_EQ(choose(close, {{"phi", 0.05}}), 1U) << "the current one is not good enough";
}

// What comes out is the fastest of the others that are surely faster, not the fastest whose times overlap.
TEST(Proposal, TheFastestThatIsSurelyFaster) {
  std::vector<Trial> some = trials;
  some[1].seconds = {4, 11};
  EXPECT_EQ(choose(some, {{"phi", 0.05}, {"mu", 0.06}}), 3U);
}

// h=2 with l=g: 4 · 6/10 = 2.4 s, mu² = 0.05² + 2 (0.06² - 0.05²) = 0.0047, mu = 0.0686, phi as h=2 alone.
TEST(Proposal, CombinationsThatPromiseTheMost) {
  const Tolerances loose{{"phi", 0.05}, {"mu", 0.07}};
  const std::vector<Combination> found = promising(trials, knobs, loose, 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0].trials, ElementsAre(1U, 3U));
  EXPECT_DOUBLE_EQ(found[0].seconds, 2.4);
  const std::vector<Combination> more = promising(trials, knobs, loose, 10);
  for (std::size_t c = 1; c < more.size(); ++c) EXPECT_LE(more[c - 1].seconds, more[c].seconds);
  for (const Combination& c : promising(trials, knobs, {{"phi", 0.05}, {"mu", 0.068}}, 10))
    EXPECT_THAT(c.trials, ::testing::Not(ElementsAre(1U, 3U)));
  EXPECT_THAT(promising(trials, knobs, {}, 5), IsEmpty());
  EXPECT_THAT(promising(trials, knobs, loose, 0), IsEmpty());
}

}  // namespace
}  // namespace grainvdb::proposal_test
