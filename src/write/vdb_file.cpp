#include "write/vdb_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <ios>
#include <string>
#include <vector>

#include "grainvdb/error.hpp"

namespace grainvdb {
namespace {

/// Opens up OpenVDB's writer of seekable archives to any stream.
class Archive final : public openvdb::io::Archive {
 public:
  Ptr copy() const override { return std::make_shared<Archive>(*this); }
  void write_to(std::ostream& stream, const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata) const {
    openvdb::io::Archive::write(stream, grids, /*seekable=*/true, metadata);
  }
};

// The header: magic number (8 bytes), file version (4), library version (8), seekable (1), UUID (36 characters).
constexpr std::size_t uuid_at = 21;
constexpr std::size_t uuid_length = 36;

/// 128 bits of FNV-1a, in two halves that start differently, over everything after the UUID.
std::array<std::uint64_t, 2> content_hash(const AtomicFile& file) {
  constexpr std::uint64_t prime = 0x100000001b3;
  std::array<std::uint64_t, 2> hash{0xcbf29ce484222325, 0x9e3779b97f4a7c15};
  std::vector<std::byte> block(std::size_t{1} << 20);
  const std::uint64_t size = file.size();
  for (std::uint64_t at = uuid_at + uuid_length; at < size; at += block.size()) {
    block.resize(static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), size - at)));
    file.read(at, block);
    for (const std::byte b : block)
      for (std::uint64_t& h : hash) h = (h ^ std::to_integer<std::uint64_t>(b)) * prime;
  }
  return hash;
}

/// As a UUID of version 8, the one whose bits are the maker's own.
std::string uuid_of(std::array<std::uint64_t, 2> hash) {
  hash[0] = (hash[0] & ~std::uint64_t{0xf000}) | 0x8000;
  hash[1] = (hash[1] & ~(std::uint64_t{3} << 62)) | (std::uint64_t{2} << 62);
  std::string text;
  for (std::size_t digit = 0; digit < 32; ++digit) {
    if (digit == 8 || digit == 12 || digit == 16 || digit == 20) text += '-';
    text += "0123456789abcdef"[(hash[digit / 16] >> (60 - 4 * (digit % 16))) & 15];
  }
  return text;
}

}  // namespace

void initialize_openvdb() {
  static const bool once = (openvdb::initialize(), true);
  static_cast<void>(once);
}

void write_vdb(AtomicFile& file, const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata) {
  try {
    errno = 0;
    std::ofstream stream(file.temporary_path(), std::ios::binary | std::ios::in | std::ios::out);
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    Archive().write_to(stream, grids, metadata);
    stream.close();
  } catch (const std::ios_base::failure&) {
    throw IoError("cannot write", file.path(), errno);
  } catch (const openvdb::Exception& error) {
    throw IoError(std::string("cannot write: OpenVDB says: ") + error.what(), file.path(), 0);
  }
  file.write(uuid_at, uuid_of(content_hash(file)));
}

openvdb::GridPtrVecPtr read_vdb(const AtomicFile& file) {
  try {
    openvdb::io::File reader(file.temporary_path());
    reader.open(/*delayLoad=*/false);
    return reader.getGrids();
  } catch (const openvdb::Exception& error) {
    throw IoError(std::string("cannot read back: OpenVDB says: ") + error.what(), file.path(), 0);
  }
}

}  // namespace grainvdb
