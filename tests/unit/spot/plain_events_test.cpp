// Every event of a run against the model written down plainly in double precision: all particles, all pairs, no cells.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <ostream>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "spot/published_spots.hpp"
#include "spot/random_packing.hpp"
#include "spot/snapshot.hpp"

namespace grainvdb::spot::plain_events_test {
namespace {

using Places = std::map<std::int64_t, Vec3>;

Places places_of(const SpotModel& model) {
  Places places;
  for (const std::int32_t i : model.particles().places())
    places[model.particles().id(i)] = model.particles().position(i);
  return places;
}

struct Step {
  Vec3 from{}, step{};
};

/// The spot that differs between two moments, if one has stepped.
std::optional<Step> step_between(const Box& box, const std::vector<Vec3>& before, const std::vector<Vec3>& after) {
  if (before.size() != after.size()) return std::nullopt;
  for (std::size_t k = 0; k < before.size(); ++k) {
    if (before[k] == after[k]) continue;
    Step step{before[k], {}};
    for (int a = 0; a < 3; ++a) step.step[a] = box.minimum_image(a, after[k][a] - before[k][a]);
    return step;
  }
  return std::nullopt;
}

class PlainEvent {
 public:
  PlainEvent(const Container& container, const SpotParameters& parameters, const Step& step)
      : container_(container), parameters_(parameters), step_(step) {
    for (std::size_t a = 0; a < 3; ++a) centre_[a] = step.from[a] + 0.5 * step.step[a];
  }
  /// Whether somebody is so near to a radius that single precision may decide otherwise.
  bool is_close(const Places& places) const {
    for (const auto& [id, x] : places)
      for (const double radius : {parameters_.radius, parameters_.relaxation.radius})
        if (std::abs(distance(x, centre_) - radius) < 1e-6) return true;
    return false;
  }
  /// Moves the particles; those that leave are taken out.
  void apply(Places& places, bool relaxed) const {
    std::set<std::int64_t> zone;
    for (auto& [id, x] : places) {
      const double r = distance(x, centre_);
      if (r < (relaxed ? parameters_.relaxation.radius : parameters_.radius)) zone.insert(id);
      if (r >= parameters_.radius) continue;
      for (std::size_t a = 0; a < 3; ++a) x[a] -= step_.step[a] / parameters_.influence;
      x = kept(x);
    }
    if (relaxed) relax(places, zone);
    for (const std::int64_t id : zone)
      if (container_.orifice && places.at(id)[2] < container_.box.lo[2] - 0.5) places.erase(id);
  }

 private:
  double distance(const Vec3& x, const Vec3& y) const {
    double r2 = 0;
    for (int a = 0; a < 3; ++a) r2 += std::pow(container_.box.minimum_image(a, x[a] - y[a]), 2);
    return std::sqrt(r2);
  }
  Vec3 kept(Vec3 x) const {
    for (int a = 0; a < 3; ++a) {
      const double below = a == 2 && container_.orifice ? 1.8 : 0;
      x[a] = container_.box.periodic[a] ? container_.box.wrap(a, x[a])
                                        : std::clamp(x[a], container_.box.lo[a] - below, container_.box.hi[a]);
    }
    return x;
  }
  void relax(Places& places, const std::set<std::int64_t>& zone) const {
    Places moved;
    for (const std::int64_t i : zone) {
      const Vec3 x = places.at(i);
      Vec3 push = push_from_walls(container_, x, 1);
      for (const auto& [j, y] : places) {
        const double r = distance(x, y);
        if (j == i || r >= 1) continue;
        const double f = (zone.contains(j) ? 0.5 : 1) * parameters_.relaxation.strength * (1 - r) / r;
        for (int a = 0; a < 3; ++a) push[a] += f * container_.box.minimum_image(a, x[a] - y[a]);
      }
      for (std::size_t a = 0; a < 3; ++a) push[a] += x[a];
      moved[i] = kept(push);
    }
    for (const auto& [i, x] : moved) places.at(i) = x;
  }

  const Container& container_;
  const SpotParameters& parameters_;
  Step step_;
  Vec3 centre_{};
};

struct Case {
  const char* name;
  Container container;
  std::int64_t every;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class EveryEvent : public ::testing::TestWithParam<Case> {};

// The packing is random places, in which many particles overlap and cells hold from none to many.
TEST_P(EveryEvent, IsThatOfThePlainModel) {
  const Container& container = GetParam().container;
  SpotParameters p = published_spots();
  p.influence = 8;  // particles go far
  p.relaxation.every = GetParam().every;
  p.count = 10;
  p.insertion_rate = container.orifice ? 100 : 0;
  SpotModel model(container, poisson_packing(container.box, 0.5, 1, 11), p, 12);
  std::size_t steps = 0, changed = 0, close = 0;
  for (int event = 0; event < 800; ++event) {
    Places expected = places_of(model);
    const std::vector<Vec3> spots = model.spots();
    model.run_events(1);
    const auto step = step_between(container.box, spots, model.spots());
    const Places before = expected;
    if (step) {
      ++steps;
      const bool relaxed = p.relaxation.every > 0 && steps % static_cast<std::size_t>(p.relaxation.every) == 0;
      const PlainEvent plain(container, p, *step);
      if (plain.is_close(expected)) {
        ++close;
        continue;
      }
      plain.apply(expected, relaxed);
    }
    const Places found = places_of(model);
    ASSERT_EQ(found.size(), expected.size()) << event;
    for (const auto& [id, x] : expected) {
      ASSERT_TRUE(found.contains(id)) << event;
      // A dozen neighbours, each with a few roundings of single precision of a push below 1.
      for (int a = 0; a < 3; ++a)
        ASSERT_NEAR(container.box.minimum_image(a, found.at(id)[a] - x[a]), 0, 12 * 8 * 6e-8) << event << ' ' << id;
      changed += before.at(id) != x ? 1U : 0U;
    }
  }
  EXPECT_GT(steps, 600U);
  EXPECT_LT(close, 10U);
  EXPECT_GT(changed, 30 * steps);
  if (container.orifice) {
    EXPECT_GT(model.drained().size(), 5U);
  }
}

const Container& walls() {
  static const Container one{{{-5, 0, 0}, {5, 8, 10}, {false, true, false}}, Orifice{Orifice::Shape::slot, {0, 0}, 5}};
  return one;
}
const Container& periodic() {
  static const Container one{{{0, 0, 0}, {8, 9, 8}, {true, true, true}}, std::nullopt};
  return one;
}

INSTANTIATE_TEST_SUITE_P(Runs, EveryEvent,
                         ::testing::Values(Case{"Walls", walls(), 0}, Case{"WallsRelaxed", walls(), 1},
                                           Case{"WallsRelaxedEveryThird", walls(), 3}, Case{"Periodic", periodic(), 0},
                                           Case{"PeriodicRelaxed", periodic(), 1},
                                           Case{"PeriodicRelaxedEverySecond", periodic(), 2}),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace grainvdb::spot::plain_events_test
