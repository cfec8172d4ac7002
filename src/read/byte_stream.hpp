#pragma once
/// The bytes of a file, decompressed where it is compressed. The kind of compression is told from the first bytes,
/// never from the name. Memory is bounded whatever the size of the file.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace grainvdb {

enum class Compression { none, gzip, zstd };

class ByteStream {
 public:
  virtual ~ByteStream() = default;
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;

  /// Puts up to n bytes into `out` and returns their number: 0 only at the end. Throws IoError when the system cannot
  /// read, InputError when compressed data is corrupt or cut off.
  std::size_t read(char* out, std::size_t n);

  /// Continues at a byte of the decompressed content. A plain file jumps there; a compressed one is read forward, from
  /// its start when the place lies behind.
  virtual void seek(std::uint64_t offset) = 0;

 protected:
  explicit ByteStream(std::size_t& counter) : counter_(counter) {}
  virtual std::size_t read_some(char* out, std::size_t n) = 0;

 private:
  std::size_t& counter_;
};

struct OpenedBytes {
  std::unique_ptr<ByteStream> bytes;
  Compression compression = Compression::none;
};

/// Opens a file. `counter` grows by every byte delivered, after decompression, and must outlive the stream.
/// Throws IoError.
OpenedBytes open_bytes(const std::string& path, std::size_t& counter);

}  // namespace grainvdb
