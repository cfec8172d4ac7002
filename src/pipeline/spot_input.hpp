#pragma once
/// Dumps of a spot run: snapshots of places alone. There are no forces, and velocities are displacements since the
/// snapshot before, divided by the time between.
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"

namespace grainvdb {

/// The column by which such dumps are known.
inline constexpr const char* spot_column = "v_spot";

/// What a result says of the snapshots that it was made from.
inline constexpr const char* spot_snapshots =
    "of a spot run: there are no forces, and velocities are displacements since the snapshot before";

/// Whether the first frame bears that column.
bool is_spot_run(const FrameSource& source);

/// Refuses what is made of forces, for spot runs, with the names of all wanted fields that are (ConfigError).
void refuse_forces_of_spots(const Pipeline& pipeline, const Plan& plan, const FrameSource& source);
/// Refuses measurements that need contacts, for spot runs (ConfigError).
void refuse_contacts_of_spots(const Pipeline& pipeline, const FrameSource& source);

}  // namespace grainvdb
