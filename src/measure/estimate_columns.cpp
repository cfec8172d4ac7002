#include "measure/estimate_columns.hpp"

namespace grainvdb {

std::size_t add_estimate_columns(Table& table, const std::string& name, const Dimension& dimension,
                                 const std::string& description) {
  table.columns.push_back({name, dimension, description});
  table.columns.push_back({name + "_error", dimension, "standard error of " + name});
  return table.columns.size() - 2;
}

void append(Table& table, std::size_t column, const Estimate& estimate) {
  table.columns[column].values.push_back(estimate.value);
  table.columns[column + 1].values.push_back(estimate.error);
}

std::string error_remark(std::size_t times, const std::string& what) {
  if (times < 2) return "Standard errors need two " + what + "s at least: there is " + std::to_string(times) + ".";
  return "Standard errors are from leaving out one of the " + std::to_string(times) + " " + what +
         "s at a time, taken as independent.";
}

}  // namespace grainvdb
