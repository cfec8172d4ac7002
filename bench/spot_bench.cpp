#include "spot_bench.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <string>

#include <benchmark/benchmark.h>

#include "check.hpp"
#include "plain_spots.hpp"
#include "spot_scene.hpp"

namespace grainvdb::bench {
namespace {

constexpr double cell_edge = 1.3;  // half a spot's radius: the fastest from 0.8 to 2.6, relaxed
constexpr std::uint64_t events_per_look = 250'000;

/// A silo in which spots have come to the top, on the way to which a relaxed one was watched.
struct FilledSilo {
  FilledSilo(const Sizes& sizes, bool relaxed)
      : scene(make_silo(sizes, relaxed)), model(scene.container, scene.packing, scene.parameters, 1) {
    const double rise = scene.parameters.hop_rate * scene.parameters.step[2];
    const double transit = scene.container.box.length(2) / rise;
    while (model.time() < 1.1 * transit || (relaxed && watched < sizes.spot_events)) {
      model.run_events(events_per_look);
      watched += events_per_look;
      if (relaxed) look_for_breakdowns(scene, model, breakdowns);
    }
    model.compact();
  }
  PlainSpots::Start plain_start() const {
    PlainSpots::Start start{{1, {}, {}}, model.spots(), scene.container.box.hi[2]};
    for (std::size_t i = 0; i < model.particles().slots(); ++i) {
      if (!model.particles().holds(static_cast<std::int32_t>(i))) continue;
      start.packing.id.push_back(model.particles().id(static_cast<std::int32_t>(i)));
      start.packing.position.push_back(model.particles().position(static_cast<std::int32_t>(i)));
    }
    return start;
  }

  SpotScene scene;
  spot::SpotModel model;
  std::uint64_t watched = 0;
  Breakdowns breakdowns;
};

FilledSilo& silo(const Sizes& sizes, bool relaxed) {
  static std::map<bool, std::unique_ptr<FilledSilo>> made;
  if (!made[relaxed]) made[relaxed] = std::make_unique<FilledSilo>(sizes, relaxed);
  return *made[relaxed];
}

void count(benchmark::State& state, const FilledSilo& silo, std::size_t events) {
  state.counters["events"] = static_cast<double>(events);  // of an iteration
  state.counters["particles"] = static_cast<double>(silo.model.particles().size());
  state.counters["spots"] = static_cast<double>(silo.model.spots().size());
}

/// More than 1 if a particle or spot of the plain run strays by 1e-4 diameters, or has left only one of both: the
/// library's distances are in single precision, of 2e-7 diameters, and thousands of pushes add up.
bool check(const Sizes& sizes, bool relaxed) {
  return check_once(std::string("spot/grainvdb and spot/plain, ") + (relaxed ? "relaxed" : "unrelaxed"), [&] {
    const SpotScene scene = make_silo(sizes, relaxed);
    spot::SpotModel model(scene.container, scene.packing, scene.parameters, 3);
    PlainSpots plain(scene.container, {scene.packing, {}, scene.container.box.hi[2]}, scene.parameters, 3, cell_edge);
    model.run_events(20'000);
    plain.run_events(20'000);
    std::map<std::int64_t, Vec3> places;
    for (std::size_t i = 0; i < model.particles().slots(); ++i)
      if (model.particles().holds(static_cast<std::int32_t>(i)))
        places[model.particles().id(static_cast<std::int32_t>(i))] =
            model.particles().position(static_cast<std::int32_t>(i));
    double worst = plain.spots() == model.spots() ? 0 : std::numeric_limits<double>::infinity();
    std::size_t here = 0;
    for (std::size_t i = 0; i < plain.ids().size(); ++i) {
      if (!plain.holds(i)) continue;
      ++here;
      const auto place = places.find(plain.ids()[i]);
      if (place == places.end()) return std::numeric_limits<double>::infinity();
      for (int a = 0; a < 3; ++a)
        worst =
            std::max(worst, std::abs(scene.container.box.minimum_image(a, place->second[a] - plain.positions()[i][a])));
    }
    return here == places.size() ? worst / 1e-4 : std::numeric_limits<double>::infinity();
  });
}

void run_library(benchmark::State& state, FilledSilo& silo) {
  constexpr std::size_t events = 20'000;
  for (auto _ : state) silo.model.run_events(events);
  count(state, silo, events);
  if (silo.watched == 0 || silo.scene.parameters.relaxation.every == 0) return;
  state.counters["watched_events"] = static_cast<double>(silo.watched);
  state.counters["breakdowns"] = static_cast<double>(silo.breakdowns.all());
  state.counters["worst_overlap"] = silo.breakdowns.worst_overlap;
  state.counters["badness"] = silo.breakdowns.badness;
}

void run_plain(benchmark::State& state, const FilledSilo& silo, double edge, std::size_t events) {
  PlainSpots plain(silo.scene.container, silo.plain_start(), silo.scene.parameters, 5, edge);
  for (auto _ : state) plain.run_events(events);
  count(state, silo, events);
}

void register_kind(const Sizes& sizes, bool relaxed) {
  const std::string kind = std::string("spot/") + (relaxed ? "relaxed/" : "unrelaxed/");
  const auto add = [&](const char* name, auto run) {
    benchmark::RegisterBenchmark((kind + name).c_str(), [=](benchmark::State& state) {
      if (!check(tiny_sizes(), relaxed)) return state.SkipWithError("the results disagree");
      run(state, silo(sizes, relaxed));
    })->Unit(benchmark::kMillisecond);
  };
  add("grainvdb", [](benchmark::State& state, FilledSilo& silo) { run_library(state, silo); });
  add("plain_cells", [](benchmark::State& state, FilledSilo& silo) { run_plain(state, silo, cell_edge, 500); });
  add("all_particles",
      [](benchmark::State& state, FilledSilo& silo) { run_plain(state, silo, std::numeric_limits<double>::max(), 5); });
}

}  // namespace

void register_spots(const Sizes& sizes) {
  register_kind(sizes, true);
  register_kind(sizes, false);
}

void check_spots(const Sizes& sizes) {
  check(sizes, true);
  check(sizes, false);
}

}  // namespace grainvdb::bench
