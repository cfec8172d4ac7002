#include <memory>
#include <utility>

#include "grainvdb/run.hpp"
#include "measure/estimate_columns.hpp"
#include "measure/field_columns.hpp"
#include "measure/register.hpp"

namespace grainvdb {
namespace {

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
    FieldColumns fields(profile_, asked_);
    fields.add_to(table);
    for (const std::int64_t bin : profile_.bins()) {
      const FieldProfile::Means means(profile_, bin);
      table.columns[0].values.push_back(means.position());
      table.columns[1].values.push_back(means.height());
      table.columns[2].values.push_back(means.voxels());
      fields.append_row(bin, table);
    }
    table.remarks.push_back(error_remark(profile_.times(), "output time"));
    return {std::move(table)};
  }

 private:
  std::size_t axis() const { return static_cast<std::size_t>(profile_.geometry().spec().axis); }

  std::vector<std::string> asked_;
  FieldProfile profile_;
};

MeasurementInfo profile() {
  MeasurementInfo info;
  info.name = "profile";
  info.description = "fields averaged over planes or cylindrical shells, and over the output times";
  info.equation = "<q> = sum w q/sum w; ratios are formed from the averages";
  info.options = bin_options();
  info.options.push_back(averaged_fields_option({"phi", "velocity", "mean_diameter", "temperature", "stress",
                                                 "shear_rate", "pressure", "mu", "inertial_number", "gd_over_dv"}));
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
