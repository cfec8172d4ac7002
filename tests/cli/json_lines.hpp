#pragma once
/// What a command logs with --log-json.
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace grainvdb::test {

/// An object a line. Throws where a line is none.
inline std::vector<nlohmann::json> json_lines(const std::string& text) {
  std::vector<nlohmann::json> all;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) all.push_back(nlohmann::json::parse(line));
  return all;
}

}  // namespace grainvdb::test
