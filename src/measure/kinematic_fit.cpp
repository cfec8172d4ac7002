#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "grainvdb/kinematic.hpp"
#include "grainvdb/run.hpp"
#include "measure/drainage_fit.hpp"
#include "measure/jackknife_error.hpp"
#include "measure/option_values.hpp"
#include "measure/plasticity.hpp"
#include "measure/voxel_values.hpp"

namespace grainvdb {
namespace {

constexpr Dimension discharge_dimension{0, 2, -1};
constexpr Dimension area{0, 2, 0};
constexpr std::size_t fewest_times = 3;  ///< whose scatter says something

Origin origin_of(const OptionValues& options) {
  return std::get<std::string>(options.at("origin")) == "slot" ? Origin::slot : Origin::fitted;
}

/// The mean downward velocity over depth and time, against the kinematic model.
class KinematicMeasurement : public Measurement {
 public:
  explicit KinematicMeasurement(const MeasurementSetting& setting)
      : lattice_(setting.lattice),
        up_(axis_option(setting.options, "up")),
        across_(axis_option(setting.options, "across")),
        slot_(number_option(setting.options, "slot")),
        bottom_(number_option(setting.options, "bottom")),
        lowest_(number_option(setting.options, "lowest") > 0 ? number_option(setting.options, "lowest")
                                                             : setting.kernel.cutoff()),
        highest_(number_option(setting.options, "highest") > 0 ? number_option(setting.options, "highest")
                                                               : std::numeric_limits<double>::infinity()),
        half_width_(number_option(setting.options, "half_width") > 0 ? number_option(setting.options, "half_width")
                                                                     : std::numeric_limits<double>::infinity()),
        least_phi_(number_option(setting.options, "phi_min")),
        independence_(independence(setting.lattice.voxel(), setting.kernel)),
        origin_(origin_of(setting.options)) {}

  void take(const OutputFields& fields) override {
    columns_.emplace_back();
    const auto component = static_cast<std::size_t>(1 + up_);
    for_each_value(fields, {"phi", "velocity"}, [&](const Coord& c, std::span<const double> v) {
      const double x = lattice_.centre(across_, c[across_]) - slot_;
      const double z = lattice_.centre(up_, c[up_]) - bottom_;
      if (!(v[0] >= least_phi_) || std::isnan(v[component])) return;
      if (z < lowest_ || z > highest_ || std::abs(x) > half_width_) return;
      Column& column = columns_.back()[{c[up_], c[across_]}];
      column.flux -= v[0] * v[component];
      column.phi += v[0];
      ++column.voxels;
    });
  }

  std::vector<Table> tables() override {
    const Columns all = sum_over_times();
    std::vector<Table> tables = tables_of(mean_flow(all, columns_.size()));
    widen_errors(all, tables);
    return tables;
  }

 private:
  using Place = std::pair<std::int32_t, std::int32_t>;  ///< up, across
  struct Column {
    double flux = 0, phi = 0;
    std::size_t voxels = 0;

    void add(const Column& other) {
      flux += other.flux;
      phi += other.phi;
      voxels += other.voxels;
    }
    void take_off(const Column& other) {
      flux -= other.flux;
      phi -= other.phi;
      voxels -= other.voxels;
    }
  };
  using Columns = std::map<Place, Column>;

  Columns sum_over_times() const {
    Columns sums;
    for (const Columns& one : columns_)
      for (const auto& [at, column] : one) sums[at].add(column);
    return sums;
  }

  // Output times tell the same place again, so that a point is no more independent for their number.
  std::vector<DrainagePoint> mean_flow(const Columns& sums, std::size_t outputs) const {
    std::vector<DrainagePoint> points;
    for (const auto& [at, column] : sums) {
      if (column.voxels == 0) continue;
      const double deep = static_cast<double>(column.voxels) / static_cast<double>(outputs);
      points.push_back({lattice_.centre(across_, at.second) - slot_, lattice_.centre(up_, at.first) - bottom_,
                        column.flux / column.phi, std::min(1.0, independence_ * std::max(1.0, deep))});
    }
    return points;
  }

  std::vector<Table> tables_of(const std::vector<DrainagePoint>& points) const {
    return {field_table(points), width_table(points)};
  }

  // Voxels tell nothing of what all of them do for a time. What varies between output times does: the jackknife over
  // them takes the place of an error that is smaller.
  void widen_errors(const Columns& all, std::vector<Table>& tables) const {
    const std::size_t times = columns_.size();
    if (times < fewest_times) return;
    std::vector<std::vector<double>> without;  // [number of any table][time]
    for (const Columns& one : columns_) {
      Columns others = all;
      for (const auto& [at, column] : one) others[at].take_off(column);
      std::size_t n = 0;
      for (const Table& table : tables_of(mean_flow(others, times - 1)))
        for (const Quantity& q : table.numbers) {
          if (n == without.size()) without.emplace_back();
          without[n++].push_back(q.value);
        }
    }
    std::size_t n = 0;
    for (Table& table : tables) {
      for (Quantity& q : table.numbers) {
        if (std::isfinite(q.error)) q.error = std::max(q.error, jackknife_error(without[n]));
        ++n;
      }
      table.remarks.push_back("Errors are those of the fit or, where these are larger, of leaving out one of the " +
                              std::to_string(times) + " output times at a time.");
    }
  }

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

  Lattice lattice_;
  int up_, across_;
  double slot_, bottom_, lowest_, highest_, half_width_, least_phi_, independence_;
  Origin origin_;
  std::vector<Columns> columns_;  ///< of each output time
};

OptionInfo length_option_info(const char* name, const char* help) {
  return {.name = name, .default_value = 0.0, .help = help, .minimum = 0};
}

}  // namespace

MeasurementInfo kinematic_fit_measurement() {
  MeasurementInfo m;
  m.name = "kinematic_fit";
  m.description = "kinematic model of drainage through a slot: b and Q of the flow, and profile width against height";
  m.equation = "v = Q exp(-x^2/(4 b z))/sqrt(4 pi b z); s^2 = 2 b z + offset; b of dv/dz = b d2v/dx2";
  m.options = {
      up_option(),
      {.name = "across",
       .default_value = std::string("x"),
       .help = "axis across the slot; the flow is averaged over the third",
       .choices = {"x", "y", "z"}},
      {.name = "slot", .default_value = 0.0, .help = "where the middle of the slot is, across [length]"},
      {.name = "bottom", .default_value = 0.0, .help = "where the slot is, up [length]"},
      length_option_info("lowest",
                         "height above the slot from which on the flow counts [length]; 0: the kernel's cutoff, "
                         "usually three mean diameters"),
      length_option_info("highest", "height above the slot up to which it counts [length]; 0: all"),
      length_option_info("half_width", "distance from the middle up to which it counts [length]; 0: all"),
      {.name = "origin",
       .default_value = std::string("slot"),
       .help = "where profiles have no width: slot (at its height) or fitted (below, for a wide slot and kernel)",
       .choices = {"slot", "fitted"}},
      least_phi_option()};
  m.conflict = [](const OptionValues& options) -> std::optional<OptionConflict> {
    if (axis_option(options, "up") != axis_option(options, "across")) return std::nullopt;
    return OptionConflict{"across", std::get<std::string>(options.at("across")), "another axis than up"};
  };
  m.needs = [](const OptionValues&) { return MeasurementNeeds{{}, {"phi", "velocity"}}; };
  m.make = [](const MeasurementSetting& setting) { return std::make_unique<KinematicMeasurement>(setting); };
  return m;
}

}  // namespace grainvdb
