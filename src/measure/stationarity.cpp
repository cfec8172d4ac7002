#include <cmath>
#include <string>
#include <utility>

#include "grainvdb/run.hpp"
#include "measure/balance.hpp"
#include "measure/estimate_columns.hpp"
#include "measure/field_profile.hpp"
#include "measure/option_values.hpp"
#include "measure/register.hpp"
#include "measure/state_samples.hpp"

namespace grainvdb {
namespace {

class StationarityMeasurement : public Measurement {
 public:
  explicit StationarityMeasurement(const MeasurementSetting& setting)
      : axis_(axis_option(setting.options, "axis")),
        flow_(axis_option(setting.options, "flow")),
        gravity_(number_option(setting.options, "gravity")),
        profile_(spec_of(setting.options), setting.lattice, {"stress", "density"}) {}

  void add(const Frame& frame) override {
    const Particles& p = frame.particles;
    double energy = 0, mass = 0;
    for (std::size_t n = 0; n < p.size(); ++n) {
      mass += p.mass[n];
      for (std::size_t a = 0; a < 3; ++a) energy += p.mass[n] * p.velocity[a][n] * p.velocity[a][n] / 2;
    }
    has_time_ = has_time_ && frame.time.has_value();
    time_.push_back(frame.time.value_or(static_cast<double>(frame.step)));
    energy_.push_back(energy / mass);
  }

  void take(const OutputFields& output) override { profile_.take(output); }

  std::vector<Table> tables() override { return {balance_table(), energy_table()}; }

 private:
  static BinSpec spec_of(const OptionValues& options) {
    BinSpec spec;
    spec.axis = axis_option(options, "axis");
    spec.from = number_option(options, "from");
    spec.to = number_option(options, "to");
    return spec;
  }

  /// Planes in which both stresses and the density are known.
  LayerProfile layer(std::optional<std::size_t> without = {}) const {
    LayerProfile all;
    for (const std::int64_t bin : profile_.bins()) {
      const FieldProfile::Means means(profile_, bin, without);
      const double shear = means.value("stress", 3 * flow_ + axis_);
      const double normal = means.value("stress", 4 * axis_);
      const double density = means.value("density");
      if (!std::isfinite(shear + normal + density)) continue;
      all.z.push_back(means.position());
      all.shear.push_back(shear);
      all.normal.push_back(normal);
      all.density.push_back(density);
    }
    return all;
  }

  Table balance_table() const {
    Table table{"stationarity", "stresses over the height of a sheared layer, and whether they balance",
                "d sigma_xz/dz = 0, d sigma_zz/dz = rho g  (A21)"};
    table.columns.push_back({"z", dimension::length, "position of the plane along the axis"});
    const std::size_t shear =
        add_estimate_columns(table, "shear", dimension::stress, "sigma_xz, x the flow, z the axis");
    const std::size_t normal = add_estimate_columns(table, "normal", dimension::stress, "sigma_zz, tension positive");
    const std::size_t density = add_estimate_columns(table, "density", dimension::density, "sum m W");
    table.columns.push_back(
        {"balanced", dimension::stress, "constant + g integral of rho dz, with the constant nearest to sigma_zz"});
    for (const std::int64_t bin : profile_.bins()) {
      const auto estimates = profile_.estimate(bin, 3, [this](const FieldProfile::Means& means, std::span<double> out) {
        out[0] = means.value("stress", 3 * flow_ + axis_);
        out[1] = means.value("stress", 4 * axis_);
        out[2] = means.value("density");
      });
      if (!std::isfinite(estimates[0].value + estimates[1].value + estimates[2].value)) continue;
      table.columns[0].values.push_back(FieldProfile::Means(profile_, bin).position());
      append(table, shear, estimates[0]);
      append(table, normal, estimates[1]);
      append(table, density, estimates[2]);
    }
    if (table.columns[0].values.size() < 3) {
      table.remarks.push_back("The balance needs three planes at least: there are " +
                              std::to_string(table.columns[0].values.size()) + '.');
      table.columns.back().values.assign(table.columns[0].values.size(), FlowState::unknown);
      return table;
    }
    table.columns.back().values = balanced_stress(layer(), gravity_);
    add_balance_numbers(table);
    table.remarks.push_back(error_remark(profile_.times(), "output time"));
    return table;
  }

  void add_balance_numbers(Table& table) const {
    const auto found =
        jackknife(profile_.times(), 5, [this](std::optional<std::size_t> without, std::span<double> out) {
          const Balance b = balance_of(layer(without), gravity_);
          out[0] = b.shear, out[1] = b.shear_change, out[2] = b.gravity, out[3] = b.normal_change, out[4] = b.residual;
        });
    const auto add = [&](const char* name, std::size_t n, Dimension dimension, const char* meaning) {
      table.numbers.push_back({name, found[n].value, found[n].error, dimension, meaning});
    };
    add("mean_shear", 0, dimension::stress, "mean of sigma_xz over the planes");
    add("shear_change", 1, dimension::none, "slope of sigma_xz times the height, over its mean: 0 in balance");
    add("gravity", 2, Dimension{0, 1, -2}, "slope of sigma_zz against the integral of rho dz: g in balance");
    add("normal_change", 3, dimension::none, "slope of sigma_zz times the height, over its mean: 0 without gravity");
    add("balance_residual", 4, dimension::none,
        "rms of sigma_zz less the balanced stress, over the mean of |sigma_zz|");
    table.numbers.push_back({.name = "gravity_given",
                             .value = gravity_,
                             .dimension = {0, 1, -2},
                             .description = "the option gravity, with which the balanced stress is formed"});
  }

  Table energy_table() const {
    Table table{"kinetic_energy", "mean kinetic energy per mass of the grains, frame by frame",
                "e = sum m v^2/2 / sum m; e = e_0 + drift (t - mean t)"};
    const Dimension time = has_time_ ? dimension::time : dimension::none;
    table.columns.push_back(
        {"time", time, has_time_ ? "of the frame" : "step of the frame: its time is not known", time_});
    table.columns.push_back({"energy", dimension::velocity_squared, "kinetic energy per mass", energy_});
    const Fit fit = fit_drift(time_, energy_);
    const Dimension drift = has_time_ ? Dimension{0, 2, -3} : dimension::velocity_squared;
    const double change = (time_.empty() ? 0 : time_.back() - time_.front()) / fit.parameters[0];
    table.numbers.push_back({"energy", fit.parameters[0], fit.errors[0], dimension::velocity_squared, "mean of e"});
    table.numbers.push_back({"drift", fit.parameters[1], fit.errors[1], drift, "slope of e in time: 0 in steady flow"});
    table.numbers.push_back({"energy_change", fit.parameters[1] * change, fit.errors[1] * std::abs(change),
                             dimension::none, "drift times the duration, over the mean: 0 in steady flow"});
    if (!fit.fitted()) table.remarks.push_back("A fit of the drift is refused: " + fit.refusal + '.');
    table.remarks.push_back(
        "The errors take the frames for independent: what lasts longer than a frame makes them too "
        "small.");
    return table;
  }

  int axis_, flow_;
  double gravity_;
  FieldProfile profile_;
  bool has_time_ = true;
  std::vector<double> time_, energy_;
};

MeasurementInfo stationarity() {
  MeasurementInfo info;
  info.name = "stationarity";
  info.description = "balance of stresses over the height of a sheared layer, and drift of the kinetic energy";
  info.equation = "d sigma_xz/dz = 0, d sigma_zz/dz = rho g  (A21)";
  info.options = {
      {.name = "axis",
       .default_value = std::string("z"),
       .help = "against gravity, and normal to the planes",
       .choices = {"x", "y", "z"}},
      {.name = "flow",
       .default_value = std::string("x"),
       .help = "the direction of the flow",
       .choices = {"x", "y", "z"}},
      {.name = "from",
       .default_value = 0.0,
       .help = "voxel centres below are left out [length]; no bounds where from and to are 0"},
      {.name = "to", .default_value = 0.0, .help = "voxel centres from here on are left out [length]"},
      {.name = "gravity", .default_value = 0.0, .help = "acceleration against the axis, 0 for none [length/time^2]"},
      {.name = "source",
       .default_value = std::string("profile"),
       .help = "profile: averages over the voxels of planes; planes: exact averages over planes, as plane_profile",
       .choices = {"profile", "planes"}},
      plane_area_option()};
  info.conflict = [](const OptionValues& options) -> std::optional<OptionConflict> {
    if (axis_option(options, "axis") == axis_option(options, "flow"))
      return OptionConflict{"flow", std::get<std::string>(options.at("flow")), "another direction than the axis"};
    return height_conflict(options);
  };
  info.needs = [](const OptionValues& options) {
    MeasurementNeeds needs = sample_needs(options, {"stress", "density"});
    needs.particles = Column::velocity | Column::mass;
    return needs;
  };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<StationarityMeasurement>(setting); };
  return info;
}

}  // namespace

std::vector<MeasurementInfo> stationarity_measurements() {
  return {stationarity()};
}

}  // namespace grainvdb
