// Measurements of exact averages over planes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/error.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/measurement.hpp"
#include "grainvdb/moment.hpp"
#include "pipeline/measure_needs.hpp"
#include "support/memory_source.hpp"
#include "support/random.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"
#include "support/static_columns.hpp"

namespace grainvdb::testing::plane_measurements_test {
namespace {

/// What a sum in single precision may err by, relative to Σ |terms|.
constexpr double e = 1e-5;

/// The options of a measurement, of which these are not the defaults.
OptionValues options_of(const std::string& measurement, const OptionValues& given) {
  OptionValues options;
  for (const OptionInfo& option : find_measurement(measurement)->options) options[option.name] = option.default_value;
  for (const auto& [name, value] : given) options.at(name) = value;
  return options;
}

Pipeline measuring(Pipeline p, const std::string& measurement, const OptionValues& given) {
  p.fields.clear();
  p.measure[measurement] = options_of(measurement, given);
  return p;
}

/// Without any results but the tables.
RunReport measure(Pipeline p, const std::vector<Frame>& frames) {
  p.input.contacts.files = {"memory"};
  MemorySource source(frames);
  return run_pipeline(p, make_plan(p), source, {});
}

OptionValues fields(std::vector<std::string> names) {
  return {{"fields", std::move(names)}};
}

const Table& table_of(const RunReport& report, const std::string& name) {
  for (const Table& table : report.tables)
    if (table.name == name) return table;
  throw std::out_of_range(name);
}

const std::vector<double>& column(const Table& table, const std::string& name) {
  for (const TableColumn& c : table.columns)
    if (c.name == name) return c.values;
  throw std::out_of_range(name);
}

const Quantity& number(const Table& table, const std::string& name) {
  for (const Quantity& q : table.numbers)
    if (q.name == name) return q;
  throw std::out_of_range(name);
}

// The mean over the periodic height is Σ V/volume, to the error of the trapezoidal rule at c/h = 5.4 (1.5e-4) and that
// of the splat. In rigid motion every plane has its velocity.
TEST(PlaneProfile, HoldsAllMaterialAndRigidMotion) {
  Scene scene = periodic_scene();
  for (Frame& f : scene.frames)
    for (std::size_t a = 0; a < 3; ++a)
      std::fill(f.particles.velocity[a].begin(), f.particles.velocity[a].end(), std::array{7.0, 0.0, -1.0}[a]);
  Pipeline p = measuring(scene.pipeline({}), "plane_profile", {});
  p.window = 1;
  const Table table = table_of(measure(p, scene.frames), "plane_profile");
  double volume = 0;
  for (const Frame& f : scene.frames)
    for (const double r : f.particles.radius) volume += sphere_volume(r) / static_cast<double>(scene.frames.size());
  double sum = 0;
  const Box& box = scene.frames[0].box;
  ASSERT_EQ(column(table, "phi").size(), 15U);
  for (std::size_t n = 0; n < 15; ++n) {
    sum += column(table, "phi")[n] * scene.voxel * box.length(0) * box.length(1);
    EXPECT_NEAR(column(table, "velocity_x")[n], 7, 7 * 2 * e);
    EXPECT_NEAR(column(table, "velocity_z")[n], -1, 2 * e);
    EXPECT_NEAR(column(table, "temperature")[n], 0, 50 * 4 * e * e);
    EXPECT_GT(column(table, "phi_error")[n], 0);
  }
  EXPECT_NEAR(sum, volume, 1.7e-4 * volume);
}

// The average over voxels converges to that over planes: the same stages, options and averages over time are behind
// both. At 5.4 voxels a cutoff, planes of voxels miss 2e-4.
TEST(PlaneProfile, IsWhatTheProfileOfFieldsConvergesTo) {
  const Scene scene = periodic_scene();
  const OptionValues same = fields({"phi", "velocity", "contact_stress", "density", "mean_diameter"});
  Pipeline p = measuring(scene.pipeline({}), "plane_profile", same);
  p.measure["profile"] = options_of("profile", same);
  for (const std::size_t window : {0U, 1U}) {
    p.window = window;
    const RunReport result = measure(p, scene.frames);
    const Table &planes = table_of(result, "plane_profile"), &voxels = table_of(result, "profile");
    EXPECT_EQ(planes.columns.size() + 2, voxels.columns.size());  // height and voxels
    for (const TableColumn& c : planes.columns) {
      if (c.name.ends_with("_error")) continue;
      const std::vector<double>& other = column(voxels, c.name);
      double largest = 0;
      for (const double v : c.values) largest = std::max(largest, std::abs(v));
      ASSERT_EQ(c.values.size(), other.size());
      for (std::size_t n = 0; n < other.size(); ++n) EXPECT_NEAR(c.values[n], other[n], 6e-4 * largest) << c.name << n;
    }
  }
}

TEST(PlaneProfile, HasSpeciesThatAddUp) {
  const Scene scene = walled_scene();
  Pipeline p =
      measuring(scene.pipeline({}), "plane_profile",
                fields({"phi", "phi_fine", "phi_coarse", "velocity", "velocity_fine", "velocity_coarse",
                        "contact_stress", "contact_stress_fine", "contact_stress_coarse", "contact_stress_wall"}));
  p.species = {
      {"fine", {1}, {}, std::pair(0.0, 0.94)}, {"coarse", {1}, {}, std::pair(0.94, 9.0)}, {"wall", {2, 3}, {}, {}}};
  const Table table = table_of(measure(p, scene.frames), "plane_profile");
  std::size_t compared = 0;
  for (std::size_t n = 0; n < column(table, "z").size(); ++n) {
    const double phi = column(table, "phi")[n];
    if (!(phi > 1e-6)) continue;
    const double fine = column(table, "phi_fine")[n], coarse = column(table, "phi_coarse")[n];
    EXPECT_NEAR(fine + coarse, phi, 2 * e * phi);
    double flux = 0;
    if (fine > 0) flux += fine * column(table, "velocity_fine_x")[n];
    if (coarse > 0) flux += coarse * column(table, "velocity_coarse_x")[n];
    EXPECT_NEAR(flux, phi * column(table, "velocity_x")[n], 6 * e * phi * 5);  // of speeds up to 5
    double stress = 0, size = 0;
    for (const char* s : {"_fine_zz", "_coarse_zz", "_wall_zz"}) {
      stress += column(table, std::string("contact_stress") + s)[n];
      size += std::abs(column(table, std::string("contact_stress") + s)[n]);
    }
    EXPECT_NEAR(stress, column(table, "contact_stress_zz")[n], 1e-6 * size);
    ++compared;
  }
  EXPECT_GT(compared, 15U);
}

TEST(PlaneProfile, ReadsWhatItsFieldsNeedAndNoMore) {
  const Scene scene = periodic_scene();
  const auto read = [&](std::vector<std::string> names) {
    const Pipeline p = measuring(scene.pipeline({}), "plane_profile", fields(std::move(names)));
    return columns_read(make_plan(p), p);
  };
  EXPECT_EQ(read({"phi"}), ColumnSet(Column::radius));
  EXPECT_EQ(read({"density"}), ColumnSet(Column::mass));
  EXPECT_EQ(read({"velocity"}), Column::velocity | Column::radius);
  EXPECT_EQ(read({"contact_stress"}), Column::contacts | Column::radius);
  EXPECT_TRUE(read({"mu"}).has(Column::contacts));
  EXPECT_FALSE(read({"phi", "velocity", "temperature", "mean_diameter", "kinetic_stress"}).has(Column::contacts));
  // Nothing is splatted on voxels for it.
  EXPECT_TRUE(make_plan(measuring(scene.pipeline({}), "plane_profile", fields({"stress"}))).stages.empty());
}

TEST(PlaneProfile, SaysWhatItDoesNotMind) {
  const Scene scene = periodic_scene();
  Pipeline p = measuring(scene.pipeline({}), "plane_profile", fields({"phi", "temperature"}));
  const auto has = [](const Table& table, const std::string& text) {
    return std::any_of(table.remarks.begin(), table.remarks.end(),
                       [&](const std::string& remark) { return remark.find(text) != std::string::npos; });
  };
  const Table plain = table_of(measure(p, scene.frames), "plane_profile");
  EXPECT_FALSE(has(plain, "region") || has(plain, "self_weight"));
  p.region = {{0, 0, 0}, {2, 2, 2}};
  p.stages["temperature"]["self_weight"] = std::string("corrected");
  const Table table = table_of(measure(p, scene.frames), "plane_profile");
  EXPECT_TRUE(has(table, "whatever the region"));
  EXPECT_TRUE(has(table, "stages.temperature.self_weight"));
}

// A grain at one height in a box without walls: φ is V w₁/A whatever the area is said to be.
TEST(PlaneProfile, NeedsAnArea) {
  Frame frame;
  frame.file = "memory";
  frame.box = {{0, 0, 0}, {6, 6, 6}, {true, false, false}};
  add_particle(frame.particles, 1, 1, {1, 2, 3.4}, {}, {}, 0.5, 1);
  Pipeline p = measuring(make_pipeline(0.5, {0, 0, 0}, 3, {}), "plane_profile", {});
  EXPECT_THROW(measure(p, {frame}), InputError);
  p = measuring(p, "plane_profile", {{"area", 12.0}});
  const Table table = table_of(measure(p, {frame}), "plane_profile");
  for (std::size_t n = 0; n < column(table, "z").size(); ++n)
    EXPECT_NEAR(column(table, "phi")[n], sphere_volume(0.5) * LucyKernel(3).marginal(column(table, "z")[n] - 3.4) / 12,
                e * sphere_volume(0.5) / 12);
}

// Planes normal to a wall's normal cut the kernel off alike all over them, others do not.
TEST(PlaneProfile, KnowsWallsAlongThePlanesAlone) {
  Frame frame;
  frame.file = "memory";
  frame.box = {{0, 0, 0}, {6, 6, 9}, {true, true, false}};
  Random random(3);
  for (int n = 1; n <= 20000; ++n)
    add_particle(frame.particles, n, 1, {random.uniform(0, 6), random.uniform(0, 6), random.uniform(0, 9)}, {}, {}, 0.1,
                 1);
  Pipeline p = measuring(make_pipeline(0.5, {0, 0, 0}, 2, {}), "plane_profile", fields({"phi"}));
  p.walls.kernel = WallSpec::Kernel::renormalise;
  p.walls.surfaces = {{Wall::Shape::plane, {0, 0, 0}, {0, 0, 1}}};
  const double expected = 20000 * sphere_volume(0.1) / (6 * 6 * 9);
  const Table table = table_of(measure(p, {frame}), "plane_profile");
  std::size_t compared = 0;
  for (std::size_t n = 0; n < column(table, "z").size(); ++n) {
    if (!(column(table, "z")[n] > 0 && column(table, "z")[n] < 7)) continue;
    EXPECT_NEAR(column(table, "phi")[n], expected, 0.04 * expected);  // four standard deviations of some 10⁴ grains
    ++compared;
  }
  EXPECT_EQ(compared, 14U);
  p.walls.surfaces = {{Wall::Shape::cylinder, {3, 3, 0}, {0, 0, 1}, 2.0, 0, true}};
  EXPECT_THROW(measure(p, {frame}), ConfigError);
}

// g d/δv at the places of the profile, and what is fitted to it.
TEST(PlaneSamples, AreThoseOfThePlaneProfile) {
  const Scene scene = moving(periodic_scene(), 4);
  Pipeline p = measuring(scene.pipeline({}), "fluidity_fit", {{"source", std::string("planes")}, {"spin", true}});
  p.measure["plane_profile"] = options_of("plane_profile", fields({"phi", "gd_over_dv", "dv_over_d_domega"}));
  p.measure["rheology"] = options_of("rheology", {{"source", std::string("planes")}});
  p.window = 1;
  const RunReport result = measure(p, scene.frames);
  const Table &samples = table_of(result, "fluidity"), &planes = table_of(result, "plane_profile");
  ASSERT_GT(column(samples, "phi").size(), 5U);
  std::size_t compared = 0;
  for (std::size_t n = 0; n < column(samples, "phi").size(); ++n)
    for (std::size_t k = 0; k < column(planes, "z").size(); ++k) {
      if (column(planes, "z")[k] != column(samples, "position")[n]) continue;
      EXPECT_EQ(column(samples, "phi")[n], column(planes, "phi")[k]);
      EXPECT_EQ(column(samples, "gd_over_dv")[n], column(planes, "gd_over_dv")[k]);
      EXPECT_EQ(column(samples, "gd_over_dv_error")[n], column(planes, "gd_over_dv_error")[k]);
      EXPECT_EQ(column(samples, "dv_over_d_domega")[n], column(planes, "dv_over_d_domega")[k]);
      ++compared;
    }
  EXPECT_EQ(compared, column(samples, "phi").size());
  EXPECT_GT(column(table_of(result, "rheology"), "mu").size(), 5U);
}

// g d/δv with the diameter and the fluctuations of one species, in the flow of all.
TEST(PlaneSamples, MayBeOfASpecies) {
  const Scene scene = moving(walled_scene(), 4);
  for (const char* source : {"planes", "profile"}) {
    SCOPED_TRACE(source);
    Pipeline p = measuring(scene.pipeline({}), "fluidity_fit",
                           {{"source", std::string(source)}, {"species", std::string("fine")}});
    const std::string beside = std::string(source) == "planes" ? "plane_profile" : "profile";
    p.measure[beside] = options_of(beside, fields({"gd_over_dv", "mean_diameter", "temperature", "phi_fine",
                                                   "mean_diameter_fine", "temperature_fine"}));
    p.species = {{"fine", {1}, {}, std::pair(0.0, 0.94)}};
    const RunReport result = measure(p, scene.frames);
    const Table &samples = table_of(result, "fluidity"), &means = table_of(result, beside);
    std::size_t compared = 0;
    for (std::size_t n = 0; n < column(samples, "phi").size(); ++n)
      for (std::size_t k = 0; k < column(means, "z").size(); ++k) {
        if (column(means, "z")[k] != column(samples, "position")[n] || std::isnan(column(means, "gd_over_dv")[k]))
          continue;
        const double expected = column(means, "gd_over_dv")[k] * column(means, "mean_diameter_fine")[k] /
                                column(means, "mean_diameter")[k] *
                                std::sqrt(column(means, "temperature")[k] / column(means, "temperature_fine")[k]);
        EXPECT_NEAR(column(samples, "gd_over_dv")[n], expected, 1e-12 * expected);
        ++compared;
      }
    EXPECT_GT(compared, 5U);
    p.measure["fluidity_fit"]["species"] = std::string("nobody");
    EXPECT_THROW(measure(p, scene.frames), ConfigError);
  }
}

TEST(PlaneSamples, HaveNeitherShellsNorPoints) {
  const auto conflict = [](const std::string& option, const OptionValue& value) {
    const OptionValues options = options_of("fluidity_fit", {{"source", std::string("planes")}, {option, value}});
    const auto found = find_measurement("fluidity_fit")->conflict(options);
    return found ? found->option : std::string();
  };
  EXPECT_EQ(conflict("geometry", std::string("shells")), "geometry");
  EXPECT_EQ(conflict("points", std::int64_t{16}), "points");
  EXPECT_EQ(conflict("bin", 0.5), "");
  EXPECT_EQ(conflict("species", std::string("fine")), "");
}

// Columns at rest whose contacts with the floor are left out balance with the density in every plane beyond: σ_zz falls
// by g ∫ρ dz, which the trapezoidal rule over planes h = c/6 apart takes to 1e-3 (measured).
TEST(PlaneBalance, FindsGravity) {
  const StaticColumns columns(31);
  Pipeline p = measuring(make_pipeline(0.5, {0, 0, 0.1}, 3, {}), "stationarity",
                         {{"source", std::string("planes")}, {"from", 3.1}, {"to", 12.0}, {"gravity", 9.81}});
  p.select.types = {1};
  const Table table = table_of(measure(p, {columns.frame}), "stationarity");
  EXPECT_NEAR(number(table, "gravity").value, columns.gravity, 1e-3 * columns.gravity);
  EXPECT_LT(number(table, "balance_residual").value, 2e-3);
}

}  // namespace
}  // namespace grainvdb::testing::plane_measurements_test
