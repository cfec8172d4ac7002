#include "cli/write_tables.hpp"

#include "grainvdb/table_sink.hpp"

namespace grainvdb::cli {

void write_tables(RunReport& report, const std::string& folder) {
  if (report.tables.empty()) return;
  for (const TableSinkInfo& format : table_sink_registry()) {
    const auto sink = format.make(folder);
    sink->write(report.tables, report.tables_from);
    const std::vector<std::string> files = sink->files();
    report.files.insert(report.files.end(), files.begin(), files.end());
  }
}

}  // namespace grainvdb::cli
