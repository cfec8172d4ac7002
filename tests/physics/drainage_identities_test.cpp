// The kinematic model from grains on: what the kernel does to a flow that is known.
#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "grainvdb/kinematic.hpp"
#include "grainvdb/measurement.hpp"
#include "support/random.hpp"
#include "support/run_in_memory.hpp"

namespace grainvdb::testing::drainage_identities_test {
namespace {

const KinematicFlow flow{2.28, 10};
constexpr double cutoff = 3;

/// Grains of diameter 1, one near each site of a cubic lattice, that drain through a slot below the box.
Frame draining_grains() {
  Frame f;
  f.file = "memory";
  f.box = {{-30, 0, 2}, {30, 6, 22}, {false, true, false}};
  Random random(23);
  for (double x = -29.5; x < 30; ++x)
    for (double y = 0.5; y < 6; ++y)
      for (double z = 2.5; z < 22; ++z) {
        const Vec3 at{x + random.uniform(-0.2, 0.2), y + random.uniform(-0.2, 0.2), z + random.uniform(-0.2, 0.2)};
        const Vec3 v{flow.sideways(at[0], at[2]), 0, -flow.downward(at[0], at[2])};
        f.particles.id.push_back(static_cast<std::int64_t>(f.particles.id.size()) + 1);
        f.particles.radius.push_back(0.5);
        for (std::size_t a = 0; a < 3; ++a) {
          f.particles.position[a].push_back(at[a]);
          f.particles.velocity[a].push_back(v[a]);
        }
      }
  return f;
}

std::map<std::string, double> numbers_of(const std::string& measurement, const OptionValues& changed) {
  OptionValues options;
  for (const OptionInfo& option : find_measurement(measurement)->options) options[option.name] = option.default_value;
  for (const auto& [name, value] : changed) options.at(name) = value;
  Pipeline p = make_pipeline(0.5, {0, 0, 0}, cutoff, {});
  p.measure[measurement] = options;
  std::map<std::string, double> numbers;
  for (const Table& table : run(p, {draining_grains()}).report.tables)
    for (const Quantity& q : table.numbers) numbers[table.name + '.' + q.name] = q.value;
  return numbers;
}

// The kernel adds c²/12 to the variance of every profile, which moves their origin and leaves b. Smoothing along z,
// whose profiles are no Gaussians any more, and grains at random places leave 0.3 % of b by all places and 0.5 % by
// widths.
TEST(DrainageIdentities, BIsRecoveredThroughTheKernel) {
  const auto found =
      numbers_of("kinematic_fit", {{"lowest", 6.0}, {"highest", 18.0}, {"origin", std::string("fitted")}});
  EXPECT_NEAR(found.at("kinematic_fit.b"), flow.b, 0.01 * flow.b);
  EXPECT_NEAR(found.at("kinematic_fit.discharge"), flow.discharge, 0.01 * flow.discharge);
  EXPECT_NEAR(found.at("kinematic_width.b"), flow.b, 0.01 * flow.b);
}

// Spots without width that are asked halfway along their steps are the kinematic model, through the kernel, too.
TEST(DrainageIdentities, TheMeanFieldIsTheFlow) {
  const auto found = numbers_of("mean_field", {{"lowest", 6.0},
                                               {"highest", 18.0},
                                               {"origin", std::string("fitted")},
                                               {"radius", 0.1},
                                               {"influence", 1 / 399.0}});
  EXPECT_NEAR(found.at("mean_field.velocity_over_drift"), 1, 0.005);
  EXPECT_NEAR(found.at("mean_field.sideways_over_drift"), 1, 0.02);
  EXPECT_NEAR(found.at("mean_field.grain_diffusion"), 0.00571, 0.0001);
}

}  // namespace
}  // namespace grainvdb::testing::drainage_identities_test
