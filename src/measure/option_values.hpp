#pragma once
/// The values of a measurement's options, of the kind that they are declared with.
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "grainvdb/options.hpp"

namespace grainvdb {

inline double number_option(const OptionValues& options, const std::string& name) {
  return std::get<double>(options.at(name));
}

/// The value of a length option, or `diameters` mean diameters where it is 0.
inline double length_option(const OptionValues& options, const std::string& name, double diameters, double diameter) {
  const double given = number_option(options, name);
  return given > 0 ? given : diameters * diameter;
}

inline const std::vector<double>& numbers_option(const OptionValues& options, const std::string& name) {
  return std::get<std::vector<double>>(options.at(name));
}

/// 0, 1 or 2 of an option that is x, y or z.
inline int axis_option(const OptionValues& options, const std::string& name) {
  return std::get<std::string>(options.at(name))[0] - 'x';
}

inline OptionInfo up_option() {
  return {.name = "up", .default_value = std::string("z"), .help = "axis against gravity", .choices = {"x", "y", "z"}};
}

inline std::size_t count_option(const OptionValues& options, const std::string& name) {
  return static_cast<std::size_t>(std::get<std::int64_t>(options.at(name)));
}

}  // namespace grainvdb
