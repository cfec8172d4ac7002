#include "grainvdb/units.hpp"

#include <algorithm>

#include "base/unit_product.hpp"

namespace grainvdb {

std::string UnitSystem::symbol(const Dimension& d) const {
  if (name == "si" && d == dimension::stress) return "Pa";
  UnitProduct product;
  product.multiply(mass, d.mass);
  product.multiply(length, d.length);
  product.multiply(time, d.time);
  return product.text();
}

const std::vector<UnitSystem>& unit_systems() {
  static const std::vector<UnitSystem> systems{{"si", "kg", "m", "s"},
                                               {"cgs", "g", "cm", "s"},
                                               {"micro", "pg", "um", "us"},
                                               {"nano", "ag", "nm", "ns"},
                                               {"lj", "m*", "sigma", "tau"}};
  return systems;
}

const UnitSystem* find_unit_system(std::string_view name) {
  const auto& all = unit_systems();
  const auto it = std::find_if(all.begin(), all.end(), [&](const UnitSystem& u) { return u.name == name; });
  return it == all.end() ? nullptr : &*it;
}

}  // namespace grainvdb
