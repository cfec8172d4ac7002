#include <filesystem>
#include <limits>
#include <string>

#include <gmock/gmock.h>

#include "grainvdb/error.hpp"
#include "grainvdb/table_sink.hpp"
#include "unit/write/hdf5_reader.hpp"
#include "unit/write/support.hpp"

namespace grainvdb::table_sinks_test {
namespace {

using namespace testing;  // NOLINT: the folder's own helpers
using ::testing::ElementsAre;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Table table() {
  Table t{"pairs", "pairs of grains, \"close\"", "g = n/n_0  (1)"};
  t.columns = {{"distance", dimension::length, "of centres", {0.5, 1.0 / 3.0}, "m"},
               {"g", dimension::none, "density of pairs", {nan, -2e-300}, "1"}};
  t.numbers = {{"peak", 1.25, 0.5, dimension::length, "where g is largest, in words", "m"},
               {"count", 7, nan, dimension::none, "of pairs", "1"}};
  t.remarks = {"nothing was refused"};
  return t;
}

Table numbers_alone() {
  Table t{"fit", "a law", "y = a x"};
  t.numbers = {{"a", 2, 0.1, dimension::none, "slope", "1"}};
  return t;
}

std::string write(const std::string& format, const TemporaryFolder& folder) {
  for (const TableSinkInfo& info : table_sink_registry())
    if (info.name == format) {
      const auto sink = info.make(folder.path());
      sink->write({table(), numbers_alone()}, {{"version", "1"}});
      return sink->files().front();
    }
  return {};
}

TEST(CsvTables, HaveUnitsRemarksAndNumbersThatReadBackTheSame) {
  const TemporaryFolder folder;
  write("csv", folder);
  EXPECT_EQ(read_file(folder / "tables/pairs.csv"),
            "# pairs of grains, \"close\"\n# g = n/n_0  (1)\n# nothing was refused\n"
            "distance [m],g [1]\n0.5,nan\n0.3333333333333333,-2e-300\n");
  EXPECT_EQ(read_file(folder / "tables/numbers.csv"),
            "table,quantity,value,error,unit,description\n"
            "pairs,peak,1.25,0.5,m,\"where g is largest, in words\"\n"
            "pairs,count,7,nan,1,of pairs\n"
            "fit,a,2,0.1,1,slope\n");
}

TEST(CsvTables, AreLeftOutWhereThereAreNoRows) {
  const TemporaryFolder folder;
  write("csv", folder);
  EXPECT_TRUE(std::filesystem::exists(folder / "tables/pairs.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "tables/fit.csv"));
}

TEST(Hdf5Tables, AreGroupsWithADatasetPerColumn) {
  const TemporaryFolder folder;
  const Hdf5Reader file(write("hdf5", folder));
  EXPECT_THAT(file.read<double>("/pairs/distance"), ElementsAre(0.5, 1.0 / 3.0));
  EXPECT_EQ(file.text_of("/pairs/distance", "units"), "m");
  EXPECT_EQ(file.text_of("/pairs/distance", "long_name"), "of centres");
  EXPECT_EQ(file.text_of("/pairs", "equation"), "g = n/n_0  (1)");
  EXPECT_THAT(file.read<double>("/pairs/numbers/peak"), ElementsAre(1.25));
  EXPECT_THAT(file.read<double>("/fit/numbers/a"), ElementsAre(2.0));
  EXPECT_EQ(file.text("/provenance/version"), "1");
}

TEST(Hdf5Tables, GiveTheSameBytesAgain) {
  const TemporaryFolder one, other;
  EXPECT_TRUE(read_file(write("hdf5", one)) == read_file(write("hdf5", other)));
}

TEST(Tables, AFolderThatCannotBeMadeIsAnIoError) {
  const TemporaryFolder folder;
  write_file(folder / "tables", "a file in the way");
  EXPECT_THROW(write("csv", folder), IoError);
}

}  // namespace
}  // namespace grainvdb::table_sinks_test
