// The void model against its closed forms. Voids enter one at a time, so that they are independent random walks, for
// which the forms are exact.
#include "spot/void_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gmock/gmock.h>

#include "grainvdb/error.hpp"
#include "grainvdb/kinematic.hpp"
#include "spot/void_frame.hpp"

namespace grainvdb::spot::void_model_test {
namespace {

using ::testing::HasSubstr;

constexpr double dx = 0.5, dz = 0.9;
constexpr double b = dx * dx / (2 * dz);

/// A lattice between far walls, staggered along x alone, in which a void has two ways at every hop.
struct Scene {
  Container container;
  StaggeredLattice lattice;
};
Scene plane(double half_width, std::size_t layers, bool periodic) {
  const double height = 1 + dz * (static_cast<double>(layers) - 0.5);
  const Container container{{{-half_width, 0, 0}, {half_width, 1, height}, {periodic, true, false}},
                            Orifice{Orifice::Shape::slot, {0, 0}, 2.5 * half_width}};
  return {container, StaggeredLattice(container.box, 1, {dx, 0, dz}, height)};
}

/// Hops of voids are a million times as frequent as entries: hardly ever are there two.
VoidParameters one_at_a_time(VoidParameters::Entry entry) {
  return {1e6, 1, entry};
}

/// Runs until so many voids have entered, and calls f(from, to) for every hop of one that is alone.
template <class F>
void watch(LatticeVoids& model, std::size_t voids, F f) {
  while (model.counters().inserted < voids) {
    const std::vector<std::size_t> before = model.voids();
    const std::size_t entered = model.counters().inserted;
    model.run_events(1);
    const bool alone = before.size() == 1 && model.voids().size() == 1 && model.counters().inserted == entered;
    if (alone && model.voids() != before) f(before[0], model.voids()[0]);
  }
}

/// Mean and its standard error, of independent values.
struct Mean {
  double value = 0, error = 0;
};
Mean mean_of(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  for (const double v : values) sum += v;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) squares += (v - sum / n) * (v - sum / n);
  return {sum / n, std::sqrt(squares / (n - 1) / n)};
}

TEST(LatticeVoids, AccountsForEveryGrainAndSite) {
  const Box box{{0, 0, 0}, {9, 6, 12}, {false, true, false}};
  const Container container{box, Orifice{Orifice::Shape::circle, {4.5, 3}, 4}};
  const StaggeredLattice lattice(box, 1, {0.5, 0.5, 0.70711}, 10);
  LatticeVoids model(container, lattice, {20, 100, VoidParameters::Entry::spread}, 3);
  for (int round = 0; round < 20; ++round) {
    model.run_events(2000);
    std::set<std::int64_t> ids;
    for (const Drained& d : model.drained()) EXPECT_TRUE(ids.insert(d.id).second);
    std::size_t voids = 0;
    for (std::size_t site = 0; site < lattice.size(); ++site) {
      const std::int64_t there = model.sites()[site];
      if (there > 0) {
        EXPECT_TRUE(ids.insert(there).second);
      }
      if (there == LatticeVoids::empty) ++voids;
      if (there != LatticeVoids::air) continue;
      // Nothing hangs over the air.
      const auto above = lattice.above(site);
      for (std::size_t n = 0; n < above.count; ++n) EXPECT_EQ(model.sites()[above.site[n]], LatticeVoids::air);
    }
    EXPECT_EQ(ids.size(), lattice.size());
    EXPECT_EQ(*ids.begin(), 1);
    EXPECT_EQ(voids, model.voids().size());
    EXPECT_EQ(model.grains() + model.drained().size(), lattice.size());
    EXPECT_EQ(model.counters().inserted, model.drained().size());
    EXPECT_EQ(model.counters().inserted - model.counters().removed, model.voids().size());
  }
  // All that can leave has left: a slope of the lattice's steps stays on each side.
  EXPECT_TRUE(model.voids().empty());
  EXPECT_GT(model.grains(), lattice.size() / 10);
  EXPECT_LT(model.grains(), lattice.size() / 2);
}

// Under voids from everywhere a grain falls to each lower neighbour with the same probability: Var(Δx) = Δx² per layer,
// which is 2 b of the voids per Δz. The spot model has b_p/b below 1/w.
TEST(LatticeVoids, GrainsSpreadAsFastAsVoids) {
  const std::size_t layer = 20;
  const Scene scene = plane(300, 140, true);
  const StaggeredLattice& lattice = scene.lattice;
  LatticeVoids model(scene.container, lattice, one_at_a_time(VoidParameters::Entry::spread), 1);
  std::vector<double> of_grain(lattice.size() + 1);  // ways sideways by id
  double of_void = 0;
  std::vector<double> void_spread, grain_spread;  // (Δx)²/(2 Δz) of one after the other
  watch(model, 40'000, [&](std::size_t from, std::size_t to) {
    if (lattice.layer_of(from) == 0) of_void = 0;
    const double hop = scene.container.box.minimum_image(0, lattice.position(to)[0] - lattice.position(from)[0]);
    of_void += hop;
    if (lattice.layer_of(to) == layer) void_spread.push_back(of_void * of_void / (2 * layer * dz));
    // The grain has gone where the void was. Those that began here or below have fallen too little to tell.
    const auto id = static_cast<std::size_t>(model.sites()[from]);
    of_grain[id] -= hop;
    const std::size_t fallen = lattice.layer_of(id - 1) - lattice.layer_of(from);
    if (lattice.layer_of(from) == 0 && fallen >= layer)
      grain_spread.push_back(of_grain[id] * of_grain[id] / (2 * static_cast<double>(fallen) * dz));
  });
  const Mean of_voids = mean_of(void_spread), of_grains = mean_of(grain_spread);
  EXPECT_LT(of_voids.error, 0.015 * b);
  EXPECT_LT(of_grains.error, 0.015 * b);
  EXPECT_NEAR(of_voids.value, b, 4 * of_voids.error);
  EXPECT_NEAR(of_grains.value, b, 4 * of_grains.error);
  const double ratio = of_grains.value / of_voids.value;
  EXPECT_NEAR(ratio, 1, 4 * ratio * std::hypot(of_grains.error / of_grains.value, of_voids.error / of_voids.value));
}

// How often voids have been at each site above a point: the binomial distribution, whose variance is 2 b z and which
// the kinematic model's Gaussian follows.
TEST(LatticeVoids, TheProfileIsThatOfTheKinematicModel) {
  const std::size_t layer = 20;
  const Scene scene = plane(60.5, 200, false);  // 121 columns: one above the middle
  LatticeVoids model(scene.container, scene.lattice, one_at_a_time(VoidParameters::Entry::centre), 2);
  std::map<double, double> visits;
  std::vector<double> squares;
  watch(model, 4000, [&](std::size_t, std::size_t to) {
    if (scene.lattice.layer_of(to) != layer) return;
    const double x = scene.lattice.position(to)[0];
    visits[std::round(x / dx)] += 1;
    squares.push_back(x * x);
  });
  const double z = static_cast<double>(layer) * dz;
  const KinematicFlow flow{b, 1};
  const Mean variance = mean_of(squares);
  EXPECT_NEAR(flow.variance(z), static_cast<double>(layer) * dx * dx, 1e-12);
  EXPECT_LT(variance.error, 0.04 * flow.variance(z));
  EXPECT_NEAR(variance.value, flow.variance(z), 4 * variance.error);
  const auto n = static_cast<double>(squares.size());
  for (int k = -static_cast<int>(layer); k <= static_cast<int>(layer); k += 2) {
    const double right = 0.5 * (static_cast<double>(layer) + k);
    const double p =
        std::exp(std::lgamma(layer + 1.0) - std::lgamma(right + 1) -
                 std::lgamma(static_cast<double>(layer) - right + 1) - static_cast<double>(layer) * std::log(2));
    EXPECT_NEAR(visits[k] / n, p, 4.5 * std::sqrt(p / n) + 5 / n) << k;
    // Sites of a layer are 2Δx apart; the binomial is the normal distribution but for a few per cent in its middle and
    // less than 1e-3 beyond.
    EXPECT_NEAR(2 * dx * flow.downward(k * dx, z), p, p * 0.03 + 1e-3) << k;
  }
}

// A grain in the flow to a point goes the way of a void backwards: a random walk whose end is known. Its mean is
// x₀ z/z₀; its variance 2bz(1 - z/z₀) with the factor (1 - (x₀/(kΔx))²) k/(k-1), k = z₀/Δz, that steps of finite length
// make.
TEST(LatticeVoids, AGrainFallsAsTheClosedFormSays) {
  const std::size_t upper = 18, lower = 9;
  const Scene scene = plane(60.5, 200, false);
  LatticeVoids model(scene.container, scene.lattice, one_at_a_time(VoidParameters::Entry::centre), 4);
  std::map<std::int64_t, double> begun;  // place of each grain in the upper layer
  std::vector<double> deviations, squares;
  watch(model, 4000, [&](std::size_t from, std::size_t) {
    const std::int64_t id = model.sites()[from];
    const double x = scene.lattice.position(from)[0];
    if (scene.lattice.layer_of(from) == upper) begun[id] = x;
    if (scene.lattice.layer_of(from) != lower || !begun.contains(id)) return;
    const double k = upper, x0 = begun[id], z0 = k * dz, z = lower * dz;
    const double finite = (1 - std::pow(x0 / (k * dx), 2)) * k / (k - 1);
    const double deviation = x - grainvdb::VoidModel::mean(x0, z0, z);
    deviations.push_back(deviation);
    squares.push_back(deviation * deviation / (grainvdb::VoidModel{b}.variance(z0, z) * finite));
  });
  const Mean mean = mean_of(deviations), variance = mean_of(squares);
  EXPECT_LT(variance.error, 0.04);
  EXPECT_NEAR(mean.value, 0, 4 * mean.error);
  EXPECT_NEAR(variance.value, 1, 4 * variance.error);
}

TEST(LatticeVoids, VelocitiesAreDisplacements) {
  const Scene scene = plane(10, 12, true);
  LatticeVoids model(scene.container, scene.lattice, {100, 50, VoidParameters::Entry::spread}, 5);
  const Box& box = scene.container.box;
  const DumpFrame first = make_frame(model, box, 1, {});
  for (const Vec3& v : first.velocity) EXPECT_EQ(v, (Vec3{0, 0, 0}));
  model.advance(0.5);
  const DumpFrame second = make_frame(model, box, 1, first);
  EXPECT_LT(second.id.size(), first.id.size());
  EXPECT_EQ(second.id.size(), model.grains());
  EXPECT_TRUE(std::is_sorted(second.id.begin(), second.id.end()));
  double fallen = 0;
  for (std::size_t i = 0; i < second.id.size(); ++i) {
    const auto site = static_cast<std::size_t>(second.id[i] - 1);  // at the start
    for (int a = 0; a < 3; ++a)
      EXPECT_NEAR(second.velocity[i][a], box.minimum_image(a, second.position[i][a] - first.position[site][a]) / 0.5,
                  1e-12);
    fallen -= second.velocity[i][2] * 0.5;
  }
  EXPECT_GT(fallen, 0);
  // Every hop lets a grain fall by one layer; those that have left began in layers that are known by their ids.
  double left = 0;
  for (const Drained& d : model.drained())
    left += static_cast<double>(scene.lattice.layer_of(static_cast<std::size_t>(d.id - 1)));
  EXPECT_NEAR(fallen / dz + left, static_cast<double>(model.counters().hops), 1e-6);
}

TEST(LatticeVoids, NeedsASiteOverTheOrifice) {
  Scene scene = plane(30, 10, true);
  scene.container.orifice->width = 0.4;
  scene.container.orifice->centre = {0.5, 0};
  try {
    const LatticeVoids model(scene.container, scene.lattice, {1, 1, VoidParameters::Entry::centre}, 1);
    FAIL();
  } catch (const ConfigError& e) {
    EXPECT_THAT(e.what(), HasSubstr("voids have nowhere to enter"));
  }
}

}  // namespace
}  // namespace grainvdb::spot::void_model_test
