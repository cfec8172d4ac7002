#include "splat_bench.hpp"

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include <benchmark/benchmark.h>

#include "check.hpp"
#include "dense_sums.hpp"
#include "library_paths.hpp"
#include "lucy.hpp"
#include "naive_splat.hpp"
#include "rasterize_splat.hpp"

namespace grainvdb::bench {
namespace {

struct Case {
  Case(std::size_t particles, double voxel) : h(voxel), scene(make_scene(particles)), setting(voxel) {
    for (std::size_t p = 0; p < scene.size(); ++p)
      for_each_weight(scene.position[0][p] / h - 0.5, scene.position[1][p] / h - 0.5, scene.position[2][p] / h - 0.5,
                      cutoff, h, [&](int, int, int, double) { ++pairs; });
  }
  double h;
  Scene scene;
  Setting setting;
  std::size_t pairs = 0;  ///< kernel values inside the support

  std::vector<double> q(int channels) const { return moments(scene, channels); }
};

const Case& case_of(const Sizes& sizes, double h) {
  static std::map<std::pair<std::size_t, double>, std::unique_ptr<Case>> cases;
  auto& made = cases[{sizes.particles, h}];
  if (!made) made = std::make_unique<Case>(sizes.particles, h);
  return *made;
}

std::string name_of(double h) {
  return h == 1 ? "h=d" : "h=0.5d";
}

// Single precision rounds each of n additions to 2⁻²⁴ of a partial sum, and the term itself.
constexpr DenseSums::Tolerance in_single{.relative = 3 * 0x1p-24, .per_term = 0x1p-24};
// Points of OpenVDB have positions in single precision: |Δr| ≤ 2e-7 c moves W by up to 12·4/27·2e-7 W(0).
const DenseSums::Tolerance with_single_positions{
    .relative = 3 * 0x1p-24, .per_term = 0x1p-24, .absolute = 4e-7 * lucy_peak(cutoff)};
// What the library promises, and the rounding of the grids.
constexpr DenseSums::Tolerance promised{.relative = 1e-5 + 0x1p-24};

constexpr int channel_counts[] = {1, 4, 5, 8, 9, 14};

using Splat = std::function<Grids(const Case&, std::span<const double>, int)>;

Grids naive(const Case& c, std::span<const double> q, int channels) {
  return naive_splat(c.scene, c.h, q, channels);
}

Grids rasterize(const Case& c, std::span<const double>, int) {
  return rasterize_splat(c.scene, c.h);
}

Grids library(const Case& c, std::span<const double> q, int channels) {
  return splat_to_grids(c.setting, c.scene, q, channels);
}

bool check(const std::string& name, const Case& c, const Splat& splat, const DenseSums::Tolerance& tolerance,
           int channels) {
  return check_once(name + " on " + std::to_string(c.scene.size()) + " particles", [&] {
    const auto q = c.q(channels);
    return sum_particles(c.scene, c.h, q, channels).disagreement(splat(c, q, channels), tolerance);
  });
}

void count_pairs(benchmark::State& state, std::size_t of_iteration, int channels) {
  using benchmark::Counter;
  const auto pairs = static_cast<double>(of_iteration);
  state.counters["pairs/s"] = Counter(pairs, Counter::kIsIterationInvariantRate);
  state.counters["useful_fma/s"] = Counter(pairs * channels, Counter::kIsIterationInvariantRate);
}

void count(benchmark::State& state, const Case& c, int channels) {
  state.counters["particles"] = static_cast<double>(c.scene.size());
  count_pairs(state, c.pairs, channels);
}

void register_whole(const Sizes& sizes, double h, const std::string& side, const Splat& splat,
                    const DenseSums::Tolerance& tolerance) {
  const std::string name = "particles/" + name_of(h) + "/" + side;
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    const Case& c = case_of(sizes, h);
    if (!check(name, c, splat, tolerance, all_channels)) return state.SkipWithError("the results disagree");
    const auto q = c.q(all_channels);
    for (auto _ : state) {
      Grids grids = splat(c, q, all_channels);
      benchmark::DoNotOptimize(grids);
    }
    count(state, c, all_channels);
  })->Unit(benchmark::kMillisecond);
}

void register_channels(const Sizes& sizes, int channels) {
  const std::string name = "channels/" + std::to_string(channels);
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    const Case& c = case_of(sizes, 0.5);
    if (!check(name, c, library, promised, channels)) return state.SkipWithError("the results disagree");
    const auto q = c.q(channels);
    for (auto _ : state) {
      Grids grids = library(c, q, channels);
      benchmark::DoNotOptimize(grids);
    }
    count(state, c, channels);
  })->Unit(benchmark::kMillisecond);
}

void register_kernel(const Sizes& sizes, double h) {
  const std::string name = "kernel/" + name_of(h);
  benchmark::RegisterBenchmark((name + "/loop").c_str(), [=](benchmark::State& state) {
    const Case& c = case_of(sizes, h);
    const auto q = c.q(all_channels);
    const Prepared prepared = prepare(c.setting, c.scene);
    for (auto _ : state) splat_prepared(c.setting, prepared, q, all_channels);
    count(state, c, all_channels);
  })->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark((name + "/weights_and_sums").c_str(), [=](benchmark::State& state) {
    const Case& c = case_of(sizes, h);
    PreparedLeaves leaves(c.setting, prepare(c.setting, c.scene), c.q(all_channels), all_channels);
    for (auto _ : state) leaves.splat();
    count_pairs(state, leaves.pairs(), all_channels);
  })->Unit(benchmark::kMillisecond);
}

}  // namespace

void register_splat(const Sizes& sizes) {
  for (const double h : {0.5, 1.0}) {
    register_whole(sizes, h, "naive", naive, in_single);
    register_whole(sizes, h, "rasterize", rasterize, with_single_positions);
    register_whole(sizes, h, "grainvdb", library, promised);
  }
  for (const double h : {0.5, 1.0}) register_kernel(sizes, h);
  for (const int channels : channel_counts) register_channels(sizes, channels);
}

void check_splat(const Sizes& sizes) {
  for (const double h : {0.5, 1.0}) {
    const Case& c = case_of(sizes, h);
    check("particles/" + name_of(h) + "/naive", c, naive, in_single, all_channels);
    check("particles/" + name_of(h) + "/rasterize", c, rasterize, with_single_positions, all_channels);
    check("particles/" + name_of(h) + "/grainvdb", c, library, promised, all_channels);
  }
  for (const int channels : channel_counts)
    check("channels/" + std::to_string(channels), case_of(sizes, 0.5), library, promised, channels);
}

}  // namespace grainvdb::bench
