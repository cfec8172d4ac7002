#include "read/number.hpp"

namespace grainvdb {

bool parse_real(std::string_view token, double& value) {
  const char* end = token.data() + token.size();
  return parse_real(token.data(), end, value) == end && !token.empty();
}

bool parse_whole(std::string_view token, std::int64_t& value) {
  const char* end = token.data() + token.size();
  return parse_whole(token.data(), end, value) == end && !token.empty();
}

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

}  // namespace grainvdb
