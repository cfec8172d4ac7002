// The inner loops against plain sums in double, on every instruction set of the machine.
#include "spot/zone_kernels.hpp"

#include <algorithm>
#include <cmath>

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
  ParticleStore store(box, packing, ParticleStore::Lists::none);
  testing::Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 centre{random.uniform(-3, 6), random.uniform(1, 9), random.uniform(0, 12)};
    const double inner = random.uniform(0.5, 2.5), outer = inner + random.uniform(0, 1.5);
    const Site site = store.site_at(centre);
    const Found& found = store.find(site, inner, outer);
    std::vector<std::int32_t> in, out, expected_in, expected_out;
    in.assign(found.inner.begin(), found.inner.begin() + static_cast<std::ptrdiff_t>(found.inner_count));
    out.assign(found.outer.begin(), found.outer.begin() + static_cast<std::ptrdiff_t>(found.outer_count));
    std::sort(in.begin(), in.end());
    std::sort(out.begin(), out.end());
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(store.slots()); ++i) {
      const double r2 = squared_distance(box, store.position(i), store.position_of(site));
      // Distances are taken in single precision; in this sample none is that near to a radius.
      ASSERT_GT(std::abs(r2 - inner * inner), 1e-6);
      ASSERT_GT(std::abs(r2 - outer * outer), 1e-6);
      if (r2 < inner * inner)
        expected_in.push_back(i);
      else if (r2 < outer * outer)
        expected_out.push_back(i);
    }
    EXPECT_EQ(in, expected_in);
    EXPECT_EQ(out, expected_out);
  }
}

TEST_P(EveryTarget, PushesAreTheSumOverOverlaps) {
  const Box box = mixed_box();
  ParticleStore store(box, poisson_packing(box, 0.6, 1, 4), ParticleStore::Lists::kept);
  PushLaw law{{}, 1, 0.8F, 7};
  for (std::size_t a = 0; a < 3; ++a) law.unit[a] = static_cast<float>(store.unit()[a]);
  std::vector<std::int32_t> zone;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(store.slots()); i += 2) zone.push_back(i);
  for (const std::int32_t i : zone) store.set_stamp(i, 7);
  std::vector<Site> pushes(zone.size());
  push_apart(store.sites(), store.near(), zone.data(), zone.size(), law, pushes.data());
  double largest = 0;
  for (std::size_t k = 0; k < zone.size(); ++k) {
    Vec3 expected{};
    const Vec3 x = store.position(zone[k]);
    for (std::int32_t j = 0; j < static_cast<std::int32_t>(store.slots()); ++j) {
      const Vec3 y = store.position(j);
      const double r = std::sqrt(squared_distance(box, x, y));
      if (j == zone[k] || r >= 1) continue;
      const double f = (j % 2 == 0 ? 0.5 : 1) * 0.8 * (1 - r) / r;
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
