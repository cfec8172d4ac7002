// The pipelines that come with the project, as they are, on the dumps that come with it.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/scales.hpp"
#include "support/memory_tracers.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::testing {
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

TEST(ShippedPipelines, AreAllTested) {
  std::vector<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(folder()))
    if (!file.path().stem().string().starts_with("spot_")) names.push_back(file.path().stem());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"kinematic", "minimal", "plasticity", "plateau", "shear_cell", "silo",
                                             "silo_elements"}));
}

}  // namespace
}  // namespace grainvdb::testing
