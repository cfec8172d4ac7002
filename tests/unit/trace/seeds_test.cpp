#include "grainvdb/seeds.hpp"

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/error.hpp"
#include "grainvdb/tracer_sink.hpp"

namespace grainvdb::seeds_test {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pointwise;
using ::testing::ThrowsMessage;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Seeds, GridOverAPlaneHasEqualRoomAtBothEnds) {
  const TracerSeeds seeds = seeds_on_grid({.lo = {0, -1, 2}, .hi = {3.5, 1, 2}, .spacing = {1.5, 1, 0}});
  EXPECT_THAT(seeds.id, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(seeds.position[0], ElementsAre(1, 2.5, 1, 2.5));
  EXPECT_THAT(seeds.position[1], ElementsAre(-0.5, -0.5, 0.5, 0.5));
  EXPECT_THAT(seeds.position[2], ElementsAre(2, 2, 2, 2));
}

// 0.7/0.1 is below 7 in double precision; a whole period must hold 7 seeds, half a spacing from its ends.
TEST(Seeds, GridOverAWholeNumberOfSpacingsContinuesItself) {
  const TracerSeeds seeds = seeds_on_grid({.lo = {0, 0, 0}, .hi = {0.7, 0.2, 0.3}, .spacing = {0.1, 0.1, 0.1}});
  ASSERT_EQ(seeds.size(), 7u * 2 * 3);
  EXPECT_THAT(std::vector<double>(seeds.position[0].begin(), seeds.position[0].begin() + 7),
              Pointwise(DoubleNear(1e-15), {0.05, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65}));
  std::set<std::array<double, 3>> places;
  for (std::size_t i = 0; i < seeds.size(); ++i)
    places.insert({seeds.position[0][i], seeds.position[1][i], seeds.position[2][i]});
  EXPECT_EQ(places.size(), seeds.size());
}

TEST(Seeds, GridNarrowerThanItsSpacingHasOneSeedInTheMiddle) {
  const TracerSeeds seeds = seeds_on_grid({.lo = {0, 0, 0}, .hi = {1, 1, 1}, .spacing = {5, 5, 5}});
  ASSERT_EQ(seeds.size(), 1u);
  for (const auto& x : seeds.position) EXPECT_EQ(x[0], 0.5);
}

TEST(Seeds, GridThatCannotBeMeantIsRefused) {
  const auto message = [](const std::string& text) { return ThrowsMessage<std::invalid_argument>(HasSubstr(text)); };
  const SeedGrid good{.lo = {0, 0, 0}, .hi = {1, 1, 1}, .spacing = {0.5, 0.5, 0.5}};
  for (const double bad : {0.0, -1.0, nan, infinity}) {
    SeedGrid grid = good;
    grid.spacing[1] = bad;
    EXPECT_THAT([&] { seeds_on_grid(grid); }, message("spacing of the seeds must be positive and finite along y"));
  }
  for (const double bad : {nan, infinity}) {
    SeedGrid grid = good;
    grid.hi[2] = bad;
    EXPECT_THAT([&] { seeds_on_grid(grid); }, message("bounds of the seeds must be finite along z"));
  }
  SeedGrid grid = good;
  grid.hi[0] = -0.25;
  EXPECT_THAT([&] { seeds_on_grid(grid); }, message("must not be below the lower one along x, found -0.25"));
}

TEST(Seeds, GridOfTooManySeedsIsRefusedBeforeItIsMade) {
  SeedGrid grid{.lo = {0, 0, 0}, .hi = {1, 1, 1}, .spacing = {1e-9, 1e-9, 1e-9}};
  EXPECT_THAT([&] { seeds_on_grid(grid); }, ThrowsMessage<LimitError>(HasSubstr("at most 10000000")));
  grid.spacing = {0.1, 0.1, 0.1};
  grid.most = 999;
  EXPECT_THAT([&] { seeds_on_grid(grid); }, ThrowsMessage<LimitError>(HasSubstr("1000 (10 × 10 × 10)")));
  grid.most = 1000;
  EXPECT_EQ(seeds_on_grid(grid).size(), 1000u);
}

TEST(Seeds, ListKeepsItsOrder) {
  const TracerSeeds seeds = seeds_at(std::vector<Vec3>{{3, 2, 1}, {0, 5, 0}});
  EXPECT_THAT(seeds.id, ElementsAre(1, 2));
  EXPECT_THAT(seeds.position[0], ElementsAre(3, 0));
  EXPECT_THAT(seeds.position[1], ElementsAre(2, 5));
  EXPECT_THAT(seeds.position[2], ElementsAre(1, 0));
}

TEST(Seeds, ListThatCannotBeMeantIsRefused) {
  EXPECT_THAT([] { seeds_at({}); }, ThrowsMessage<std::invalid_argument>(HasSubstr("no seeds")));
  for (const double bad : {nan, infinity})
    EXPECT_THAT(([bad] {
                  seeds_at(std::vector<Vec3>{{0, 0, 0}, {0, bad, 0}});
                }),
                ThrowsMessage<std::invalid_argument>(HasSubstr("seed 2 must be finite along y")));
}

TEST(Seeds, ParticlesGiveTheirIdsAndPlaces) {
  Particles particles;
  particles.id = {2, 5, 7, 11};
  particles.position = {{{0.2, 0.5, 0.7, 1.1}, {0, 1, 2, 3}, {9, 8, 7, 6}}};
  const TracerSeeds seeds = seeds_on_particles(particles, std::vector<std::int64_t>{11, 2, 11});
  EXPECT_THAT(seeds.id, ElementsAre(2, 11));
  EXPECT_THAT(seeds.position[0], ElementsAre(0.2, 1.1));
  EXPECT_THAT(seeds.position[1], ElementsAre(0, 3));
  EXPECT_THAT(seeds.position[2], ElementsAre(9, 6));
  EXPECT_THAT(([&] {
                seeds_on_particles(particles, std::vector<std::int64_t>{5, 6});
              }),
              ThrowsMessage<std::invalid_argument>(HasSubstr("particle 6, which is not in the frame")));
  EXPECT_THAT([&] { seeds_on_particles(particles, {}); }, ThrowsMessage<std::invalid_argument>(HasSubstr("no seeds")));
}

TEST(TracerStop, HasNames) {
  EXPECT_EQ(name_of(TracerStop::moving), "moving");
  EXPECT_EQ(name_of(TracerStop::left_material), "left_material");
  EXPECT_EQ(name_of(TracerStop::left_domain), "left_domain");
  EXPECT_EQ(name_of(TracerStop::masked), "masked");
}

}  // namespace
}  // namespace grainvdb::seeds_test
