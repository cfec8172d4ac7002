#pragma once
/// Numbers and texts from a byte stream, in the byte order of this machine.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "read/byte_stream.hpp"

namespace grainvdb {

class BinaryReader {
 public:
  BinaryReader(std::unique_ptr<ByteStream> bytes, std::string file);

  /// Reads n bytes. Throws InputError, which says at which byte, where fewer are left.
  void read(void* out, std::size_t n);
  template <class T>
  T number() {
    T value{};
    read(&value, sizeof value);
    return value;
  }
  /// A text of that many bytes. Memory is taken as the bytes come.
  std::string text(std::size_t n);

  /// Passes over n bytes; false where fewer are left.
  bool skip(std::uint64_t n);
  bool at_end();
  void seek(std::uint64_t offset);

  /// How many bytes lie before the next one.
  std::uint64_t position() const { return base_ + begin_; }
  const std::string& file() const { return file_; }

  /// Throws an InputError that names the place.
  [[noreturn]] void fail(const std::string& what, const std::string& found, const std::string& expected,
                         const std::string& hint = {}) const;

 private:
  bool refill();

  std::unique_ptr<ByteStream> bytes_;
  std::string file_;
  std::vector<char> buffer_;
  std::uint64_t base_ = 0;  ///< where the buffer begins in the stream
  std::size_t begin_ = 0, end_ = 0;
};

}  // namespace grainvdb
