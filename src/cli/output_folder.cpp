#include "cli/output_folder.hpp"

#include <cerrno>
#include <filesystem>

#include <unistd.h>

#include "grainvdb/error.hpp"

namespace grainvdb::cli {

void check_output_folder(const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::path place = fs::absolute(folder, error).lexically_normal();
  while (!error && fs::status(place, error).type() == fs::file_type::not_found && place.has_relative_path()) {
    error.clear();
    place = place.parent_path();
  }
  if (error) throw IoError("cannot use the output folder", folder, error.value());
  if (!fs::is_directory(place, error))
    throw IoError("cannot make the output folder: " + place.string() + " is not a folder", folder, 0);
  if (access(place.c_str(), W_OK | X_OK) != 0) throw IoError("cannot write to the output folder", folder, errno);
}

}  // namespace grainvdb::cli
