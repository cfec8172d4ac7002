#pragma once
/// Flows in which methods fail: what the tests of stability run on.
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "support/scenes.hpp"

namespace grainvdb::testing {

/// A scene with every field asked for, and whatever thresholds the program has by itself.
struct Regime {
  std::string name;
  std::function<Scene()> scene;
};
void PrintTo(const Regime& regime, std::ostream* out);
std::vector<Regime> regimes();
/// The scene of a regime; throws std::out_of_range for one that is not known.
Scene scene_of(const std::string& regime);

/// All particles of the scene with one velocity and no spin.
Scene in_plug_flow(Scene scene, const Vec3& velocity);

/// The number as it comes back from a dump with six digits, `%g`.
double six_digits(double x);

/// A periodic cubic packing of n³ grains of diameter 1 in which every neighbouring pair pulls (`force` > 0) or pushes
/// along the axis that joins it.
Frame bonded_packing(int n, const Vec3& force);

}  // namespace grainvdb::testing
