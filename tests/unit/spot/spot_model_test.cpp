#include "spot/spot_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "spot/published_spots.hpp"
#include "spot/random_packing.hpp"
#include "spot/snapshot.hpp"

namespace grainvdb::spot::spot_model_test {
namespace {

Container silo() {
  return {{{-7, 0, 0}, {7, 8, 14}, {false, true, false}}, Orifice{Orifice::Shape::slot, {0, 0}, 5}};
}

const Packing& packing() {
  static const Packing one = random_packing(silo().box, 0.58, 1, 1);
  return one;
}

std::string text_after(const SpotParameters& p, std::uint64_t seed, const std::vector<double>& times) {
  SpotModel model(silo(), packing(), p, seed);
  for (const double t : times) {
    model.advance(t);
    model.compact();
  }
  const Snapshot now = take_snapshot(model);
  return dump_text(make_frame(model, now, velocities(now, now, model.particles().unit())), 0, "lj");
}

TEST(SpotModel, IsReproducibleForASeed) {
  const std::string one = text_after(published_spots(), 1, {2});
  EXPECT_EQ(one, text_after(published_spots(), 1, {2}));
  EXPECT_EQ(one, text_after(published_spots(), 1, {0.3, 1.1, 2}));  // however the run is cut
  EXPECT_NE(one, text_after(published_spots(), 2, {2}));
}

TEST(SpotModel, DoesNotDependOnTheOrderOfThePacking) {
  Packing reversed = packing();
  std::reverse(reversed.id.begin(), reversed.id.end());
  std::reverse(reversed.position.begin(), reversed.position.end());
  SpotModel model(silo(), reversed, published_spots(), 1);
  model.advance(2);
  const Snapshot now = take_snapshot(model);
  EXPECT_EQ(text_after(published_spots(), 1, {2}),
            dump_text(make_frame(model, now, velocities(now, now, model.particles().unit())), 0, "lj"));
}

// One spot on its way through a packing that covers it everywhere: the particles that it holds all the time are moved
// by -1/w of its way.
TEST(SpotModel, AParticleMovesByMinusOneOverWOfTheSpotsStep) {
  const Box box{{0, 0, 0}, {12, 12, 12}, {true, true, true}};
  SpotParameters p = published_spots();
  p.insertion_rate = 0;
  p.count = 1;
  p.relaxation.every = 0;
  SpotModel model({box, std::nullopt}, poisson_packing(box, 0.5, 1, 2), p, 3);
  std::size_t moved = 0;
  for (int event = 0; event < 50; ++event) {
    const Vec3 from = model.spots()[0];
    const Snapshot before = take_snapshot(model);
    model.run_events(1);
    const Snapshot after = take_snapshot(model);
    Vec3 step{}, centre{};
    for (int a = 0; a < 3; ++a) {
      step[a] = box.minimum_image(a, model.spots()[0][a] - from[a]);
      centre[a] = from[a] + 0.5 * step[a];
    }
    for (std::size_t i = 0; i < after.id.size(); ++i) {
      const Vec3 x = model.particles().position_of(before.site[i]), y = model.particles().position_of(after.site[i]);
      double r2 = 0;
      for (int a = 0; a < 3; ++a) r2 += std::pow(box.minimum_image(a, x[a] - centre[a]), 2);
      const bool inside = r2 < 2.6 * 2.6;
      moved += inside ? 1U : 0U;
      // One count is 12 / 2³²; it is rounded twice, with what is left over from before.
      for (int a = 0; a < 3; ++a)
        EXPECT_NEAR(box.minimum_image(a, y[a] - x[a]), inside ? -step[a] / 399 : 0, 1.5 * 12 * 0x1p-32);
    }
  }
  EXPECT_EQ(moved, model.counters().displaced);
  EXPECT_GT(moved, 50 * 50U);
}

TEST(SpotModel, AccountsForEveryParticle) {
  SpotParameters p = published_spots();
  p.influence = 40;  // drains fast
  SpotModel model(silo(), packing(), p, 4);
  model.advance(12);
  EXPECT_GT(model.drained().size(), packing().id.size() / 4);
  std::set<std::int64_t> ids;
  double last = 0;
  for (const Drained& d : model.drained()) {
    EXPECT_TRUE(ids.insert(d.id).second);
    EXPECT_GE(d.time, last);
    last = d.time;
  }
  const Snapshot now = take_snapshot(model);
  for (const std::int64_t id : now.id) EXPECT_TRUE(ids.insert(id).second);
  EXPECT_EQ(ids, std::set<std::int64_t>(packing().id.begin(), packing().id.end()));
  const SpotCounters& c = model.counters();
  EXPECT_EQ(c.inserted - c.removed, model.spots().size());
}

TEST(SpotModel, AnEmptyContainerLetsSpotsThrough) {
  Packing few{1, {5}, {{0, 4, 0.5}}};
  SpotParameters p = published_spots();
  p.influence = 10;
  SpotModel model(silo(), few, p, 1);
  model.advance(20);
  EXPECT_EQ(model.particles().size(), 0U);
  EXPECT_EQ(model.drained().size(), 1U);
  EXPECT_GT(model.counters().removed, 0U);
}

TEST(SpotModel, RelaxesEveryKthStepOrByChance) {
  SpotParameters p = published_spots();
  const auto share = [&] {
    SpotModel model(silo(), packing(), p, 5);
    model.run_events(20'000);
    return static_cast<double>(model.counters().relaxed) / static_cast<double>(model.counters().steps);
  };
  p.relaxation.every = 10;
  EXPECT_NEAR(share(), 0.1, 1e-4);  // one in 20,000
  p.relaxation.every = 1;
  p.relaxation.probability = 0.3;
  EXPECT_NEAR(share(), 0.3, 4 * std::sqrt(0.3 * 0.7 / 19'000));
  p.relaxation.every = 0;
  EXPECT_EQ(share(), 0);
}

TEST(SpotModel, SpotsKeepTheirDistanceFromWalls) {
  SpotParameters p = published_spots();
  p.relaxation.every = 0;
  const auto widest = [&](double distance) {
    p.wall_distance = distance;
    SpotModel model(silo(), packing(), p, 6);
    double most = 0;
    for (int k = 0; k < 100; ++k) {
      model.run_events(500);
      for (const Vec3& s : model.spots()) most = std::max(most, std::abs(s[0]));
    }
    return most;
  };
  EXPECT_DOUBLE_EQ(widest(1), 6);
  EXPECT_DOUBLE_EQ(widest(-1.5), 8.5);
}

// Not nearer to the plate beside the slot than that: a slot of 5 leaves nothing of 2.6, and spots rise in its middle
// first.
TEST(SpotModel, SpotsKeepTheirDistanceFromTheFloor) {
  SpotParameters p = published_spots();
  p.relaxation.every = 0;
  p.entry_depth = 2;
  const auto nearest = [&](double distance) {
    p.floor_distance = distance;
    SpotModel model(silo(), packing(), p, 6);
    double least = 1e9;
    for (int k = 0; k < 100; ++k) {
      model.run_events(500);
      for (const Vec3& s : model.spots())
        least = std::min(least, std::hypot(std::max(0.0, 2.5 - std::abs(s[0])), s[2]));
    }
    return least;
  };
  EXPECT_LT(nearest(0), 0.1);
  EXPECT_NEAR(nearest(1.5), 1.5, 1e-9);
  EXPECT_NEAR(nearest(2.6), 2.5, 0.01);  // in the plane of the floor, or up to half a step of 0.1 off it
}

// A bias leads spots to where the particles are: with the right half of the container empty they stay in the left one.
TEST(SpotModel, ABiasLeadsSpotsTowardsParticles) {
  Packing half{1, {}, {}};
  for (std::size_t i = 0; i < packing().id.size(); ++i)
    if (packing().position[i][0] < 0) {
      half.id.push_back(packing().id[i]);
      half.position.push_back(packing().position[i]);
    }
  SpotParameters p = published_spots();
  p.relaxation.every = 0;
  const auto right = [&] {
    SpotModel model(silo(), half, p, 7);
    model.run_events(30'000);
    std::size_t n = 0;
    for (const Vec3& s : model.spots()) n += s[0] > 2.6 ? 1U : 0U;
    return static_cast<double>(n) / static_cast<double>(model.spots().size());
  };
  const double unbiased = right();
  p.bias = Bias{3, 0.2, 20};
  p.influence = 0;
  EXPECT_GT(unbiased, 0.1);
  EXPECT_LT(right(), 0.1 * unbiased);
}

}  // namespace
}  // namespace grainvdb::spot::spot_model_test
