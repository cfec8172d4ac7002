#pragma once
/// Numbers of pipeline files: read without regard to the locale, the whole text or nothing.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace grainvdb {

/// Decimal and exponent forms, ".inf" and "-.inf" (YAML). Nothing for anything else: hexadecimal, "nan", trailing
/// letters, values beyond the range of double.
std::optional<double> parse_number(std::string_view text);

/// Digits with an optional sign, or a decimal form of a whole number up to 2^53, e.g. 4e9.
std::optional<std::int64_t> parse_integer(std::string_view text);

/// The shortest text that reads back as the same number, in the form that every YAML reader takes for one.
std::string print_number(double value);

/// To four digits, for people.
std::string short_number(double value);

}  // namespace grainvdb
