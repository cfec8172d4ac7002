#include "cli/error_json.hpp"

#include <string>

namespace grainvdb::cli {
namespace {

const char* kind(int exit_code) {
  switch (exit_code) {
    case 1:
      return "config";
    case 2:
      return "input";
    case 3:
      return "io";
    case 4:
      return "limit";
    default:
      return "other";
  }
}

}  // namespace

nlohmann::ordered_json error_json(const Error& error) {
  const Problem& p = error.problem();
  nlohmann::ordered_json json{{"kind", kind(error.exit_code())}, {"exit_code", error.exit_code()}};
  if (!p.where.file.empty()) json["file"] = p.where.file;
  if (p.where.line > 0) json["line"] = p.where.line;
  for (const auto& [name, text] : {std::pair<const char*, const std::string&>{"what", p.what},
                                   {"found", p.found},
                                   {"expected", p.expected},
                                   {"hint", p.hint}})
    if (!text.empty()) json[name] = text;
  json["message"] = error.what();
  return json;
}

}  // namespace grainvdb::cli
