#include <cmath>
#include <cstddef>
#include <iterator>

#include "grainvdb/kinematic.hpp"
#include "grainvdb/run.hpp"
#include "measure/drainage_columns.hpp"
#include "measure/drainage_fit.hpp"
#include "measure/plasticity.hpp"

namespace grainvdb {
namespace {

constexpr Dimension discharge_dimension{0, 2, -1};
constexpr Dimension area{0, 2, 0};

/// The mean downward velocity over depth and time, against the kinematic model.
class KinematicMeasurement : public Measurement {
 public:
  explicit KinematicMeasurement(const MeasurementSetting& setting)
      : columns_(setting), origin_(origin_option(setting.options)) {}

  void take(const OutputFields& fields) override { columns_.take(fields); }

  std::vector<Table> tables() override {
    return columns_.tables([&](const std::vector<DrainagePoint>& points) {
      return std::vector<Table>{field_table(points), width_table(points)};
    });
  }

 private:
  Table field_table(const std::vector<DrainagePoint>& points) const {
    const KinematicEstimate fit = fit_kinematic(points, origin_);
    Table t{.name = "kinematic_fit",
            .description = "downward velocity, mean over depth and time, and the kinematic model that fits it best",
            .equation = "v = Q exp(-x^2/(4 b z'))/sqrt(4 pi b z'), z' = z + rise; b of dv/dz = b d2v/dx2"};
    t.columns = {{"x", dimension::length, "from the middle of the slot", {}},
                 {"z", dimension::length, "above the slot", {}},
                 {"velocity", dimension::velocity, "downward, measured", {}},
                 {"fitted", dimension::velocity, "downward, of the fit", {}}};
    const KinematicFlow flow{fit.b.value, fit.discharge.value};
    for (const DrainagePoint& p : points) {
      t.columns[0].values.push_back(p.x);
      t.columns[1].values.push_back(p.z);
      t.columns[2].values.push_back(p.v);
      t.columns[3].values.push_back(flow.downward(p.x, p.z + fit.rise.value));
    }
    t.numbers = {
        {"b", fit.b.value, fit.b.error, dimension::length, "of dv/dz = b d2v/dx2, twice Var(dx)/(4 dz)"},
        {"discharge", fit.discharge.value, fit.discharge.error, discharge_dimension, "Q, by depth of the slot"},
        {"rise", fit.rise.value, fit.rise.error, dimension::length,
         "how far below the slot profiles would have no width"},
        {.name = "rms", .value = fit.rms, .dimension = dimension::velocity, .description = "of what is left"}};
    if (!fit.refusal.empty()) t.remarks.push_back("No kinematic flow was fitted: " + fit.refusal + '.');
    return t;
  }

  static Table width_table(const std::vector<DrainagePoint>& points) {
    const std::vector<DrainageProfile> profiles = fit_profiles(points);
    const WidthGrowth growth = fit_width(profiles);
    Table t{.name = "kinematic_width",
            .description = "width of the velocity profile at each height",
            .equation = "v ~ exp(-(x - m)^2/(2 s^2)); s^2 = 2 b z + offset; b of dv/dz = b d2v/dx2"};
    t.columns = {{"z", dimension::length, "above the slot", {}},
                 {"variance", area, "s^2 of the Gaussian that fits best", {}},
                 {"variance_error", area, "its standard error", {}},
                 {"moment_variance", area, "second moment of the profile about its mean, cut off at the walls", {}},
                 {"middle", dimension::length, "m of the Gaussian", {}},
                 {"peak", dimension::velocity, "of the Gaussian", {}}};
    std::size_t without = 0;
    for (const DrainageProfile& p : profiles) {
      if (std::isnan(p.variance.value)) ++without;
      const double row[] = {p.z, p.variance.value, p.variance.error, p.moment_variance, p.middle.value, p.peak.value};
      for (std::size_t c = 0; c < std::size(row); ++c) t.columns[c].values.push_back(row[c]);
    }
    t.numbers = {{"b", growth.b.value, growth.b.error, dimension::length, "half the slope of the variance"},
                 {"offset", growth.offset.value, growth.offset.error, area, "variance at the height of the slot"},
                 {.name = "reduced_chi_square",
                  .value = growth.reduced_chi_square,
                  .description = "of the straight line: near 1 where it describes the widths within their errors"}};
    if (without > 0)
      t.remarks.push_back(std::to_string(without) + " heights have no Gaussian profile and are left out of the line.");
    if (!growth.refusal.empty()) t.remarks.push_back("No growth was fitted: " + growth.refusal + '.');
    return t;
  }

  DrainageColumns columns_;
  Origin origin_;
};

}  // namespace

MeasurementInfo kinematic_fit_measurement() {
  MeasurementInfo m;
  m.name = "kinematic_fit";
  m.description = "kinematic model of drainage through a slot: b and Q of the flow, and profile width against height";
  m.equation = "v = Q exp(-x^2/(4 b z))/sqrt(4 pi b z); s^2 = 2 b z + offset; b of dv/dz = b d2v/dx2";
  m.options = DrainageColumns::options({});
  m.conflict = DrainageColumns::conflict;
  m.needs = [](const OptionValues&) { return MeasurementNeeds{{}, {"phi", "velocity"}}; };
  m.make = [](const MeasurementSetting& setting) { return std::make_unique<KinematicMeasurement>(setting); };
  return m;
}

}  // namespace grainvdb
