#pragma once
#include <string>

namespace grainvdb::cli {

/// Whether files can be made in a folder that may not exist yet; found out before any work is done. Throws IoError.
void check_output_folder(const std::string& folder);

}  // namespace grainvdb::cli
