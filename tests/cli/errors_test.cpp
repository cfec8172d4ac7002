/// The exit code and the message of each kind of error. `run` and `validate` must agree on all of them.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"

namespace grainvdb::test::errors_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::string with(const std::string& from, const std::string& to) {
  std::string text = pipeline_text();
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("no '" + from + "' in the file");
  return text.replace(at, from.size(), to);
}

// Both commands refuse p.yaml with this exit code and a message that matches; nothing is written.
void expect_refused(const Folder& folder, int exit_code, const testing::Matcher<std::string>& message,
                    const std::vector<std::string>& options = {}) {
  for (const char* command : {"run", "validate"}) {
    std::vector<std::string> arguments{command, "p.yaml"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const CommandResult result = run_command(arguments, folder.path());
    EXPECT_EQ(result.exit_code, exit_code) << command << '\n' << result.err;
    EXPECT_THAT(result.err, message) << command;
    EXPECT_EQ(result.out, "") << command;
  }
  EXPECT_THAT(folder.names_in("output"), testing::IsEmpty());
}

TEST(Errors, BadPipelineFilesExitWithOne) {
  const Folder folder;
  write_example(folder);
  folder.write("p.yaml", with("cutoff", "cutof"));
  expect_refused(folder, 1,
                 AllOf(StartsWith("grainvdb: p.yaml:8: unknown key 'cutof'"), HasSubstr("Did you mean 'cutoff'?")));
  folder.write("p.yaml", with("velocity]", "velocitty]"));
  expect_refused(folder, 1,
                 AllOf(StartsWith("grainvdb: p.yaml:9: "), HasSubstr("expected one of "),
                       HasSubstr("Did you mean 'velocity'?"), Not(HasSubstr("temperature"))));
  folder.write("p.yaml", with("velocity]", "xyz]"));
  expect_refused(folder, 1, AllOf(HasSubstr("expected phi, density, "), HasSubstr("temperature")));
  folder.write("p.yaml", with("0.5", "-0.5"));
  expect_refused(folder, 1,
                 StartsWith("grainvdb: p.yaml:7: lattice.voxel is too small; found '-0.5'; expected a number > 0"));
  folder.write("p.yaml", pipeline_text() + "kernel: {cutoff: 1}\n");
  expect_refused(folder, 1, StartsWith("grainvdb: p.yaml:10: the key 'kernel' is repeated"));
  folder.write("p.yaml", "");
  expect_refused(folder, 1, StartsWith("grainvdb: p.yaml: the pipeline file is empty"));
}

TEST(Errors, OverridesAreCheckedLikeTheFile) {
  const Folder folder;
  write_example(folder);
  expect_refused(folder, 1, StartsWith("grainvdb: --set kernel.cutof=1: unknown key 'cutof'"),
                 {"--set", "kernel.cutof=1"});
  expect_refused(folder, 1, StartsWith("grainvdb: --set kernel.cutoff=wide: kernel.cutoff is not a number"),
                 {"--set", "kernel.cutoff=wide"});
}

TEST(Errors, PipelinesThatDoNotFitTheDumpExitWithOne) {
  const Folder folder;
  write_example(folder);
  folder.write("p.yaml", with("1.5", "2.5"));  // half the box is 2
  expect_refused(folder, 1, AllOf(StartsWith("grainvdb: p.yaml:8: "), HasSubstr("half the periodic box")));
  folder.write("p.yaml", with("0.5", "0.7"));  // 4/0.7 voxels
  expect_refused(folder, 1, AllOf(StartsWith("grainvdb: p.yaml:7: "), HasSubstr("whole number")));
  folder.write("p.yaml", pipeline_text() + "frames: '7:'\n");
  expect_refused(folder, 1, AllOf(StartsWith("grainvdb: p.yaml:10: "), HasSubstr("no frame")));
  folder.write("p.yaml", with("  contacts: {files: frames/contacts*.txt}\n", ""));
  expect_refused(folder, 1, HasSubstr("contacts"), {"--set", "output.fields=[contact_stress]"});
}

TEST(Errors, BadDumpsExitWithTwo) {
  const Folder folder;
  write_example(folder);
  std::string text = dump_text(0);
  folder.write("frames/dump0.txt", text.replace(text.find("2.5"), 3, "nan"));
  expect_refused(folder, 2, HasSubstr("frames/dump0.txt:"));
  folder.write("frames/dump0.txt", dump_text(0, "id type x y z radius mass"));
  expect_refused(folder, 2, AllOf(HasSubstr("frames/dump0.txt"), HasSubstr("vx")));
  folder.write("frames/dump0.txt", "not a dump\n");
  expect_refused(folder, 2, HasSubstr("frames/dump0.txt"));
  folder.write("p.yaml", with("dump*", "nothing*"));
  expect_refused(folder, 2, AllOf(HasSubstr("p.yaml:3"), HasSubstr("nothing*")));
}

TEST(Errors, FilesThatCannotBeReadExitWithThree) {
  const Folder folder;
  write_dumps(folder);
  expect_refused(folder, 3,
                 AllOf(StartsWith("grainvdb: p.yaml: cannot open the pipeline file"), HasSubstr("No such file")));
}

TEST(Errors, ExceededLimitsExitWithFour) {
  const Folder folder;
  write_example(folder);
  expect_refused(folder, 4, AllOf(HasSubstr("spans a box of too many voxels"), HasSubstr("limits.dense_voxels = 100")),
                 {"--set", "limits.dense_voxels=100"});
  // 4 Terabytes: refused before anything is allocated or takes long.
  const CommandResult big =
      run_command({"run", "p.yaml", "--set", "lattice.voxel=0.001", "--set", "limits.dense_voxels=1000000000000000000"},
                  folder.path());
  EXPECT_EQ(big.exit_code, 4);
  EXPECT_THAT(big.err, AllOf(HasSubstr("needs more memory than is allowed"), HasSubstr("limits.memory_gb")));
  EXPECT_THAT(folder.names_in("output"), testing::IsEmpty());
}

TEST(Errors, OutputFoldersThatCannotBeMadeExitWithThree) {
  const Folder folder;
  write_example(folder);
  folder.write("a_file", "text");
  for (const char* bad : {"a_file", "a_file/below", "a_file/far/below", "/proc/no_such_folder"}) {
    const CommandResult result = run_command({"run", "p.yaml", "--output", bad}, folder.path());
    EXPECT_EQ(result.exit_code, 3) << bad << '\n' << result.err;
    EXPECT_THAT(result.err, AllOf(StartsWith("grainvdb: "), HasSubstr(bad))) << bad;
  }
  EXPECT_EQ(read_file(folder / "a_file"), "text");
}

TEST(Errors, ValidateFindsWhatWouldFailLater) {
  const Folder folder;
  write_example(folder);
  const CommandResult good = run_command({"validate", "p.yaml"}, folder.path());
  EXPECT_EQ(good.exit_code, 0) << good.err;
  EXPECT_EQ(good.out, "valid\n");
  // The dumps are looked at only when wanted.
  folder.write("p.yaml", with("dump*", "nothing*"));
  EXPECT_EQ(run_command({"validate", "p.yaml"}, folder.path()).exit_code, 2);
  EXPECT_EQ(run_command({"validate", "p.yaml", "--no-input"}, folder.path()).exit_code, 0);
  EXPECT_EQ(run_command({"validate", "p.yaml", "--no-input", "--set", "kernel.cutoff=0"}, folder.path()).exit_code, 1);
}

TEST(Errors, ValidateGivesTheVerdictAsJson) {
  const Folder folder;
  write_example(folder);
  const auto verdict = [&](const std::vector<std::string>& options, int exit_code) {
    std::vector<std::string> arguments{"validate", "p.yaml", "--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const CommandResult result = run_command(arguments, folder.path());
    EXPECT_EQ(result.exit_code, exit_code) << result.out;
    EXPECT_EQ(result.err, "");
    return nlohmann::json::parse(result.out);
  };
  EXPECT_EQ(verdict({}, 0), nlohmann::json({{"valid", true}}));
  folder.write("p.yaml", with("0.5", "-0.5"));
  nlohmann::json error{{"kind", "config"}, {"exit_code", 1}, {"file", "p.yaml"}, {"line", 7}};
  error["what"] = "lattice.voxel is too small";
  error["found"] = "'-0.5'";
  error["expected"] = "a number > 0 [length]";
  error["hint"] = "Numbers are given without their unit, in the unit system of the dump.";
  error["message"] =
      "p.yaml:7: lattice.voxel is too small; found '-0.5'; expected a number > 0 [length]. Numbers are given without "
      "their unit, in the unit system of the dump.";
  EXPECT_EQ(verdict({}, 1), nlohmann::json({{"valid", false}, {"error", error}}));
  folder.write("p.yaml", with("0.5", "\xff"));  // not UTF-8
  EXPECT_EQ(verdict({}, 1)["error"]["kind"], "config");
  folder.write("p.yaml", with("dump*", "nothing*"));
  EXPECT_EQ(verdict({}, 2)["error"]["kind"], "input");
  folder.write("p.yaml", with("cutoff", "cutof"));
  EXPECT_THAT(verdict({}, 1)["error"]["hint"].get<std::string>(), HasSubstr("Did you mean 'cutoff'?"));
}

// The dump of step 0 with another first coordinate of particle 1, in a box that is open along x.
void write_with_stray(const Folder& folder, const std::string& x, const std::string& boundary) {
  std::string text = dump_text(0);
  text.replace(text.find("pp pp pp"), 2, boundary);
  text.replace(text.find("\n1 1 0.5 ") + 5, 3, x);
  folder.write("frames/dump0.txt", text);
}

TEST(Errors, StrayParticlesAreRefusedUnlessSelectLeavesThemOut) {
  const Folder folder;
  write_example(folder);
  const auto run = [&](std::vector<std::string> options) {
    std::vector<std::string> arguments{"run", "p.yaml", "--frames", "0"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_command(arguments, folder.path());
  };
  for (const std::string boundary : {"ff", "pp"}) {
    write_with_stray(folder, "1e30", boundary);
    const CommandResult refused = run({});
    EXPECT_EQ(refused.exit_code, 4) << boundary;
    EXPECT_THAT(refused.err,
                AllOf(HasSubstr("particle 1 of step 0 lies too far from the box"), HasSubstr("x = 1.0e+30")));
    EXPECT_EQ(run_command({"validate", "p.yaml", "--set", "frames=0"}, folder.path()).err, refused.err) << boundary;
    EXPECT_EQ(run({"--set", "select.ids=[2,64]"}).exit_code, 0) << boundary;
  }
}

TEST(Errors, ASelectionThatKeepsNothingIsRefused) {
  const Folder folder;
  write_example(folder);
  for (const char* fields : {"output.fields=[phi]", "output.fields=[stress]"}) {
    const CommandResult result =
        run_command({"run", "p.yaml", "--set", "select.types=[7]", "--set", fields}, folder.path());
    EXPECT_EQ(result.exit_code, 2) << fields;
    EXPECT_THAT(result.err, AllOf(HasSubstr("no material in any of the frames; found types 1, 2 at step 0"),
                                  HasSubstr("which wants type 7")));
  }
  const CommandResult scales = run_command({"run", "p.yaml", "--set", "select.types=[7, 9]", "--set",
                                            "scales.cutoff=[1.5, 2]", "--set", "scales.voxel=[0.5, 0.5]"},
                                           folder.path());
  EXPECT_EQ(scales.exit_code, 2);
  EXPECT_THAT(scales.err, AllOf(HasSubstr("found types 1, 2 at step 0"), HasSubstr("which wants types 7, 9")));
  const CommandResult by_id = run_command({"run", "p.yaml", "--set", "select.ids=[100, 200]"}, folder.path());
  EXPECT_EQ(by_id.exit_code, 2);
  EXPECT_THAT(by_id.err, Not(HasSubstr("type")));
  EXPECT_THAT(folder.names_in("output"), testing::IsEmpty());
}

}  // namespace
}  // namespace grainvdb::test::errors_test
