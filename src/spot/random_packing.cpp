#include "spot/random_packing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "grainvdb/error.hpp"
#include "spot/container.hpp"
#include "spot/random.hpp"

namespace grainvdb::spot {
namespace {

constexpr int most_passes = 20'000;
constexpr double tolerated_overlap = 1e-3;  // in diameters

}  // namespace

Packing poisson_packing(const Box& box, double phi, double diameter, std::uint64_t seed) {
  const double volume = box.length(0) * box.length(1) * box.length(2);
  const auto n = static_cast<std::size_t>(std::llround(phi * volume / (std::numbers::pi / 6 * std::pow(diameter, 3))));
  Random random(seed);
  Packing packing;
  packing.diameter = diameter;
  packing.id.resize(n);
  std::iota(packing.id.begin(), packing.id.end(), std::int64_t{1});
  packing.position.resize(n);
  for (Vec3& x : packing.position)
    for (int a = 0; a < 3; ++a) {
      const double margin = box.periodic[a] ? 0 : 0.5 * diameter;
      x[a] = random.uniform(box.lo[a] + margin, box.hi[a] - margin);
    }
  return packing;
}

Packing random_packing(const Box& box, double phi, double diameter, std::uint64_t seed) {
  Packing packing = poisson_packing(box, phi, diameter, seed);
  const std::size_t n = packing.id.size();
  ParticleStore store(box, packing, ParticleStore::Neighbours::listed);
  const Container container{box, std::nullopt};
  std::vector<std::int32_t> all = store.places();
  std::vector<Site> pushes(n);
  PushLaw law{{}, static_cast<float>(diameter), 0.8F, 0};
  for (std::size_t a = 0; a < 3; ++a) law.unit[a] = static_cast<float>(store.unit()[a]);
  double worst = 0;  // the largest push in a pass, which is near the largest overlap
  for (int pass = 0; pass < most_passes; ++pass) {
    push_apart(store.sites(), store.near(), all, law, pushes.data());
    worst = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 wall = push_from_walls(container, store.position(all[i]), diameter);
      for (std::size_t a = 0; a < 3; ++a) {
        pushes[i].at[a] += static_cast<std::int32_t>(std::nearbyint(wall[a] / store.unit()[a]));
        worst = std::max(worst, std::abs(pushes[i].at[a] * store.unit()[a]));
      }
    }
    if (worst < tolerated_overlap * diameter / 8) break;
    store.move_each(all, pushes);
    all = store.places();
  }
  if (!(worst < tolerated_overlap * diameter / 8))
    throw LimitError({{},
                      "the random packing did not come free of overlaps",
                      "packing fraction " + std::to_string(phi),
                      "at most about 0.6",
                      "Take fewer grains, or a packing from a dump"});
  for (std::size_t i = 0; i < n; ++i) {
    packing.id[i] = store.id(all[i]);
    packing.position[i] = store.position(all[i]);
  }
  return packing;
}

}  // namespace grainvdb::spot
