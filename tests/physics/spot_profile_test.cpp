// The velocity profile of the basic spot model. Spots that enter in the middle of the floor have gone k + ½ steps, on
// average, when they move the particles around (their place is taken halfway along the step): their places have the
// variance Δx² (k + ¼), or 2bz - Δx²/4 at height z, b = Δx²/(2Δz). Each moves the particles in a ball of radius R,
// whose parts at one height have the variance R²/5 per axis. Together
//     var_x = 2bz + R²/5 - Δx²/4.
#include <cmath>

#include <gtest/gtest.h>

#include "physics/jackknife.hpp"
#include "physics/spot_scene.hpp"

namespace grainvdb::testing::spot_profile_test {
namespace {

/// Points on a grid in layers at these heights; one layer far above keeps spots alive.
spot::Packing layers(const Box& box, const std::vector<double>& heights) {
  constexpr double spacing = 0.5;
  spot::Packing packing{1, {}, {}};
  for (const double z : heights)
    for (double x = box.lo[0] + 0.25; x < box.hi[0]; x += spacing)
      for (double y = 0.25; y < box.hi[1]; y += 1) {
        packing.id.push_back(static_cast<std::int64_t>(packing.id.size() + 1));
        packing.position.push_back({x, y, z});
      }
  packing.id.push_back(static_cast<std::int64_t>(packing.id.size() + 1));
  packing.position.push_back({0, 0, box.hi[2]});
  return packing;
}

/// var_x of the downward displacement at each height, after 20 blocks of 250 spots each.
std::vector<Measured> variances(const Vec3& step, double half_width, const std::vector<double>& heights) {
  const Box box{{-half_width, 0, 0}, {half_width, 8, 14}, {false, true, false}};
  const spot::Container container{box, spot::Orifice{spot::Orifice::Shape::slot, {0, 0}, 4}};
  spot::SpotParameters p = gentle_spots();
  p.step = step;
  p.insertion_rate = 100;
  p.hop_rate = 1e4;  // few spots at a time: hardly any is on its way when a block ends
  const spot::Packing packing = layers(box, heights);
  spot::SpotModel model(container, packing, p, 11);
  Displacements displacements(model);
  std::vector<std::vector<double>> squares(heights.size()), sums(heights.size());
  for (int block = 1; block <= 20; ++block) {
    model.advance(2.5 * block);
    const std::vector<Vec3> moved = displacements.next();
    const std::size_t in_layer = (moved.size() - 1) / heights.size();
    for (std::size_t h = 0; h < heights.size(); ++h) {
      double square = 0, sum = 0;
      for (std::size_t i = h * in_layer; i < (h + 1) * in_layer; ++i) {
        sum -= moved[i][2];
        square -= moved[i][2] * std::pow(packing.position[i][0], 2);
      }
      squares[h].push_back(square);
      sums[h].push_back(sum);
    }
  }
  std::vector<Measured> result;
  for (std::size_t h = 0; h < heights.size(); ++h) result.push_back(ratio_of_sums(squares[h], sums[h]));
  return result;
}

void expect_profile(const Vec3& step, double half_width) {
  const std::vector<double> heights{3, 6, 9};
  const std::vector<Measured> measured = variances(step, half_width, heights);
  const double b = step[0] * step[0] / (2 * step[2]), radius = gentle_spots().radius;
  for (std::size_t h = 0; h < heights.size(); ++h) {
    const double expected = 2 * b * heights[h] + radius * radius / 5 - step[0] * step[0] / 4;
    EXPECT_LT(measured[h].error, 0.04 * expected);  // √(2/5000), for as many spots, is 0.02
    // Particles sink by less than 0.03 d meanwhile; sums over whole numbers of steps in a ball are its integral to
    // 3e-4.
    EXPECT_NEAR(measured[h].value, expected, 4 * measured[h].error + 0.03 * b + 3e-4 * expected) << heights[h];
  }
}

TEST(SpotProfile, VarianceGrowsBy2bzWithThePublishedSteps) {
  expect_profile({0.676, 0.676, 0.1}, 45);
}

// Steps twice as long sideways and four times as high make the same flow: b stays, and the variance at any height is
// less by 0.34 d², by which Δx²/4 is greater.
TEST(SpotProfile, StepsTwiceAsLongKeepTheFlow) {
  expect_profile({1.352, 1.352, 0.4}, 45);
}

// With short steps, 2bz is no more than the width of the spots themselves: without R²/5 this is 8 errors off and more.
TEST(SpotProfile, SpotsWidenItByTheirOwnWidth) {
  expect_profile({0.2, 0.2, 0.1}, 20);
}

// Grains in the plane of the floor meet only the part of the spots' ways above the place where they enter: of a ball
// that comes from D below the plane, ½ + 3D/(4R) - D³/(4R³). In the plane itself that is half of what grains above
// meet.
TEST(SpotProfile, GrainsAtTheFloorMeetLessOfSpotsThatEnterThere) {
  const Box box{{-20, 0, 0}, {20, 8, 14}, {false, true, false}};
  const spot::Container container{box, spot::Orifice{spot::Orifice::Shape::slot, {0, 0}, 4}};
  const spot::Packing packing = layers(box, {0, 8});
  for (const double depth : {0.0, 2.0}) {
    spot::SpotParameters p = gentle_spots();
    p.step = {0.2, 0.2, 0.1};
    p.insertion_rate = 100;
    p.hop_rate = 1e4;
    p.entry_depth = depth;
    spot::SpotModel model(container, packing, p, 12);
    Displacements displacements(model);
    std::vector<double> low, high;
    for (int block = 1; block <= 10; ++block) {
      model.advance(2.5 * block);
      const std::vector<Vec3> moved = displacements.next();
      const std::size_t in_layer = moved.size() / 2;
      low.push_back(0);
      high.push_back(0);
      for (std::size_t i = 0; i < in_layer; ++i) {
        low.back() -= moved[i][2];
        high.back() -= moved[in_layer + i][2];
      }
    }
    const Measured share = ratio_of_sums(low, high);
    const double d = depth / p.radius;
    EXPECT_LT(share.error, 0.01);
    // The grid has a few points across a ball; a step of Δz is 1/26 of it.
    EXPECT_NEAR(share.value, 0.5 + 0.75 * d - 0.25 * d * d * d, 4 * share.error + 0.01) << depth;
  }
}

}  // namespace
}  // namespace grainvdb::testing::spot_profile_test
