#pragma once
/// Numbers in text, independent of the locale. A number must fill its whole token: "1.5e" is not 1.5.
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <system_error>

#include <fast_float/fast_float.h>

#include "read/text.hpp"

namespace grainvdb {

/// Parses the token that begins at p. Returns its end, or nullptr when it is not one finite decimal number.
inline const char* parse_real(const char* p, const char* end, double& value) {
  if (p != end && *p == '+') {
    ++p;
    if (p != end && *p == '-') return nullptr;
  }
  const auto [next, error] = fast_float::from_chars(p, end, value);
  if (error != std::errc() || !(next == end || is_blank(*next)) || !std::isfinite(value)) return nullptr;
  return next;
}

/// Parses the token that begins at p as a whole number, written with or without a fraction of zeros ("561", "561.0").
/// Exponents are refused: "1e+06" may stand for any number that rounds to it. Returns its end, or nullptr.
inline const char* parse_whole(const char* p, const char* end, std::int64_t& value) {
  if (p != end && *p == '+') {
    ++p;
    if (p != end && *p == '-') return nullptr;
  }
  auto [next, error] = std::from_chars(p, end, value);
  if (error != std::errc()) return nullptr;
  if (next != end && *next == '.') {
    ++next;
    while (next != end && *next == '0') ++next;
  }
  return next == end || is_blank(*next) ? next : nullptr;
}

/// The same for a text that is the token.
bool parse_real(std::string_view token, double& value);
bool parse_whole(std::string_view token, std::int64_t& value);

/// Takes the whole number out of a double; false where it is none, or from 2^53 on, where doubles leave some out.
inline bool whole_of(double value, std::int64_t& whole) {
  constexpr double limit = 9007199254740992;
  if (!(std::abs(value) < limit) || value != std::floor(value)) return false;
  whole = static_cast<std::int64_t>(value);
  return true;
}

}  // namespace grainvdb
