#pragma once
/// Checks of numbers on the command line that say what is expected. CLI11's own print the largest double in full.
#include <string>

#include <CLI/CLI.hpp>

#include "pipeline/number.hpp"
#include "pipeline/text.hpp"

namespace grainvdb::cli {

inline CLI::Validator positive_number() {
  const auto check = [](std::string& text) -> std::string {
    const auto number = parse_number(text);
    return number && *number > 0 ? "" : quote_text(text) + " is not a number > 0";
  };
  return {check, "POSITIVE"};
}

inline CLI::Validator nonnegative_number() {
  const auto check = [](std::string& text) -> std::string {
    const auto number = parse_number(text);
    return number && *number >= 0 ? "" : quote_text(text) + " is not a number >= 0";
  };
  return {check, "NONNEGATIVE"};
}

}  // namespace grainvdb::cli
