#pragma once
/// Files that are no dumps: what they are, told from their first bytes, so that they can be refused by name.
#include <string>
#include <string_view>

namespace grainvdb {

/// What a file is, and what its owner can do.
struct ForeignFile {
  std::string name;  ///< "an HDF5 file"
  std::string hint;  ///< may be empty
};

/// From the first bytes of the decompressed content.
ForeignFile what_it_looks_like(std::string_view head);

}  // namespace grainvdb
