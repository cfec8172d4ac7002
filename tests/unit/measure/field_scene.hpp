#pragma once
/// What a measurement sees of a run, made by hand.
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/measurement.hpp"
#include "grainvdb/run.hpp"
#include "unit/trace/fields.hpp"

namespace grainvdb::testing {

/// A measurement by its name, with options of one's own, on the fields that are set.
class FieldScene {
 public:
  FieldScene(const MeasurementInfo& info, const Lattice& lattice, std::shared_ptr<const Topology> topology,
             const OptionValues& given = {})
      : info_(info), lattice_(lattice), topology_(std::move(topology)) {
    for (const OptionInfo& o : info.options) options_[o.name] = o.default_value;
    for (const auto& [name, value] : given) options_.at(name) = value;
    fields_ = std::make_unique<OutputFields>(OutputFields{{}, {}, Mask(topology_)});
  }

  using Values = std::function<double(const Vec3&, int component)>;
  void set(const std::string& name, int components, const Values& values) {
    fields_->fields.erase(name);
    fields_->fields.emplace(name, field_of(name, components, lattice_, topology_, values));
  }
  void set(const std::string& name, double value) {
    set(name, 1, [value](const Vec3&, int) { return value; });
  }

  std::unique_ptr<Measurement> make(const Box& box = open_box({-100, -100, -100}, {100, 100, 100})) const {
    return info_.make({options_, stages_, lattice_, LucyKernel(3), box, {}});
  }
  /// The tables of one output time.
  std::vector<Table> tables() const {
    const auto measurement = make();
    measurement->take(*fields_);
    return measurement->tables();
  }
  const OutputFields& fields() const { return *fields_; }
  MeasurementNeeds needs() const { return info_.needs(options_); }

 private:
  MeasurementInfo info_;
  Lattice lattice_;
  std::shared_ptr<const Topology> topology_;
  OptionValues options_;
  StageSettings stages_;
  std::unique_ptr<OutputFields> fields_;
};

inline const Quantity& number(const Table& table, const std::string& name) {
  for (const Quantity& q : table.numbers)
    if (q.name == name) return q;
  throw std::out_of_range("no number " + name);
}
inline const std::vector<double>& column(const Table& table, const std::string& name) {
  for (const TableColumn& c : table.columns)
    if (c.name == name) return c.values;
  throw std::out_of_range("no column " + name);
}

}  // namespace grainvdb::testing
