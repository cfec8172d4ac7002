#include "read/file_list.hpp"

#include "unit/read/dump_files.hpp"

namespace grainvdb::file_list_test {
namespace {

using namespace testing_dumps;
using ::testing::ElementsAre;

class FileListTest : public ::testing::Test {
 protected:
  std::vector<std::string> names(const std::vector<std::string>& patterns) {
    std::vector<std::string> full;
    for (const std::string& pattern : patterns) full.push_back(files_.path(pattern));
    std::vector<std::string> result;
    for (const InputFile& file : list_files(full, {}))
      result.push_back(std::filesystem::relative(file.path, files_.directory()).string());
    return result;
  }
  DumpFiles files_;
};

TEST(NaturalLess, ComparesRunsOfDigitsAsNumbers) {
  EXPECT_TRUE(natural_less("dump1000", "dump2000"));
  EXPECT_TRUE(natural_less("dump2000", "dump10000"));
  EXPECT_FALSE(natural_less("dump10000", "dump2000"));
  EXPECT_TRUE(natural_less("dump2", "dump010"));
  EXPECT_TRUE(natural_less("a1b2", "a1b10"));
  EXPECT_TRUE(natural_less("a", "a1"));
  EXPECT_TRUE(natural_less("dump9", "dump12345678901234567890123"));
  EXPECT_FALSE(natural_less("x", "x"));
  // Equal numbers written differently are still told apart, in one order only.
  EXPECT_NE(natural_less("d1", "d01"), natural_less("d01", "d1"));
}

TEST_F(FileListTest, PathsGlobsAndDirectoriesInNaturalOrder) {
  for (const char* name : {"dump1000", "dump10000", "dump2000", "log", ".hidden", "sub/dump1"}) files_.write(name, "x");
  EXPECT_THAT(names({"dump*"}), ElementsAre("dump1000", "dump2000", "dump10000"));
  EXPECT_THAT(names({"dump?000"}), ElementsAre("dump1000", "dump2000"));
  EXPECT_THAT(names({"dump[1]*"}), ElementsAre("dump1000", "dump10000"));
  EXPECT_THAT(names({"*/dump*"}), ElementsAre("sub/dump1"));
  EXPECT_THAT(names({"log"}), ElementsAre("log"));
  EXPECT_THAT(names({"."}), ElementsAre("dump1000", "dump2000", "dump10000", "log"));
}

TEST_F(FileListTest, EachFileOnce) {
  files_.write("dump1", "x");
  files_.write("dump2", "x");
  std::filesystem::create_symlink("dump1", files_.path("link1"));
  EXPECT_THAT(names({"dump*", "dump1", "link1", ".", "./dump2"}), ElementsAre("dump1", "dump2"));
}

TEST_F(FileListTest, KnowsSizesAndWhatWasNamed) {
  files_.write("a", "12345");
  files_.write("b", "");
  const auto list = list_files({files_.path("a"), files_.directory()}, {});
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].size, 5U);
  EXPECT_TRUE(list[0].named);
  EXPECT_EQ(list[1].size, 0U);
  EXPECT_FALSE(list[1].named);
}

TEST_F(FileListTest, AFileMayBearTheNameOfAGlob) {
  files_.write("dump[1]", "x");
  files_.write("dump1", "x");
  EXPECT_THAT(names({"dump[1]"}), ElementsAre("dump[1]"));
}

TEST_F(FileListTest, Refusals) {
  files_.write("a", "x");
  expect_error<InputError>(
      [&] {
        list_files({files_.path("q*")}, {"run.yaml", 4});
      },
      {"run.yaml:4", "no file matches", "q*"});
  expect_error<InputError>([&] { list_files({""}, {"run.yaml", 4}); }, {"run.yaml:4", "no file matches ''"});
  expect_error<IoError>([&] { list_files({files_.path("missing")}, {}); }, {files_.path("missing"), "cannot open"});
  expect_error<InputError>([&] { list_files({"/dev/null"}, {}); }, {"/dev/null", "regular file"});
}

}  // namespace
}  // namespace grainvdb::file_list_test
