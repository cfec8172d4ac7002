// What every sink of tracers does: order of calls, older results, and a disk that is full.
#include <map>
#include <set>

#include <gmock/gmock.h>

#include "grainvdb/error.hpp"
#include "unit/write/limit_file_size.hpp"
#include "unit/write/tracer_scene.hpp"

namespace grainvdb::tracer_sinks_test {
namespace {

using namespace testing;  // NOLINT: the folder's own helpers
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

TEST(TracerSinkRegistry, ListsTheFormats) {
  std::vector<std::string> names;
  for (const TracerSinkInfo& s : tracer_sink_registry()) {
    names.push_back(s.name);
    EXPECT_FALSE(s.description.empty());
    EXPECT_NE(s.make("somewhere"), nullptr);
  }
  EXPECT_THAT(names, ElementsAre("h5md", "lammps"));
}

class TracerSinks : public ::testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<TracerSink> make(const std::string& path) const { return make_tracer_sink(GetParam(), path); }
  std::string main_file() const { return make(folder.path())->files().at(0); }

  /// Writes a result under a limit on the size of files. Returns the phase in which it failed, or "" when it did not.
  std::string phase_of_failure(const TracerScene& scene, std::uint64_t limit) const {
    std::string phase = "begin";
    const LimitFileSize limited(limit);
    try {
      const auto sink = make(folder.path());
      sink->begin(scene.layout());
      phase = "write";
      for (int t = 0; t < scene.samples; ++t) sink->write(scene.sample(t));
      phase = "commit";
      sink->commit(some_provenance());
      return "";
    } catch (const IoError& error) {
      EXPECT_EQ(error.exit_code(), 3);
      EXPECT_THAT(error.what(), AllOf(StartsWith(folder / "tracers"), HasSubstr("File too large"))) << limit;
      return phase;
    }
  }

  TemporaryFolder folder;
};

TEST_P(TracerSinks, RefuseToBeUsedOutOfOrder) {
  const TracerScene scene;
  EXPECT_THROW(make(folder.path())->commit({}), std::logic_error);
  EXPECT_THROW(make(folder.path())->write(scene.sample(0)), std::logic_error);
  const auto sink = make(folder.path());
  sink->begin(scene.layout());
  EXPECT_THROW(sink->begin(scene.layout()), std::logic_error);
  EXPECT_THROW(sink->commit({}), std::logic_error);
  sink->write(scene.sample(1));
  EXPECT_THROW(sink->write(scene.sample(1)), std::invalid_argument);
  EXPECT_THROW(sink->write(scene.sample(0)), std::invalid_argument);
  sink->write(scene.sample(2));
  TracerScene none;
  none.tracers = 0;
  EXPECT_THROW(make(folder.path())->begin(none.layout()), std::invalid_argument);
}

TEST_P(TracerSinks, RefuseSamplesThatAreNotAsAnnounced) {
  const TracerScene scene;
  const std::vector<std::function<void(TracerSample&)>> spoilers{[](TracerSample& s) { s.position[1].pop_back(); },
                                                                 [](TracerSample& s) { s.image[2].pop_back(); },
                                                                 [](TracerSample& s) { s.displacement[0].pop_back(); },
                                                                 [](TracerSample& s) { s.strain.pop_back(); },
                                                                 [](TracerSample& s) { s.courant.clear(); },
                                                                 [](TracerSample& s) { s.stop.pop_back(); },
                                                                 [](TracerSample& s) { s.stop_time.clear(); },
                                                                 [](TracerSample& s) { s.fields.pop_back(); },
                                                                 [](TracerSample& s) { s.fields[2].pop_back(); },
                                                                 [](TracerSample& s) { s.gradient_number.pop_back(); }};
  for (const auto& spoil : spoilers) {
    const auto sink = make(folder.path());
    sink->begin(scene.layout());
    sink->write(scene.sample(0));
    TracerSample sample = scene.sample(1);
    spoil(sample);
    EXPECT_THROW(sink->write(sample), std::invalid_argument) << &spoil - spoilers.data();
  }
}

TEST_P(TracerSinks, LeaveNothingBehindWithoutCommit) {
  {
    const auto sink = make(folder.path());
    TracerScene{}.write_all(*sink);
    EXPECT_THAT(folder.names(), ::testing::Not(IsEmpty()));
  }
  EXPECT_THAT(folder.names(), IsEmpty());
  write_file(main_file(), "an older result");
  { TracerScene{}.write_all(*make(folder.path())); }
  EXPECT_EQ(folder.names().size(), 1U);
  EXPECT_EQ(read_file(main_file()), "an older result");
}

TEST_P(TracerSinks, ShowAFullDiskAsAnErrorWhereverItStrikesAndLeaveNothing) {
  TracerScene scene;
  scene.tracers = 200;
  scene.samples = 50;
  std::set<std::string> phases;
  std::uint64_t limit = 0;
  for (;; limit += 1 + limit / 4) {
    const std::string phase = phase_of_failure(scene, limit);
    if (phase.empty()) break;
    phases.insert(phase);
    EXPECT_THAT(folder.names(), IsEmpty()) << limit;
  }
  EXPECT_GT(limit, 100'000U);
  EXPECT_TRUE(phases.contains("write"));
}

TEST_P(TracerSinks, ShowAFullDiskAtTheVeryEndAndKeepAnOlderResult) {
  const TracerScene scene;
  const auto sink = make(folder.path());
  scene.write_all(*sink);
  sink->commit(some_provenance());
  const std::string before = read_file(main_file());
  const auto names = folder.names();
  EXPECT_NE(phase_of_failure(scene, before.size() - 1), "");
  EXPECT_EQ(folder.names(), names);
  EXPECT_TRUE(read_file(main_file()) == before);
  EXPECT_EQ(phase_of_failure(scene, 10 * before.size()), "");
}

TEST_P(TracerSinks, ShowAFolderThatCannotBeMadeAtTheBeginning) {
  write_file(folder / "file", "");
  EXPECT_THROW(make(folder / "file/out")->begin(TracerScene{}.layout()), IoError);
}

INSTANTIATE_TEST_SUITE_P(Formats, TracerSinks, ::testing::Values("h5md", "lammps"),
                         [](const auto& sink) { return sink.param; });

TEST(TracerSinks, KeepTheDataFileBackWhenItsSidecarCannotBeWritten) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "tracers.xmf2");
  {
    const auto sink = make_tracer_sink("h5md", folder.path());
    TracerScene{}.write_all(*sink);
    EXPECT_THROW(sink->commit({}), IoError);
  }
  EXPECT_THAT(folder.names(), ElementsAre("tracers.xmf2"));
}

}  // namespace
}  // namespace grainvdb::tracer_sinks_test
