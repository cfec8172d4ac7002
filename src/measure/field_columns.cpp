#include "measure/field_columns.hpp"

#include <set>
#include <utility>

#include "measure/derived_quantity.hpp"
#include "measure/estimate_columns.hpp"
#include "measure/partial_field.hpp"

namespace grainvdb {
namespace {

/// All fields but the axes, which have no mean, and those that only keep books.
std::vector<std::string> names_of_averaged() {
  std::vector<std::string> names;
  for (const Stage& stage : StageRegistry::standard().stages())
    if (stage.name != "principal_axes" && stage.name != "mask" && stage.error_of.empty()) names.push_back(stage.name);
  return names;
}

/// "_x", "_xy", … after the name of a field with several components.
std::string suffix(const std::array<std::string, 3>& directions, int components, int c) {
  if (components == 3) return '_' + directions[static_cast<std::size_t>(c)];
  if (components == 9)
    return '_' + directions[static_cast<std::size_t>(c / 3)] + directions[static_cast<std::size_t>(c % 3)];
  return components == 1 ? "" : '_' + std::to_string(c + 1);
}

}  // namespace

std::vector<std::string> averaged_fields(const std::vector<std::string>& asked) {
  std::set<std::string> all;
  for (const std::string& name : asked) {
    if (const DerivedQuantity* derived = find_derived_quantity(name)) {
      all.insert(derived->fields.begin(), derived->fields.end());
    } else {
      all.insert(name);
      if (std::string weight = volume_weight(name); !weight.empty()) all.insert(std::move(weight));
    }
  }
  return {all.begin(), all.end()};
}

OptionInfo averaged_fields_option(std::vector<std::string> by_default) {
  return {.name = "fields",
          .default_value = std::move(by_default),
          .help = "what to average: names of fields",
          .choices = names_of_averaged()};
}

const std::vector<std::string>& fields_of(const OptionValues& options) {
  return std::get<std::vector<std::string>>(options.at("fields"));
}

FieldColumns::FieldColumns(const FieldProfile& profile, std::vector<std::string> asked)
    : profile_(profile), asked_(std::move(asked)) {}

void FieldColumns::add_to(Table& table) {
  first_ = table.columns.size();
  for (const std::string& name : asked_) add_field(name, table);
}

void FieldColumns::add_field(const std::string& name, Table& table) const {
  if (const DerivedQuantity* derived = find_derived_quantity(name)) {
    add_estimate_columns(table, name, derived->dimension, derived->description);
    return;
  }
  const PartialField field = partial_field(name);
  const Stage& stage = *field.all;
  const std::string of = field.species.empty() ? "" : " of species " + field.species + " alone,";
  const bool scalars = name == "principal_stress";
  for (int c = 0; c < stage.components; ++c) {
    const std::string label =
        scalars ? '_' + std::to_string(c + 1) : suffix(profile_.geometry().directions(), stage.components, c);
    add_estimate_columns(table, name + label, stage.dimension, stage.description + ',' + of + " average");
  }
}

void FieldColumns::append_row(std::int64_t bin, Table& table) const {
  const std::size_t outputs = (table.columns.size() - first_) / 2;
  const auto estimates = profile_.estimate(bin, outputs, [&](const FieldProfile::Means& part, std::span<double> out) {
    std::size_t next = 0;
    for (const std::string& name : asked_) {
      if (const DerivedQuantity* derived = find_derived_quantity(name)) {
        out[next++] = (part.state().*derived->value)();
      } else {
        for (int c = 0; c < profile_.components(name); ++c) out[next++] = part.value(name, c);
      }
    }
  });
  for (std::size_t n = 0; n < outputs; ++n) append(table, first_ + 2 * n, estimates[n]);
}

}  // namespace grainvdb
