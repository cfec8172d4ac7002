#pragma once
/// Columns of values with columns of their standard errors beside them.
#include <string>

#include "grainvdb/table.hpp"
#include "measure/time_sums.hpp"

namespace grainvdb {

/// Adds `name` and `name`_error to the table, both empty yet. Returns the place of the first.
std::size_t add_estimate_columns(Table& table, const std::string& name, const Dimension& dimension,
                                 const std::string& description);
/// Appends to the two columns at that place.
void append(Table& table, std::size_t column, const Estimate& estimate);

/// What a table says of errors over so many output times (or frames, by `what`).
std::string error_remark(std::size_t times, const std::string& what);

}  // namespace grainvdb
