#include "spot_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plain_spots.hpp"
#include "spot/published_spots.hpp"
#include "spot/random_packing.hpp"

namespace grainvdb::bench {
namespace {

constexpr double depth = 8, phi = 0.58;

/// Whether a row of a list holds an index.
bool lists(const spot::NearView& near, std::size_t i, std::size_t j) {
  for (std::size_t k = 0; k < static_cast<std::size_t>(near.counts[i]); ++k)
    if (near.at(i, k) == static_cast<std::int32_t>(j)) return true;
  return false;
}

void look_at_pairs(const spot::SpotModel& model, const std::vector<Vec3>& x, Breakdowns& found) {
  const spot::ParticleStore& store = model.particles();
  const double d = store.diameter();
  const PlainCells cells(store.box(), x, d);
  found.badness = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    cells.visit(x[i], d, [&](std::size_t j) {
      if (j == i || !store.holds(static_cast<std::int32_t>(i)) || !store.holds(static_cast<std::int32_t>(j))) return;
      double r2 = 0;
      for (int a = 0; a < 3; ++a) r2 += std::pow(store.box().minimum_image(a, x[j][a] - x[i][a]), 2);
      if (!(r2 < d * d)) return;
      const double overlap = 1 - std::sqrt(r2) / d;
      found.badness += overlap * overlap / static_cast<double>(store.size());
      found.worst_overlap = std::max(found.worst_overlap, overlap);
      if (overlap > 0.5) ++found.overlaps;
      if (!lists(store.near(), i, j)) ++found.unlisted;
    });
}

bool within_walls(const Box& box, const Vec3& x, double distance) {
  const double rounding = 1e-6;
  for (int a = 0; a < 2; ++a)
    if (!box.periodic[a] && !(x[a] >= box.lo[a] + distance - rounding && x[a] <= box.hi[a] - distance + rounding))
      return false;
  return true;
}

}  // namespace

SpotScene make_silo(const Sizes& sizes, bool relaxed) {
  const double grain = std::numbers::pi / 6;
  const double height = static_cast<double>(sizes.spot_particles) * grain / (phi * sizes.spot_width * depth);
  Box box{{-sizes.spot_width / 2, 0, 0}, {sizes.spot_width / 2, depth, height}, {false, true, false}};
  SpotScene scene;
  scene.packing = spot::random_packing(box, phi, 1, 1);
  scene.container = {box, spot::Orifice{spot::Orifice::Shape::slot, {0, 0}, 8}};
  scene.parameters = spot::published_spots();
  if (!relaxed) scene.parameters.relaxation.every = 0;
  return scene;
}

void look_for_breakdowns(const SpotScene& scene, const spot::SpotModel& model, Breakdowns& found) {
  const spot::ParticleStore& store = model.particles();
  std::vector<Vec3> x;
  std::vector<std::int64_t> ids;
  for (std::size_t i = 0; i < store.slots(); ++i) {
    x.push_back(store.position(static_cast<std::int32_t>(i)));
    if (!store.holds(static_cast<std::int32_t>(i))) continue;
    ids.push_back(store.id(static_cast<std::int32_t>(i)));
    if (!within_walls(store.box(), x[i], 0) || !(x[i][2] > store.box().lo[2] - 2 * store.diameter()) ||
        !(x[i][2] <= store.box().hi[2]))
      ++found.outside;
  }
  for (const Vec3& s : model.spots())
    if (!within_walls(store.box(), s, scene.parameters.wall_distance)) ++found.outside;
  for (const spot::Drained& d : model.drained()) ids.push_back(d.id);
  std::sort(ids.begin(), ids.end());
  std::vector<std::int64_t> expected = scene.packing.id;
  std::sort(expected.begin(), expected.end());
  if (ids != expected) ++found.lost;
  if (model.counters().inserted - model.counters().removed != model.spots().size()) ++found.uncounted;
  look_at_pairs(model, x, found);
}

}  // namespace grainvdb::bench
