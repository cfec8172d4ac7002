// What happens when the disk is full: the limit on file sizes makes writes fail at any byte one likes.
#include <map>
#include <string>

#include <gmock/gmock.h>

#include "grainvdb/error.hpp"
#include "unit/write/limit_file_size.hpp"
#include "unit/write/support.hpp"

namespace grainvdb::write_errors_test {
namespace {

using namespace testing;  // NOLINT: the folder's own helpers
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// Long enough for a limit to strike while it is written.
Provenance long_provenance() {
  return {{"version", "1.2.3"}, {"pipeline", std::string(100000, '#')}};
}

/// Writes a result under the limit. Returns the phase in which it failed, or "" when it did not.
std::string phase_of_failure(const std::string& sink_name, const std::string& folder, const Scene& scene,
                             std::uint64_t limit) {
  std::string phase = "begin";
  const LimitFileSize limited(limit);
  try {
    const auto sink = make_sink(sink_name, folder);
    sink->begin(scene.layout());
    phase = "write";
    for (int t = 0; t < scene.times; ++t) scene.write_time(*sink, t);
    phase = "commit";
    sink->commit(long_provenance());
    return "";
  } catch (const IoError& error) {
    EXPECT_EQ(error.exit_code(), 3);
    EXPECT_THAT(error.what(), AllOf(StartsWith(folder + "/fields"), HasSubstr("File too large"))) << limit;
    return phase;
  }
}

class FullDisk : public ::testing::TestWithParam<std::string> {};

TEST_P(FullDisk, ShowsAsAnErrorWhereverItStrikesAndLeavesNothing) {
  Scene scene;
  scene.first = {0, 0, 0};
  scene.last = {15, 15, 15};
  scene.times = 2;
  std::map<std::string, int> phases;
  std::uint64_t limit = 0;
  for (;; limit += 1 + limit / 16) {
    const TemporaryFolder folder;
    const std::string phase = phase_of_failure(GetParam(), folder.path(), scene, limit);
    if (phase.empty()) break;
    ++phases[phase];
    EXPECT_THAT(folder.names(), IsEmpty()) << limit;
  }
  EXPECT_GT(limit, 1000U);
  EXPECT_GT(phases["write"], 0);
  EXPECT_GT(phases["commit"], 0);
}

TEST_P(FullDisk, LeavesAnOlderResultAlone) {
  Scene scene;
  const TemporaryFolder folder;
  const auto sink = make_sink(GetParam(), folder.path());
  scene.write_all(*sink);
  sink->commit(long_provenance());
  const std::string path = sink->files().at(0);
  const std::string before = read_file(path);
  EXPECT_EQ(phase_of_failure(GetParam(), folder.path(), scene, 5000), "write");
  EXPECT_EQ(phase_of_failure(GetParam(), folder.path(), scene, before.size() - 1), "commit");
  EXPECT_EQ(folder.names().size(), 1U);
  EXPECT_TRUE(read_file(path) == before);
}

TEST_P(FullDisk, DoesNotKeepTheNextResultFromBeingWritten) {
  Scene scene;
  const TemporaryFolder folder;
  EXPECT_EQ(phase_of_failure(GetParam(), folder.path(), scene, 5000), "write");
  const auto sink = make_sink(GetParam(), folder.path());
  scene.write_all(*sink);
  sink->commit({});
  EXPECT_EQ(folder.names().size(), 1U);
}

INSTANTIATE_TEST_SUITE_P(Sinks, FullDisk, ::testing::Values("hdf5", "vdb"),
                         [](const auto& sink) { return sink.param; });

TEST(WriteErrors, AFolderThatCannotBeMadeShowsAtTheBeginning) {
  const TemporaryFolder folder;
  write_file(folder / "file", "");
  for (const SinkInfo& info : sink_registry())
    EXPECT_THROW(info.make(folder / "file/out")->begin(Scene{}.layout()), IoError) << info.name;
}

TEST(WriteErrors, ASidecarThatCannotBeWrittenKeepsTheDataFileBack) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "fields.xmf2");
  Scene scene;
  scene.times = 2;
  {
    const auto sink = make_sink("hdf5", folder.path());
    scene.write_all(*sink);
    EXPECT_THROW(sink->commit({}), IoError);
  }
  EXPECT_THAT(folder.names(), ElementsAre("fields.xmf2"));
}

}  // namespace
}  // namespace grainvdb::write_errors_test
