#pragma once
/// The number in the name of a file, for formats that do not say which timestep they hold.
#include <cstdint>
#include <optional>
#include <string_view>

namespace grainvdb {

/// The digits at the end of a file name, before .vtk and before what names a compression: 40 of grains0040.vtk.gz.
/// Nothing where there are none, or more than a number can hold.
std::optional<std::int64_t> number_at_end(std::string_view file);

}  // namespace grainvdb
