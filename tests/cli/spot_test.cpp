/// The spot model as a user runs it: the shipped file makes dumps that the other commands read.
#include <filesystem>

#include <gmock/gmock.h>

#include "cli/command.hpp"
#include "cli/json_lines.hpp"
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

TEST(Spot, SaysBeforeWhatItWouldRun) {
  const Folder folder;
  const CommandResult dry = run_command({"spot", "run", shipped_file(), "--dry-run"}, folder.path());
  ASSERT_EQ(dry.exit_code, 0) << dry.err;
  EXPECT_THAT(dry.out, AllOf(HasSubstr("\nwould begin with "), HasSubstr(" at most 5 snapshots until time 2\n"),
                             HasSubstr("relaxation:")));
  EXPECT_FALSE(std::filesystem::exists(folder / "spot"));
  const CommandResult from =
      run_command({"spot", "run", shipped_file(), "--dry-run", "--set", "output.from=1.6"}, folder.path());
  EXPECT_THAT(from.out, HasSubstr(" at most 2 snapshots until time 2\n"));
  folder.write("spot/spot_0000000.dump", "");
  const CommandResult used = run_command({"spot", "run", shipped_file(), "--dry-run"}, folder.path());
  EXPECT_EQ(used.exit_code, 1);
  EXPECT_THAT(used.err, HasSubstr("the folder holds dumps of another spot run"));
}

TEST(Spot, LogsSnapshotsAndErrors) {
  const Folder folder;
  const CommandResult run =
      run_command({"spot", "run", shipped_file(), "--log-json", "-q", "--set", "output.end=0.5"}, folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  const auto events = json_lines(run.err);
  ASSERT_GE(events.size(), 2U);
  EXPECT_EQ(events.front()["doing"], "snapshots");
  EXPECT_EQ(events.back()["frames_done"], events.back()["frames_total"]);
  const auto errors =
      json_lines(run_command({"spot", "run", shipped_file(), "--log-json", "--set", "sed=1"}, folder.path()).err);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0]["event"], "error");
  EXPECT_EQ(errors[0]["kind"], "config");
}

/// Dumps of the shipped file until a time, made once.
const std::filesystem::path& short_run() {
  static const Folder folder;
  static const bool made = [] {
    const CommandResult result =
        run_command({"spot", "run", shipped_file(), "-o", "spot", "--set", "output.end=0.5"}, folder.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return true;
  }();
  EXPECT_TRUE(made);
  return folder.path();
}

/// A pipeline on these dumps with the density of the grains and with contacts of a simulation: nothing but the
/// snapshots themselves stands against forces.
CommandResult run_on_spots(const std::string& wanted, const std::string& command = "run") {
  const Folder folder;
  folder.write("p.yaml", "grainvdb: 1\ninput:\n  particles: " + (short_run() / "spot/*.dump").string() +
                             "\n  density: 1\n  contacts:\n    files: " +
                             ::grainvdb::testing::in_repository("sample_dumps/silo/contacts_040000.dump.gz") +
                             "\n    lammps: {ids: pp, forces: pl}\nlattice: {voxel: 0.5}\nkernel: {cutoff: 3}\n" +
                             wanted + '\n');
  return run_command({command, "p.yaml"}, folder.path());
}

class ForcesOfSpots : public ::testing::TestWithParam<std::string> {};

TEST_P(ForcesOfSpots, AreRefusedWithTheReason) {
  for (const char* command : {"run", "validate"}) {
    const CommandResult result = run_on_spots("output: {fields: [phi, " + GetParam() + "]}", command);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, AllOf(HasSubstr("p.yaml:10: there are no forces in a spot run"),
                                  HasSubstr("output.fields wants " + GetParam() + "."),
                                  HasSubstr("velocities in its dumps are displacements"),
                                  HasSubstr("column v_spot in "), HasSubstr("phi, velocity and shear_rate are there")));
  }
}

INSTANTIATE_TEST_SUITE_P(Fields, ForcesOfSpots,
                         ::testing::Values("stress", "mu", "inertial_number", "gd_over_dv", "fluidity", "pressure",
                                           "contact_stress", "kinetic_stress", "wall_force", "mu_error"),
                         [](const auto& param) { return std::string(param.param); });

TEST(Spot, AllFieldsOfForcesAreNamedAtOnce) {
  EXPECT_THAT(run_on_spots("output: {fields: [stress, phi, mu, inertial_number, gd_over_dv]}").err,
              HasSubstr("output.fields wants stress, mu, inertial_number, gd_over_dv."));
}

TEST(Spot, MeasurementsOfForcesAreRefusedToo) {
  EXPECT_THAT(run_on_spots("measure: {fluidity_fit: {}}").err,
              AllOf(HasSubstr("there are no forces in a spot run"), HasSubstr("measure.fluidity_fit wants stress")));
  EXPECT_THAT(run_on_spots("measure: {coordination: {contacts: dump}}").err,
              AllOf(HasSubstr("measure.coordination wants the contacts of a simulation"), HasSubstr("contacts: gap")));
  EXPECT_THAT(run_on_spots("trace: {seeds: {points: [[0, 4, 5]]}, dt: 0.1, duration: 1, record: [mu]}").err,
              HasSubstr("trace.record wants mu."));
}

TEST(Spot, WhatIsMadeOfPlacesIsThereAndSaysWhereFrom) {
  const CommandResult result = run_on_spots(
      "output: {fields: [phi, velocity, shear_rate, temperature]}\nmeasure: {coordination: {contacts: gap}}");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const CommandResult info = run_command({"info", "spot/spot_*.dump"}, short_run());
  EXPECT_THAT(info.out, HasSubstr("snapshots: of a spot run: there are no forces"));
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
