#include "average/register.hpp"
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
    register_wall_force(r);
    register_gradients(r);
    register_rates(r);
    register_stress_invariants(r);
    register_rheology(r);
    register_fluidity(r);
    register_spin(r);
    register_principal(r);
    register_mohr_coulomb(r);
    register_coaxiality(r);
    register_spot_drift(r);
    register_standard_errors(r);
    register_bookkeeping(r);
    return r;
  }();
  return registry;
}

}  // namespace grainvdb
