// `grainvdb trace`, and tracers along with the fields of `grainvdb run`.
#include <gmock/gmock.h>

#include "cli/example_dumps.hpp"

namespace grainvdb::test::trace_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// The example with tracers in its flow u_x = z.
Folder& add_trace(Folder& folder, const std::string& inside) {
  write_example(folder);
  folder.write("p.yaml", pipeline_text() + "trace:\n  seeds: {points: [[1, 1, 1.25], [2, 2, 2.75]]}\n" + inside);
  return folder;
}

TEST(Trace, WritesHistoriesAlone) {
  Folder folder;
  add_trace(folder, "  steps: 4\n  record: [phi, shear_rate]\n");
  const CommandResult result = run_command({"trace", "p.yaml", "-o", "paths"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(folder.names_in("paths"), ElementsAre("run.json", "tracers.h5", "tracers.xmf2"));
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("trace: 2 tracers, 5 samples: 2 moving to the end"), HasSubstr("wrote paths/tracers.h5"),
                    HasSubstr("paraview paths/tracers.xmf2"), HasSubstr("particles/tracers")));
  EXPECT_EQ(result.err, "");
}

TEST(Trace, GoesAlongWithARun) {
  Folder folder;
  add_trace(folder, "  through: frames\n  formats: [h5md, lammps]\n");
  const CommandResult result = run_command({"run", "p.yaml", "--set", "average.window=1", "-o", "both"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(folder.names_in("both"),
              ElementsAre("fields.hdf", "fields.xmf2", "run.json", "tracers.dump", "tracers.h5", "tracers.xmf2"));
  EXPECT_THAT(result.out, HasSubstr("trace: 2 tracers, 3 samples"));
  EXPECT_EQ(result.err, "");
}

TEST(Trace, GivesTheSameBytesForAnyNumberOfThreads) {
  Folder folder;
  add_trace(folder, "  steps: 4\n  record: [phi]\n");
  const auto bytes = [&](const std::string& threads) {
    const CommandResult result =
        run_command({"trace", "p.yaml", "-o", "t" + threads, "--threads", threads}, folder.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_file(folder / ("t" + threads + "/tracers.h5"));
  };
  const std::string one = bytes("1");
  EXPECT_FALSE(one.empty());
  EXPECT_TRUE(one == bytes("2"));
}

TEST(Trace, WarnsWhenHistoriesMeanNothing) {
  Folder folder;
  add_trace(folder, "  through: frames\n");
  // The frames are 1 s apart: K = 1 and Co up to 5.
  const CommandResult result =
      run_command({"trace", "p.yaml", "--set", "average.window=1", "--set", "input.dt=0.01", "-q"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, AllOf(HasSubstr("grainvdb: warning: histories through frames are not meaningful"),
                                HasSubstr("4 had K > 0.3"), HasSubstr("trace.through: mean")));
}

TEST(Trace, RefusesBeforeItComputes) {
  Folder folder;
  write_example(folder);
  CommandResult result = run_command({"trace", "p.yaml"}, folder.path());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("p.yaml: there is nothing to trace: the section 'trace' is missing"));
  add_trace(folder, "  through: frames\n");
  for (const char* command : {"trace", "validate", "run"}) {
    result = run_command({command, "p.yaml"}, folder.path());
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr("p.yaml:12: tracers move from one output time to the next, and there is one"));
  }
  result = run_command({"trace", "p.yaml", "--set", "average.window=none", "--set", "trace.seeds.points=[[1, 1, 90]]",
                        "--set", "select.region.lo=[0, 0, 0]", "--set", "select.region.hi=[4, 4, 0.1]"},
                       folder.path());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("no seed of a tracer lies in the material"));
  EXPECT_FALSE(std::filesystem::exists(folder / "output"));
}

TEST(Trace, StandsInTheGraph) {
  Folder folder;
  add_trace(folder, "  steps: 4\n  record: [phi]\n");
  const CommandResult text = run_command({"graph", "p.yaml"}, folder.path());
  EXPECT_THAT(text.out,
              HasSubstr("traced: through the time mean, by Runge-Kutta steps of order 4, recording phi and the "
                        "strain, as h5md\n"));
  const CommandResult dot = run_command({"graph", "p.yaml", "--dot"}, folder.path());
  EXPECT_THAT(dot.out, AllOf(HasSubstr("\"field:shear_rate\" -> \"tracers\""), HasSubstr("shape=folder")));
  write_example(folder);
  EXPECT_THAT(run_command({"graph", "p.yaml"}, folder.path()).out, Not(HasSubstr("traced")));
}

}  // namespace
}  // namespace grainvdb::test::trace_test
