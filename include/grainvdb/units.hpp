#pragma once
/// Unit systems of dumps and the units of fields. All computation is done in the dump's own units.
#include <string>
#include <string_view>
#include <vector>

namespace grainvdb {

/// A quantity mass^m length^l time^t.
struct Dimension {
  int mass = 0;
  int length = 0;
  int time = 0;
  bool operator==(const Dimension&) const = default;
};

namespace dimension {
inline constexpr Dimension none{0, 0, 0}, length{0, 1, 0}, time{0, 0, 1}, mass{1, 0, 0}, velocity{0, 1, -1},
    rate{0, 0, -1}, density{1, -3, 0}, stress{1, -1, -2}, velocity_squared{0, 2, -2}, rate_squared{0, 0, -2},
    force_density{1, -2, -2}, acceleration{0, 1, -2};
}

/// A coherent unit system: stress is mass/(length time²). LAMMPS `real`, `metal` and `electron` are not coherent and
/// are not offered.
struct UnitSystem {
  std::string name;  ///< as LAMMPS names it: si, cgs, lj, micro, nano
  std::string mass, length, time;

  /// "m/s", "kg/(m s^2)" is written "Pa" in si; "1" for a pure number.
  std::string symbol(const Dimension& d) const;
};

/// The systems that can be named in a pipeline file.
const std::vector<UnitSystem>& unit_systems();
/// The system of that name; nullptr when there is none.
const UnitSystem* find_unit_system(std::string_view name);

}  // namespace grainvdb
