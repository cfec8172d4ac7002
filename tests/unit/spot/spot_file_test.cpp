// Spot files: what is refused and why, and that the dumps of a run are read like any other.
#include "spot/spot_file.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

#include "grainvdb/frame_source.hpp"
#include "spot/run_spot.hpp"
#include "support/dump_text.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::spot::spot_file_test {
namespace {

using ::testing::HasSubstr;

const std::string text = R"(grainvdb: 1
packing:
  random: {phi: 0.55}
container:
  lo: [-4, 0, 0]
  hi: [4, 8, 8]
  periodic: [y]
  orifice: {width: 4}
spots:
  radius: 2.6
  influence: 100
  step: [0.676, 0.676, 0.1]
  hop_rate: 28
  insertion_rate: 100
  wall_distance: 1
output: {interval: 0.5, end: 1.5}
)";

std::string write(const testing::TemporaryFolder& folder, const std::string& content) {
  const std::string file = folder.path() + "/spot.yaml";
  testing::write_plain(file, content);
  return file;
}

std::string refusal_of(const std::string& content, const std::vector<std::string>& overrides) {
  const testing::TemporaryFolder folder;
  try {
    load_spot_run(write(folder, content), overrides);
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "nothing was refused";
}

std::string refusal(const std::vector<std::string>& overrides) {
  return refusal_of(text, overrides);
}

TEST(SpotFile, RefusesWhatCannotBeRun) {
  EXPECT_THAT(refusal({"spots.radios=2"}), HasSubstr("Did you mean 'radius'?"));
  EXPECT_THAT(refusal({"spots.radius=0"}), HasSubstr("is too small"));
  EXPECT_THAT(refusal({"spots.insertion_rate=0"}), HasSubstr("there are no spots"));
  EXPECT_THAT(refusal({"spots.bias.volume=0.2"}), HasSubstr("either spots.influence, or spots.bias"));
  EXPECT_THAT(refusal({"container.hi=[4, 6, 8]"}), HasSubstr("too short along the periodic axis y"));
  EXPECT_THAT(refusal({"container.periodic=[y, z]"}), HasSubstr("an orifice needs a floor"));
  EXPECT_THAT(refusal({"container.hi=[-5, 8, 8]"}), HasSubstr("the container is empty along x"));
  EXPECT_THAT(refusal({"relaxation.radius=2"}), HasSubstr("must hold the spot"));
  EXPECT_THAT(refusal({"packing.dump=nothing.dump"}), HasSubstr("either packing.dump or packing.random"));
  EXPECT_THAT(refusal({"spots.influence=0.1"}), HasSubstr("moves grains too far"));
  EXPECT_THAT(refusal({"spots.entry_depth=2.1"}), HasSubstr("too far below the floor"));
  EXPECT_THAT(refusal({"input.particles=x.dump"}), HasSubstr("this is a pipeline file"));
}

TEST(SpotFile, RefusesWhatWouldRunAndMeanNothing) {
  EXPECT_THAT(refusal({"spots.step=[0.676, 0.676, 0]"}), HasSubstr("spots would never rise"));
  EXPECT_THAT(refusal({"spots.step=[0, 0, 0]", "spots.direction=any"}), HasSubstr("spots would never move"));
  EXPECT_THAT(refusal({"spots.step=[2, 1.9, 0.01]", "spots.influence=5"}), HasSubstr("moves grains too far"));
  EXPECT_THAT(refusal({"spots.step=[0.676, 2.1, 0.1]"}), HasSubstr("long beside the container along y; found 2.1"));
  EXPECT_THAT(refusal({"spots.wall_distance=4"}), HasSubstr("walls leave no room for spots along x"));
  EXPECT_THAT(refusal({"container.orifice.width=9"}), HasSubstr("the orifice reaches beyond the floor along x"));
  EXPECT_THAT(refusal({"container.orifice.centre=[2.5, 0]"}),
              HasSubstr("found 0.5 to 4.5; expected an orifice between"));
  EXPECT_THAT(refusal({"container.orifice.shape=circle", "container.periodic=[x]"}),
              HasSubstr("the orifice reaches beyond the floor along y"));
  EXPECT_THAT(refusal({"container.hi=[4, 8, 20000]", "packing.random.height=8"}),
              HasSubstr("too long along z to tell small displacements"));
  const testing::TemporaryFolder folder;
  std::string biased = text;
  biased.replace(biased.find("influence: 100"), 14, "bias: {volume: 0.2}");
  EXPECT_NO_THROW(load_spot_run(write(folder, biased)));
  EXPECT_THROW(load_spot_run(write(folder, biased), {"spots.direction=any"}), ConfigError);
  EXPECT_THAT(refusal({"packing.random.phi=1e-6"}), HasSubstr("there is no grain in the packing"));
  EXPECT_THAT(refusal({"output.interval=2"}), HasSubstr("no snapshot but that of the start"));
  EXPECT_THAT(refusal({"output.from=2"}), HasSubstr("no snapshot but that of the start"));
  EXPECT_THAT(refusal({"spots.floor_distance=-1"}), HasSubstr("is too small"));
}

TEST(SpotFile, AllowsAnOrificeAsWideAsTheFloor) {
  EXPECT_THAT(refusal({"container.orifice.width=8"}), HasSubstr("nothing was refused"));
  EXPECT_THAT(
      refusal({"container.orifice.shape=circle", "container.orifice.width=8", "container.orifice.centre=[0, 1]"}),
      HasSubstr("nothing was refused"));  // across a periodic end
}

TEST(SpotFile, NamesThePlaceOfAFault) {
  EXPECT_THAT(refusal({}), HasSubstr("nothing was refused"));
  const testing::TemporaryFolder folder;
  const std::string file = write(folder, text + "seeed: 3\n");
  try {
    load_spot_run(file);
    FAIL();
  } catch (const ConfigError& e) {
    EXPECT_THAT(e.what(), HasSubstr("spot.yaml:17"));
  }
}

TEST(SpotFile, FillsInDefaultsAndSaysSo) {
  const testing::TemporaryFolder folder;
  const SpotRun run = load_spot_run(write(folder, text));
  EXPECT_DOUBLE_EQ(run.parameters.relaxation.radius, 3.6);
  EXPECT_THAT(run.resolved, HasSubstr("strength: 0.8"));
  testing::write_plain(folder.path() + "/again.yaml", run.resolved);
  EXPECT_EQ(load_spot_run(folder.path() + "/again.yaml").resolved, run.resolved);
}

TEST(SpotRun, WritesDumpsThatAreReadLikeAnyOther) {
  const testing::TemporaryFolder folder;
  const SpotRun run = load_spot_run(write(folder, text));
  const std::string out = folder.path() + "/out";
  const SpotReport report = run_spot(run, out);
  InputSpec spec;
  spec.particles = {out + "/spot_*.dump"};
  const auto source = open_dumps(spec);
  ASSERT_EQ(source->frames().size(), 4U);
  EXPECT_EQ(source->units().name, "lj");
  EXPECT_DOUBLE_EQ(source->frames()[3].time.value(), 1.5);
  EXPECT_EQ(source->frames()[0].box, run.container.box);
  EXPECT_EQ(report.particles_at_start, report.particles_at_end + report.drained);
  EXPECT_EQ(source->frames()[3].particle_count, report.particles_at_end);

  // Velocities are displacements over the time between, matched by id.
  const Frame before = source->read(2, Column::velocity), now = source->read(3, Column::velocity);
  std::size_t k = 0;
  for (std::size_t i = 0; i < now.particles.size(); ++i) {
    while (before.particles.id[k] != now.particles.id[i]) ++k;
    for (int a = 0; a < 3; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      const double moved =
          run.container.box.minimum_image(a, now.particles.position[axis][i] - before.particles.position[axis][k]);
      // Nine digits of positions below 10 and of velocities.
      EXPECT_NEAR(now.particles.velocity[axis][i], moved / 0.5, 2 * 2e-8 / 0.5);
    }
  }
  EXPECT_THROW(run_spot(run, out), ConfigError);  // two runs in one folder would be read as one
}

std::string contents(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream all;
  all << in.rdbuf();
  return all.str();
}

// Those that are written are the same.
TEST(SpotRun, LeavesOutSnapshotsBeforeATime) {
  const testing::TemporaryFolder folder;
  const std::string file = write(folder, text), all = folder.path() + "/all", late = folder.path() + "/late";
  run_spot(load_spot_run(file), all);
  EXPECT_EQ(run_spot(load_spot_run(file, {"output.from=0.9"}), late).snapshots, 3U);
  EXPECT_FALSE(std::filesystem::exists(late + "/spot_0000001.dump"));
  for (const std::string name : {"/spot_0000000.dump", "/spot_0000002.dump", "/spot_0000003.dump", "/drained.txt"})
    EXPECT_EQ(contents(late + name), contents(all + name)) << name;
}

TEST(SpotRun, TakesAPackingFromADump) {
  const std::string dump = testing::in_repository("sample_dumps/silo/full_040000.dump.gz");
  const testing::TemporaryFolder folder;
  std::string content = text;
  content.replace(content.find("  random: {phi: 0.55}"), 21, "  dump: " + dump + "\n  types: [1]");
  content.replace(content.find("[-4, 0, 0]"), 10, "[-10, 0, 0]");
  content.replace(content.find("[4, 8, 8]"), 9, "[10, 8, 40]");
  const SpotRun run = load_spot_run(write(folder, content));
  EXPECT_DOUBLE_EQ(run.packing.diameter, 1);
  EXPECT_GT(run.packing.id.size(), 3000U);
  EXPECT_GT(run.left_out, 0U);
  EXPECT_THROW(load_spot_run(write(folder, content), {"packing.frame=1"}), ConfigError);
  EXPECT_THROW(load_spot_run(write(folder, content), {"packing.types=[3]"}), InputError);
}

std::string dump_refusal(const std::string& bounds, const std::string& second) {
  const testing::TemporaryFolder folder;
  testing::write_plain(folder.path() + "/two.dump", "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS " +
                                                        bounds + "\nITEM: ATOMS id x y z radius\n1 0 4 1 0.5\n" +
                                                        second + '\n');
  std::string content = text;
  content.replace(content.find("random: {phi: 0.55}"), 19, "dump: two.dump");
  try {
    load_spot_run(write(folder, content));
  } catch (const std::exception& e) {
    return e.what();
  }
  return "nothing was refused";
}

TEST(SpotFile, RefusesPackingsOfDumpsThatCannotBeMeant) {
  const std::string bounds = "ff pp ff\n-4 4\n0 8\n0 20";
  EXPECT_EQ(dump_refusal(bounds, "2 1 4 1 0.5"), "nothing was refused");
  EXPECT_THAT(dump_refusal(bounds, "2 0 4 1 0.5"), HasSubstr("two grains are at the same place; found ids 1 and 2"));
  EXPECT_THAT(dump_refusal("ff pp ff\n-4 4\n0 12\n0 20", "2 1 11 1 0.5"),
              HasSubstr("different periods along y; found 8.0; expected 12.0"));
  EXPECT_EQ(dump_refusal("ff ff ff\n-4 4\n0 12\n0 20", "2 1 4 1 0.5"), "nothing was refused");
}

TEST(SpotFile, TheResolvedFileFindsItsDumpsFromAnywhere) {
  const testing::TemporaryFolder folder;
  std::filesystem::copy_file(testing::in_repository("sample_dumps/silo/full_040000.dump.gz"),
                             folder.path() + "/a.dump.gz");
  std::string content = text;
  content.replace(content.find("random: {phi: 0.55}"), 19, "dump: a.dump.gz\n  types: [1]");
  const SpotRun run = load_spot_run(write(folder, content));
  std::filesystem::create_directory(folder.path() + "/out");
  testing::write_plain(folder.path() + "/out/spot.yaml", run.resolved);
  EXPECT_EQ(load_spot_run(folder.path() + "/out/spot.yaml").packing.id, run.packing.id);
}

const std::string void_text = R"(grainvdb: 1
packing:
  lattice: {step: [0.5, 0.5, 0.70711]}
container:
  lo: [-4, 0, 0]
  hi: [4, 4, 8]
  periodic: [x, y]
  orifice: {width: 2}
voids:
  hop_rate: 28
  insertion_rate: 20
output: {interval: 0.5, end: 1.5}
)";

TEST(SpotFile, VoidsTakeTheSectionOfSpots) {
  const testing::TemporaryFolder folder;
  const SpotRun run = load_spot_run(write(folder, void_text));
  ASSERT_TRUE(run.voids.has_value());
  EXPECT_EQ(run.packing.id.size(), 8 * 4 * 10U);  // layers at .5, 1.21, … 6.86
  EXPECT_EQ(run.units, "lj");
  EXPECT_THAT(run.resolved, ::testing::Not(HasSubstr("relaxation")));
  testing::write_plain(folder.path() + "/again.yaml", run.resolved);
  EXPECT_EQ(load_spot_run(folder.path() + "/again.yaml").resolved, run.resolved);
  const SpotRun crystal =
      load_spot_run(write(folder, text), {"packing={lattice: {step: [0.5, 0.5, 0.70711], height: 5}}"});
  EXPECT_FALSE(crystal.voids.has_value());
  EXPECT_EQ(crystal.packing.id.size(), 3 * (8 + 7) * 8U);
}

std::string void_refusal(const std::vector<std::string>& overrides) {
  return refusal_of(void_text, overrides);
}

TEST(SpotFile, RefusesVoidsThatCannotBeRun) {
  EXPECT_THAT(void_refusal({}), HasSubstr("nothing was refused"));
  EXPECT_THAT(void_refusal({"spots.radius=2", "spots.step=[1,1,1]", "spots.hop_rate=1"}),
              HasSubstr("either spots or voids"));
  EXPECT_THAT(void_refusal({"relaxation.every=0"}), HasSubstr("nothing is relaxed in the void model"));
  EXPECT_THAT(void_refusal({"packing={random: {phi: 0.5}}"}), HasSubstr("voids need a lattice"));
  EXPECT_THAT(void_refusal({"packing.lattice.step=[0.5, 0.5, 0.6]"}), HasSubstr("spot.yaml:3: grains of the lattice"));
  EXPECT_THAT(void_refusal({"container.orifice.width=0.1", "container.orifice.centre=[0.5, 0]"}),
              HasSubstr("voids have nowhere to enter"));
  EXPECT_THAT(refusal({"packing.lattice.step=[1, 1, 1]"}), HasSubstr("the packing must be given in one way"));
}

TEST(SpotRun, VoidsWriteDumpsThatAreReadLikeAnyOther) {
  const testing::TemporaryFolder folder;
  const SpotRun run = load_spot_run(write(folder, void_text));
  const std::string out = folder.path() + "/out";
  const SpotReport report = run_spot(run, out);
  InputSpec spec;
  spec.particles = {out + "/spot_*.dump"};
  const auto source = open_dumps(spec);
  ASSERT_EQ(source->frames().size(), 4U);
  EXPECT_DOUBLE_EQ(source->frames()[3].time.value(), 1.5);
  EXPECT_GT(report.drained, 0U);
  EXPECT_EQ(report.drained, report.counters.inserted);
  EXPECT_EQ(report.particles_at_start, report.particles_at_end + report.drained);
  const Frame last = source->read(3, Column::velocity);
  EXPECT_EQ(last.particles.size(), report.particles_at_end);
  double falling = 0;
  for (const double v : last.particles.velocity[2]) falling -= v;
  EXPECT_GT(falling, 0);
}

}  // namespace
}  // namespace grainvdb::spot::spot_file_test
