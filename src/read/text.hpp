#pragma once
/// Pieces of text: the fields of a line, and how messages show them.
#include <string>
#include <string_view>
#include <vector>

namespace grainvdb {

/// What every section of a text dump begins with.
inline constexpr std::string_view item_mark = "ITEM:";

/// What separates the fields of a line; a carriage return counts, so that lines may end in CRLF.
constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

/// Takes the next token off the front of a line; empty at its end.
std::string_view take_token(std::string_view& line);

/// A text as error messages show it: in quotes, cut after 40 characters, unprintable bytes as \xNN.
std::string in_quotes(std::string_view text);

/// Whether a text can be a name that messages repeat as it is: printable ASCII, at most 200 characters.
bool is_name(std::string_view text);

/// Names separated by blanks, cut after 600 characters.
std::string joined(const std::vector<std::string>& names);

}  // namespace grainvdb
