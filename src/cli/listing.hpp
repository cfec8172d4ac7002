#pragma once
/// What the registries say of their entries, for the commands that list them.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "grainvdb/options.hpp"

namespace grainvdb::cli {

using Json = nlohmann::ordered_json;

/// What a command that lists a registry was asked for.
struct ListRequest {
  std::string name;  ///< of one entry; empty: all
  bool json = false;
  bool markdown = false;
};
/// NAME, --json and --markdown; `what` is what an entry is called.
std::shared_ptr<ListRequest> add_list_options(CLI::App& command, const std::string& what);

/// How entries are printed for people.
struct ListPrinters {
  void (*table)(const Json& entries);
  void (*markdown)(const Json& entries);
  void (*details)(const Json& entry);
};
/// Prints the entries of a registry, or the one that is asked for. Throws ConfigError, which calls an entry `what`, for
/// a name that none has.
void print_list(const ListRequest& request, const std::string& what, const Json& entries, const ListPrinters& printers);

/// Name, type, default, help and what is accepted.
Json describe_option(const OptionInfo& option);

/// On the standard output, an option after another.
void print_options(const Json& options);

/// "`name` (default), …"; "-" where there are none.
std::string options_in_short(const Json& options);

/// Texts with commas between them; `none` where there are none.
std::string joined(const Json& names, const char* none);

/// A text as a cell of a Markdown table.
std::string cell(std::string text);

}  // namespace grainvdb::cli
