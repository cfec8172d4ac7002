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

std::string refusal(const std::vector<std::string>& overrides) {
  const testing::TemporaryFolder folder;
  try {
    load_spot_run(write(folder, text), overrides);
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "nothing was refused";
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

}  // namespace
}  // namespace grainvdb::spot::spot_file_test
