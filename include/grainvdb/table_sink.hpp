#pragma once
/// Where the tables of measurements go. An output format is one class, one test and one line of registration.
#include <memory>
#include <string>
#include <vector>

#include "grainvdb/field_sink.hpp"
#include "grainvdb/table.hpp"

namespace grainvdb {

/// Nothing appears under the final names before everything is written. Throws IoError.
class TableSink {
 public:
  virtual ~TableSink() = default;
  virtual void write(const std::vector<Table>& tables, const Provenance& provenance) = 0;
  /// The files that `write` left, for the user.
  virtual std::vector<std::string> files() const = 0;
};

struct TableSinkInfo {
  std::string name;
  std::string description;
  std::unique_ptr<TableSink> (*make)(const std::string& directory);
};
/// The formats that tables are written in.
const std::vector<TableSinkInfo>& table_sink_registry();

}  // namespace grainvdb
