#pragma once
/// Files of bytes that end in a checksum.
#include <cstdint>
#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "write/atomic_file.hpp"

namespace grainvdb {

/// Appears under its name, whole and on the disk, with `publish`. Throws IoError.
class CheckedFileWriter final : public ByteWriter {
 public:
  explicit CheckedFileWriter(const std::string& path);
  void write(const void* bytes, std::size_t count) override;
  void publish();

 private:
  void flush();

  AtomicFile file_;
  std::vector<char> buffer_;
  std::uint64_t offset_ = 0;
  std::uint32_t checksum_;
};

/// Throws IoError, or InputError when the file is not what was written.
class CheckedFileReader final : public ByteReader {
 public:
  /// Compares the checksum of the whole file.
  explicit CheckedFileReader(const std::string& path);
  ~CheckedFileReader() override;
  CheckedFileReader(const CheckedFileReader&) = delete;
  CheckedFileReader& operator=(const CheckedFileReader&) = delete;
  void read(void* bytes, std::size_t count) override;

 private:
  void check();
  void fill();
  [[noreturn]] void refuse() const;

  std::string path_;
  int descriptor_ = -1;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;
  std::uint64_t left_ = 0;  // in the file, behind the buffer and before the checksum
};

}  // namespace grainvdb
