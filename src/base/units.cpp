#include "grainvdb/units.hpp"

#include <algorithm>
#include <cstdlib>

namespace grainvdb {

std::string UnitSystem::symbol(const Dimension& d) const {
  if (d == dimension::none) return "1";
  if (name == "si" && d == dimension::stress) return "Pa";
  std::string above, below;
  int below_count = 0;
  const auto put = [&](const std::string& unit, int power) {
    if (power == 0) return;
    std::string& to = power > 0 ? above : below;
    if (power < 0) ++below_count;
    if (!to.empty()) to += ' ';
    to += unit;
    if (std::abs(power) > 1) to += '^' + std::to_string(std::abs(power));
  };
  put(mass, d.mass);
  put(length, d.length);
  put(time, d.time);
  if (above.empty()) above.push_back('1');
  if (below.empty()) return above;
  return above + '/' + (below_count > 1 ? '(' + below + ')' : below);
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
