#include "support/dump_text.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <zlib.h>
#include <zstd.h>

namespace grainvdb::testing {

std::string DumpText::text() const {
  std::string all;
  for (const std::vector<std::string>* part : {&header, &rows})
    for (const std::string& line : *part) all += line + "\n";
  return all;
}

std::vector<std::string> DumpText::columns() const {
  std::istringstream words(header.back());
  std::vector<std::string> names;
  for (std::string word; words >> word;) names.push_back(word);
  return {names.begin() + 2, names.end()};  // after ITEM: and ATOMS or ENTRIES
}

DumpText read_dump_text(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot open " + file);
  DumpText dump;
  bool in_rows = false;
  for (std::string line; std::getline(in, line);) {
    (in_rows ? dump.rows : dump.header).push_back(line);
    in_rows = in_rows || line.starts_with("ITEM: ATOMS") || line.starts_with("ITEM: ENTRIES");
  }
  return dump;
}

void write_plain(const std::string& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

void write_gzip(const std::string& file, const std::string& text) {
  gzFile out = gzopen(file.c_str(), "wb6");
  const int written = gzwrite(out, text.data(), static_cast<unsigned>(text.size()));
  if (gzclose(out) != Z_OK || written != static_cast<int>(text.size()))
    throw std::runtime_error("cannot write " + file);
}

void write_zstd(const std::string& file, const std::string& text) {
  std::string packed(ZSTD_compressBound(text.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), text.data(), text.size(), 3);
  if (ZSTD_isError(size) != 0) throw std::runtime_error("cannot pack " + file);
  packed.resize(size);
  write_plain(file, packed);
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "grainvdb_test_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace grainvdb::testing
