#pragma once
/// Numbers in text files.
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <type_traits>

namespace grainvdb {

/// Appends the shortest text that reads back as the same number, whatever the locale; "nan" without the sign that
/// to_chars would show.
template <class T>
void append_number(std::string& text, T value) {
  if constexpr (std::is_floating_point_v<T>) {
    if (std::isnan(value)) {
      text += "nan";
      return;
    }
  }
  std::array<char, 32> buffer;
  text.append(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr);
}

}  // namespace grainvdb
