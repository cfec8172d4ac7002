#include "read/line_reader.hpp"

#include "unit/read/dump_files.hpp"

namespace grainvdb::line_reader_test {
namespace {

using namespace testing_dumps;

class LineReaderTest : public ::testing::Test {
 protected:
  LineReader open(const std::string& text) {
    path_ = files_.write("text", text);
    return {open_bytes(path_, counter_).bytes, path_};
  }
  DumpFiles files_;
  std::string path_;
  std::size_t counter_ = 0;
};

TEST_F(LineReaderTest, NumbersLinesAndTellsACutOffLastLine) {
  LineReader lines = open("one\n\nthree");
  std::string_view line;
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(line, "one");
  EXPECT_EQ(lines.line_number(), 1U);
  EXPECT_TRUE(lines.complete());
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(line, "");
  EXPECT_TRUE(lines.complete());
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(line, "three");
  EXPECT_EQ(lines.line_number(), 3U);
  EXPECT_FALSE(lines.complete());
  EXPECT_FALSE(lines.next(line));
  EXPECT_FALSE(lines.next(line));
}

TEST_F(LineReaderTest, EmptyFileHasNoLines) {
  LineReader lines = open("");
  std::string_view line;
  EXPECT_FALSE(lines.next(line));
}

TEST_F(LineReaderTest, UnreadGivesTheLineAgain) {
  LineReader lines = open("one\ntwo\n");
  std::string_view line;
  ASSERT_TRUE(lines.next(line));
  lines.unread();
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(line, "one");
  EXPECT_EQ(lines.line_number(), 1U);
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(line, "two");
}

TEST_F(LineReaderTest, LinesOfEveryLengthAcrossBufferBoundaries) {
  std::mt19937 random(3);
  std::vector<std::string> expected;
  std::string text;
  for (int i = 0; i < 20'000; ++i) {
    // Mostly short lines, some longer than the first buffers.
    const std::size_t n = i % 500 == 0 ? random() % 200'000 : random() % 100;
    expected.emplace_back(n, static_cast<char>('a' + i % 26));
    text += expected.back() + "\n";
  }
  LineReader lines = open(text);
  std::vector<TextPosition> starts;
  std::string_view line;
  for (const std::string& e : expected) {
    starts.push_back(lines.position());
    ASSERT_TRUE(lines.next(line));
    ASSERT_EQ(line, e);
  }
  EXPECT_FALSE(lines.next(line));
  for (const std::size_t i : {std::size_t{0}, std::size_t{19'999}, std::size_t{10'001}, std::size_t{10'000}}) {
    lines.seek(starts[i]);
    EXPECT_EQ(lines.position().offset, starts[i].offset);
    EXPECT_EQ(lines.position().line, starts[i].line);
    ASSERT_TRUE(lines.next(line));
    EXPECT_EQ(line, expected[i]);
    EXPECT_EQ(lines.line_number(), i + 1);
  }
}

TEST_F(LineReaderTest, RefusesALineThatHasNoEnd) {
  LineReader lines = open("first\n" + std::string(3'000'000, 'x'));
  std::string_view line;
  ASSERT_TRUE(lines.next(line));
  expect_error<InputError>([&] { lines.next(line); }, {path_ + ":2", "longer than 1 MiB"});
}

TEST_F(LineReaderTest, ReadsNoMoreThanAFirstPieceForAHeader) {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += "a line of some length\n";
  LineReader lines = open(text);
  std::string_view line;
  for (int i = 0; i < 9; ++i) ASSERT_TRUE(lines.next(line));
  EXPECT_LE(counter_, 16'384U);
}

}  // namespace
}  // namespace grainvdb::line_reader_test
