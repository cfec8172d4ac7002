#include <memory>
#include <string>
#include <utility>

#include "grainvdb/run.hpp"
#include "measure/estimate_columns.hpp"
#include "measure/field_columns.hpp"
#include "measure/option_values.hpp"
#include "measure/register.hpp"
#include "measure/state_samples.hpp"

namespace grainvdb {
namespace {

BinSpec plane_spec(const OptionValues& options) {
  BinSpec spec;
  spec.axis = axis_option(options, "axis");
  spec.from = number_option(options, "from");
  spec.to = number_option(options, "to");
  return spec;
}

class PlaneProfile : public Measurement {
 public:
  explicit PlaneProfile(const MeasurementSetting& setting)
      : asked_(fields_of(setting.options)),
        profile_(plane_spec(setting.options), setting.lattice, averaged_fields(asked_)) {}

  void take(const OutputFields& output) override { profile_.take(output); }

  std::vector<Table> tables() override {
    Table table{
        "plane_profile", "exact averages over planes, straight from grains and contacts",
        "fields of sums over planes, W in them replaced by w_1/A; over times <q> = sum w q/sum w as in profile"};
    const auto axis = static_cast<std::size_t>(profile_.geometry().spec().axis);
    table.columns.push_back({profile_.geometry().directions()[axis], dimension::length, "position of the plane"});
    FieldColumns fields(profile_, asked_);
    fields.add_to(table);
    for (const std::int64_t bin : profile_.bins()) {
      table.columns[0].values.push_back(FieldProfile::Means(profile_, bin).position());
      fields.append_row(bin, table);
    }
    table.remarks.push_back(error_remark(profile_.times(), "output time"));
    return {std::move(table)};
  }

 private:
  std::vector<std::string> asked_;
  FieldProfile profile_;
};

MeasurementInfo plane_profile() {
  MeasurementInfo info;
  info.name = "plane_profile";
  info.description = "fields as exact averages over planes, by the kernel's marginal, without splatting them in 3-D";
  info.equation = "w_1(z) = 21/(16c) (1-|z|/c)^4 (1 + 4|z|/c + 5 z^2/c^2)";
  info.options = {{.name = "axis",
                   .default_value = std::string("z"),
                   .help = "the normal of the planes",
                   .choices = {"x", "y", "z"}},
                  {.name = "from",
                   .default_value = 0.0,
                   .help = "planes below are left out [length]; no bounds where from and to are 0"},
                  {.name = "to", .default_value = 0.0, .help = "planes from here on are left out [length]"},
                  plane_area_option(),
                  averaged_fields_option({"phi", "density", "velocity", "temperature", "mean_diameter"})};
  info.field_option = "fields";
  info.conflict = height_conflict;
  info.needs = [](const OptionValues& options) {
    return MeasurementNeeds{.planes = plane_needs(options, averaged_fields(fields_of(options)))};
  };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<PlaneProfile>(setting); };
  return info;
}

}  // namespace

std::vector<MeasurementInfo> plane_profile_measurements() {
  return {plane_profile()};
}

}  // namespace grainvdb
