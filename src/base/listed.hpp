#pragma once
/// Lists in words.
#include <functional>
#include <string>

namespace grainvdb {

/// "a, b, c", of what `print` makes of each item; empty without items.
template <class Items, class Print = std::identity>
std::string listed(const Items& items, Print print = {}) {
  std::string text;
  for (const auto& item : items) {
    if (!text.empty()) text += ", ";
    text += std::invoke(print, item);
  }
  return text;
}

}  // namespace grainvdb
