#pragma once
/// tables.h5: a group per table, a dataset per column, with units and what it means.
#include <memory>
#include <string>

#include "grainvdb/table_sink.hpp"

namespace grainvdb {

std::unique_ptr<TableSink> make_hdf5_table_sink(const std::string& directory);

}  // namespace grainvdb
