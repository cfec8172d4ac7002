#pragma once
/// A file that appears under its name only when it is complete.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace grainvdb {

/// Bytes go to a temporary file in the target's folder, which `finish` makes durable and `publish` renames. Until then
/// a file of the final name stays as it is; a file that was not published is removed by the destructor. Every failure
/// is an IoError with the final path and errno.
class AtomicFile {
 public:
  /// Makes the folder where it is missing. Refuses a path that is a folder.
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::string& path() const { return path_; }
  const std::string& temporary_path() const { return temporary_path_; }

  void write(std::uint64_t offset, std::span<const std::byte> bytes);
  void write(std::uint64_t offset, std::string_view text) { write(offset, std::as_bytes(std::span(text))); }
  /// Fills `bytes`; what lies beyond the end of the file reads as zero.
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;
  std::uint64_t size() const;
  void resize(std::uint64_t size);

  /// Brings the bytes to the disk and closes the file: the last moment at which a full disk can show.
  void finish();
  /// Renames the finished file.
  void publish();

 private:
  [[noreturn]] void fail(const char* action, int error_number) const;

  std::string path_;
  std::string temporary_path_;
  int descriptor_ = -1;
  bool published_ = false;
};

/// Removes temporary files that programs left in a folder that were killed. None may be at work there.
void remove_leftovers(const std::string& folder);

/// Removes a file if there is one.
void remove_file(const std::string& path);

}  // namespace grainvdb
