#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "grainvdb/kinematic.hpp"
#include "grainvdb/run.hpp"
#include "grainvdb/spot_theory.hpp"
#include "measure/drainage_columns.hpp"
#include "measure/drainage_fit.hpp"
#include "measure/estimate.hpp"
#include "measure/option_values.hpp"
#include "measure/plasticity.hpp"

namespace grainvdb {
namespace {

constexpr Dimension flux_dimension{0, 2, -1};

/// Spots that make a kinematic flow of grains.
struct RisingSpots {
  std::string refusal;  ///< why nothing is known of them
  Estimate b;           ///< [length]
  Estimate discharge;   ///< [length²/time]
  double rise = 0;      ///< how far below the slot they would be in one place [length]
};

/// The line through zero y = slope x.
class ThroughZero {
 public:
  void add(double x, double y, double weight) {
    xx_ += x * x;
    xy_ += x * y;
    yy_ += y * y;
    weight_ += weight;
    ++count_;
  }
  double rms_difference() const { return std::sqrt((yy_ - 2 * xy_ + xx_) / count_); }
  /// With the error of the residuals, for as many values as are independent.
  Estimate slope() const {
    const double left = std::max(0.0, yy_ - xy_ * xy_ / xx_) / count_;
    return {xy_ / xx_, std::sqrt(left * count_ / (xx_ * std::max(1.0, weight_ - 1)))};
  }

 private:
  double xx_ = 0, xy_ = 0, yy_ = 0, weight_ = 0, count_ = 0;
};

/// The mean flow beside the drift and diffusivity of grains in a cloud of spots that rise from the slot.
class MeanFieldMeasurement : public Measurement {
 public:
  explicit MeanFieldMeasurement(const MeasurementSetting& setting)
      : columns_(setting),
        origin_(origin_option(setting.options)),
        b_(number_option(setting.options, "b")),
        discharge_(number_option(setting.options, "discharge")),
        reach_{number_option(setting.options, "radius"), number_option(setting.options, "influence"),
               number_option(setting.options, "place")} {}

  void take(const OutputFields& fields) override { columns_.take(fields); }

  std::vector<Table> tables() override {
    return columns_.tables(
        [&](const std::vector<DrainagePoint>& points) { return std::vector<Table>{table_of(points)}; });
  }

 private:
  // The mean over the ball adds R²/5 to the variance of the flow, so that the spots that make a fitted flow are that
  // much nearer together.
  RisingSpots spots_behind(const std::vector<DrainagePoint>& points) const {
    if (b_ > 0) return {"", {b_}, {discharge_}, 0};
    const KinematicEstimate fit = fit_kinematic(points, origin_);
    return {fit.refusal, fit.b, fit.discharge, fit.rise.value - reach_.radius * reach_.radius / (10 * fit.b.value)};
  }

  // With the speed 1: drift and diffusivity of grains depend on the product of number and speed, which the flow tells.
  SpotCloud cloud_of(const RisingSpots& spots) const {
    const KinematicFlow flow{spots.b.value, spots.discharge.value};
    const double ball = 4 * std::numbers::pi / 3 * std::pow(reach_.radius, 3);
    const double number = 1 / (reach_.influence * ball);
    const double rise = spots.rise;
    return {[=](const Vec3& x) { return number * flow.downward(x[0], x[2] + rise); },
            [=](const Vec3& x) {
              return Vec3{number * flow.sideways(x[0], x[2] + rise) / flow.b, 0, 0};  // b ∂v/∂x; spread along x alone
            },
            {0, 0, 1},
            {flow.b, 0, 0}};
  }

  Table table_of(const std::vector<DrainagePoint>& points) const {
    const RisingSpots spots = spots_behind(points);
    Table t{.name = "mean_field",
            .description = "mean flow beside the mean-field drift and diffusivity of grains among spots that make it",
            .equation = "u_p = -int w [rho_s u_s - 2 s D_s grad rho_s] dV, D_p = int w^2 rho_s D_s dV"};
    t.columns = {{"x", dimension::length, "from the middle of the slot", {}},
                 {"z", dimension::length, "above the slot", {}},
                 {"velocity", dimension::velocity, "downward, measured", {}},
                 {"drift", dimension::velocity, "downward, of the theory", {}},
                 {"sideways", dimension::velocity, "along x, measured", {}},
                 {"drift_sideways", dimension::velocity, "along x, of the theory", {}},
                 {"diffusivity", flux_dimension, "of grains along x, of the theory", {}}};
    ThroughZero down, across;
    std::size_t undefined = 0;
    const SpotCloud cloud = cloud_of(spots);
    for (const DrainagePoint& p : points) {
      std::array<double, 3> theory;
      theory.fill(std::numeric_limits<double>::quiet_NaN());
      if (spots.refusal.empty() && p.z + spots.rise > reach_.radius) {
        const MeanField field = mean_field(cloud, reach_, {p.x, 0, p.z});
        theory = {-field.drift[2], field.drift[0], field.diffusivity[0]};
        down.add(theory[0], p.v, p.independent);
        across.add(theory[1], p.u, p.independent);
      } else {
        ++undefined;
      }
      const double row[] = {p.x, p.z, p.v, theory[0], p.u, theory[1], theory[2]};
      for (std::size_t c = 0; c < std::size(row); ++c) t.columns[c].values.push_back(row[c]);
    }
    t.numbers = numbers_of(spots, down, across);
    if (!spots.refusal.empty()) t.remarks.push_back("No kinematic flow was fitted: " + spots.refusal + '.');
    if (spots.refusal.empty() && undefined > 0)
      t.remarks.push_back(std::to_string(undefined) +
                          " places are less than a radius above where the spots come from: there is no theory there.");
    return t;
  }

  std::vector<Quantity> numbers_of(const RisingSpots& spots, const ThroughZero& down, const ThroughZero& across) const {
    const Estimate fall = down.slope(), sideways = across.slope();
    return {{"b", spots.b.value, spots.b.error, dimension::length, "of dv/dz = b d2v/dx2 of the spots"},
            {"discharge", spots.discharge.value, spots.discharge.error, flux_dimension, "Q, by depth of the slot"},
            {.name = "spot_rise",
             .value = spots.rise,
             .dimension = dimension::length,
             .description = "how far below the slot the spots would be in one place"},
            {.name = "grain_diffusion",
             .value = grain_diffusion(reach_.influence, spots.b.value),
             .dimension = dimension::length,
             .description = "b_p = influence b: half the variance along x that grains gain per height fallen"},
            {"velocity_over_drift", fall.value, fall.error, {}, "slope through zero of the velocity against the drift"},
            {"sideways_over_drift", sideways.value, sideways.error, {}, "the same along x"},
            {.name = "rms",
             .value = down.rms_difference(),
             .dimension = dimension::velocity,
             .description = "of the difference between velocity and drift, downward"},
            {.name = "rms_sideways",
             .value = across.rms_difference(),
             .dimension = dimension::velocity,
             .description = "the same along x"}};
  }

  DrainageColumns columns_;
  Origin origin_;
  double b_, discharge_;  ///< 0: fitted
  SpotReach reach_;
};

std::optional<OptionConflict> mean_field_conflict(const OptionValues& options) {
  if (auto axes = DrainageColumns::conflict(options)) return axes;
  if (!(number_option(options, "radius") > 0)) return OptionConflict{"radius", "none", "the radius of spots, a length above 0"};
  if (!(number_option(options, "influence") > 0)) return OptionConflict{"influence", "0", "a number above 0"};
  if ((number_option(options, "b") > 0) != (number_option(options, "discharge") > 0))
    return OptionConflict{"discharge", std::to_string(number_option(options, "discharge")),
                          "both b and discharge, or neither: then both are fitted"};
  return std::nullopt;
}

}  // namespace

MeasurementInfo mean_field_measurement() {
  MeasurementInfo m;
  m.name = "mean_field";
  m.description = "mean-field theory of spots: drift and diffusivity of grains in a draining silo beside the flow";
  m.equation =
      "u_p = -int w [rho_s u_s - 2 s D_s grad rho_s] dV, D_p = int w^2 rho_s D_s dV, w = influence within radius";
  m.options = DrainageColumns::options(
      {{.name = "radius", .default_value = 0.0, .help = "radius of spots, to be given [length]", .minimum = 0},
       {.name = "influence",
        .default_value = 0.0025,
        .help = "part of the step of a spot that each grain within it makes the other way",
        .minimum = 0,
        .maximum = 1},
       {.name = "place",
        .default_value = 0.5,
        .help = "where along its step a spot is when it is asked which grains it moves: 0.5 halfway, 1 at the end, as "
                "published",
        .minimum = 0,
        .maximum = 1},
       {.name = "b",
        .default_value = 0.0,
        .help = "of dv/dz = b d2v/dx2 of spots that come from the slot [length]; 0: that of the flow",
        .minimum = 0},
       {.name = "discharge",
        .default_value = 0.0,
        .help = "Q by depth of the slot, together with b [length^2/time]; 0: that of the flow",
        .minimum = 0}});
  m.conflict = mean_field_conflict;
  m.needs = [](const OptionValues&) { return MeasurementNeeds{{}, {"phi", "velocity"}}; };
  m.make = [](const MeasurementSetting& setting) { return std::make_unique<MeanFieldMeasurement>(setting); };
  return m;
}

}  // namespace grainvdb
