#pragma once
/// What the registries say of their entries, for the commands that list them.
#include <string>

#include <nlohmann/json.hpp>

#include "grainvdb/options.hpp"

namespace grainvdb::cli {

using Json = nlohmann::ordered_json;

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
