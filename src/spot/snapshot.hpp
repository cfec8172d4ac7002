#pragma once
/// Snapshots of a spot run as LAMMPS dumps.
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/spot_input.hpp"
#include "spot/spot_model.hpp"

namespace grainvdb::spot {

/// The particles in ascending order of id.
struct Snapshot {
  double time = 0;
  std::vector<std::int64_t> id;
  std::vector<Site> site;
};
Snapshot take_snapshot(const SpotModel& model);

/// Velocities are displacements since the snapshot before, matched by id, divided by the time between; 0 in the first
/// one. A particle must not move by half a period in that time.
std::vector<Vec3> velocities(const Snapshot& before, const Snapshot& now, const Vec3& unit);

/// What a dump tells of equal grains at a moment.
struct DumpFrame {
  double time = 0;
  Box box;
  double diameter = 0;
  std::vector<std::int64_t> id;
  std::vector<Vec3> position, velocity;
};
DumpFrame make_frame(const SpotModel& model, const Snapshot& now, const std::vector<Vec3>& velocity);

/// Text of one frame: `id type x y z vx vy vz radius v_spot`, type 1, numbered by `step`.
std::string dump_text(const DumpFrame& frame, std::int64_t step, const std::string& units);

}  // namespace grainvdb::spot
