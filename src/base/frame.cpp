#include "grainvdb/frame.hpp"

#include <utility>

#include "grainvdb/frame_source.hpp"

namespace grainvdb {

std::vector<std::string> column_names(ColumnSet columns) {
  static constexpr std::pair<Column, const char*> names[] = {
      {Column::velocity, "velocity"}, {Column::angular_velocity, "angular velocity"},
      {Column::radius, "radius"},     {Column::mass, "mass"},
      {Column::type, "type"},         {Column::contacts, "contacts"},
      {Column::force, "force"},       {Column::wall_contacts, "wall contacts"}};
  std::vector<std::string> result{"id", "position"};
  for (const auto& [column, name] : names)
    if (columns.has(column)) result.emplace_back(name);
  return result;
}

std::string to_string(const BadFrame& frame) {
  return frame.step ? "step " + std::to_string(*frame.step) + ": " + frame.reason : frame.reason;
}

}  // namespace grainvdb
