#pragma once
/// Options that stages and pipeline sections declare about themselves. One declaration feeds the pipeline file's
/// validation, `grainvdb stages`, the help texts and the JSON schema.
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace grainvdb {

using OptionValue =
    std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>, std::vector<double>>;

/// The declaration of one option.
struct OptionInfo {
  std::string name;
  OptionValue default_value;           ///< also fixes the type
  std::string help;                    ///< one line; units included where there are any
  std::vector<std::string> choices{};  ///< for texts (and the items of lists): what is accepted; empty: anything
  double minimum = -std::numeric_limits<double>::infinity();  ///< for numbers, inclusive
  double maximum = std::numeric_limits<double>::infinity();   ///< for numbers, inclusive
};

/// The values of one stage's options, defaults filled in.
using OptionValues = std::map<std::string, OptionValue>;

/// The option values of every stage: settings.at("temperature").at("mode").
using StageSettings = std::map<std::string, OptionValues>;

/// A value of known type, e.g. option<std::string>(settings, "temperature", "mode"). Both names must exist and the
/// type must be the declared one; anything else is a programming error (std::out_of_range, std::bad_variant_access).
template <class T>
const T& option(const StageSettings& settings, const std::string& stage, const std::string& name) {
  return std::get<T>(settings.at(stage).at(name));
}

}  // namespace grainvdb
