// The pipelines that come with the project, as they are, on the dumps that come with it.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/measurement.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/scales.hpp"
#include "support/memory_tracers.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::testing::pipelines_test {
namespace {

std::string folder() {
  return in_repository("pipelines");
}

/// Mean over the frames of ΣV of the material.
double particle_volume(FrameSource& source, const Pipeline& p) {
  const ColumnSet all = Column::velocity | Column::angular_velocity | Column::radius | Column::mass | Column::type;
  double sum = 0;
  for (std::size_t k = 0; k < source.frames().size(); ++k) {
    const Particles grains = material(source.read(k, all), p.select);
    for (double r : grains.radius) sum += sphere_volume(r);
  }
  return sum / static_cast<double>(source.frames().size());
}

class ShippedPipeline : public ::testing::TestWithParam<const char*> {};

TEST_P(ShippedPipeline, Runs) {
  const Pipeline p = load_pipeline(folder() + "/" + GetParam() + ".yaml");
  const auto source = open_dumps(p.input);
  const Result r = run(p, *source);
  EXPECT_TRUE(r.record.committed);
  const Written& w = r.only();
  EXPECT_EQ(w.time.frame_count, source->frames().size());

  double volume = 0;
  for (const std::string& name : p.fields) {
    const FieldCopy& field = w.field(name);
    std::size_t defined = 0;
    std::size_t voxels = 0;
    field.for_each_active([&](const Coord& c) {
      ++voxels;
      defined += std::isfinite(field.at(c)) ? 1U : 0U;
      if (name == "phi") volume += static_cast<double>(field.at(c)) * std::pow(p.voxel, 3);
    });
    EXPECT_GT(2 * defined, voxels) << name << " is undefined nearly everywhere";
  }
  // h³Σφ = ΣV: at c/h = 6 a particle's sum is within 2.4e-5 of its volume, and the sums are exact to 1e-5.
  EXPECT_DOUBLE_EQ(p.cutoff / p.voxel, 6);
  const double expected = particle_volume(*source, p);
  EXPECT_NEAR(volume, expected, (2.4e-5 + 1e-5) * expected);
}

INSTANTIATE_TEST_SUITE_P(Pipelines, ShippedPipeline, ::testing::Values("minimal", "shear_cell", "silo"),
                         [](const auto& param) { return std::string(param.param); });

TEST(ShippedPipelines, FollowElementsThroughTheSilo) {
  const Pipeline p = load_pipeline(folder() + "/silo_elements.yaml");
  const auto source = open_dumps(p.input);
  const Histories h = trace(p, *source);
  EXPECT_EQ(h.layout.id.size(), 18U);
  EXPECT_EQ(h.layout.fields.size(), p.trace->record.size());
  EXPECT_TRUE(h.report.trace->is_meaningful());
  const TracerSample& last = h.samples.back();
  std::size_t through_the_slot = 0;
  for (std::size_t i = 0; i < h.layout.id.size(); ++i) {
    EXPECT_LT(last.displacement[2][i], 0);
    EXPECT_GT(last.strain[i], 0.5);
    EXPECT_TRUE(std::isfinite(last.fields[3][i])) << "mu";
    through_the_slot += last.position[2][i] < 1 && std::abs(last.position[0][i]) < 3 ? 1U : 0U;
  }
  EXPECT_GT(through_the_slot, 9U);  // the others are still beside it
}

TEST(ShippedPipelines, PlateauRunsAtAllItsScales) {
  const Pipeline p = load_pipeline(folder() + "/plateau.yaml");
  ASSERT_EQ(p.scales.size(), 4U);
  const auto source = open_dumps(p.input);
  std::vector<ScaleRun> runs;
  std::vector<std::shared_ptr<Record>> records;
  for (Pipeline& at : at_scales(p)) {
    ScaleRun& run = runs.emplace_back();
    run.plan = make_plan(at);
    run.sinks.push_back(std::make_unique<MemorySink>(records.emplace_back(std::make_shared<Record>())));
    run.pipeline = std::move(at);
  }
  run_scales(runs, *source);
  // h³Σφ = ΣV: a particle's sum is within 2.2e-3 of its volume at c/h of 3 and more.
  const double expected = particle_volume(*source, p);
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const FieldCopy& phi = records[n]->times.at(0).field("phi");
    double volume = 0;
    phi.for_each_active([&](const Coord& c) { volume += static_cast<double>(phi.at(c)); });
    EXPECT_NEAR(volume * std::pow(runs[n].pipeline.voxel, 3), expected, 2.3e-3 * expected);
  }
}

/// Makes the tables of a pipeline and writes nothing.
RunReport measure(const Pipeline& p) {
  const auto source = open_dumps(p.input);
  const std::vector<std::unique_ptr<FieldSink>> no_fields;
  return run_pipeline(p, make_plan(p), *source, no_fields);
}

class ShippedMeasurements : public ::testing::TestWithParam<std::string> {};

TEST_P(ShippedMeasurements, MakeTheirTables) {
  Pipeline p = load_pipeline(folder() + '/' + GetParam() + ".yaml");
  p.fields.clear();
  const RunReport report = measure(p);
  EXPECT_GE(report.tables.size(), p.measure.size());
  for (const Table& table : report.tables) {
    bool known = false;
    for (const TableColumn& column : table.columns) {
      EXPECT_EQ(column.values.size(), table.columns.front().values.size()) << table.name << ' ' << column.name;
      EXPECT_FALSE(column.unit.empty()) << table.name << ' ' << column.name;
      known =
          known || std::any_of(column.values.begin(), column.values.end(), [](double x) { return std::isfinite(x); });
    }
    for (const Quantity& number : table.numbers) known = known || std::isfinite(number.value);
    EXPECT_TRUE(known || !table.remarks.empty()) << table.name << " says nothing";
  }
}

INSTANTIATE_TEST_SUITE_P(Pipelines, ShippedMeasurements,
                         ::testing::Values("fluidity", "kinematic", "plasticity", "rheology", "spot_calibrate",
                                           "spot_compare", "structure"),
                         [](const auto& param) { return std::string(param.param); });

/// The numbers of the tables of a pipeline's measurements, by table and name.
std::map<std::string, Quantity> numbers_of(const Pipeline& p) {
  std::map<std::string, Quantity> numbers;
  for (const Table& table : measure(p).tables)
    for (const Quantity& q : table.numbers) numbers[table.name + '.' + q.name] = q;
  return numbers;
}

TEST(ShippedPipelines, MeasureThePackingOfTheSilo) {
  const Pipeline p = load_pipeline(folder() + "/structure.yaml");
  EXPECT_TRUE(p.fields.empty());
  auto n = numbers_of(p);
  const auto expect_between = [&](const std::string& name, double least, double most) {
    EXPECT_GT(n.at(name).value, least) << name;
    EXPECT_LT(n.at(name).value, most) << name;
  };
  // Stiff spheres that flow densely, and collide more than they rest on each other: a count of the contact dumps by
  // hand gave 1.53 and 1.67 contacts a grain in the first and last frame, a count of grains a packing fraction of
  // 0.579.
  expect_between("pair_correlation.closest", 0.99, 1);
  expect_between("pair_correlation.peak", 0.97, 1.05);
  expect_between("overlap.largest", 0, 0.01);
  expect_between("coordination.coordination", 1.4, 1.8);
  expect_between("coordination.rattlers", 0.5, 0.9);
  expect_between("voronoi.phi", 0.57, 0.59);
  expect_between("voronoi_windows.by_volume", 0.56, 0.60);
  EXPECT_LT(n.at("voronoi_windows.by_cells_deviation").value, n.at("voronoi_windows.by_centres_deviation").value);
  expect_between("velocity_correlation.correlation_radius", 0.5, 8);
  expect_between("surface_angle.angle", 0, 35);
  EXPECT_GT(n.at("diffusion.diffusion_length_x").value, -3 * n.at("diffusion.diffusion_length_x").error);
}

// Files of the spot and the void model make dumps; they are tested with that command.
TEST(ShippedPipelines, AreAllTested) {
  std::vector<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(folder())) names.push_back(file.path().stem());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"fluidity", "kinematic", "minimal", "plasticity", "plateau", "rheology",
                                             "shear_cell", "silo", "silo_elements", "spot_calibrate", "spot_compare",
                                             "spot_silo", "structure", "void_silo"}));
}

}  // namespace
}  // namespace grainvdb::testing::pipelines_test
