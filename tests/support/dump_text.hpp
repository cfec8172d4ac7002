#pragma once
/// Text dumps taken apart and written in other ways, for tests of their equivalence.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace grainvdb::testing {

/// One frame of a text dump: its header, up to the line that names the columns, and its rows.
struct DumpText {
  std::vector<std::string> header;
  std::vector<std::string> rows;
  std::string text() const;
  /// The columns that the last line of the header names.
  std::vector<std::string> columns() const;
};
DumpText read_dump_text(const std::string& file);

void write_plain(const std::string& file, const std::string& text);
void write_gzip(const std::string& file, const std::string& text);
void write_zstd(const std::string& file, const std::string& text);

/// A folder that is removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace grainvdb::testing
