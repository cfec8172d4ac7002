#pragma once
/// Lattices of grains with a given velocity, and tracers in them.
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "grainvdb/error.hpp"
#include "support/lattice_packing.hpp"
#include "support/memory_source.hpp"
#include "support/memory_tracers.hpp"
#include "support/run_in_memory.hpp"

namespace grainvdb::testing::tracing_scene {

inline constexpr int sites = 8;
inline constexpr int many_sites = 32;  // 8 leaves along each axis
/// Fields are floats whose sums are exact to 1e-5 of their terms.
inline constexpr double exact = 1e-5;

using Velocity = std::function<Vec3(const Vec3&, double)>;

/// A packing at several times. The grains themselves stay where they are: only their velocities matter here.
inline std::vector<Frame> frames_of(const Velocity& velocity, const std::vector<double>& times, bool periodic = true) {
  std::vector<Frame> frames;
  for (const double t : times) {
    frames.push_back(cubic_packing(sites, periodic, [&](const Vec3& x) { return velocity(x, t); }));
    frames.back().time = t;
    frames.back().step = std::lround(1000 * t);
  }
  return frames;
}

inline Pipeline tracing(std::vector<Vec3> seeds, TraceSpec::Through through) {
  Pipeline p = make_pipeline(0.5, {-0.5, -0.5, -0.5}, 2, {});
  p.trace.emplace();
  p.trace->seeds.points = std::move(seeds);
  p.trace->through = through;
  if (through == TraceSpec::Through::frames) p.window = 1;
  return p;
}
inline Pipeline through_mean(std::vector<Vec3> seeds, double duration, double dt) {
  Pipeline p = tracing(std::move(seeds), TraceSpec::Through::mean);
  p.trace->duration = duration;
  p.trace->dt = dt;
  return p;
}
inline Pipeline through_frames(std::vector<Vec3> seeds) {
  return tracing(std::move(seeds), TraceSpec::Through::frames);
}

inline void expect_near(const Vec3& found, const Vec3& expected, double tolerance) {
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(found[a], expected[a], tolerance) << "xyz"[a];
}

inline std::vector<double> times_of(const Histories& h) {
  std::vector<double> times;
  for (const TracerSample& s : h.samples) times.push_back(s.time);
  return times;
}
inline std::vector<std::int64_t> steps_of(const Histories& h) {
  std::vector<std::int64_t> steps;
  for (const TracerSample& s : h.samples) steps.push_back(s.step);
  return steps;
}

/// Takes the particles away that lie where `there` says.
inline void erase(Particles& p, const std::function<bool(const Vec3&)>& there) {
  Particles kept;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (there({p.position[0][i], p.position[1][i], p.position[2][i]})) continue;
    kept.id.push_back(p.id[i]);
    kept.radius.push_back(p.radius[i]);
    kept.mass.push_back(p.mass[i]);
    kept.type.push_back(p.type[i]);
    for (std::size_t a = 0; a < 3; ++a) {
      kept.position[a].push_back(p.position[a][i]);
      kept.velocity[a].push_back(p.velocity[a][i]);
      kept.angular_velocity[a].push_back(p.angular_velocity[a][i]);
    }
  }
  p = kept;
}

inline const Vec3 u0{0.7, -0.4, 0.2};
inline Vec3 uniform(const Vec3&, double) {
  return u0;
}
inline Vec3 accelerating(const Vec3&, double t) {
  return {u0[0] + 0.3 * t, u0[1], u0[2] - 0.1 * t};
}

}  // namespace grainvdb::testing::tracing_scene
