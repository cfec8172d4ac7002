// `grainvdb measure` and `grainvdb measurements`, and tables along with the fields of `grainvdb run`.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "cli/example_dumps.hpp"

namespace grainvdb::test::measure_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* of_frames = "measure:\n  pair_correlation: {bins: 20}\n";
constexpr const char* of_fields = "measure:\n  profile: {fields: [phi]}\n";

/// Nothing is said of a lattice and a kernel: distances between grains need neither.
std::string without_fields() {
  return "grainvdb: 1\ninput: {particles: frames/dump*.txt, units: si, dt: 1.0e-3}\n";
}

TEST(Measure, MakesTablesWithoutALattice) {
  const Folder folder;
  write_dumps(folder);
  folder.write("p.yaml", without_fields() + of_frames);
  for (const char* command : {"measure", "run"}) {
    const CommandResult result = run_command({command, "p.yaml", "-o", command}, folder.path());
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(folder.names_in(command), ElementsAre("run.json", "tables", "tables.h5"));
    EXPECT_THAT(result.out, AllOf(StartsWith("3 frames\n"), HasSubstr("table pair_correlation: 20 rows\n"),
                                  HasSubstr("closest 1 m"), HasSubstr(std::string("wrote ") + command + "/tables.h5")));
    EXPECT_EQ(result.err, "");
  }
}

TEST(Measure, LeavesOutFieldsAndTracers) {
  const Folder folder;
  write_dumps(folder);
  folder.write("p.yaml", pipeline_text() + of_frames + "trace: {seeds: {points: [[1, 1, 1.25]]}, steps: 2}\n");
  ASSERT_EQ(run_command({"measure", "p.yaml", "-o", "alone"}, folder.path()).exit_code, 0);
  EXPECT_THAT(folder.names_in("alone"), ElementsAre("run.json", "tables", "tables.h5"));
  ASSERT_EQ(run_command({"run", "p.yaml", "-o", "all"}, folder.path()).exit_code, 0);
  EXPECT_THAT(folder.names_in("all"),
              ElementsAre("fields.hdf", "run.json", "tables", "tables.h5", "tracers.h5", "tracers.xmf2"));
  EXPECT_EQ(read_file(folder / "all/tables/pair_correlation.csv"),
            read_file(folder / "alone/tables/pair_correlation.csv"));
}

TEST(Measure, MakesTablesOfFieldsThatAreNotWritten) {
  const Folder folder;
  write_dumps(folder);
  folder.write("p.yaml", pipeline_text() + of_fields);
  const CommandResult result = run_command({"measure", "p.yaml", "-o", "t"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(folder.names_in("t"), ElementsAre("run.json", "tables", "tables.h5"));
  EXPECT_THAT(result.out, HasSubstr("1 channel splatted per frame"));
}

TEST(Measure, GivesTheSameBytesForAnyNumberOfThreads) {
  const Folder folder;
  write_dumps(folder);
  folder.write("p.yaml", pipeline_text() + of_frames + "  profile: {fields: [phi, velocity]}\n");
  for (const char* threads : {"1", "2"})
    ASSERT_EQ(run_command({"measure", "p.yaml", "--threads", threads, "-o", threads}, folder.path()).exit_code, 0);
  EXPECT_TRUE(read_file(folder / "1/tables.h5") == read_file(folder / "2/tables.h5"));
}

TEST(Measure, LeavesOutBadFramesAndSaysSo) {
  const Folder folder;
  write_dumps(folder);
  std::string bad = dump_text(100);
  bad.replace(bad.rfind('2'), 1, "nonsense");
  folder.write("frames/dump100.txt", bad);
  folder.write("p.yaml", without_fields() + of_frames);
  const CommandResult stopped = run_command({"measure", "p.yaml"}, folder.path());
  EXPECT_EQ(stopped.exit_code, 0) << "the bad column, mass, is not read";
  folder.write("p.yaml", pipeline_text() + "measure:\n  plane_profile: {axis: z}\n");
  EXPECT_EQ(run_command({"measure", "p.yaml"}, folder.path()).exit_code, 2);
  const CommandResult skipped = run_command({"measure", "p.yaml", "--set", "input.on_error=skip_frame"}, folder.path());
  EXPECT_EQ(skipped.exit_code, 0) << skipped.err;
  EXPECT_THAT(skipped.err, HasSubstr("left out step 100"));
  EXPECT_THAT(skipped.out, HasSubstr("2 frames"));
}

TEST(Measure, RefusesWhatCannotBeMeant) {
  const Folder folder;
  write_dumps(folder);
  const auto error_of = [&](const std::string& text, const char* command = "measure") {
    folder.write("p.yaml", text);
    const CommandResult result = run_command({command, "p.yaml"}, folder.path());
    EXPECT_EQ(result.exit_code, 1);
    return result.err;
  };
  EXPECT_THAT(error_of(pipeline_text()), HasSubstr("there is nothing to measure"));
  EXPECT_THAT(error_of(pipeline_text() + "measure:\n  pair_corelation: {bins: 3}\n"),
              AllOf(HasSubstr("'pair_corelation'"), HasSubstr("pair_correlation")));
  EXPECT_THAT(error_of(without_fields() + "measure:\n  pair_correlation: {lo: [0, 1]}\n"),
              HasSubstr("measure.pair_correlation.lo does not fit; found 2 numbers; expected three numbers"));
  EXPECT_THAT(error_of(without_fields() + of_fields), HasSubstr("the section 'lattice' is missing"));
  EXPECT_THAT(error_of(without_fields() + "measure:\n  plane_profile: {axis: z}\n"),
              HasSubstr("the section 'lattice' is missing"));
  EXPECT_THAT(error_of(pipeline_text() + "scales: {cutoff: [1.5, 2], voxel: [0.5, 0.5]}\n" + of_frames, "run"),
              HasSubstr("frames are not measured at several scales"));
}

TEST(Measure, ValidateAndGraphKnowOfIt) {
  const Folder folder;
  write_dumps(folder);
  folder.write("p.yaml", without_fields() + of_frames);
  EXPECT_EQ(run_command({"validate", "p.yaml"}, folder.path()).out, "valid\n");
  const std::string graph = run_command({"graph", "p.yaml"}, folder.path()).out;
  EXPECT_THAT(graph, AllOf(HasSubstr("measured: pair_correlation: g(r)"), HasSubstr("radius of every frame"),
                           Not(HasSubstr("peak memory"))));
}

TEST(Measure, EstimatesPassesOverPlanes) {
  const Folder folder;
  write_dumps(folder);
  folder.write("p.yaml", pipeline_text() + "measure:\n  plane_profile: {axis: z, area: 1}\n");
  const std::string graph = run_command({"graph", "p.yaml"}, folder.path()).out;
  EXPECT_THAT(graph,
              AllOf(HasSubstr("peak memory of averages over planes normal to z: "), HasSubstr("64 for each plane")));
  const CommandResult dry = run_command({"measure", "p.yaml", "--dry-run"}, folder.path());
  ASSERT_EQ(dry.exit_code, 0) << dry.err;
  EXPECT_THAT(dry.out, AllOf(HasSubstr("step 0 alone: averages over planes, "), HasSubstr(" planes\nall frames: "),
                             HasSubstr(" MB by the formula"), Not(HasSubstr("active voxels"))));
  EXPECT_THAT(run_command({"measure", "p.yaml"}, folder.path()).out, HasSubstr(" MB by the formula"));
}

TEST(Measurements, AreListedWithTheirOptions) {
  const Folder folder;
  const auto said = [&](const std::vector<std::string>& arguments) {
    const CommandResult result = run_command(arguments, folder.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  };
  const auto all = nlohmann::json::parse(said({"measurements", "--json"}));
  ASSERT_FALSE(all.empty());
  const std::string table = said({"measurements"}), markdown = said({"measurements", "--markdown"});
  for (const auto& measurement : all) {
    const std::string name = measurement["name"];
    EXPECT_THAT(table, HasSubstr(name + ' '));
    EXPECT_THAT(markdown, HasSubstr("\n| `" + name + "` | "));
    for (const auto& option : measurement["options"])
      EXPECT_THAT(said({"measurements", name}), HasSubstr("option " + option["name"].get<std::string>() + " ("));
  }
  const CommandResult unknown = run_command({"measurements", "profil"}, folder.path());
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("Did you mean 'profile'?"));
}

}  // namespace
}  // namespace grainvdb::test::measure_test
