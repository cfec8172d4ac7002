// What becomes of results beside walls: masks, stress, standard errors, records and refusals.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "grainvdb/error.hpp"
#include "grainvdb/measurement.hpp"
#include "physics/walls_scene.hpp"
#include "support/lattice_packing.hpp"
#include "support/memory_source.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::wall_results_test {
namespace {

using namespace testing::walls_scene;  // NOLINT: what the tests of this scene share

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Pair;

TEST(Walls, MaskLeavesOutVoxelsWhoseKernelComesNear) {
  const Scene scene = walled_scene();
  Pipeline p = scene.pipeline({"phi", "velocity", "stress", "mu"});
  p.walls.surfaces = {floor_at(0)};
  const Result cut = run(p, scene.frames);
  p.walls.kernel = Kernel::mask;
  double largest = 0;
  for (std::size_t n = 0; n < scene.frames[0].particles.size(); ++n)
    if (scene.frames[0].particles.type[n] == 1) largest = std::max(largest, scene.frames[0].particles.radius[n]);
  for (const std::optional<double> clearance : {std::optional<double>(), std::optional<double>(0.4)}) {
    p.walls.clearance = clearance;
    const double least = p.cutoff + clearance.value_or(1.5 * largest);
    const Result r = run(p, scene.frames);
    std::size_t masked = 0, kept = 0;
    cut.only().field("phi").for_each_active([&](const Coord& c) {
      const double z = p.origin[2] + (c.z + 0.5) * p.voxel;
      const std::uint32_t bits = r.only().mask_at(c);
      EXPECT_EQ((bits & bit(Reason::near_wall)) != 0, z < least);
      EXPECT_EQ((bits & bit(Reason::behind_wall)) != 0, z < 0);
      EXPECT_EQ(bits & ~(bit(Reason::near_wall) | bit(Reason::behind_wall)), cut.only().mask_at(c));
      ++(z < least ? masked : kept);
      for (const std::string& name : p.fields)
        for (int k = 0; k < cut.only().field(name).meta.components; ++k) {
          const float before = cut.only().field(name).at(c, k);
          const float after = r.only().field(name).at(c, k);
          EXPECT_TRUE(z < least ? std::isnan(after) : std::memcmp(&before, &after, sizeof after) == 0) << name;
        }
    });
    EXPECT_GT(masked, 100U);
    EXPECT_GT(kept, 100U);
  }
}

// Half branches in grains behind the wall are left out: the sums that are divided are those of what is inside.
TEST(Walls, RenormalisedStressIsThatOfWhatIsInside) {
  const Scene scene = walled_scene();
  Pipeline p = scene.pipeline({"contact_stress"});
  p.walls.surfaces = {floor_at(-0.2), {Wall::Shape::plane, {0, 0, 5.1}, {0, 0, -1}}};  // among the wall grains
  set_option(p, "contact_stress", "wall_contacts", std::string("exclude"));
  const Result cut = run(p, scene.frames);
  p.walls.kernel = Kernel::renormalise;
  set_option(p, "contact_stress", "wall_contacts", std::string("include"));
  const Result r = run(p, scene.frames);
  const LucyKernel kernel(p.cutoff);
  const WallDomain domain(p.walls.surfaces);
  std::size_t checked = 0;
  r.only().field("contact_stress").for_each_active([&](const Coord& c) {
    const Vec3 x{0, 0, p.origin[2] + (c.z + 0.5) * p.voxel};
    if (!domain.contains(x)) return;
    ++checked;
    const double part = domain.inside_fraction(kernel, x);
    for (int k = 0; k < 9; ++k) {
      const auto expected = static_cast<double>(cut.only().field("contact_stress").at(c, k)) / part;
      EXPECT_NEAR(static_cast<double>(r.only().field("contact_stress").at(c, k)), expected,
                  1e-6 * std::abs(expected) + 1e-9);
    }
  });
  EXPECT_GT(checked, 500U);
}

// What is left without a block of frames is divided as the whole is: errors of sums scale with them, errors of ratios
// stay. Both are differences of floats, which are good to 1e-7 of the fields; the jackknife of three blocks doubles
// that.
TEST(Walls, StandardErrorsAreThoseOfRenormalisedFields) {
  const Scene scene = walled_scene();
  Pipeline p = scene.pipeline({"phi", "phi_error", "velocity", "velocity_error"});
  p.blocks = 3;
  p.walls.surfaces = {floor_at(-0.2)};
  const Result cut = run(p, scene.frames);
  p.walls.kernel = Kernel::renormalise;
  const Result r = run(p, scene.frames);
  const LucyKernel kernel(p.cutoff);
  const WallDomain domain(p.walls.surfaces);
  std::size_t checked = 0, divided = 0;
  r.only().field("phi").for_each_active([&](const Coord& c) {
    const auto value = [&](const Result& result, const char* name) {
      return static_cast<double>(result.only().field(name).at(c));
    };
    const Vec3 x{0, 0, p.origin[2] + (c.z + 0.5) * p.voxel};
    if (!domain.contains(x)) {
      EXPECT_TRUE(std::isnan(value(r, "phi_error")));
      return;
    }
    if (std::isnan(value(cut, "phi_error"))) return;
    ++checked;
    const double part = domain.inside_fraction(kernel, x);
    divided += part < 0.9 ? 1U : 0U;
    EXPECT_NEAR(value(r, "phi_error") * part, value(cut, "phi_error"), 1e-6 * value(cut, "phi"));
    EXPECT_NEAR(value(r, "velocity_error"), value(cut, "velocity_error"),
                1e-6 * std::abs(value(cut, "velocity")) + 1e-6 * value(cut, "velocity_error"));
  });
  EXPECT_GT(checked, 500U);
  EXPECT_GT(divided, 100U);
}

TEST(Walls, AreRecordedAndCostNothingWhereNotAskedFor) {
  Pipeline p = with_walls(Kernel::renormalise, 0.2, {0, 0, 0}, {"phi"});
  p.walls.faces = {{2, false}};
  const Result r = run(p, {layers()});
  EXPECT_THAT(r.record.provenance,
              Contains(Pair("walls", HasSubstr("plane through (0.0, 0.0, 0.0), material towards"))));
  EXPECT_THAT(r.record.provenance, Contains(Pair("walls", HasSubstr("divided by the part of the kernel inside"))));
  EXPECT_THAT(r.report.masked, Contains(Pair("behind_wall", ::testing::Gt(0U))));
  EXPECT_TRUE(r.only().has_mask);
  EXPECT_THAT(describe(r.plan, p), HasSubstr("face z_lo of the box"));
  p.walls.kernel = Kernel::cut;
  const Result cut = run(p, {layers()});
  EXPECT_THAT(cut.record.provenance, Contains(Pair("walls", "")));
  EXPECT_FALSE(cut.only().has_mask);
  EXPECT_EQ(cut.report.channels, r.report.channels);
  EXPECT_EQ(describe(cut.plan, p).find("walls"), std::string::npos);
}

TEST(Walls, SameBytesForAnyNumberOfThreads) {
  const Scene scene = walled_scene();
  for (const Kernel kernel : {Kernel::renormalise, Kernel::mirror, Kernel::mask}) {
    Pipeline p = scene.pipeline({"phi", "temperature", "stress", "wall_force"});
    p.walls.kernel = kernel;
    p.walls.surfaces = {floor_at(0), {Wall::Shape::plane, {0, 0, 5}, {0, 0, -1}}};
    std::vector<Result> results;
    for (const std::size_t threads : {1U, 4U}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      results.push_back(run(p, scene.frames));
    }
    for (const std::string& name : p.fields) {
      const std::vector<float>& a = results[0].only().field(name).values;
      const std::vector<float>& b = results[1].only().field(name).values;
      ASSERT_EQ(a.size(), b.size());
      EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0) << name;
    }
  }
}

std::string refusal(const Pipeline& p, const std::vector<Frame>& frames) {
  try {
    run(p, frames);
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "no error";
}

TEST(Walls, WallsThatDoNotFitTheBoxAreRefused) {
  Pipeline p = with_walls(Kernel::renormalise, 0.2, {0, 0, 0}, {"phi"});
  p.walls.faces = {{0, true}};
  EXPECT_THAT(refusal(p, {layers()}), HasSubstr("a periodic face of the box is no wall; found x_hi"));
  p.walls.faces = {{2, true}};
  std::vector<Frame> frames{layers(), layers()};
  frames[1].step = 1;
  frames[1].box.hi[2] += 0.1;
  EXPECT_THAT(refusal(p, frames), HasSubstr("the face z_hi of the box moves"));
  p.walls.faces = {};
  const auto with = [&](const Wall& wall) {
    p.walls.surfaces = {wall};
    return refusal(p, {layers()});
  };
  EXPECT_THAT(with({Wall::Shape::plane, {0, 0, 0}, {0.1, 0, 1}}), HasSubstr("meets the periodic boundary along x"));
  EXPECT_THAT(with({Wall::Shape::cone, {0, 0, 0}, {0, 0, 1}, 0, 0.5}), HasSubstr("meets the periodic boundary"));
  EXPECT_THAT(with({Wall::Shape::cylinder, {1, 1, 0}, {0, 0, 1}, 0.9}), HasSubstr("meets the periodic boundary"));
  EXPECT_EQ(with({Wall::Shape::plane, {0, 0, 0}, {0, 0, 3}}), "no error");
}

/// The numbers of a table by their names.
std::map<std::string, double> numbers_of(const RunReport& report, const std::string& table) {
  std::map<std::string, double> numbers;
  for (const Table& t : report.tables)
    if (t.name == table)
      for (const Quantity& q : t.numbers) numbers[q.name] = q.value;
  return numbers;
}

// The walls of the pipeline file reach a measurement that asks for no field: with all faces as walls the cells of a
// cubic packing are all cubes. Walls that do not fit the box are refused there, too.
TEST(Walls, EndVoronoiCells) {
  const auto at_rest = [](const Vec3&) { return Vec3{}; };
  MemorySource open({cubic_packing(4, false, at_rest)}), periodic({cubic_packing(4, true, at_rest)});
  Pipeline p = make_pipeline(0.5, {0, 0, 0}, 2, {});
  OptionValues options;
  for (const OptionInfo& option : find_measurement("voronoi")->options) options[option.name] = option.default_value;
  p.measure["voronoi"] = options;
  EXPECT_DOUBLE_EQ(numbers_of(measure(p, open), "voronoi").at("at_faces"), 56 / 64.0);
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) p.walls.faces.push_back({axis, high});
  const auto within = numbers_of(measure(p, open), "voronoi");
  EXPECT_EQ(within.at("at_faces"), 0);
  EXPECT_DOUBLE_EQ(within.at("at_walls"), 56 / 64.0);
  EXPECT_NEAR(within.at("phi"), std::numbers::pi / 6, 1e-9);
  EXPECT_LT(within.at("cells_deviation"), 1e-7);  // the root of what rounding leaves of a variance
  p.walls.faces = {};
  p.walls.surfaces = {{Wall::Shape::plane, {0, 0, 0}, {0.1, 0, 1}}};
  EXPECT_THROW(measure(p, periodic), ConfigError);
}

}  // namespace
}  // namespace grainvdb::testing::wall_results_test
