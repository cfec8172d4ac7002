#include "derive/register.hpp"
#include "fields/register.hpp"
#include "grainvdb/stage.hpp"

namespace grainvdb {

const StageRegistry& StageRegistry::standard() {
  static const StageRegistry registry = [] {
    StageRegistry r;
    register_packing(r);
    register_velocity(r);
    register_mean_diameter(r);
    register_temperature(r);
    register_angular_velocity(r);
    register_rotational_fluctuation(r);
    register_contact_stress(r);
    register_kinetic_stress(r);
    register_stress(r);
    register_bookkeeping(r);
    return r;
  }();
  return registry;
}

}  // namespace grainvdb
