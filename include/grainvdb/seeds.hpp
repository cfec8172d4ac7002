#pragma once
/// Where tracers start.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "grainvdb/box.hpp"
#include "grainvdb/frame.hpp"

namespace grainvdb {

/// Tracers before they move.
struct TracerSeeds {
  std::vector<std::int64_t> id;  ///< ascending
  Columns3 position;             ///< unwrapped coordinates are kept: displacements count from them [length]

  std::size_t size() const { return id.size(); }
};

/// A regular grid over a box, or over a plane or line where lo equals hi along one or two axes.
struct SeedGrid {
  Vec3 lo{}, hi{};                ///< lo ≤ hi [length]
  Vec3 spacing{};                 ///< > 0 along every axis with lo < hi [length]
  std::size_t most = 10'000'000;  ///< seeds that are allowed
};

/// As many seeds as fit the spacing along each axis, at least one, with equal room at both ends: over whole periods
/// the grid continues itself. Ids from 1, x fastest. Throws std::invalid_argument for bounds or a spacing that are not
/// finite or out of order, LimitError for more seeds than `most`.
TracerSeeds seeds_on_grid(const SeedGrid& grid);

/// Ids from 1 in the order of the list. Throws std::invalid_argument when it is empty or a coordinate is not finite.
TracerSeeds seeds_at(std::span<const Vec3> positions);

/// On the particles with these ids, which the tracers take over; a repeated id counts once. Throws
/// std::invalid_argument when there are none or a particle is missing.
TracerSeeds seeds_on_particles(const Particles& particles, std::span<const std::int64_t> ids);

}  // namespace grainvdb
