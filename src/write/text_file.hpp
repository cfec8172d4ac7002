#pragma once
#include <string>
#include <string_view>

#include "write/atomic_file.hpp"

namespace grainvdb {

/// Puts a text into a file that appears under its name when it is complete, as AtomicFile.
inline void write_text_file(const std::string& path, std::string_view text) {
  AtomicFile file(path);
  file.write(0, text);
  file.finish();
  file.publish();
}

}  // namespace grainvdb
