#pragma once
/// The `trace:` section of a pipeline file: where tracers start, what carries them, and what is recorded.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "grainvdb/box.hpp"
#include "grainvdb/flow.hpp"
#include "grainvdb/tracers.hpp"

namespace grainvdb {

/// Where tracers start; one of the three is given.
struct SeedSpec {
  struct Grid {
    Vec3 lo{}, hi{};  ///< infinite sides are those of the box [length]
    Vec3 spacing{};   ///< [length]
  };
  /// On material particles of the first frame of the trace.
  struct OnParticles {
    std::vector<std::int64_t> ids;  ///< empty: every n-th in ascending order of id
    std::size_t every = 1;
  };
  std::optional<Grid> grid;
  std::vector<Vec3> points;  ///< [length]
  std::optional<OnParticles> particles;
};

struct TraceSpec {
  enum class Through : std::uint8_t {
    mean,   ///< the one time mean of all frames, for a given duration
    frames  ///< the output times, with a straight line in time between two of them
  };
  enum class Scheme : std::uint8_t { rk4, adaptive };
  enum class Direction : std::uint8_t { forward, backward };
  enum class Neighbourhood : std::uint8_t {
    automatic,  ///< where that is expected to be cheaper
    always,     ///< only the leaves that tracers may come to are splatted
    never       ///< whole grids
  };

  SeedSpec seeds;
  Through through = Through::mean;
  Scheme scheme = Scheme::rk4;
  Interpolation interpolation = Interpolation::trilinear;
  Direction direction = Direction::forward;
  std::optional<double> dt;           ///< longest step [time]
  std::optional<std::int64_t> steps;  ///< or their number over the duration
  std::optional<double> duration;     ///< through the mean; none: from the first frame to the last [time]
  std::optional<double> tolerance;    ///< of the adaptive scheme, per step [length]
  std::vector<std::string> record;    ///< fields
  bool strain = true;
  OnUndefined on_undefined = OnUndefined::stop;
  StepLimits limits{};
  std::int64_t every = 1;  ///< steps, or output times, from sample to sample
  std::vector<std::string> formats;
  Neighbourhood neighbourhood = Neighbourhood::automatic;  ///< has no meaning where fields are written, or for a region
};

}  // namespace grainvdb
