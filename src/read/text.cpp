#include "read/text.hpp"

#include <algorithm>

namespace grainvdb {

std::string_view take_token(std::string_view& line) {
  std::size_t begin = 0;
  while (begin < line.size() && is_blank(line[begin])) ++begin;
  std::size_t end = begin;
  while (end < line.size() && !is_blank(line[end])) ++end;
  const std::string_view token = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return token;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 40;
  constexpr char digits[] = "0123456789abcdef";
  std::string result = "'";
  for (const char c : text.substr(0, longest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7f) {
      result += c;
    } else {
      result += "\\x";
      result += digits[byte >> 4];
      result += digits[byte & 15];
    }
  }
  return result + (text.size() > longest ? "...'" : "'");
}

bool is_name(std::string_view text) {
  return text.size() <= 200 && std::all_of(text.begin(), text.end(), [](char c) { return c >= 0x20 && c < 0x7f; });
}

std::string joined(const std::vector<std::string>& names) {
  constexpr std::size_t longest = 600;
  std::string text;
  for (const std::string& name : names) {
    if (text.size() + name.size() > longest) return text + " ...";
    text += (text.empty() ? "" : " ") + name;
  }
  return text;
}

}  // namespace grainvdb
