#include <algorithm>
#include <utility>

#include "grainvdb/measurement.hpp"
#include "measure/register.hpp"

namespace grainvdb {

const std::vector<MeasurementInfo>& measurement_registry() {
  static const std::vector<MeasurementInfo> registry = [] {
    std::vector<MeasurementInfo> all;
    for (const auto family :
         {profile_measurements, plane_profile_measurements, fluidity_measurements, rheology_measurements,
          stationarity_measurements, plasticity_measurements, structure_measurements, spot_measurements})
      for (MeasurementInfo& measurement : family()) all.push_back(std::move(measurement));
    return all;
  }();
  return registry;
}

const MeasurementInfo* find_measurement(const std::string& name) {
  const auto& all = measurement_registry();
  const auto it = std::find_if(all.begin(), all.end(), [&](const MeasurementInfo& m) { return m.name == name; });
  return it == all.end() ? nullptr : &*it;
}

}  // namespace grainvdb
