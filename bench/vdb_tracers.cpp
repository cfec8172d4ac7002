#include "vdb_tracers.hpp"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include "grainvdb/grids.hpp"

namespace grainvdb::bench {
namespace {

using Sampler = openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, openvdb::tools::BoxSampler>;
using openvdb::Vec3d;

class Velocity {
 public:
  explicit Velocity(const SparseField& field)
      : transform_(field.grids().components[0]->transform()),
        x_(field.grids().components[0]->getConstAccessor()),
        y_(field.grids().components[1]->getConstAccessor()),
        z_(field.grids().components[2]->getConstAccessor()) {}

  Vec3d operator()(const Vec3d& at) const {
    return {Sampler(x_, transform_).wsSample(at), Sampler(y_, transform_).wsSample(at),
            Sampler(z_, transform_).wsSample(at)};
  }

 private:
  const openvdb::math::Transform& transform_;
  openvdb::FloatGrid::ConstAccessor x_, y_, z_;
};

}  // namespace

void move_with_vdb(const SparseField& velocity, std::size_t steps, double dt, Columns3& position) {
  const Velocity u(velocity);
  for (std::size_t i = 0; i < position[0].size(); ++i) {
    Vec3d x(position[0][i], position[1][i], position[2][i]);
    for (std::size_t s = 0; s < steps; ++s) {
      const Vec3d k1 = u(x), k2 = u(x + dt / 2 * k1), k3 = u(x + dt / 2 * k2), k4 = u(x + dt * k3);
      x += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    for (int a = 0; a < 3; ++a) position[static_cast<std::size_t>(a)][i] = x[a];
  }
}

}  // namespace grainvdb::bench
