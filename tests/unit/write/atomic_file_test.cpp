#include "write/atomic_file.hpp"

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "grainvdb/error.hpp"
#include "unit/write/limit_file_size.hpp"
#include "unit/write/support.hpp"

namespace grainvdb::atomic_file_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::read_file;
using testing::TemporaryFolder;
using testing::write_file;

template <class Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const IoError& error) {
    EXPECT_EQ(error.exit_code(), 3);
    return error.what();
  }
  ADD_FAILURE() << "no IoError";
  return {};
}

TEST(AtomicFile, AppearsUnderItsNameOnlyWhenPublished) {
  const TemporaryFolder folder;
  {
    AtomicFile file(folder / "a.txt");
    file.write(0, "hello ");
    file.write(6, "world");
    EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
    file.finish();
    EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
    file.publish();
    EXPECT_EQ(read_file(folder / "a.txt"), "hello world");
  }
  EXPECT_THAT(folder.names(), ElementsAre("a.txt"));
}

TEST(AtomicFile, IsRemovedWhenItWasNotPublished) {
  const TemporaryFolder folder;
  {
    AtomicFile open(folder / "a.txt");
    open.write(0, "x");
    AtomicFile finished(folder / "b.txt");
    finished.finish();
    EXPECT_EQ(folder.names().size(), 2U);
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(AtomicFile, LeavesAnOlderFileUntilItIsPublished) {
  const TemporaryFolder folder;
  write_file(folder / "a.txt", "old");
  { AtomicFile(folder / "a.txt").write(0, "new"); }
  EXPECT_EQ(read_file(folder / "a.txt"), "old");
  AtomicFile file(folder / "a.txt");
  file.write(0, "new");
  file.finish();
  EXPECT_EQ(read_file(folder / "a.txt"), "old");
  file.publish();
  EXPECT_EQ(read_file(folder / "a.txt"), "new");
}

TEST(AtomicFile, TwoDraftsOfOneFileDoNotDisturbEachOther) {
  const TemporaryFolder folder;
  AtomicFile one(folder / "a.txt");
  AtomicFile two(folder / "a.txt");
  EXPECT_NE(one.temporary_path(), two.temporary_path());
  one.write(0, "one");
  two.write(0, "two");
  two.finish();
  two.publish();
  EXPECT_EQ(read_file(folder / "a.txt"), "two");
}

TEST(AtomicFile, MakesMissingFolders) {
  const TemporaryFolder folder;
  AtomicFile file(folder / "deep/er/a.txt");
  file.finish();
  file.publish();
  EXPECT_TRUE(std::filesystem::exists(folder / "deep/er/a.txt"));
}

TEST(AtomicFile, HasThePermissionsOfAnOrdinaryFile) {
  const TemporaryFolder folder;
  const mode_t before = ::umask(027);
  AtomicFile file(folder / "a.txt");
  ::umask(before);
  file.finish();
  file.publish();
  struct stat status {};
  ASSERT_EQ(::stat((folder / "a.txt").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0640U);
}

TEST(AtomicFile, ReadsBackWhatWasWrittenAndZerosBeyond) {
  const TemporaryFolder folder;
  AtomicFile file(folder / "a.bin");
  file.write(2, "abc");
  EXPECT_EQ(file.size(), 5U);
  std::array<std::byte, 7> bytes{};
  bytes.fill(std::byte{9});
  file.read(1, bytes);
  const std::array<char, 7> expected{0, 'a', 'b', 'c', 0, 0, 0};
  for (std::size_t i = 0; i < bytes.size(); ++i) EXPECT_EQ(std::to_integer<int>(bytes[i]), expected[i]) << i;
  file.resize(3);
  EXPECT_EQ(file.size(), 3U);
}

TEST(AtomicFile, SaysWhereAFolderCannotBeMade) {
  const TemporaryFolder folder;
  write_file(folder / "file", "");
  EXPECT_THAT(message_of([&] { AtomicFile(folder / "file/below/a.txt"); }),
              AllOf(HasSubstr(folder / "file/below"), HasSubstr("Not a directory")));
}

TEST(AtomicFile, RefusesTheNameOfAFolder) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "a.txt");
  EXPECT_THAT(message_of([&] { AtomicFile(folder / "a.txt"); }),
              AllOf(HasSubstr(folder / "a.txt"), HasSubstr("Is a directory")));
  EXPECT_THAT(folder.names(), ElementsAre("a.txt"));
}

TEST(AtomicFile, SaysSoWhenAFileCannotBeWrittenToItsEnd) {
  const TemporaryFolder folder;
  const std::vector<std::byte> block(600);
  AtomicFile file(folder / "a.bin");
  const testing::LimitFileSize limit(1000);
  file.write(0, block);
  EXPECT_THAT(message_of([&] { file.write(600, block); }),
              AllOf(HasSubstr(folder / "a.bin"), HasSubstr("cannot write"), HasSubstr("File too large")));
}

TEST(AtomicFile, SaysSoWhenTheRenameFails) {
  const TemporaryFolder folder;
  AtomicFile file(folder / "sub/a.txt");
  file.finish();
  std::filesystem::remove_all(folder / "sub");
  EXPECT_THAT(message_of([&] { file.publish(); }),
              AllOf(HasSubstr(folder / "sub/a.txt"), HasSubstr("No such file or directory")));
}

TEST(RemoveFile, TakesAMissingFileForDone) {
  const TemporaryFolder folder;
  write_file(folder / "a", "");
  remove_file(folder / "a");
  remove_file(folder / "a");
  EXPECT_THAT(folder.names(), IsEmpty());
  std::filesystem::create_directory(folder / "b");
  EXPECT_THAT(message_of([&] { remove_file(folder / "b"); }), HasSubstr(folder / "b"));
}

}  // namespace
}  // namespace grainvdb::atomic_file_test
