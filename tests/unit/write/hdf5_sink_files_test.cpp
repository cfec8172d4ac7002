// The files of the HDF5 sink: when they are there, and that they are the same for the same result.

#include <gmock/gmock.h>

#include "grainvdb/error.hpp"
#include "unit/write/hdf5_reader.hpp"
#include "unit/write/hdf5_scene.hpp"
#include "unit/write/support.hpp"
#include "write/hdf5_sink.hpp"

namespace grainvdb::hdf5_sink_files_test {
namespace {

using namespace testing::hdf5_scene;  // NOLINT: what the tests of this scene share

using namespace testing;  // NOLINT: the folder's own helpers
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

TEST(Hdf5Sink, LeavesNothingBehindWithoutCommit) {
  const TemporaryFolder folder;
  {
    const auto sink = make_hdf5_sink(folder.path());
    Scene{}.write_all(*sink);
    EXPECT_FALSE(folder.names().empty());
  }
  EXPECT_THAT(folder.names(), IsEmpty());
  write_file(folder / "fields.hdf", "an older result");
  {
    const auto sink = make_hdf5_sink(folder.path());
    Scene{}.write_all(*sink);
  }
  EXPECT_THAT(folder.names(), ElementsAre("fields.hdf"));
  EXPECT_EQ(read_file(folder / "fields.hdf"), "an older result");
}

TEST(Hdf5Sink, ReplacesAnOlderResultWhole) {
  const TemporaryFolder folder;
  Scene scene;
  scene.times = 2;
  write_scene(scene, folder.path());
  EXPECT_THAT(folder.names(), ElementsAre("fields.hdf", "fields.xmf2"));
  scene.times = 1;
  write_scene(scene, folder.path());
  expect_scene_in(scene, folder / "fields.hdf");
  EXPECT_THAT(folder.names(), ElementsAre("fields.hdf"));  // the sidecar described the older one
}

TEST(Hdf5Sink, NamesTheFilesThatItLeaves) {
  const TemporaryFolder folder;
  Scene scene;
  const auto fixed = make_hdf5_sink(folder.path());
  scene.write_all(*fixed);
  EXPECT_THAT(fixed->files(), ElementsAre(folder / "fields.hdf"));
  scene.times = 2;
  const auto series = make_hdf5_sink(folder.path());
  scene.write_all(*series);
  EXPECT_THAT(series->files(), ElementsAre(folder / "fields.hdf", folder / "fields.xmf2"));
}

herr_t expect_no_time_stamp(hid_t, const char* name, const H5O_info_t* info, void*) {
  EXPECT_EQ(info->ctime, 0) << name;
  EXPECT_EQ(info->mtime, 0) << name;
  return 0;
}

TEST(Hdf5Sink, GivesTheSameBytesForTheSameResult) {
  const TemporaryFolder folder;
  Scene scene;
  scene.times = 2;
  write_scene(scene, folder / "a");
  write_scene(scene, folder / "b");
  EXPECT_TRUE(read_file(folder / "a/fields.hdf") == read_file(folder / "b/fields.hdf"));
  EXPECT_TRUE(read_file(folder / "a/fields.xmf2") == read_file(folder / "b/fields.xmf2"));
  const Hdf5Reader file(folder / "a/fields.hdf");
  H5Ovisit1(file.id(), H5_INDEX_NAME, H5_ITER_INC, expect_no_time_stamp, nullptr);
}

TEST(Hdf5Sink, RefusesToBeUsedOutOfOrder) {
  const TemporaryFolder folder;
  const Scene scene;
  EXPECT_THROW(make_hdf5_sink(folder.path())->commit({}), std::logic_error);
  EXPECT_THROW(scene.write_time(*make_hdf5_sink(folder.path()), 0), std::logic_error);
  const auto sink = make_hdf5_sink(folder.path());
  sink->begin(scene.layout());
  EXPECT_THROW(sink->begin(scene.layout()), std::logic_error);
  EXPECT_THROW(sink->commit({}), std::logic_error);
  EXPECT_THROW(sink->write(scene.time(0), {}, nullptr), std::invalid_argument);
  scene.write_time(*sink, 0);
  EXPECT_THROW(scene.write_time(*sink, 0), std::logic_error);
  sink->commit({});
  OutputLayout nothing = scene.layout();
  nothing.time_count = 0;
  EXPECT_THROW(make_hdf5_sink(folder.path())->begin(nothing), std::invalid_argument);
  nothing = scene.layout();
  nothing.last.x = nothing.first.x - 1;
  EXPECT_THROW(make_hdf5_sink(folder.path())->begin(nothing), std::invalid_argument);
}

}  // namespace
}  // namespace grainvdb::hdf5_sink_files_test
