#include "support/csv_table.hpp"

#include <array>
#include <memory>
#include <sstream>
#include <stdexcept>

#include <zlib.h>

namespace grainvdb::testing {

CsvTable::CsvTable(const std::string& gzip_file) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(gzip_file.c_str(), "rb"), gzclose);
  if (!file) throw std::runtime_error("cannot open " + gzip_file);
  std::string content;
  std::array<char, 65536> buffer;
  int n = 0;
  while ((n = gzread(file.get(), buffer.data(), buffer.size())) > 0)
    content.append(buffer.data(), static_cast<std::size_t>(n));
  if (n < 0) throw std::runtime_error("cannot unpack " + gzip_file);

  std::istringstream lines(content);
  std::string line;
  std::getline(lines, line);
  std::vector<std::string> names;
  std::istringstream header(line);
  for (std::string name; std::getline(header, name, ',');) names.push_back(name);
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::size_t column = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++column)
      columns_[names.at(column)].push_back(std::stod(cell));
    if (column != names.size()) throw std::runtime_error("a row of " + gzip_file + " is short");
    ++rows_;
  }
}

}  // namespace grainvdb::testing
