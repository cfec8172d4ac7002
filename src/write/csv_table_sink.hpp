#pragma once
/// tables/NAME.csv: one file per table, and numbers.csv with the single numbers of all.
#include <memory>
#include <string>

#include "grainvdb/table_sink.hpp"

namespace grainvdb {

std::unique_ptr<TableSink> make_csv_table_sink(const std::string& directory);

}  // namespace grainvdb
