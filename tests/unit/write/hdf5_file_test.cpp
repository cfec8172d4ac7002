#include "write/hdf5_file.hpp"

#include <optional>

#include <gmock/gmock.h>

#include "grainvdb/error.hpp"
#include "unit/write/hdf5_reader.hpp"
#include "unit/write/limit_file_size.hpp"
#include "unit/write/support.hpp"

namespace grainvdb::hdf5_file_test {
namespace {

using namespace testing;  // NOLINT: the folder's own helpers
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Hdf5File, TurnsAnErrorOfHdf5IntoOneWithItsWordsAndPrintsNothing) {
  const TemporaryFolder folder;
  AtomicFile target(folder / "a.hdf");
  Hdf5File file(target);
  file.create_group("/group");
  ::testing::internal::CaptureStderr();
  try {
    file.create_group("/group");
    ADD_FAILURE() << "no IoError";
  } catch (const IoError& error) {
    EXPECT_THAT(error.what(), AllOf(StartsWith(folder / "a.hdf"), HasSubstr("cannot create /group"),
                                    HasSubstr("name already exists")));
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(Hdf5File, LetsOthersSeeTheErrorsOfTheirOwnCalls) {
  const TemporaryFolder folder;
  AtomicFile target(folder / "a.hdf");
  Hdf5File file(target);
  ::testing::internal::CaptureStderr();
  EXPECT_LT(H5Dclose(-1), 0);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("HDF5-DIAG"));
}

TEST(Hdf5File, CanBeOpenedTwiceAtATime) {
  const TemporaryFolder folder;
  AtomicFile one(folder / "a.hdf"), two(folder / "a.hdf");
  Hdf5File a(one), b(two);
  a.create_text("/which", "one");
  b.create_text("/which", "two");
  a.close();
  b.close();
  EXPECT_EQ(Hdf5Reader(one.temporary_path()).text("/which"), "one");
  EXPECT_EQ(Hdf5Reader(two.temporary_path()).text("/which"), "two");
}

TEST(Hdf5File, WritesAChunkThatReachesBeyondTheDataset) {
  const TemporaryFolder folder;
  AtomicFile target(folder / "a.hdf");
  Hdf5File file(target);
  file.create_chunked_dataset<float>("/a", {5}, {3}, -1.0F);
  file.write_chunk<float>("/a", {3}, std::vector<float>{4, 5, 6});
  file.close();
  EXPECT_THAT(Hdf5Reader(target.temporary_path()).read<float>("/a"), ElementsAre(-1, -1, -1, 4, 5));
}

TEST(Hdf5File, ReportsTheSystemsErrorAndClosesInGoodOrderAfterIt) {
  const TemporaryFolder folder;
  AtomicFile target(folder / "a.hdf");
  std::optional<Hdf5File> file(target);
  file->create_chunked_dataset<float>("/a", {4096}, {1024}, 0.0F);
  const std::vector<float> chunk(1024);
  {
    const LimitFileSize limit(6000);
    try {
      file->write_chunk<float>("/a", {0}, chunk);
      file->write_chunk<float>("/a", {1024}, chunk);
      file->flush();
      ADD_FAILURE() << "no IoError";
    } catch (const IoError& error) {
      EXPECT_THAT(error.what(), AllOf(StartsWith(folder / "a.hdf"), HasSubstr("File too large")));
    }
    EXPECT_THROW(file->close(), IoError);
    file.reset();
  }
  EXPECT_EQ(H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_ALL), 0);
}

}  // namespace
}  // namespace grainvdb::hdf5_file_test
