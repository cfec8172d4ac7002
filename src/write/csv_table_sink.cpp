#include "write/csv_table_sink.hpp"

#include <cstddef>
#include <filesystem>
#include <vector>

#include "write/atomic_file.hpp"
#include "write/number_text.hpp"

namespace grainvdb {
namespace {

std::string number(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

/// In quotes where commas or quotes are in it (RFC 4180).
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted(1, '"');
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted.append(1, '"');
}

std::string comments(const Table& table) {
  std::string text;
  const auto add = [&](const std::string& line) { text.append("# ").append(line).append("\n"); };
  add(table.description);
  add(table.equation);
  for (const std::string& remark : table.remarks) add(remark);
  return text;
}

std::string rows(const Table& table) {
  std::string text;
  const auto add_row = [&](auto&& cell_of) {
    for (const TableColumn& column : table.columns) text.append(cell_of(column)).append(1, ',');
    text.back() = '\n';
  };
  add_row([](const TableColumn& column) { return cell(column.name + " [" + column.unit + ']'); });
  for (std::size_t row = 0; row < table.columns.front().values.size(); ++row)
    add_row([&](const TableColumn& column) { return number(column.values[row]); });
  return text;
}

std::string numbers(const std::vector<Table>& tables) {
  std::string text = "table,quantity,value,error,unit,description\n";
  for (const Table& table : tables)
    for (const Quantity& q : table.numbers)
      text += cell(table.name) + ',' + cell(q.name) + ',' + number(q.value) + ',' + number(q.error) + ',' +
              cell(q.unit) + ',' + cell(q.description) + '\n';
  return text;
}

class CsvTableSink final : public TableSink {
 public:
  explicit CsvTableSink(const std::string& directory) : folder_(std::filesystem::path(directory) / "tables") {}

  void write(const std::vector<Table>& tables, const Provenance&) override {
    std::vector<std::unique_ptr<AtomicFile>> files;
    const auto add = [&](const std::string& name, const std::string& text) {
      AtomicFile& file = *files.emplace_back(std::make_unique<AtomicFile>((folder_ / (name + ".csv")).string()));
      file.write(0, text);
      file.finish();
    };
    for (const Table& table : tables)
      if (!table.columns.empty()) add(table.name, comments(table) + rows(table));
    add("numbers", numbers(tables));
    for (const auto& file : files) {
      file->publish();
      files_.push_back(file->path());
    }
  }
  std::vector<std::string> files() const override { return files_; }

 private:
  std::filesystem::path folder_;
  std::vector<std::string> files_;
};

}  // namespace

std::unique_ptr<TableSink> make_csv_table_sink(const std::string& directory) {
  return std::make_unique<CsvTableSink>(directory);
}

}  // namespace grainvdb
