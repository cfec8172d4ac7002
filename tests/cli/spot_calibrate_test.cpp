/// The calibration of the spot model as a user runs it: dumps of a silo in, a spot file out that runs.
#include <filesystem>

#include <gmock/gmock.h>

#include "cli/command.hpp"
#include "cli/json_lines.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::test::spot_calibrate_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::string shipped_pipeline() {
  return ::grainvdb::testing::in_repository("pipelines/spot_calibrate.yaml");
}

CommandResult calibrate(const Folder& folder, const std::vector<std::string>& options) {
  std::vector<std::string> arguments{"spot", "calibrate", shipped_pipeline(), "-o", "c"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return run_command(arguments, folder.path());
}

TEST(SpotCalibrate, HelpHasExamples) {
  const Folder folder;
  const CommandResult result = run_command({"spot", "calibrate", "--help"}, folder.path());
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("Examples:\n  grainvdb spot calibrate "), HasSubstr("--frames")));
  EXPECT_EQ(result.err, "");
  const CommandResult above = run_command({"spot", "--help"}, folder.path());
  EXPECT_THAT(above.out, HasSubstr("grainvdb spot calibrate"));
}

TEST(SpotCalibrate, MakesAFileThatRuns) {
  const Folder folder;
  const CommandResult result = calibrate(folder, {});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("table spot_calibration: "), HasSubstr("\n  radius "), HasSubstr(" +- "),
                                HasSubstr("\n  insertion_rate "), HasSubstr("wrote c/spot.yaml\n"),
                                Not(HasSubstr("table spot_calibration_"))));
  EXPECT_THAT(folder.names_in("c"), ElementsAre("run.json", "spot.yaml", "tables", "tables.h5"));
  EXPECT_THAT(folder.names_in("c/tables"),
              ElementsAre("numbers.csv", "spot_calibration.csv", "spot_calibration_diffusion.csv",
                          "spot_calibration_kinematic_fit.csv", "spot_calibration_kinematic_width.csv",
                          "spot_calibration_velocity_correlation.csv"));
  const CommandResult spots =
      run_command({"spot", "run", "c/spot.yaml", "-o", "spot", "--set", "output.end=0.3"}, folder.path());
  ASSERT_EQ(spots.exit_code, 0) << spots.err;
  EXPECT_THAT(spots.out, HasSubstr("2 snapshots until time 0.3 in spot"));
}

// Two short runs of a low packing: what they tell is rough, the estimates of the sample silo are too.
TEST(SpotCalibrate, CorrectsByComparison) {
  const Folder folder;
  const CommandResult result = calibrate(folder, {"--by-comparison", "--rounds", "1", "--runs", "2", "--duration",
                                                  "0.6", "--height", "18", "--seed", "3"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("table spot_calibration_by_comparison: 2 rows"), HasSubstr("\n  radius_bias "),
                    HasSubstr("table spot_calibration: "), HasSubstr("wrote c/spot.yaml\n")));
  EXPECT_THAT(folder.names_in("c"), ElementsAre("run.json", "spot.yaml", "tables", "tables.h5"));
  const CommandResult alone = calibrate(folder, {"--runs", "4"});
  EXPECT_EQ(alone.exit_code, 1);
  EXPECT_THAT(alone.err, HasSubstr("--by-comparison"));
}

TEST(SpotCalibrate, SaysBeforeWhatItWouldMeasure) {
  const Folder folder;
  const CommandResult dry = calibrate(folder, {"--dry-run", "--by-comparison", "--rounds", "2", "--runs", "3"});
  ASSERT_EQ(dry.exit_code, 0) << dry.err;
  EXPECT_THAT(dry.out, AllOf(HasSubstr("measured: spot_calibration: "), HasSubstr("would use "),
                             HasSubstr("at most 2 x 3 runs of the spot file")));
  EXPECT_FALSE(std::filesystem::exists(folder / "c"));
  EXPECT_EQ(calibrate(folder, {"--dry-run", "--set", "measure.spot_calibration.slot_width=0"}).exit_code, 1);
}

TEST(SpotCalibrate, LogsFramesAndErrors) {
  const Folder folder;
  const CommandResult result = calibrate(folder, {"--quiet", "--log-json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "");
  const auto events = json_lines(result.err);
  ASSERT_GE(events.size(), 1U);
  EXPECT_EQ(events.front()["event"], "progress");
  const auto errors =
      json_lines(calibrate(folder, {"--log-json", "--set", "measure.spot_calibration.slot_width=0"}).err);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0]["kind"], "config");
}

TEST(SpotCalibrate, IsQuietWhenAsked) {
  const Folder folder;
  const CommandResult result = calibrate(folder, {"--quiet", "--threads", "1"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err, "");
}

TEST(SpotCalibrate, NamesTheKeyThatIsWrong) {
  const Folder folder;
  const CommandResult width = calibrate(folder, {"--set", "measure.spot_calibration.slot_width=0"});
  EXPECT_EQ(width.exit_code, 1);
  EXPECT_THAT(width.err, AllOf(StartsWith("grainvdb: --set"), HasSubstr("measure.spot_calibration.slot_width is 0")));

  const CommandResult key = calibrate(folder, {"--set", "measure.spot_calibration.slot_with=6"});
  EXPECT_EQ(key.exit_code, 1);
  EXPECT_THAT(key.err, HasSubstr("Did you mean 'slot_width'?"));

  const CommandResult walls = calibrate(folder, {"--set", "measure.spot_calibration.side_walls=[5, -5]"});
  EXPECT_EQ(walls.exit_code, 1);
  EXPECT_THAT(walls.err, HasSubstr("measure.spot_calibration.side_walls"));

  const CommandResult none =
      run_command({"spot", "calibrate", ::grainvdb::testing::in_repository("pipelines/kinematic.yaml")}, folder.path());
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, AllOf(HasSubstr("kinematic.yaml: there is nothing to calibrate"),
                              HasSubstr("'measure.spot_calibration' is missing")));

  const CommandResult file = run_command({"spot", "calibrate", "nothing.yaml"}, folder.path());
  EXPECT_EQ(file.exit_code, 3);
  EXPECT_THAT(file.err, HasSubstr("nothing.yaml"));
}

// The first frame is no packing at rest here, and what flows later is no looser.
TEST(SpotCalibrate, SaysWhichParameterTheFramesDoNotTell) {
  const Folder folder;
  const CommandResult result = calibrate(folder, {"--set", "measure.spot_calibration.phi_at_rest=0.5"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("spot_calibrate.yaml:"), HasSubstr("do not tell every parameter"),
                                HasSubstr("hop_rate (nan)"), HasSubstr("no looser than")));
  EXPECT_THAT(folder.names_in("c"), ElementsAre("run.json", "tables", "tables.h5"));
}

}  // namespace
}  // namespace grainvdb::test::spot_calibrate_test
