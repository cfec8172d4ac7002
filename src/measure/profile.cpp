#include <algorithm>
#include <set>
#include <utility>

#include "grainvdb/run.hpp"
#include "measure/derived_quantity.hpp"
#include "measure/estimate_columns.hpp"
#include "measure/field_profile.hpp"
#include "measure/partial_field.hpp"
#include "measure/register.hpp"

namespace grainvdb {
namespace {

const std::vector<std::string>& fields_of(const OptionValues& options) {
  return std::get<std::vector<std::string>>(options.at("fields"));
}

/// What is averaged: the fields that are asked for, and those that others of them are formed from.
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

/// "_x", "_xy", … after the name of a field with several components.
std::string suffix(const std::array<std::string, 3>& directions, int components, int c) {
  if (components == 3) return '_' + directions[static_cast<std::size_t>(c)];
  if (components == 9)
    return '_' + directions[static_cast<std::size_t>(c / 3)] + directions[static_cast<std::size_t>(c % 3)];
  return components == 1 ? "" : '_' + std::to_string(c + 1);
}

class ProfileMeasurement : public Measurement {
 public:
  explicit ProfileMeasurement(const MeasurementSetting& setting)
      : asked_(fields_of(setting.options)),
        profile_(bin_spec(setting.options), setting.lattice, averaged_fields(asked_)) {}

  void take(const OutputFields& output) override { profile_.take(output); }

  std::vector<Table> tables() override {
    const bool shells = profile_.geometry().spec().geometry == BinSpec::Geometry::shells;
    Table table{"profile", "fields averaged over " + std::string(shells ? "cylindrical shells" : "planes"),
                "<q> = sum w q/sum w over voxels and times, w = phi for means over volume, 1 for others"};
    table.columns.push_back({shells ? "r" : profile_.geometry().directions()[axis()], dimension::length,
                             shells ? "mean distance of the voxels from the axis" : "mean position of the voxels"});
    table.columns.push_back({"height", dimension::length, "mean position of the voxels along the axis"});
    table.columns.push_back({"voxels", dimension::none, "voxels averaged per output time"});
    for (const std::string& name : asked_) add_columns(table, name);
    for (const std::int64_t bin : profile_.bins()) add_row(table, bin);
    table.remarks.push_back(error_remark(profile_.times(), "output time"));
    return {std::move(table)};
  }

 private:
  std::size_t axis() const { return static_cast<std::size_t>(profile_.geometry().spec().axis); }

  void add_columns(Table& table, const std::string& name) const {
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

  void add_row(Table& table, std::int64_t bin) const {
    const FieldProfile::Means means(profile_, bin);
    table.columns[0].values.push_back(means.position());
    table.columns[1].values.push_back(means.height());
    table.columns[2].values.push_back(means.voxels());
    const std::size_t outputs = (table.columns.size() - fixed_columns) / 2;
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
    for (std::size_t n = 0; n < outputs; ++n) append(table, fixed_columns + 2 * n, estimates[n]);
  }

  static constexpr std::size_t fixed_columns = 3;  // position, height and voxels

  std::vector<std::string> asked_;
  FieldProfile profile_;
};

/// All fields but the axes, which have no mean, and those that only keep books.
std::vector<std::string> field_names() {
  std::vector<std::string> names;
  for (const Stage& stage : StageRegistry::standard().stages())
    if (stage.name != "principal_axes" && stage.name != "mask" && stage.error_of.empty()) names.push_back(stage.name);
  return names;
}

MeasurementInfo profile() {
  MeasurementInfo info;
  info.name = "profile";
  info.description = "fields averaged over planes or cylindrical shells, and over the output times";
  info.equation = "<q> = sum w q/sum w; ratios are formed from the averages";
  info.options = bin_options();
  info.options.push_back(
      {.name = "fields",
       .default_value = std::vector<std::string>{"phi", "velocity", "mean_diameter", "temperature", "stress",
                                                 "shear_rate", "pressure", "mu", "inertial_number", "gd_over_dv"},
       .help = "what to average: names of fields",
       .choices = field_names()});
  info.field_option = "fields";
  info.conflict = bin_conflict;
  info.needs = [](const OptionValues& options) { return MeasurementNeeds{{}, averaged_fields(fields_of(options))}; };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<ProfileMeasurement>(setting); };
  return info;
}

}  // namespace

std::vector<MeasurementInfo> profile_measurements() {
  return {profile()};
}

}  // namespace grainvdb
