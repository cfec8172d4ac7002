#pragma once
/// The units of all that is written: those of the dump, in which everything is computed, or reduced ones.
#include <optional>
#include <string>
#include <vector>

#include "grainvdb/box.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/reduced_units.hpp"
#include "grainvdb/sparse_field.hpp"
#include "grainvdb/table.hpp"
#include "grainvdb/tracer_sink.hpp"
#include "grainvdb/units.hpp"

namespace grainvdb {

/// Does nothing to numbers that stay in the units of the dump.
class OutputUnits {
 public:
  OutputUnits(const UnitSystem& dump, const std::optional<ReducedUnits>& reduced) : dump_(dump), reduced_(reduced) {}

  bool reduced() const { return reduced_.has_value(); }
  std::string symbol(const Dimension& quantity) const;
  /// As UnitSystem::name; "lj" where units are reduced: in it, as LAMMPS means it, nothing has a unit.
  std::string system() const { return reduced() ? "lj" : dump_.name; }

  double converted(double value, const Dimension& quantity) const { return value / size(quantity); }
  Lattice converted(const Lattice& lattice) const;
  Box converted(const Box& box) const;
  FieldMeta converted(FieldMeta meta) const;

  /// `written` is the lattice of the field, converted.
  void convert(SparseField& field, const Lattice& written) const;
  /// `fields` are those that the tracers record.
  void convert(TracerSample& sample, const std::vector<FieldMeta>& fields) const;
  /// Gives every column and number its unit.
  void convert(Table& table) const;

  /// d, g, ρ_p and what they make, a line each in units of the dump, by which results can be converted back.
  std::string scales() const;

 private:
  double size(const Dimension& quantity) const { return reduced_ ? reduced_->size(quantity) : 1; }
  void convert(std::vector<double>& values, const Dimension& quantity) const;

  UnitSystem dump_;
  std::optional<ReducedUnits> reduced_;
};

}  // namespace grainvdb
