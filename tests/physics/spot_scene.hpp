#pragma once
/// Runs of the spot model whose particles hardly move, so that what spots do to them can be compared with closed forms.
#include <cmath>
#include <vector>

#include "spot/published_spots.hpp"
#include "spot/snapshot.hpp"
#include "spot/spot_model.hpp"

namespace grainvdb::testing {

/// The published spots, without relaxation, of an influence that moves a particle by 1e-6 of a step; they step once a
/// unit of time, and none enters unless that is set.
inline spot::SpotParameters gentle_spots() {
  spot::SpotParameters p = spot::published_spots();
  p.influence = 1e6;
  p.hop_rate = 1;
  p.insertion_rate = 0;
  p.entry = spot::SpotParameters::Entry::centre;
  p.wall_distance = 0;
  p.relaxation.every = 0;
  return p;
}

/// C(r): the volume that two balls of this radius at a distance r have in common, over that of one.
inline double common_share(double r, double radius) {
  return r < 2 * radius ? 1 - 3 * r / (4 * radius) + std::pow(r / radius, 3) / 16 : 0;
}

/// Displacements of all particles, in the order of their ids, since the call before.
class Displacements {
 public:
  explicit Displacements(const spot::SpotModel& model) : model_(model), before_(spot::take_snapshot(model)) {}

  std::vector<Vec3> next() {
    spot::Snapshot now = spot::take_snapshot(model_);
    const spot::Snapshot at_unit_time{before_.time + 1, now.id, now.site};
    std::vector<Vec3> moved = spot::velocities(before_, at_unit_time, model_.particles().unit());
    before_ = std::move(now);
    return moved;
  }

 private:
  const spot::SpotModel& model_;
  spot::Snapshot before_;
};

}  // namespace grainvdb::testing
