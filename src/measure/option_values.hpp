#pragma once
/// The values of a measurement's options, of the kind that they are declared with.
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>

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

inline std::size_t count_option(const OptionValues& options, const std::string& name) {
  return static_cast<std::size_t>(std::get<std::int64_t>(options.at(name)));
}

}  // namespace grainvdb
