#pragma once
/// Which files an input names: paths, directories and globs, in natural order.
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "grainvdb/error.hpp"

namespace grainvdb {

/// What a file is, whatever name it is reached by: device and inode.
using FileIdentity = std::pair<std::uint64_t, std::uint64_t>;

struct InputFile {
  /// What is known of a file that may still be written to.
  enum class State {
    fixed,    ///< nobody writes to it
    known,    ///< all its frames were complete when it was last looked through, and it has not changed since
    settled,  ///< it has not changed since the last look
    growing   ///< it has: its last frame may be on its way, even if it looks complete
  };

  std::string path;
  std::uintmax_t size = 0;   ///< [byte]
  std::int64_t changed = 0;  ///< time of the last change [ns]
  FileIdentity identity;
  bool named = true;  ///< by a path or a glob; false: met in a directory, which may hold other things than dumps
  State state = State::fixed;
};

/// Runs of digits compare as numbers: dump2 < dump10 < dump010b.
bool natural_less(std::string_view a, std::string_view b);

/// The regular files that the patterns name, each once, in natural order. A pattern is a path, a directory (its files
/// that are not hidden, without its subdirectories), or a glob with * ? []. `where` says where the patterns were given.
/// Throws InputError for a pattern that matches nothing or names something that is not a regular file, IoError for a
/// path that cannot be examined.
std::vector<InputFile> list_files(const std::vector<std::string>& patterns, const Location& where);

}  // namespace grainvdb
