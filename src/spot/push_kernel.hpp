#pragma once
/// The push that a particle gets from those that it overlaps, on vector registers. Pushes are rounded to the unit of
/// positions before they are summed: sums do not depend on the order of neighbours nor on the width of registers.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "spot/site.hpp"

namespace grainvdb::spot {

/// What pushes depend on.
struct PushLaw {
  std::array<float, 3> unit{};  ///< as above
  float diameter = 0;           ///< [length]
  float strength = 0;           ///< α
  std::int32_t mark = 0;        ///< of the particles inside the zone
};

/// Lists of neighbours, in planes of eight for each particle: of particle i the k-th is at(i, k), up to counts[i]; then
/// i itself up to the next multiple of eight.
struct NearView {
  static constexpr std::size_t group = 8;

  const std::int32_t* members = nullptr;
  const std::int32_t* counts = nullptr;
  std::size_t places = 0;

  const std::int32_t* group_of(std::size_t i, std::size_t g) const { return members + (g * places + i) * group; }
  std::int32_t at(std::size_t i, std::size_t k) const { return group_of(i, k / group)[k % group]; }
};

/// Writes for each listed particle i to `pushes` [counts]: Σ_j f α (d/r - 1) (x_i - x_j) over its neighbours with
/// r = |x_i - x_j| < d, where f = 1/2 for those inside the zone and 1 for the others.
void push_apart(const Site* sites, const NearView& near, std::span<const std::int32_t> places, const PushLaw& law,
                Site* pushes);

}  // namespace grainvdb::spot
