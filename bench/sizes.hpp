#pragma once
/// How much work the benchmarks do.
#include <cstddef>
#include <vector>

namespace grainvdb::bench {

struct Sizes {
  /// Of the comparisons: more than fit the caches, as in a real frame.
  std::size_t particles = 100'000;
  /// Of the comparison of contacts, six half branches each, and of every frame of a whole run.
  std::size_t contact_particles = 16'000;
  std::size_t frames = 3;
  std::size_t tracers = 1'000'000;
  std::vector<std::size_t> growth{100'000, 1'000'000, 4'000'000};
  /// Of the silo that spots drain, its width in diameters, and the events in which breakdowns are counted.
  std::size_t spot_particles = 55'000;
  double spot_width = 50;
  std::size_t spot_events = 10'000'000;
};

inline Sizes quick_sizes() {
  return {.particles = 32'000,
          .contact_particles = 4'000,
          .frames = 2,
          .tracers = 100'000,
          .growth = {100'000, 1'000'000},
          .spot_particles = 10'000,
          .spot_width = 25,
          .spot_events = 500'000};
}

/// For checks of the results alone.
inline Sizes tiny_sizes() {
  return {.particles = 500,
          .contact_particles = 256,
          .frames = 1,
          .tracers = 1'000,
          .growth = {},
          .spot_particles = 1'500,
          .spot_width = 12,
          .spot_events = 0};
}

}  // namespace grainvdb::bench
