#pragma once
/// The options that stages and measurements declare, as keys of pipeline files.
#include <functional>
#include <string>

#include "pipeline/schema.hpp"

namespace grainvdb {

/// The key of an option in a section; `options_of` finds the values that the section sets.
KeyInfo option_key(const std::string& section, const OptionInfo& option,
                   std::function<OptionValues&(Pipeline&)> options_of);

}  // namespace grainvdb
