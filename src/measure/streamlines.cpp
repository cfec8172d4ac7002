#include "measure/streamlines.hpp"

#include <cmath>
#include <limits>
#include <memory>

#include "grainvdb/flow.hpp"
#include "grainvdb/seeds.hpp"
#include "grainvdb/topology.hpp"
#include "grainvdb/tracers.hpp"

namespace grainvdb {
namespace {

/// The directions of the vectors; NaN where they have none.
SparseField directions(const Lattice& lattice, const SparseField& field) {
  FieldMeta meta = field.meta();
  meta.unit = std::string(1, '1');  // GCC 12 takes "1" for an overlapping copy (-Wrestrict)
  meta.dimension = dimension::none;
  meta.background = std::numeric_limits<float>::quiet_NaN();
  SparseField unit(meta, field.topology(), lattice);
  for (std::size_t leaf = 0; leaf < field.topology()->leaf_count(); ++leaf)
    field.topology()->mask(leaf).for_each([&](int v) {
      const Vec3 d{static_cast<double>(field.leaf(leaf, 0)[v]), static_cast<double>(field.leaf(leaf, 1)[v]),
                   static_cast<double>(field.leaf(leaf, 2)[v])};
      const double length = std::hypot(d[0], d[1], d[2]);
      for (int i = 0; i < 3; ++i)
        unit.leaf(leaf, i)[v] = static_cast<float>(d[static_cast<std::size_t>(i)] / length);  // 0/0 is NaN
    });
  return unit;
}

}  // namespace

std::vector<Streamline> streamlines(const Lattice& lattice, const Box& box, const SparseField& field,
                                    std::span<const Vec3> starts, double step, double length) {
  // Unit vectors as a velocity: time is the way.
  const SparseField unit = directions(lattice, field);
  const Flow flow(std::make_shared<const FlowGrid>(lattice, unit, nullptr, Interpolation::trilinear));
  Tracers tracers(seeds_at(starts), box, flow, 0, {.stepping = FixedSteps{step}});
  std::vector<Streamline> lines(starts.size());
  const auto add_points = [&] {
    const TracerState& state = tracers.state();
    bool moving = false;
    for (std::size_t n = 0; n < lines.size(); ++n) {
      if (state.stop[n] != TracerStop::moving) continue;
      moving = true;
      Vec3 x{};
      for (std::size_t i = 0; i < 3; ++i) {
        const int axis = static_cast<int>(i);
        x[i] = state.position[i][n] + (box.periodic[i] ? state.image[i][n] * box.length(axis) : 0);
      }
      lines[n].points.push_back(x);
    }
    return moving;
  };
  const auto steps = static_cast<std::size_t>(std::floor(length / step * (1 + 1e-12)));
  for (std::size_t k = 1; add_points() && k <= steps; ++k) tracers.advance(flow, static_cast<double>(k) * step);
  return lines;
}

}  // namespace grainvdb
