#include "write/hdf5_table_sink.hpp"

#include <cmath>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "write/atomic_file.hpp"
#include "write/hdf5_file.hpp"
#include "write/hdf5_provenance.hpp"

namespace grainvdb {
namespace {

/// HDF5 lists what is in a group by name: an attribute keeps the order.
template <class Item>
void write_order(Hdf5File& hdf5, const std::string& group, const std::vector<Item>& items) {
  std::vector<std::string> names;
  for (const Item& item : items) names.push_back(item.name);
  if (!names.empty()) hdf5.text_attribute(group, "order", names);
}

/// xarray opens the group of a table as a data set over its first column.
void write_columns(Hdf5File& hdf5, const std::string& group, const Table& table) {
  write_order(hdf5, group, table.columns);
  for (const TableColumn& column : table.columns) {
    const std::string path = group + '/' + column.name;
    hdf5.create_dataset<double>(path, {column.values.size()});
    hdf5.text_attribute(path, "units", column.unit);
    hdf5.text_attribute(path, "long_name", column.description);
    const std::string first = group + '/' + table.columns.front().name;
    if (path == first) {
      hdf5.make_scale(path, column.name);
    } else {
      hdf5.attach_scale(path, 0, first);
    }
    hdf5.write<double>(path, column.values);
  }
}

void write_numbers(Hdf5File& hdf5, const std::string& group, const Table& table) {
  if (table.numbers.empty()) return;
  hdf5.create_group(group + "/numbers");
  write_order(hdf5, group + "/numbers", table.numbers);
  for (const Quantity& quantity : table.numbers) {
    const std::string path = group + "/numbers/" + quantity.name;
    hdf5.create_dataset<double>(path, {});
    hdf5.text_attribute(path, "units", quantity.unit);
    hdf5.text_attribute(path, "long_name", quantity.description);
    if (!std::isnan(quantity.error)) hdf5.attribute<double>(path, "standard_error", quantity.error);
    hdf5.write<double>(path, std::span(&quantity.value, 1));
  }
}

class Hdf5TableSink final : public TableSink {
 public:
  explicit Hdf5TableSink(const std::string& directory)
      : path_((std::filesystem::path(directory) / "tables.h5").string()) {}

  void write(const std::vector<Table>& tables, const Provenance& provenance) override {
    AtomicFile file(path_);
    Hdf5File hdf5(file);
    for (const Table& table : tables) {
      const std::string group = '/' + table.name;
      hdf5.create_group(group);
      hdf5.text_attribute(group, "description", table.description);
      hdf5.text_attribute(group, "equation", table.equation);
      if (!table.remarks.empty()) hdf5.text_attribute(group, "remarks", table.remarks);
      write_columns(hdf5, group, table);
      write_numbers(hdf5, group, table);
    }
    write_provenance(hdf5, provenance);
    hdf5.close();
    file.finish();
    file.publish();
  }
  std::vector<std::string> files() const override { return {path_}; }

 private:
  std::string path_;
};

}  // namespace

std::unique_ptr<TableSink> make_hdf5_table_sink(const std::string& directory) {
  return std::make_unique<Hdf5TableSink>(directory);
}

}  // namespace grainvdb
