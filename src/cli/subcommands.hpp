#pragma once
#include <vector>

#include <CLI/CLI.hpp>

namespace grainvdb::cli {

/// Of the command itself, whether they were called or not.
inline std::vector<const CLI::App*> subcommands_of(const CLI::App& command) {
  return command.get_subcommands([](const CLI::App*) { return true; });
}

}  // namespace grainvdb::cli
