#pragma once
/// Tables of numbers with a line of column names, gzipped.
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace grainvdb::testing {

class CsvTable {
 public:
  /// Throws std::runtime_error where the file cannot be read or a row has another number of columns than the header.
  explicit CsvTable(const std::string& gzip_file);
  std::size_t rows() const { return rows_; }
  double at(std::size_t row, const std::string& column) const { return columns_.at(column)[row]; }

 private:
  std::size_t rows_ = 0;
  std::map<std::string, std::vector<double>> columns_;
};

}  // namespace grainvdb::testing
