#include "spot/particle_store.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "spot/random_packing.hpp"
#include "support/random.hpp"

namespace grainvdb::spot::particle_store_test {
namespace {

double distance(const ParticleStore& store, std::int32_t i, std::int32_t j) {
  const Vec3 x = store.position(i), y = store.position(j);
  double r2 = 0;
  for (int a = 0; a < 3; ++a) r2 += std::pow(store.box().minimum_image(a, x[a] - y[a]), 2);
  return std::sqrt(r2);
}

// Every pair that overlaps is in both lists, however the particles have moved.
void expect_complete_lists(const ParticleStore& store) {
  const NearView near = store.near();
  const auto n = static_cast<std::int32_t>(store.slots());
  for (std::int32_t i = 0; i < n; ++i) {
    if (!store.holds(i)) continue;
    const auto row = near.members + static_cast<std::size_t>(i) * near.capacity;
    const std::set<std::int32_t> listed(row, row + near.counts[i]);
    EXPECT_FALSE(listed.contains(i));
    for (std::int32_t j = 0; j < n; ++j)
      if (j != i && store.holds(j) && distance(store, i, j) < store.diameter()) {
        EXPECT_TRUE(listed.contains(j)) << i << ' ' << j;
      }
    for (const std::int32_t j : listed) EXPECT_TRUE(store.holds(j));
    for (std::size_t k = static_cast<std::size_t>(near.counts[i]); k % 8 != 0; ++k) EXPECT_EQ(row[k], i);
  }
}

TEST(ParticleStore, ListsStayCompleteWhileParticlesMoveAndGo) {
  const Box box{{0, 0, 0}, {8, 7, 9}, {true, false, false}};
  ParticleStore store(box, poisson_packing(box, 0.5, 1, 1), ParticleStore::Lists::kept);
  testing::Random random(2);
  for (int round = 0; round < 40; ++round) {
    std::vector<std::int32_t> some;
    std::vector<Site> steps;
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(store.slots()); ++i) {
      if (!store.holds(i) || random.uniform() < 0.5) continue;
      some.push_back(i);
      Site step;
      for (std::size_t a = 0; a < 3; ++a)
        step.at[a] = static_cast<std::int32_t>(random.uniform(-0.1, 0.1) / store.unit()[a]);
      steps.push_back(step);
    }
    store.move_each(some, steps);
    store.take_out(some[some.size() / 2]);
    if (round % 10 == 9) expect_complete_lists(store);
    if (round == 24) store.compact();
  }
}

TEST(ParticleStore, FindsParticlesThatHaveMovedSinceTheirCellWasChosen) {
  const Box box{{0, 0, 0}, {8, 8, 8}, {true, true, false}};
  ParticleStore store(box, poisson_packing(box, 0.5, 1, 3), ParticleStore::Lists::none);
  std::vector<std::int32_t> all(store.slots());
  std::iota(all.begin(), all.end(), 0);
  testing::Random random(4);
  Site step;
  for (std::size_t a = 0; a < 3; ++a) step.at[a] = static_cast<std::int32_t>(0.011 / store.unit()[a]);
  for (int round = 0; round < 60; ++round) {
    store.move_alike(all, step);
    const Site centre = store.site_at({random.uniform(0, 8), random.uniform(0, 8), random.uniform(0, 8)});
    const Found& found = store.find(centre, 2, 2);
    std::size_t expected = 0;
    for (const std::int32_t i : all) {
      double r2 = 0;
      for (int a = 0; a < 3; ++a)
        r2 += std::pow(box.minimum_image(a, store.position(i)[a] - store.position_of(centre)[a]), 2);
      expected += r2 < 4 ? 1U : 0U;
    }
    EXPECT_EQ(found.inner_count, expected);
  }
}

TEST(ParticleStore, KeepsCentresBetweenWallsAndIdsThroughCompaction) {
  const Box box{{0, 0, 0}, {8, 8, 8}, {false, true, false}};
  const Packing packing = poisson_packing(box, 0.2, 1, 5);
  ParticleStore store(box, packing, ParticleStore::Lists::none, 1);
  std::vector<std::int32_t> all(store.slots());
  std::iota(all.begin(), all.end(), 0);
  Site step;
  for (std::size_t a = 0; a < 3; ++a) step.at[a] = -static_cast<std::int32_t>(0.5 / store.unit()[a]);
  for (int k = 0; k < 20; ++k) store.move_alike(all, step);
  for (const std::int32_t i : all) {
    EXPECT_NEAR(store.position(i)[0], 0, 1e-7);
    EXPECT_NEAR(store.position(i)[2], -1, 1e-7);
    EXPECT_GE(store.position(i)[1], 0);
    EXPECT_LT(store.position(i)[1], 8);
  }
  store.take_out(3);
  const std::int64_t gone = store.id(3);
  store.compact();
  std::set<std::int64_t> ids;
  for (std::size_t i = 0; i < store.slots(); ++i) ids.insert(store.id(static_cast<std::int32_t>(i)));
  EXPECT_EQ(ids.size(), packing.id.size() - 1);
  EXPECT_FALSE(ids.contains(gone));
}

TEST(RandomPacking, HasTheFractionAskedForAndNoOverlaps) {
  const Box box{{0, 0, 0}, {8, 8, 8}, {true, true, false}};
  const Packing packing = random_packing(box, 0.58, 1, 1);
  EXPECT_EQ(packing.id.size(), 567U);  // 0.58 · 512 / (π/6), rounded
  for (std::size_t i = 0; i < packing.id.size(); ++i) {
    EXPECT_GT(packing.position[i][2], 0.5 - 1e-3);
    for (std::size_t j = 0; j < i; ++j) {
      double r2 = 0;
      for (int a = 0; a < 3; ++a)
        r2 += std::pow(box.minimum_image(a, packing.position[i][a] - packing.position[j][a]), 2);
      EXPECT_GT(r2, std::pow(1 - 1e-3, 2));
    }
  }
}

}  // namespace
}  // namespace grainvdb::spot::particle_store_test
