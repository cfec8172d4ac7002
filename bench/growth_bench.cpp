#include "growth_bench.hpp"

#include <fstream>
#include <string>

#include <benchmark/benchmark.h>
#include <malloc.h>

#include "library_paths.hpp"

namespace grainvdb::bench {
namespace {

/// A line of /proc/self/status in bytes; 0 where there is none.
double memory_status(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == key + ":") {
      double kilobytes = 0;
      status >> kilobytes;
      return kilobytes * 1024;
    }
  return 0;
}

void growth(benchmark::State& state, std::size_t particles) {
  const Scene scene = make_scene(particles);
  const Setting setting(0.5);
  const auto q = moments(scene, all_channels);
  for (auto _ : state) {
    Grids grids = splat_to_grids(setting, scene, q, all_channels);
    benchmark::DoNotOptimize(grids);
  }
  state.counters["particles"] = static_cast<double>(scene.size());
}

void memory(benchmark::State& state, std::size_t particles, double h) {
  const Scene scene = make_scene(particles);
  const Setting setting(h);
  const auto q = moments(scene, all_channels);
  for (auto _ : state) {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << 5;  // starts the peak anew
    const double before = memory_status("VmRSS");
    const Grids grids = splat_to_grids(setting, scene, q, all_channels);
    const double peak = memory_status("VmHWM") - before;
    double kept = 0;
    for (const auto& grid : grids) kept += static_cast<double>(grid->memUsage());
    const auto voxels = static_cast<double>(grids[0]->activeVoxelCount());
    const auto n = static_cast<double>(scene.size());
    state.counters["particles"] = n;
    state.counters["active_voxels"] = voxels;
    state.counters["peak_bytes_per_particle"] = peak / n;
    state.counters["peak_bytes_per_voxel"] = peak / voxels;
    state.counters["grid_bytes_per_voxel"] = kept / voxels;
  }
}

}  // namespace

void register_growth(const Sizes& sizes) {
  for (const std::size_t particles : sizes.growth)
    benchmark::RegisterBenchmark(("growth/" + std::to_string(particles)).c_str(), growth, particles)
        ->Unit(benchmark::kMillisecond);
}

void register_memory(const Sizes& sizes) {
  benchmark::RegisterBenchmark("memory/h=0.5d", memory, sizes.particles, 0.5)->Iterations(1);
  benchmark::RegisterBenchmark("memory/h=d", memory, sizes.particles, 1.0)->Iterations(1);
}

}  // namespace grainvdb::bench
