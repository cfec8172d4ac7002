#pragma once
/// The fields of physics section 3, each in a file of its own.
#include "grainvdb/stage.hpp"

namespace grainvdb {

void register_packing(StageRegistry& registry);
void register_velocity(StageRegistry& registry);
void register_mean_diameter(StageRegistry& registry);
void register_temperature(StageRegistry& registry);
void register_angular_velocity(StageRegistry& registry);
void register_rotational_fluctuation(StageRegistry& registry);
void register_contact_stress(StageRegistry& registry);
void register_kinetic_stress(StageRegistry& registry);
void register_stress(StageRegistry& registry);
void register_wall_force(StageRegistry& registry);
void register_bookkeeping(StageRegistry& registry);

}  // namespace grainvdb
