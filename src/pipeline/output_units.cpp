#include "pipeline/output_units.hpp"

#include <utility>

#include "pipeline/number.hpp"

namespace grainvdb {

std::string OutputUnits::symbol(const Dimension& quantity) const {
  return reduced_ ? ReducedUnits::symbol(quantity) : dump_.symbol(quantity);
}

Lattice OutputUnits::converted(const Lattice& lattice) const {
  return lattice.in_unit(size(dimension::length));
}

Box OutputUnits::converted(const Box& box) const {
  Box result = box;
  for (Vec3* corner : {&result.lo, &result.hi})
    for (double& x : *corner) x = converted(x, dimension::length);
  return result;
}

FieldMeta OutputUnits::converted(FieldMeta meta) const {
  if (reduced_) meta.unit = symbol(meta.dimension);
  return meta;
}

void OutputUnits::convert(SparseField& field, const Lattice& written) const {
  const Dimension& quantity = field.meta().dimension;
  if (reduced_) field.change_units(size(quantity), symbol(quantity), written);
}

void OutputUnits::convert(std::vector<double>& values, const Dimension& quantity) const {
  const double unit = size(quantity);
  if (unit == 1) return;
  for (double& value : values) value /= unit;
}

void OutputUnits::convert(TracerSample& sample, const std::vector<FieldMeta>& fields) const {
  sample.time = converted(sample.time, dimension::time);
  convert(sample.stop_time, dimension::time);
  for (Columns3* places : {&sample.position, &sample.displacement})
    for (std::vector<double>& axis : *places) convert(axis, dimension::length);
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const double unit = size(fields[f].dimension);
    if (unit == 1) continue;
    for (float& value : sample.fields[f]) value = static_cast<float>(static_cast<double>(value) / unit);
  }
}

void OutputUnits::convert(Table& table) const {
  for (TableColumn& column : table.columns) {
    column.unit = symbol(column.dimension);
    convert(column.values, column.dimension);
  }
  for (Quantity& number : table.numbers) {
    number.unit = symbol(number.dimension);
    number.value = converted(number.value, number.dimension);
    number.error = converted(number.error, number.dimension);
  }
}

std::string OutputUnits::scales() const {
  if (!reduced_) return {};
  std::string text;
  const auto add = [&](const std::string& name, double value, const Dimension& quantity) {
    text.append(name).append(" = ").append(print_number(value));
    text.append(1, ' ').append(dump_.symbol(quantity)).append(1, '\n');
  };
  add("d", reduced_->diameter, dimension::length);
  add("g", reduced_->gravity, dimension::acceleration);
  add("rho_p", reduced_->density, dimension::density);
  for (const Dimension& quantity : {dimension::time, dimension::mass})
    add(ReducedUnits::symbol(quantity), reduced_->size(quantity), quantity);
  return text;
}

}  // namespace grainvdb
