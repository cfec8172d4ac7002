// `grainvdb run` with output.reduced: every file in units of d, sqrt(d/g) and rho_p d^3.
#include <gmock/gmock.h>
#include <openvdb/openvdb.h>

#include "cli/example_dumps.hpp"
#include "unit/write/hdf5_reader.hpp"

namespace grainvdb::test::reduced_test {
namespace {

using grainvdb::testing::Hdf5Reader;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// d = 1/2, sqrt(d/g) = 1/4, rho_p d^3 = 1/2: the example's lengths are doubled, its velocities halved.
constexpr const char* halves = "output.reduced={diameter: 0.5, gravity: 8, density: 4}";

const std::string all_kinds =
    pipeline_text() +
    "trace: {seeds: {points: [[1, 1, 1.25]]}, duration: 0.5, steps: 2, formats: [h5md, lammps]}\n"
    "measure:\n  pair_correlation: {bins: 20}\n  plane_profile: {axis: z}\n";

TEST(ReducedOutput, NamesItsUnitsInEveryFile) {
  const Folder folder;
  write_dumps(folder);
  folder.write("p.yaml", all_kinds);
  ASSERT_EQ(run_command({"run", "p.yaml", "-o", "plain"}, folder.path()).exit_code, 0);
  const CommandResult result = run_command({"run", "p.yaml", "-o", "reduced", "--set", halves}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;

  const Hdf5Reader plain((folder / "plain/fields.hdf").string()), fields((folder / "reduced/fields.hdf").string());
  EXPECT_EQ(fields.text_of("/x", "units"), "d");
  EXPECT_EQ(fields.text_of("/time", "units"), "sqrt(d/g)");
  EXPECT_EQ(fields.text_of("/VTKHDF/PointData/velocity", "units"), "sqrt(g d)");
  EXPECT_EQ(fields.text_of("/VTKHDF/PointData/phi", "units"), "1");
  EXPECT_THAT(fields.attribute<double>("/VTKHDF", "Spacing"), ElementsAre(1, 1, 1));
  EXPECT_EQ(fields.read<double>("/x").at(0), 2 * plain.read<double>("/x").at(0));
  EXPECT_EQ(fields.read<double>("/time").at(0), 4 * plain.read<double>("/time").at(0));
  const auto found = fields.read<float>("/VTKHDF/PointData/velocity"),
             expected = plain.read<float>("/VTKHDF/PointData/velocity");
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], expected[i] / 2) << i;
  EXPECT_THAT(fields.text("/provenance/reduced_units"), HasSubstr("d = 0.5 m\ng = 8.0 m/s^2\nrho_p = 4.0 kg/m^3\n"));
  EXPECT_THAT(fields.text("/provenance/pipeline"), HasSubstr("  reduced:\n    diameter: 0.5\n"));

  const Hdf5Reader tracers((folder / "reduced/tracers.h5").string());
  EXPECT_EQ(tracers.text_of("/particles/tracers/position/value", "units"), "d");
  EXPECT_EQ(tracers.text_of("/particles/tracers/position/time", "units"), "sqrt(d/g)");
  EXPECT_THAT(tracers.read<double>("/particles/tracers/position/time"), ElementsAre(0, 1, 2));
  EXPECT_THAT(tracers.attribute<double>("/particles/tracers/box", "offset"), ElementsAre(0, 0, 0));
  EXPECT_EQ(tracers.read<double>("/particles/tracers/box/edges/value").at(0), 8);
  EXPECT_THAT(read_file(folder / "reduced/tracers.dump"),
              AllOf(StartsWith("ITEM: UNITS\nlj\nITEM: TIME\n0\n"), HasSubstr("0 8\n"), HasSubstr("\n1 1 2 2 2.5 ")));

  const Hdf5Reader tables((folder / "reduced/tables.h5").string());
  EXPECT_EQ(tables.text_of("/pair_correlation/r", "units"), "d");
  EXPECT_EQ(tables.text_of("/plane_profile/density", "units"), "rho_p");
  EXPECT_THAT(read_file(folder / "reduced/tables/pair_correlation.csv"), HasSubstr("\nr [d],"));
  EXPECT_THAT(read_file(folder / "reduced/tables/numbers.csv"), HasSubstr("pair_correlation,closest,2,"));
  EXPECT_THAT(result.out, HasSubstr("closest 2 d"));
}

TEST(ReducedOutput, IsWhatVdbFilesHold) {
  const Folder folder;
  write_example(folder);
  const auto velocity = [&](const std::string& output, const std::vector<std::string>& more) {
    std::vector<std::string> words{"run", "p.yaml", "-o", output, "--set", "output.formats=[vdb]"};
    words.insert(words.end(), more.begin(), more.end());
    const CommandResult result = run_command(words, folder.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    openvdb::initialize();
    openvdb::io::File file((folder / (output + "/fields.vdb")).string());
    file.open(/*delayLoad=*/false);
    return std::pair{openvdb::gridPtrCast<openvdb::Vec3SGrid>(file.readGrid("velocity")), *file.getMetadata()};
  };
  const auto [plain, plain_file] = velocity("plain", {});
  const auto [reduced, file] = velocity("reduced", {"--set", halves});
  ASSERT_TRUE(plain && reduced);
  EXPECT_EQ(reduced->metaValue<std::string>("unit"), "sqrt(g d)");
  EXPECT_EQ(reduced->metaValue<std::string>("length_unit"), "d");
  EXPECT_EQ(reduced->metaValue<std::string>("time_unit"), "sqrt(d/g)");
  EXPECT_EQ(reduced->metaValue<double>("time"), 4 * plain->metaValue<double>("time"));
  EXPECT_THAT(file.metaValue<std::string>("provenance/reduced_units"), HasSubstr("d = 0.5 m\n"));
  const openvdb::Coord corner(1, 2, 3);
  EXPECT_EQ(reduced->indexToWorld(corner), 2 * plain->indexToWorld(corner));
  EXPECT_GT(plain->activeVoxelCount(), 0U);
  EXPECT_EQ(reduced->activeVoxelCount(), plain->activeVoxelCount());
  for (auto voxel = plain->cbeginValueOn(); voxel; ++voxel)
    ASSERT_EQ(reduced->tree().getValue(voxel.getCoord()), *voxel / 2) << voxel.getCoord();
}

TEST(ReducedOutput, IsTheSameForScalesAndSeriesThatAreResumed) {
  const Folder folder;
  write_example(folder);
  const auto bytes = [&](const std::string& output, const std::string& file, std::vector<std::string> more) {
    std::vector<std::string> words{"run", "p.yaml", "--set", halves, "-o", output};
    words.insert(words.end(), more.begin(), more.end());
    const CommandResult result = run_command(words, folder.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_file(folder / (output + file));
  };
  const std::string series = "average.window=1";
  const std::string expected = bytes("series", "/fields.hdf", {"--set", series});
  EXPECT_FALSE(expected.empty());
  EXPECT_TRUE(bytes("resumed", "/fields.hdf", {"--set", series, "--resume", "--checkpoint-interval", "0"}) == expected);
  EXPECT_TRUE(bytes("followed", "/fields.hdf",
                    {"--set", series, "--follow", "--last-step", "200", "--look-every", "0.05"}) == expected);
  const std::string whole = bytes("whole", "/fields.hdf", {});
  EXPECT_TRUE(bytes("scales", "/c1.5_h0.5/fields.hdf", {"--set", "scales={cutoff: [1.5, 1.75], voxel: [0.5, 0.5]}"}) ==
              whole);
}

TEST(ReducedOutput, RefusesUnitsThatAreNotPositive) {
  const Folder folder;
  write_dumps(folder);
  std::string text = pipeline_text();
  text.replace(text.find("velocity]}"), 10, "velocity], reduced: {diameter: 0, gravity: 8, density: 4}}");
  folder.write("p.yaml", text);
  const CommandResult result = run_command({"run", "p.yaml"}, folder.path());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("p.yaml:9"), HasSubstr("output.reduced.diameter")));
}

}  // namespace
}  // namespace grainvdb::test::reduced_test
