#include "measure/structure.hpp"

#include "measure/register.hpp"

namespace grainvdb {

std::vector<MeasurementInfo> structure_measurements() {
  return {pair_correlation_measurement(), bond_angles_measurement(),  coordination_measurement(),
          overlap_measurement(),          voronoi_measurement(),      velocity_correlation_measurement(),
          diffusion_measurement(),        surface_angle_measurement()};
}

}  // namespace grainvdb
