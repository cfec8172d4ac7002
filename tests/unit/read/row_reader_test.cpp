#include <memory>
#include <optional>

#include <tbb/global_control.h>

#include "read/number.hpp"
#include "read/text_dump.hpp"
#include "support/random.hpp"
#include "unit/read/dump_files.hpp"

namespace grainvdb::row_reader_test {
namespace {

using namespace testing_dumps;
using testing::Random;

constexpr std::size_t thread_counts[] = {1, 2, 5};

/// What reading a frame gives: a table, or what is thrown.
struct Outcome {
  DumpTable table;
  std::string error;
};

class RowReaderTest : public ::testing::Test {
 protected:
  /// The frame at the start of a file, and then where the reader stands.
  Outcome read(const std::string& path, const TableRequest& request, std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    TextDump dump(LineReader(open_bytes(path, counter_).bytes, path));
    if (!dump.next_header()) throw std::runtime_error("no frame");
    Outcome outcome;
    try {
      outcome.table = dump.read_rows(request);
      const std::optional<FrameHeader> next = dump.next_header();
      outcome.error = next ? "then step " + std::to_string(next->step) : "then the end";
    } catch (const InputError& error) {
      outcome.error = error.what();
    }
    return outcome;
  }

  /// Checks that any number of threads does the same; returns that.
  Outcome read_alike(const std::string& path, const TableRequest& request) {
    const Outcome one = read(path, request, 1);
    for (const std::size_t threads : thread_counts) {
      const Outcome many = read(path, request, threads);
      EXPECT_EQ(many.error, one.error) << threads;
      EXPECT_EQ(many.table.rows, one.table.rows);
      EXPECT_EQ(many.table.real, one.table.real);
      EXPECT_EQ(many.table.whole, one.table.whole);
    }
    return one;
  }

  DumpFiles files_;
  std::size_t counter_ = 0;
};

std::vector<std::string> random_rows(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::string> rows(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::string& row = rows[i];
    row = std::to_string(i + 1);
    for (int c = 0; c < 4; ++c)
      row += (random.below(50) == 0 ? "   " : " ") + printed(random.below(20) == 0 ? "%.17g" : "%g", random.normal());
    // Now and then something that the fast path leaves to others.
    row += random.below(100) == 0 ? " 7.0" : " 7";
    if (random.below(3) == 0) row += " ";
    if (random.below(50) == 0) row += "\t\r";
  }
  return rows;
}

const std::string columns = "id x y z w type";
const TableRequest every_column{{1, 2, 3, 4}, {0, 5}};

/// Token by token.
void expect_holds(const DumpTable& table, const std::vector<std::string>& rows, const TableRequest& request) {
  ASSERT_EQ(table.rows, rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::string_view line = rows[i];
    std::vector<std::string_view> tokens;
    for (std::string_view token = take_token(line); !token.empty(); token = take_token(line)) tokens.push_back(token);
    for (std::size_t c = 0; c < request.real.size(); ++c) {
      double value = 0;
      ASSERT_TRUE(parse_real(tokens[request.real[c]], value));
      ASSERT_EQ(table.real[c][i], value);
    }
    for (std::size_t c = 0; c < request.whole.size(); ++c) {
      std::int64_t value = 0;
      ASSERT_TRUE(parse_whole(tokens[request.whole[c]], value));
      ASSERT_EQ(table.whole[c][i], value);
    }
  }
}

TEST_F(RowReaderTest, GivesTheSameForAnyNumberOfThreadsAndAnyEncoding) {
  const auto rows = random_rows(60'000, 1);
  const std::string text = particle_dump(1, columns, rows) + particle_dump(2, columns, {"1 0 0 0 0 1"});
  for (const std::string& content : {text, gzipped(text), zstd_compressed(text)}) {
    const Outcome outcome = read_alike(files_.write("dump", content), every_column);
    EXPECT_EQ(outcome.error, "then step 2");
    EXPECT_EQ(outcome.table.first_line, static_cast<std::size_t>(first_row_line));
    expect_holds(outcome.table, rows, every_column);
  }
}

TEST_F(RowReaderTest, SkipsColumnsThatAreNotWanted) {
  const auto rows = random_rows(30'000, 2);
  const std::string path = files_.write("dump", particle_dump(1, columns, rows));
  const TableRequest some{{3}, {0}};
  expect_holds(read_alike(path, some).table, rows, some);
  EXPECT_EQ(read_alike(path, TableRequest{}).table.rows, rows.size());
}

TEST_F(RowReaderTest, StopsWhereTheFrameEnds) {
  // Many small frames in one buffer.
  std::string text;
  for (int step = 0; step < 200; ++step)
    text += particle_dump(step, columns, random_rows(static_cast<std::size_t>(step) * 7 % 300, 3));
  const std::string path = files_.write("dump", text);
  for (const std::size_t threads : thread_counts) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    TextDump dump(LineReader(open_bytes(path, counter_).bytes, path));
    for (int step = 0; step < 200; ++step) {
      ASSERT_EQ(dump.next_header()->step, step);
      ASSERT_EQ(dump.read_rows(every_column).rows, static_cast<std::size_t>(step) * 7 % 300);
    }
    EXPECT_TRUE(dump.at_end());
  }
}

TEST_F(RowReaderTest, SkipsRowsUpToTheEndOfTheFrame) {
  auto rows = random_rows(20'000, 9);
  for (std::size_t i = 0; i < rows.size(); i += 1000) rows[i].insert(0, "Indium ");  // as if a section began
  const std::string two = particle_dump(1, columns, rows) + particle_dump(2, columns, {"1 0 0 0 0 1"});
  const auto skips = [&](const std::string& text) {
    const std::string path = files_.write("dump", text);
    auto dump = std::make_unique<TextDump>(LineReader(open_bytes(path, counter_).bytes, path));
    EXPECT_TRUE(dump->next_header());
    return std::pair(dump->skip_rows(), std::move(dump));
  };
  auto [skipped, dump] = skips(two);
  EXPECT_TRUE(skipped);
  EXPECT_EQ(dump->next_header()->step, 2);
  EXPECT_TRUE(dump->skip_rows());
  EXPECT_TRUE(dump->at_end());

  std::string text = two;
  text.replace(text.find("20000"), 5, "20001");
  EXPECT_FALSE(skips(text).first);
  text.replace(text.find("20001"), 5, "19999");
  expect_error<InputError>([&] { skips(text); }, {"there is text after the last row"});
  EXPECT_FALSE(skips(two.substr(0, two.size() / 2)).first);
}

TEST_F(RowReaderTest, RefusesTheFirstBadLineWhateverTheNumberOfThreads) {
  const auto good = random_rows(60'000, 4);
  const std::vector<std::pair<std::string, std::string>> bad{{"1 2 3 x 5 6", "bad value in column z"},
                                                             {"1.5 2 3 4 5 6", "bad value in column id"},
                                                             {"1 2 3 4 5", "the row is too short"},
                                                             {"1 2 3 4 5 6 7", "the row is too long"},
                                                             {"", "the row is too short"},
                                                             {"1 2 3 4\x01 5 6", "bad value in column z"},
                                                             {"1 2 3 inf 5 6", "bad value in column z"},
                                                             {"ITEM: 2 3 4 5 6", "the next frame begins too early"}};
  Random random(5);
  for (std::size_t trial = 0; trial < 2 * bad.size(); ++trial) {
    auto rows = good;
    // Others behind the first: whoever meets them must not tell of them.
    const std::size_t first = trial % 2 == 0 ? random.below(50'000) : 37;
    rows[first] = bad[trial % bad.size()].first;
    for (std::size_t k = 0; k < 5; ++k) rows[first + 1 + random.below(9'000)] = bad[k].first;
    const std::string path = files_.write("dump", particle_dump(1, columns, rows));
    const Outcome outcome = read_alike(path, every_column);
    EXPECT_THAT(outcome.error, ::testing::HasSubstr(bad[trial % bad.size()].second));
    EXPECT_THAT(outcome.error, ::testing::HasSubstr(path + ":" + std::to_string(first + first_row_line)));
  }
}

TEST_F(RowReaderTest, ShortAndLongRowsDoNotMakeUpForEachOther) {
  auto rows = random_rows(3000, 6);
  rows[2000] = "1 2 3 4 5";
  rows[2001] = "6 7 8 9 10 11 12";
  EXPECT_THAT(read_alike(files_.write("dump", particle_dump(1, columns, rows)), every_column).error,
              ::testing::HasSubstr("5 fields in '1 2 3 4 5'"));
}

TEST_F(RowReaderTest, TellsOfAFaultOfTheFileOnlyBehindTheRowsBeforeIt) {
  auto rows = random_rows(60'000, 7);
  const auto cut_off = [&] {
    std::string file = gzipped(particle_dump(1, columns, rows));
    file.resize(file.size() * 3 / 4);
    return files_.write("dump", file);
  };
  EXPECT_THAT(read_alike(cut_off(), every_column).error, ::testing::HasSubstr("the compressed file is cut off"));
  rows[15'000] = "1 2 3 4 5 x";
  EXPECT_THAT(read_alike(cut_off(), every_column).error, ::testing::HasSubstr("bad value in column type"));
}

TEST_F(RowReaderTest, ReadsTextThatItCannotVectorise) {
  // A name with control characters in a column that nobody wants, and lines longer than what is indexed at once.
  std::vector<std::string> rows;
  for (std::size_t i = 0; i < 500; ++i)
    rows.push_back(std::to_string(i + 1) + " 0.5 1 2 " + (i % 2 == 0 ? "a\x01b" : std::string(i * 40, 'c')) + "d 3");
  const TableRequest some{{1, 2, 3}, {0, 5}};
  expect_holds(read_alike(files_.write("dump", particle_dump(1, columns, rows)), some).table, rows, some);
}

TEST_F(RowReaderTest, DoesNotTrustTheCount) {
  std::string text = particle_dump(1, columns, random_rows(20'000, 8));
  text.replace(text.find("20000"), 5, "9000000000000000000");
  const Outcome outcome = read_alike(files_.write("dump", text), every_column);
  EXPECT_THAT(outcome.error, ::testing::HasSubstr("the file ends within a frame; found 20000 rows"));
}

}  // namespace
}  // namespace grainvdb::row_reader_test
