#include "read/byte_stream.hpp"

#include "unit/read/dump_files.hpp"

namespace grainvdb::byte_stream_test {
namespace {

using namespace testing_dumps;

/// Text that neither repeats nor compresses well, several times as long as any buffer.
std::string long_text() {
  std::mt19937 random(7);
  std::string text(3'000'000, '\0');
  for (char& c : text) c = static_cast<char>('!' + random() % 90);
  return text;
}

/// Reads to the end in pieces of n bytes.
std::string read_all(ByteStream& bytes, std::size_t n) {
  std::string text, piece(n, '\0');
  for (std::size_t got = bytes.read(piece.data(), n); got != 0; got = bytes.read(piece.data(), n))
    text.append(piece, 0, got);
  return text;
}

struct Encoding {
  const char* name;
  Compression compression;
  std::string (*encode)(const std::string&);
};

class ByteStreamTest : public ::testing::TestWithParam<Encoding> {
 protected:
  DumpFiles files_;
  std::size_t counter_ = 0;
};

INSTANTIATE_TEST_SUITE_P(
    Encodings, ByteStreamTest,
    ::testing::Values(Encoding{"plain", Compression::none, [](const std::string& text) { return text; }},
                      Encoding{"gzip", Compression::gzip, gzipped},
                      Encoding{"zstd", Compression::zstd, zstd_compressed},
                      Encoding{"gzip_members", Compression::gzip,
                               [](const std::string& text) {
                                 return gzipped(text.substr(0, text.size() / 3)) + gzipped("") +
                                        gzipped(text.substr(text.size() / 3));
                               }},
                      Encoding{"zstd_frames", Compression::zstd,
                               [](const std::string& text) {
                                 return zstd_compressed(text.substr(0, text.size() / 3)) + zstd_compressed("") +
                                        zstd_compressed(text.substr(text.size() / 3));
                               }},
                      Encoding{"gzip_padded", Compression::gzip,
                               [](const std::string& text) { return gzipped(text) + std::string(700, '\0'); }},
                      Encoding{"zstd_skippable", Compression::zstd,
                               [](const std::string& text) {
                                 return std::string("\x50\x2a\x4d\x18\x03\0\0\0abc", 11) + zstd_compressed(text);
                               }}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST_P(ByteStreamTest, DeliversTheContentWhateverTheNameSays) {
  const std::string text = long_text();
  const OpenedBytes opened = open_bytes(files_.write("data.txt", GetParam().encode(text)), counter_);
  EXPECT_EQ(opened.compression, GetParam().compression);
  EXPECT_EQ(read_all(*opened.bytes, 777), text);
  EXPECT_EQ(counter_, text.size());
  char more = 0;
  EXPECT_EQ(opened.bytes->read(&more, 1), 0U);
}

TEST_P(ByteStreamTest, SeeksForwardsAndBackwards) {
  const std::string text = long_text();
  const OpenedBytes opened = open_bytes(files_.write("data", GetParam().encode(text)), counter_);
  for (const std::size_t offset : {std::size_t{2'500'000}, std::size_t{17}, std::size_t{1'999'999}, std::size_t{0}}) {
    opened.bytes->seek(offset);
    std::string piece(100, '\0');
    std::size_t n = 0;
    while (n < piece.size()) n += opened.bytes->read(piece.data() + n, piece.size() - n);
    EXPECT_EQ(piece, text.substr(offset, 100)) << offset;
  }
  opened.bytes->seek(1'000'000);
  EXPECT_EQ(read_all(*opened.bytes, 1 << 16), text.substr(1'000'000));
}

TEST_P(ByteStreamTest, EmptyContentIsDelivered) {
  const OpenedBytes opened = open_bytes(files_.write("data", GetParam().encode(std::string())), counter_);
  EXPECT_EQ(read_all(*opened.bytes, 10), "");
}

TEST(ByteStream, MissingFileIsAnIoError) {
  std::size_t counter = 0;
  expect_error<IoError>([&] { open_bytes("/nonexistent/dump", counter); }, {"/nonexistent/dump", "cannot open"});
}

TEST(ByteStream, DirectoryIsAnIoError) {
  const DumpFiles files;
  std::size_t counter = 0;
  expect_error<IoError>([&] { open_bytes(files.directory(), counter); }, {files.directory(), "cannot read"});
}

}  // namespace
}  // namespace grainvdb::byte_stream_test
