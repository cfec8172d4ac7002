// The tables of packing structure, through what the registry declares of them.
#include "measure/structure.hpp"

#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "grainvdb/error.hpp"
#include "lattices.hpp"
#include "measure/register.hpp"

namespace grainvdb::testing::structure_test {
namespace {

MeasurementInfo info_of(const std::string& name) {
  for (MeasurementInfo& info : structure_measurements())
    if (info.name == name) return info;
  throw std::out_of_range(name);
}

OptionValues defaults(const MeasurementInfo& info) {
  OptionValues values;
  for (const OptionInfo& o : info.options) values[o.name] = o.default_value;
  return values;
}

std::vector<Table> measure(const std::string& name, const std::vector<Frame>& frames, const OptionValues& changed = {},
                           const WallDomain& walls = {}) {
  const MeasurementInfo info = info_of(name);
  OptionValues options = defaults(info);
  for (const auto& [key, value] : changed) options[key] = value;
  if (info.conflict && info.conflict(options)) throw std::invalid_argument(name);
  const Lattice lattice(1, {0, 0, 0});
  const StageSettings stages;
  const Box box = frames.empty() ? Box{{0, 0, 0}, {1, 1, 1}, {}} : frames[0].box;
  const auto m = info.make({options, stages, lattice, LucyKernel(3), box, std::nullopt, walls});
  for (const Frame& frame : frames) m->add(frame);
  return m->tables();
}

const Quantity& number(const Table& table, const std::string& name) {
  for (const Quantity& q : table.numbers)
    if (q.name == name) return q;
  throw std::out_of_range(name);
}

/// Grains at random places with velocities and times, some time apart.
std::vector<Frame> random_frames(std::size_t count) {
  std::vector<Frame> frames;
  for (std::size_t n = 0; n < count; ++n) {
    Frame f = poisson({{0, 0, 0}, {8, 9, 10}, {true, true, false}}, 700, 30 + n).frame();
    Random random(n);
    for (auto& column : f.particles.velocity)
      for (std::size_t i = 0; i < f.particles.size(); ++i) column.push_back(random.normal());
    f.time = 0.5 * static_cast<double>(n);
    f.step = static_cast<std::int64_t>(100 * n);
    frames.push_back(std::move(f));
  }
  return frames;
}

class EveryStructureMeasurement : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryStructureMeasurement, NeedsParticlesAlone) {
  const MeasurementInfo info = info_of(GetParam());
  const MeasurementNeeds needs = info.needs(defaults(info));
  EXPECT_TRUE(needs.particles);
  EXPECT_TRUE(needs.fields.empty());
}

TEST_P(EveryStructureMeasurement, MakesWholeTables) {
  std::set<std::string> names;
  for (const Table& table : measure(GetParam(), random_frames(3))) {
    EXPECT_TRUE(names.insert(table.name).second);
    EXPECT_TRUE(table.name.starts_with(GetParam()));
    EXPECT_FALSE(table.description.empty());
    EXPECT_FALSE(table.equation.empty());
    ASSERT_FALSE(table.columns.empty());
    for (const TableColumn& column : table.columns) {
      EXPECT_EQ(column.values.size(), table.columns[0].values.size()) << column.name;
      EXPECT_FALSE(column.description.empty());
    }
    for (const Quantity& q : table.numbers) EXPECT_FALSE(q.description.empty()) << q.name;
  }
}

TEST_P(EveryStructureMeasurement, SaysSoWhereThereAreNoGrains) {
  Frame empty;
  empty.box = {{0, 0, 0}, {1, 1, 1}, {true, true, false}};
  for (const std::vector<Frame>& frames : {std::vector<Frame>{}, std::vector<Frame>{empty, empty}}) {
    const std::vector<Table> tables = measure(GetParam(), frames);
    ASSERT_FALSE(tables.empty());
    for (const Table& table : tables) EXPECT_FALSE(table.remarks.empty()) << table.name;
  }
}

TEST_P(EveryStructureMeasurement, SaysSoWhereNoneCounts) {
  const std::vector<double> lo{1e3, 1e3, 1e3}, hi{2e3, 2e3, 2e3};
  for (const Table& table : measure(GetParam(), random_frames(2), {{"lo", lo}, {"hi", hi}}))
    EXPECT_FALSE(table.remarks.empty()) << table.name;
}

TEST_P(EveryStructureMeasurement, RefusesRegionsThatAreNone) {
  using Numbers = std::vector<double>;
  const MeasurementInfo info = info_of(GetParam());
  OptionValues options = defaults(info);
  EXPECT_FALSE(info.conflict(options));
  options["lo"] = Numbers{1, 2};
  EXPECT_EQ(info.conflict(options)->option, "lo");
  options["lo"] = Numbers{1, 2, 3};
  options["hi"] = Numbers{5, 2, 5};
  EXPECT_EQ(info.conflict(options)->option, "hi");
}

TEST_P(EveryStructureMeasurement, IsTheSameForAnyNumberOfThreads) {
  const auto with_threads = [&](std::size_t n) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
    return measure(GetParam(), random_frames(2));
  };
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  const std::vector<Table> one = with_threads(1), four = with_threads(4);
  for (std::size_t t = 0; t < one.size(); ++t) {
    for (std::size_t c = 0; c < one[t].columns.size(); ++c)
      for (std::size_t k = 0; k < one[t].columns[c].values.size(); ++k)
        EXPECT_TRUE(same(one[t].columns[c].values[k], four[t].columns[c].values[k])) << one[t].columns[c].name;
    for (std::size_t q = 0; q < one[t].numbers.size(); ++q)
      EXPECT_TRUE(same(one[t].numbers[q].value, four[t].numbers[q].value)) << one[t].numbers[q].name;
  }
}

INSTANTIATE_TEST_SUITE_P(Structure, EveryStructureMeasurement,
                         ::testing::Values("pair_correlation", "bond_angles", "coordination", "overlap", "voronoi",
                                           "velocity_correlation", "diffusion", "surface_angle"),
                         [](const auto& param) { return param.param; });

TEST(Coordination, OfTheSimpleCubicLatticeIsSix) {
  const Table table = measure("coordination", {simple_cubic(4).frame()}).at(0);
  EXPECT_DOUBLE_EQ(number(table, "coordination").value, 6);
  EXPECT_DOUBLE_EQ(number(table, "coordination").error, 0);
  EXPECT_DOUBLE_EQ(number(table, "coordination_backbone").value, 6);
  EXPECT_DOUBLE_EQ(number(table, "rattlers").value, 0);
  EXPECT_EQ(table.columns.at(1).values, (std::vector<double>{0, 0, 0, 0, 0, 0, 1}));
}

TEST(Coordination, TakesTheContactsOfTheDump) {
  Frame f = simple_cubic(2).frame();
  f.particles.radius.clear();  // not asked for
  f.contacts.id1 = {1, 2, 1, 4};
  f.contacts.id2 = {2, 3, 3, 100};  // a ring of three, and one on a grain that is not selected
  const Table table = measure("coordination", {f}, {{"contacts", std::string("dump")}}).at(0);
  EXPECT_DOUBLE_EQ(number(table, "coordination").value, 7.0 / 8);
  EXPECT_DOUBLE_EQ(number(table, "rattlers").value, 5.0 / 8);
  EXPECT_DOUBLE_EQ(number(table, "coordination_backbone").value, 2);
  const MeasurementInfo info = info_of("coordination");
  OptionValues options = defaults(info);
  EXPECT_EQ(*info.needs(options).particles, ColumnSet(Column::radius));
  options["contacts"] = std::string("dump");
  EXPECT_EQ(*info.needs(options).particles, ColumnSet(Column::contacts));
}

TEST(Overlap, IsSeriesOfFrames) {
  std::vector<Frame> frames = random_frames(3);
  Table table = measure("overlap", frames).at(0);
  EXPECT_EQ(table.columns.at(0).name, "time");
  EXPECT_EQ(table.columns.at(0).values, (std::vector<double>{0, 0.5, 1}));
  frames[1].time.reset();
  table = measure("overlap", frames).at(0);
  EXPECT_EQ(table.columns.at(0).name, "step");
  EXPECT_EQ(table.columns.at(0).values, (std::vector<double>{0, 100, 200}));
}

TEST(Voronoi, OfACrystalIsItsPackingByAllMeasures) {
  const std::vector<Table> tables = measure("voronoi", {face_centred(4).frame()});
  EXPECT_NEAR(number(tables.at(0), "phi").value, 0.740480, 5e-7);
  EXPECT_NEAR(number(tables.at(0), "cells").value, 0.740480, 5e-7);
  EXPECT_LT(number(tables.at(0), "cells_deviation").value, 1e-9);
  EXPECT_NEAR(number(tables.at(0), "local").value, 0.740480, 5e-7);
  EXPECT_NEAR(number(tables.at(1), "by_cells").value, 0.740480, 5e-7);
  EXPECT_LT(number(tables.at(1), "by_cells_deviation").value, 1e-9);
  EXPECT_TRUE(tables.at(0).remarks.empty());
}

// Layers of touching grains, one diameter apart, and above them a diameter and a half: a cell is as high as the gaps
// below and above it on average.
TEST(Voronoi, MapTellsLooseLayersFromDenseOnes) {
  Scene scene;
  scene.box = {{-0.1, 0, 0}, {3.9, 3, 9.5}, {true, true, true}};
  const std::vector<double> heights{0.25, 1.25, 2.25, 3.25, 4.75, 6.25, 7.75}, cells{1.5, 1, 1, 1.25, 1.5, 1.5, 1.75};
  for (const double z : heights)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 3; ++j) scene.add({i + 0.5, j + 0.5, z}, 0.5);
  const std::vector<Frame> frames{scene.frame(), scene.frame()};
  const OptionValues along_y{{"map_across", std::string("y")}, {"map_bin", 1.0}};
  const Table map = measure("voronoi", frames, along_y).at(2);
  EXPECT_EQ(map.name, "voronoi_map");
  ASSERT_EQ(map.columns.size(), 5U);
  EXPECT_EQ(map.columns[0].name, "x");
  EXPECT_EQ(map.columns[1].name, "z");
  ASSERT_EQ(map.columns[0].values.size(), 4 * heights.size());
  for (std::size_t row = 0; row < map.columns[0].values.size(); ++row) {
    const std::size_t layer = row / 4;
    EXPECT_EQ(map.columns[0].values[row], static_cast<double>(row % 4) + 0.5);
    EXPECT_EQ(map.columns[1].values[row], std::floor(heights[layer]) + 0.5);
    EXPECT_NEAR(map.columns[2].values[row], std::numbers::pi / 6 / cells[layer], 1e-9);
    EXPECT_EQ(map.columns[4].values[row], 6);  // three in each frame
  }
  // The kernel of three diameters reaches beyond a layer, but not far enough to hide which side is dense.
  EXPECT_GT(map.columns[3].values[4], map.columns[3].values[20]);
}
TEST(Voronoi, MapOfNothingSaysSo) {
  const OptionValues far{{"map_across", std::string("x")}, {"lo", std::vector<double>{1e3, 1e3, 1e3}}};
  const Table map = measure("voronoi", random_frames(1), far).at(2);
  EXPECT_TRUE(map.columns[0].values.empty());
  EXPECT_FALSE(map.remarks.empty());
}
TEST(Voronoi, LeavesOutGrainsBehindFacesAndSaysSo) {
  Frame f = poisson({{0, 0, 0}, {8, 9, 10}, {true, true, false}}, 700, 3).frame();
  f.particles.position[2][5] = 11;
  const Table table = measure("voronoi", {f}).at(0);
  ASSERT_EQ(table.remarks.size(), 1U);
  EXPECT_TRUE(table.remarks[0].starts_with("1 times")) << table.remarks[0];
  EXPECT_GT(number(table, "at_faces").value, 0);
}

// Without walls the cells of the outer layers count for nothing, and here that is all of them.
TEST(Voronoi, CountsCellsThatEndAtWalls) {
  Frame f = hexagonal_layer(6).frame();
  f.box.lo[2] = -4;
  f.particles.position[2][5] = -2;
  const WallDomain walls({{Wall::Shape::plane, {0, 0, 0}, {0, 0, 1}}, {Wall::Shape::plane, {0, 0, 1}, {0, 0, -1}}});
  const std::vector<Table> within = measure("voronoi", {f}, {}, walls), open = measure("voronoi", {f});
  EXPECT_EQ(number(within[0], "at_faces").value, 0);
  EXPECT_EQ(number(within[0], "at_walls").value, 1);
  // 71 grains in the room of 72 that are pi/6/sqrt(3/4) of it.
  EXPECT_NEAR(number(within[0], "phi").value, std::numbers::pi / 6 / std::sqrt(0.75) * 71 / 72, 1e-9);
  ASSERT_EQ(within[0].remarks.size(), 1U);
  EXPECT_EQ(within[0].remarks[0], "1 times a grain lay behind a wall: it has no cell.");
  EXPECT_EQ(number(open[0], "at_faces").value, 1);
  EXPECT_TRUE(std::isnan(number(open[0], "at_walls").value));
}

// Places of windows a diameter apart across x and z, and anywhere along y: 6 x 6 x 8 within the outermost centres, of
// which 15 x 8 keep their radius away from the tilted plane, x + z >= 7.5 + sqrt(2).
TEST(Voronoi, LeavesOutWindowsThatReachBehindAWall) {
  Scene s;
  s.box = {{0, 0, 0}, {8, 8, 8}, {false, true, false}};
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      for (int k = 0; k < 8; ++k) s.add({i + 0.5, j + 0.5, k + 0.5}, 0.5);
  const WallDomain walls({{Wall::Shape::plane, {7.5, 0, 0}, {1, 0, 1}},
                          {Wall::Shape::plane, {8, 0, 8}, {-1, 0, 0}},
                          {Wall::Shape::plane, {8, 0, 8}, {0, 0, -1}}});
  const std::vector<Table> tables = measure("voronoi", {s.frame()}, {{"window", 1.0}}, walls);
  EXPECT_EQ(number(tables[1], "windows").value, 15 * 8);
  EXPECT_EQ(number(tables[0], "at_faces").value, 0);
}

TEST(Voronoi, RefusesTwoGrainsAtOnePlace) {
  Frame f = simple_cubic(3).frame();
  for (auto& column : f.particles.position) column[7] = column[20];
  try {
    measure("voronoi", {f});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("ids 8 and 21"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("scene.dump"), std::string::npos) << e.what();
  }
}

TEST(Diffusion, SaysWhichStepsAreRefused) {
  std::vector<Frame> frames = random_frames(3);
  frames[1].particles.velocity[0][3] = 100;
  const Table table = measure("diffusion", frames).at(0);
  ASSERT_FALSE(table.remarks.empty());
  EXPECT_TRUE(table.remarks.back().starts_with("2 steps between frames were refused")) << table.remarks.back();
}

TEST(SurfaceAngle, IsRefusedWhereBothHorizontalAxesArePeriodic) {
  const Table table = measure("surface_angle", random_frames(1)).at(0);
  EXPECT_TRUE(std::isnan(number(table, "angle").value));
  ASSERT_EQ(table.remarks.size(), 1U);
}

// Along x all grains move alike, along y each by itself.
TEST(VelocityCorrelationMeasurement, CorrelatesTheComponentsAskedFor) {
  std::vector<Frame> frames = random_frames(2);
  for (Frame& f : frames) std::fill(f.particles.velocity[0].begin(), f.particles.velocity[0].end(), 7.0);
  const auto at_two = [&](const std::vector<std::string>& components) {
    const Table t =
        measure("velocity_correlation", frames, {{"components", components}, {"about", std::string("none")}}).front();
    return t.columns[1].values[10];
  };
  EXPECT_NEAR(at_two({"x"}), 1, 1e-12);
  EXPECT_NEAR(at_two({"y"}), 0, 0.1);  // some thousand pairs: 3 %
  EXPECT_THROW(measure("velocity_correlation", frames, {{"components", std::vector<std::string>{}}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace grainvdb::testing::structure_test
