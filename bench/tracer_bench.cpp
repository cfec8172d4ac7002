#include "tracer_bench.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include <benchmark/benchmark.h>

#include "check.hpp"
#include "grainvdb/grids.hpp"
#include "grainvdb/tracers.hpp"
#include "library_paths.hpp"
#include "scene.hpp"
#include "vdb_tracers.hpp"

namespace grainvdb::bench {
namespace {

constexpr double voxel = 0.5;
constexpr double dt = 0.5 * voxel;  // half a voxel where the speed is 1, and less farther in
constexpr std::size_t steps = 5;    // of an iteration

/// A packing that turns about the middle of its box as a rigid body, with the fluctuations of the scene, splatted as in
/// a run, and tracers on a regular grid around the middle.
struct Case {
  explicit Case(const Sizes& sizes)
      : scene(turning(make_scene(sizes.particles))), setting(voxel), velocity(velocity_of(setting, scene)) {
    const double radius = 0.3 * scene.edge, middle = scene.edge / 2;
    const double spacing = 2 * radius / std::cbrt(static_cast<double>(sizes.tracers));
    seeds = seeds_on_grid({.lo = {middle - radius, middle - radius, middle - radius},
                           .hi = {middle + radius, middle + radius, middle + radius},
                           .spacing = {spacing, spacing, spacing}});
    const double far = 2 * scene.edge;
    box = {{-far, -far, -far}, {far, far, far}, {false, false, false}};
  }

  static Scene turning(Scene scene) {
    const double middle = scene.edge / 2;
    for (std::size_t i = 0; i < scene.size(); ++i) {
      const double x = (scene.position[0][i] - middle) / middle, y = (scene.position[1][i] - middle) / middle;
      scene.velocity[0][i] = -y + 0.1 * std::sin(7 * static_cast<double>(i));
      scene.velocity[1][i] = x + 0.1 * std::sin(11 * static_cast<double>(i));
      scene.velocity[2][i] = 0.1 * std::sin(13 * static_cast<double>(i));
    }
    return scene;
  }

  /// ΣVu W / ΣV W.
  static SparseField velocity_of(const Setting& setting, const Scene& scene) {
    const auto q = moments(scene, 4);
    const Grids sums = splat_to_grids(setting, scene, q, 4);
    const auto topology = prepare(setting, scene).topology;
    SparseField field({"velocity", "1", 3, "", "", std::numeric_limits<float>::quiet_NaN()}, topology, setting.lattice);
    for (std::size_t l = 0; l < topology->leaf_count(); ++l) {
      const Coord& o = topology->origin(l);
      const auto* weight = sums[0]->tree().probeConstLeaf(grid_index(o));
      for (int c = 0; c < 3; ++c) {
        const auto* momentum = sums[static_cast<std::size_t>(c) + 1]->tree().probeConstLeaf(grid_index(o));
        topology->mask(l).for_each([&](int v) {
          const auto at = static_cast<openvdb::Index>(v);
          field.leaf(l, c)[v] = momentum->getValue(at) / weight->getValue(at);
        });
      }
    }
    return field;
  }

  Flow flow(Interpolation interpolation) const {
    return Flow(std::make_shared<FlowGrid>(setting.lattice, velocity, nullptr, interpolation));
  }

  Scene scene;
  Setting setting;
  SparseField velocity;
  TracerSeeds seeds;
  Box box;
};

const Case& case_of(const Sizes& sizes) {
  static std::unique_ptr<Case> made;
  static std::size_t of = 0;
  if (!made || of != sizes.tracers) made = std::make_unique<Case>(sizes);
  of = sizes.tracers;
  return *made;
}

void count(benchmark::State& state, std::size_t tracers, std::size_t moving) {
  using benchmark::Counter;
  state.counters["tracers"] = static_cast<double>(tracers);
  state.counters["moving"] = static_cast<double>(moving);
  state.counters["steps/s"] = Counter(static_cast<double>(tracers * steps), Counter::kIsIterationInvariantRate);
}

/// More than 1 if a tracer stops or strays from the baseline's place by 1e-7 of a voxel per step: weights of the
/// baseline are in single precision.
bool check(const Case& c) {
  return check_once("tracers/grainvdb and tracers/vdb, " + std::to_string(c.seeds.size()) + " tracers", [&] {
    const Flow flow = c.flow(Interpolation::trilinear);
    Tracers tracers(c.seeds, c.box, flow, 0, {.stepping = FixedSteps{dt}});
    if (tracers.advance(flow, dt * steps).moving != c.seeds.size()) return std::numeric_limits<double>::infinity();
    Columns3 position = c.seeds.position;
    move_with_vdb(c.velocity, steps, dt, position);
    double worst = 0;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t i = 0; i < c.seeds.size(); ++i)
        worst = std::max(worst, std::abs(position[a][i] - tracers.state().position[a][i]));
    return worst / (1e-7 * voxel * steps);
  });
}

void move_on(benchmark::State& state, const Case& c, const Flow& flow, const TracerSettings& settings) {
  Tracers tracers(c.seeds, c.box, flow, 0, settings);
  std::size_t moving = 0;
  for (auto _ : state) moving = tracers.advance(flow, tracers.time() + dt * steps).moving;
  count(state, tracers.size(), moving);
}

void register_one(const Sizes& sizes, const std::string& name,
                  const std::function<void(benchmark::State&, const Case&)>& run) {
  benchmark::RegisterBenchmark(("tracers/" + name).c_str(), [=](benchmark::State& state) {
    const Case& c = case_of(sizes);
    if (!check(c)) return state.SkipWithError("the results disagree");
    run(state, c);
  })->Unit(benchmark::kMillisecond);
}

}  // namespace

void register_tracers(const Sizes& sizes) {
  register_one(sizes, "vdb", [](benchmark::State& state, const Case& c) {
    Columns3 position = c.seeds.position;
    for (auto _ : state) move_with_vdb(c.velocity, steps, dt, position);
    count(state, c.seeds.size(), c.seeds.size());
  });
  const TracerSettings fixed{.stepping = FixedSteps{dt}};
  register_one(sizes, "grainvdb", [=](benchmark::State& state, const Case& c) {
    move_on(state, c, c.flow(Interpolation::trilinear), fixed);
  });
  register_one(sizes, "grainvdb_tricubic", [=](benchmark::State& state, const Case& c) {
    move_on(state, c, c.flow(Interpolation::tricubic), fixed);
  });
  register_one(sizes, "grainvdb_frames", [=](benchmark::State& state, const Case& c) {
    const auto grid = std::make_shared<FlowGrid>(c.setting.lattice, c.velocity, nullptr, Interpolation::trilinear);
    const auto later = std::make_shared<FlowGrid>(c.setting.lattice, c.velocity, nullptr, Interpolation::trilinear);
    move_on(state, c, Flow(grid, 0, later, 1e9), fixed);
  });
  register_one(sizes, "blocks", [](benchmark::State& state, const Case& c) {
    for (auto _ : state) benchmark::DoNotOptimize(c.flow(Interpolation::trilinear));
    state.counters["leaves"] = static_cast<double>(c.velocity.topology()->leaf_count());
  });
}

void check_tracers(const Sizes& sizes) {
  check(case_of(sizes));
}

}  // namespace grainvdb::bench
