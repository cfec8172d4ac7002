#pragma once
/// Averaged fields as the columns of a table.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "grainvdb/options.hpp"
#include "grainvdb/table.hpp"
#include "measure/field_profile.hpp"

namespace grainvdb {

/// What is averaged for these fields: themselves with what weighs them, or what they are formed from.
std::vector<std::string> averaged_fields(const std::vector<std::string>& asked);

/// The option `fields`: what to average.
OptionInfo averaged_fields_option(std::vector<std::string> by_default);
const std::vector<std::string>& fields_of(const OptionValues& options);

class FieldColumns {
 public:
  /// `profile` averages what averaged_fields says of those asked for, and must outlive the columns.
  FieldColumns(const FieldProfile& profile, std::vector<std::string> asked);

  /// A column for each component, with one of standard errors beside it.
  void add_to(Table& table);
  /// The averages of a bin, in the columns that were added last.
  void append_row(std::int64_t bin, Table& table) const;

 private:
  void add_field(const std::string& name, Table& table) const;

  const FieldProfile& profile_;
  std::vector<std::string> asked_;
  std::size_t first_ = 0;  // of the columns in the table
};

}  // namespace grainvdb
