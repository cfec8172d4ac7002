/// The spot model as a user runs it: the shipped file makes dumps that the other commands read.
#include <gmock/gmock.h>

#include "cli/command.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::test::spot_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string shipped_file() {
  return ::grainvdb::testing::in_repository("pipelines/spot_silo.yaml");
}

TEST(Spot, DumpsOfTheShippedFileMakeFields) {
  const Folder folder;
  const CommandResult spots = run_command({"spot", "run", shipped_file(), "--output", "spot"}, folder.path());
  ASSERT_EQ(spots.exit_code, 0) << spots.err;
  EXPECT_THAT(spots.out, HasSubstr("5 snapshots until time 2 in spot"));

  folder.write("p.yaml", R"(grainvdb: 1
input: {particles: spot/*.dump}
lattice: {voxel: 0.5}
kernel: {cutoff: 3}
output: {fields: [phi, velocity]}
)");
  const CommandResult fields = run_command({"run", "p.yaml"}, folder.path());
  EXPECT_EQ(fields.exit_code, 0) << fields.err;
  EXPECT_THAT(fields.out, AllOf(HasSubstr("5 frames,"), HasSubstr("wrote output/fields.hdf")));
}

TEST(Spot, OneSeedGivesTheSameDumpsAndAnotherGivesOthers) {
  const Folder folder;
  const auto last_dump = [&](const std::string& name, const std::string& seed) {
    const CommandResult result = run_command(
        {"spot", "run", shipped_file(), "-o", name, "--set", "output.end=0.5", "--set", "seed=" + seed}, folder.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::string last;
    for (const std::string& file : folder.names_in(name))
      if (file.ends_with(".dump")) last = file;
    return read_file(folder / (name + "/" + last));
  };
  const std::string first = last_dump("one", "1");
  EXPECT_THAT(first, HasSubstr("ITEM: TIME\n0.5\n"));
  EXPECT_EQ(first, last_dump("two", "1"));
  EXPECT_NE(first, last_dump("three", "2"));
}

TEST(Spot, ForcesThatThereAreNotAreMissed) {
  const Folder folder;
  ASSERT_EQ(
      run_command({"spot", "run", shipped_file(), "-o", "spot", "--set", "output.end=0.5"}, folder.path()).exit_code,
      0);
  folder.write("p.yaml", R"(grainvdb: 1
input: {particles: spot/*.dump}
lattice: {voxel: 0.5}
kernel: {cutoff: 3}
output: {fields: [mu]}
)");
  const CommandResult result = run_command({"run", "p.yaml"}, folder.path());
  EXPECT_NE(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("contact"));
}

TEST(Spot, FilesOfTheOtherKindAreToldApart) {
  const Folder folder;
  for (const char* command : {"run", "validate"}) {
    const CommandResult result = run_command({command, shipped_file()}, folder.path());
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err,
                AllOf(HasSubstr("spot_silo.yaml:"), HasSubstr("this is a spot file"), HasSubstr("grainvdb spot run")));
  }
  const CommandResult result =
      run_command({"spot", "run", ::grainvdb::testing::in_repository("pipelines/silo.yaml")}, folder.path());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("this is a pipeline file"), HasSubstr("'grainvdb run'")));
}

TEST(Spot, VoidsMakeDumpsThatMakeFields) {
  const Folder folder;
  const CommandResult voids = run_command(
      {"spot", "run", ::grainvdb::testing::in_repository("pipelines/void_silo.yaml"), "-o", "voids"}, folder.path());
  ASSERT_EQ(voids.exit_code, 0) << voids.err;
  EXPECT_THAT(voids.out, AllOf(HasSubstr("5 snapshots until time 2 in voids"), HasSubstr("\nvoids: ")));
  folder.write("p.yaml", R"(grainvdb: 1
input: {particles: voids/*.dump}
lattice: {voxel: 0.5}
kernel: {cutoff: 3}
output: {fields: [phi, velocity]}
)");
  const CommandResult fields = run_command({"run", "p.yaml"}, folder.path());
  EXPECT_EQ(fields.exit_code, 0) << fields.err;
  EXPECT_THAT(fields.out, HasSubstr("wrote output/fields.hdf"));
}

}  // namespace
}  // namespace grainvdb::test::spot_test
