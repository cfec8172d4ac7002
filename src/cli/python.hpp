#pragma once
/// The part of the program that is written in Python: what draws.
#include <string>
#include <vector>

namespace grainvdb::cli {

/// Replaces this process by `python3 -m module arguments…`, with the package that belongs to this command on its path.
/// The interpreter is that of the environment variable GRAINVDB_PYTHON, or the first of `python3` and /usr/bin/python3
/// that has every module of `needs`. Throws IoError when there is none.
[[noreturn]] void become_python(const std::string& module, const std::vector<std::string>& arguments,
                                const std::vector<std::string>& needs);

}  // namespace grainvdb::cli
