// A relaxed run gives back what made it, by comparison with relaxed runs of known parameters.
#include "spot/comparison.hpp"

#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include "grainvdb/plan.hpp"
#include "grainvdb/run.hpp"
#include "spot/calibration.hpp"
#include "spot/run_spot.hpp"
#include "spot/spot_file.hpp"
#include "support/dump_text.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::spot::comparison_test {
namespace {

using ::testing::HasSubstr;

const std::string silo = R"(grainvdb: 1
packing: {random: {phi: 0.58}}
container:
  lo: [-13, 0, 0]
  hi: [13, 8, 14]
  periodic: [y]
  orifice: {width: 4}
spots:
  radius: 2.2
  influence: 400
  step: [0.6, 0.6, 0.1]
  hop_rate: 28
  insertion_rate: 240
  entry: spread
  wall_distance: 1
output: {interval: 0.1, end: 9.9, from: 6}
seed: 2
)";

std::string pipeline_of(const std::string& folder) {
  return "grainvdb: 1\ninput: {particles: " + folder + R"(/spot_*.dump}
lattice: {voxel: 1}
kernel: {cutoff: 3}
average: {window: 8}
measure:
  spot_calibration:
    lo: [-8, 0, 3]
    hi: [8, 8, 10]
    slot_width: 4
    side_walls: [-13, 13]
    lowest: 3
    highest: 9
    half_width: 12
    reach: 5
    lags: 5
    flow_from: 60
    phi_at_rest: 0.63
)";
}

/// A relaxed run and its direct calibration.
class Comparison : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new testing::TemporaryFolder;
    const std::string file = folder_->path() + "/silo.yaml", dumps = folder_->path() + "/dumps";
    testing::write_plain(file, silo);
    run_spot(load_spot_run(file), dumps);
    testing::write_plain(folder_->path() + "/pipeline.yaml", pipeline_of(dumps));
    pipeline_ = new Pipeline(load_pipeline(folder_->path() + "/pipeline.yaml"));
    source_ = open_dumps(pipeline_->input).release();
    direct_ = new Table(run_pipeline(*pipeline_, make_plan(*pipeline_), *source_, {}).tables.front());
  }
  static void TearDownTestSuite() {
    delete direct_;
    delete source_;
    delete pipeline_;
    delete folder_;
  }

  static Table compare(const ComparisonOptions& options) {
    return calibrate_by_comparison(*pipeline_, *direct_, *source_, options, folder_->path());
  }

  inline static testing::TemporaryFolder* folder_ = nullptr;
  inline static Pipeline* pipeline_ = nullptr;
  inline static FrameSource* source_ = nullptr;
  inline static Table* direct_ = nullptr;
};

const Quantity& number(const Table& table, const std::string& name) {
  for (const Quantity& q : table.numbers)
    if (q.name == name) return q;
  throw std::out_of_range(name);
}

double errors_off(const Quantity& q, double truth) {
  return std::abs(q.value - truth) / q.error;
}

TEST_F(Comparison, GivesBackWhatMadeARelaxedRun) {
  const Table t = compare({.rounds = 4, .runs = 2});
  const auto expect = [&](const char* name, double truth) {
    EXPECT_LT(errors_off(number(t, name), truth), 3) << name;
    EXPECT_LT(number(t, name).error, 0.6 * truth) << name;
  };
  expect("radius", 2.2);
  expect("b", 1.8);
  expect("influence", 400);
  expect("hop_rate", 28);
  expect("insertion_rate", 240);
  EXPECT_GT(errors_off(number(*direct_, "radius"), 2.2), 3);
  EXPECT_GT(errors_off(number(*direct_, "insertion_rate"), 240), 3);
  EXPECT_GE(t.columns.front().values.size(), 4U);
  EXPECT_FALSE(std::filesystem::exists(folder_->path() + "/comparison_runs"));
  // A spot file can be made of it.
  const std::string file = folder_->path() + "/corrected.yaml";
  testing::write_plain(file, calibrated_spot_file(*pipeline_, t, *source_));
  EXPECT_NEAR(load_spot_run(file).parameters.radius, number(t, "radius").value, 1e-3);
}

// Short runs tell little, but the same on any number of threads.
TEST_F(Comparison, IsReproducible) {
  const ComparisonOptions brief{.rounds = 1, .runs = 2, .duration = 1, .height = 11};
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return compare(brief);
  };
  const Table one = on(1), two = on(2);
  ASSERT_EQ(one.numbers.size(), two.numbers.size());
  for (std::size_t k = 0; k < one.numbers.size(); ++k)
    EXPECT_EQ(std::to_string(one.numbers[k].value), std::to_string(two.numbers[k].value)) << one.numbers[k].name;
}

TEST_F(Comparison, RefusesFramesWithoutFlow) {
  Pipeline p = *pipeline_;
  p.measure.at("spot_calibration").at("flow_from") = std::int64_t{99};
  try {
    calibrate_by_comparison(p, *direct_, *source_, {}, folder_->path());
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("there is no flow to compare with; found 1 frames with a time"));
  }
}

}  // namespace
}  // namespace grainvdb::spot::comparison_test
