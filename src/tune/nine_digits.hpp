#pragma once
#include <locale>
#include <sstream>
#include <string>

namespace grainvdb {

/// A number for a setting: more digits than a length needs, and far more than what a period must be divided by.
inline std::string nine_digits(double x) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(9);
  text << x;
  return text.str();
}

}  // namespace grainvdb
