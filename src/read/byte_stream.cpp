#include "read/byte_stream.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include "grainvdb/error.hpp"

namespace grainvdb {
namespace {

/// An open file descriptor.
class RawFile {
 public:
  explicit RawFile(std::string path) : path_(std::move(path)), fd_(::open(path_.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (fd_ < 0) throw IoError("cannot open", path_, errno);
  }
  RawFile(RawFile&& other) noexcept : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)) {}
  RawFile& operator=(RawFile&&) = delete;
  ~RawFile() {
    if (fd_ >= 0) ::close(fd_);
  }

  std::size_t read(char* out, std::size_t n) {
    for (;;) {
      const ssize_t got = ::read(fd_, out, n);
      if (got >= 0) return static_cast<std::size_t>(got);
      if (errno != EINTR) throw IoError("cannot read", path_, errno);
    }
  }
  void seek(std::uint64_t offset) {
    if (::lseek(fd_, static_cast<off_t>(offset), SEEK_SET) < 0) throw IoError("cannot seek", path_, errno);
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int fd_;
};

class PlainStream final : public ByteStream {
 public:
  PlainStream(RawFile file, std::size_t& counter) : ByteStream(counter), file_(std::move(file)) {}
  void seek(std::uint64_t offset) override { file_.seek(offset); }

 protected:
  std::size_t read_some(char* out, std::size_t n) override { return file_.read(out, n); }

 private:
  RawFile file_;
};

/// What the decompressors share: a buffer of compressed bytes, and seeking by reading forward.
class CompressedStream : public ByteStream {
 public:
  void seek(std::uint64_t offset) override {
    if (offset < position_) {
      file_.seek(0);
      begin_ = end_ = 0;
      position_ = 0;
      restart();
    }
    std::vector<char> scratch(std::min<std::uint64_t>(offset - position_, std::uint64_t{1} << 18));
    while (position_ < offset) {
      const auto n = std::min<std::uint64_t>(offset - position_, scratch.size());
      if (read(scratch.data(), static_cast<std::size_t>(n)) == 0) fail("shorter than when it was first read");
    }
  }

 protected:
  CompressedStream(RawFile file, std::size_t& counter)
      : ByteStream(counter), file_(std::move(file)), input_(std::size_t{1} << 17) {}

  std::size_t read_some(char* out, std::size_t n) final {
    const std::size_t got = decompress(out, n);
    position_ += got;
    return got;
  }
  /// Fills `out` as far as the content goes.
  virtual std::size_t decompress(char* out, std::size_t n) = 0;
  virtual void restart() = 0;

  /// True when compressed bytes are at hand; false at the end of the file.
  bool have_input() {
    if (begin_ == end_) {
      begin_ = 0;
      end_ = file_.read(input_.data(), input_.size());
    }
    return begin_ != end_;
  }
  const char* input() const { return input_.data() + begin_; }
  std::size_t input_size() const { return end_ - begin_; }
  void consume(std::size_t n) { begin_ += n; }

  [[noreturn]] void fail(const std::string& what) const { throw InputError({{file_.path(), 0}, what, {}, {}, {}}); }
  [[noreturn]] void fail_cut_off() const {
    throw InputError({{file_.path(), 0},
                      "the compressed file is cut off",
                      "the end of the file within compressed data",
                      {},
                      "Copy or compress it again"});
  }

 private:
  RawFile file_;
  std::vector<char> input_;
  std::size_t begin_ = 0, end_ = 0;
  std::uint64_t position_ = 0;
};

/// gzip, any number of members one after another.
class GzipStream final : public CompressedStream {
 public:
  GzipStream(RawFile file, std::size_t& counter) : CompressedStream(std::move(file), counter) {
    constexpr int gzip_only = 16 + MAX_WBITS;
    if (inflateInit2(&z_, gzip_only) != Z_OK) fail("zlib cannot be initialised");
  }
  ~GzipStream() override { inflateEnd(&z_); }

 protected:
  void restart() override { in_member_ = false; }

  std::size_t decompress(char* out, std::size_t n) override {
    n = std::min<std::size_t>(n, std::numeric_limits<uInt>::max());
    z_.next_out = reinterpret_cast<Bytef*>(out);
    z_.avail_out = static_cast<uInt>(n);
    while (z_.avail_out > 0) {
      if (!have_input()) {
        if (in_member_) fail_cut_off();
        break;
      }
      if (!in_member_ && !begin_member()) continue;
      z_.next_in = reinterpret_cast<z_const Bytef*>(const_cast<char*>(input()));
      z_.avail_in = static_cast<uInt>(input_size());
      const int code = inflate(&z_, Z_NO_FLUSH);
      consume(input_size() - z_.avail_in);
      if (code == Z_STREAM_END)
        in_member_ = false;
      else if (code != Z_OK && code != Z_BUF_ERROR)
        fail(std::string("the gzip data is corrupt: ") + (z_.msg != nullptr ? z_.msg : "unknown fault"));
    }
    return n - z_.avail_out;
  }

 private:
  /// Zero bytes may pad the end of a file (tapes do); anything else must be a new member.
  bool begin_member() {
    if (*input() == 0) {
      consume(1);
      return false;
    }
    if (static_cast<unsigned char>(*input()) != 0x1f) fail("the gzip file goes on with something else than gzip data");
    inflateReset(&z_);
    in_member_ = true;
    return true;
  }

  z_stream z_{};
  bool in_member_ = false;
};

/// zstd, any number of frames one after another.
class ZstdStream final : public CompressedStream {
 public:
  ZstdStream(RawFile file, std::size_t& counter)
      : CompressedStream(std::move(file), counter), context_(ZSTD_createDCtx(), &ZSTD_freeDCtx) {
    if (!context_) fail("zstd cannot be initialised");
  }

 protected:
  void restart() override {
    ZSTD_DCtx_reset(context_.get(), ZSTD_reset_session_only);
    wanted_ = 0;
  }

  std::size_t decompress(char* out, std::size_t n) override {
    ZSTD_outBuffer output{out, n, 0};
    while (output.pos < output.size) {
      const bool at_end = !have_input();
      if (at_end && wanted_ == 0) break;
      ZSTD_inBuffer in{input(), input_size(), 0};
      const std::size_t before = output.pos;
      wanted_ = ZSTD_decompressStream(context_.get(), &output, &in);
      if (ZSTD_isError(wanted_)) fail(std::string("the zstd data is corrupt: ") + ZSTD_getErrorName(wanted_));
      consume(in.pos);
      if (at_end && output.pos == before) fail_cut_off();
    }
    return output.pos;
  }

 private:
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context_;
  std::size_t wanted_ = 0;  ///< 0 where a frame has ended
};

Compression recognise(const unsigned char* head, std::size_t n) {
  if (n >= 2 && head[0] == 0x1f && head[1] == 0x8b) return Compression::gzip;
  // 0xfd2fb528, little endian, or one of the sixteen magic numbers of skippable frames.
  if (n >= 4 && ((head[0] == 0x28 && head[1] == 0xb5 && head[2] == 0x2f && head[3] == 0xfd) ||
                 ((head[0] & 0xf0) == 0x50 && head[1] == 0x2a && head[2] == 0x4d && head[3] == 0x18)))
    return Compression::zstd;
  return Compression::none;
}

}  // namespace

std::size_t ByteStream::read(char* out, std::size_t n) {
  const std::size_t got = read_some(out, n);
  counter_ += got;
  return got;
}

OpenedBytes open_bytes(const std::string& path, std::size_t& counter) {
  RawFile file(path);
  char head[4];
  std::size_t n = 0;
  while (n < sizeof head) {
    const std::size_t got = file.read(head + n, sizeof head - n);
    if (got == 0) break;
    n += got;
  }
  file.seek(0);
  const Compression compression = recognise(reinterpret_cast<const unsigned char*>(head), n);
  switch (compression) {
    case Compression::gzip:
      return {std::make_unique<GzipStream>(std::move(file), counter), compression};
    case Compression::zstd:
      return {std::make_unique<ZstdStream>(std::move(file), counter), compression};
    case Compression::none:
      break;
  }
  return {std::make_unique<PlainStream>(std::move(file), counter), compression};
}

}  // namespace grainvdb
