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

}  // namespace grainvdb
