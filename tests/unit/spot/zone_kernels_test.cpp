// The inner loops against plain sums in double, on every instruction set of the machine.
#include "spot/zone_kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "spot/particle_store.hpp"
#include "spot/random_packing.hpp"
#include "support/random.hpp"

namespace grainvdb::spot::zone_kernels_test {
namespace {

Box mixed_box() {
  return {{-3, 1, 0}, {6, 9, 12}, {false, true, false}};
}

double squared_distance(const Box& box, const Vec3& x, const Vec3& y) {
  double r2 = 0;
  for (int a = 0; a < 3; ++a) r2 += std::pow(box.minimum_image(a, x[a] - y[a]), 2);
  return r2;
}

/// Sets the instruction sets that may be used, and all of them again at the end.
class EveryTarget : public ::testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { hwy::SetSupportedTargetsForTest(GetParam()); }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_P(EveryTarget, FindsExactlyThoseWithinReach) {
  const Box box = mixed_box();
  const Packing packing = poisson_packing(box, 0.6, 1, 3);
  ParticleStore store(box, packing, ParticleStore::Neighbours::none);
  testing::Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 centre{random.uniform(-3, 6), random.uniform(1, 9), random.uniform(0, 12)};
    const double radius = random.uniform(0.5, 4);
    const Site site = store.site_at(centre);
    const auto found = store.find(site, radius);
    std::vector<std::int32_t> expected;
    for (const std::int32_t i : store.places()) {
      const double r2 = squared_distance(box, store.position(i), store.position_of(site));
      // Distances are taken in single precision; in this sample none is that near to a radius.
      ASSERT_GT(std::abs(r2 - radius * radius), 1e-6);
      if (r2 < radius * radius) expected.push_back(i);
    }
    std::vector<std::int32_t> sorted(found.begin(), found.end());
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, expected);
  }
}

// Spots pass and zones are marked at random places, across periodic ends and at walls. Positions are whole numbers, so
// that they must be those of plain sums exactly.
TEST_P(EveryTarget, MovesAndMarksExactlyThoseWithinReach) {
  const Box box = mixed_box();
  ParticleStore store(box, poisson_packing(box, 0.6, 1, 6), ParticleStore::Neighbours::listed, {1.5, 3});
  testing::Random random(7);
  std::size_t on_walls = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Site centre = store.site_at({random.uniform(-3, 6), random.uniform(1, 9), random.uniform(0, 12)});
    const Radii radii{random.uniform(0.5, 2.5), random.uniform(2.5, 3.9)};
    Site step;
    for (std::size_t a = 0; a < 3; ++a)
      step.at[a] = static_cast<std::int32_t>(random.uniform(-0.8, 0.8) / store.unit()[a]);
    const std::array<Site, 2> ends{store.site_at({-3, 1, -1.5}), store.site_at({6, 9, 12})};
    std::map<std::int64_t, std::array<std::int32_t, 3>> expected;
    std::set<std::int64_t> marked;
    std::size_t moved = 0;
    for (const std::int32_t i : store.places()) {
      const double r2 = squared_distance(box, store.position(i), store.position_of(centre));
      ASSERT_GT(std::abs(r2 - radii.moved * radii.moved), 1e-6);
      ASSERT_GT(std::abs(r2 - radii.marked * radii.marked), 1e-6);
      auto at = store.site(i).at;
      if (r2 < radii.marked * radii.marked) marked.insert(store.id(i));
      if (r2 < radii.moved * radii.moved) {
        ++moved;
        for (std::size_t a = 0; a < 3; ++a) {
          at[a] = static_cast<std::int32_t>(static_cast<std::uint32_t>(at[a]) + static_cast<std::uint32_t>(step.at[a]));
          if (box.periodic[a]) continue;
          const std::int32_t bounded = std::clamp(at[a], ends[0].at[a], ends[1].at[a] + 1);
          on_walls += bounded != at[a] ? 1U : 0U;
          at[a] = bounded;
        }
      }
      expected[store.id(i)] = at;
    }
    EXPECT_EQ(store.move_and_mark(centre, radii, step), moved);
    std::set<std::int64_t> zone;
    for (const std::int32_t i : store.zone()) zone.insert(store.id(i));
    EXPECT_EQ(zone, marked);
    EXPECT_EQ(store.zone().size(), marked.size());
    for (const std::int32_t i : store.places())
      for (std::size_t a = 0; a < 3; ++a)
        // Where a wall is, in counts, is rounded once more here.
        EXPECT_NEAR(store.site(i).at[a], expected.at(store.id(i))[a], box.periodic[a] ? 0 : 1);
    store.move_zone(std::vector<Site>(store.zone().size()));
  }
  EXPECT_GT(on_walls, 20U);
}

TEST_P(EveryTarget, PushesAreTheSumOverOverlaps) {
  const Box box = mixed_box();
  ParticleStore store(box, poisson_packing(box, 0.6, 1, 4), ParticleStore::Neighbours::listed);
  PushLaw law{{}, 1, 0.8F, Site::in_zone};
  for (std::size_t a = 0; a < 3; ++a) law.unit[a] = static_cast<float>(store.unit()[a]);
  store.move_and_mark(store.site_at({1, 2, 3}), {0, 4}, {});
  const std::set<std::int32_t> inside(store.zone().begin(), store.zone().end());
  EXPECT_GT(inside.size(), 100U);
  EXPECT_LT(inside.size(), store.size() / 2);
  std::vector<Site> pushes(inside.size());
  push_apart(store.sites(), store.near(), store.zone(), law, pushes.data());
  double largest = 0;
  for (std::size_t k = 0; k < pushes.size(); ++k) {
    Vec3 expected{};
    const std::int32_t i = store.zone()[k];
    const Vec3 x = store.position(i);
    for (const std::int32_t j : store.places()) {
      const Vec3 y = store.position(j);
      const double r = std::sqrt(squared_distance(box, x, y));
      if (j == i || r >= 1) continue;
      const double f = (inside.contains(j) ? 0.5 : 1) * 0.8 * (1 - r) / r;
      for (int a = 0; a < 3; ++a) expected[a] += f * box.minimum_image(a, x[a] - y[a]);
    }
    for (std::size_t a = 0; a < 3; ++a) {
      // A dozen neighbours, each with a few roundings of single precision of a push below 1.
      EXPECT_NEAR(pushes[k].at[a] * store.unit()[a], expected[a], 12 * 8 * 6e-8);
      largest = std::max(largest, std::abs(expected[a]));
    }
  }
  EXPECT_GT(largest, 0.3);
}

// Runs are the same everywhere only if every instruction set gives the same counts.
TEST_P(EveryTarget, GivesTheCountsOfTheBest) {
  const Box box = mixed_box();
  const auto run = [&] {
    const Packing packing = random_packing(box, 0.5, 1, 9);
    return packing.position;
  };
  const auto here = run();
  hwy::SetSupportedTargetsForTest(0);
  EXPECT_EQ(here, run());
}

INSTANTIATE_TEST_SUITE_P(Targets, EveryTarget, ::testing::ValuesIn([] {
                           std::vector<std::int64_t> targets;
                           for (std::int64_t all = hwy::SupportedTargets(); all != 0; all &= all - 1)
                             targets.push_back(all & -all);
                           return targets;
                         }()),
                         [](const auto& param) { return std::string(hwy::TargetName(param.param)); });

}  // namespace
}  // namespace grainvdb::spot::zone_kernels_test
