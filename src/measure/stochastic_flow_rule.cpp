#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include "grainvdb/run.hpp"
#include "measure/distribution.hpp"
#include "measure/option_values.hpp"
#include "measure/plasticity.hpp"
#include "measure/streamlines.hpp"
#include "measure/voxel_values.hpp"

namespace grainvdb {
namespace {

/// `lines` places from `from` to `to`, ends included.
std::vector<Vec3> starts_of(const OptionValues& options) {
  const std::vector<double>& from = numbers_option(options, "from");
  const std::vector<double>& to = numbers_option(options, "to");
  std::vector<Vec3> starts;
  if (from.empty()) return starts;
  const auto lines = std::get<std::int64_t>(options.at("lines"));
  for (std::int64_t n = 0; n < lines; ++n) {
    const double share = lines > 1 ? static_cast<double>(n) / static_cast<double>(lines - 1) : 0.5;
    Vec3& x = starts.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) x[i] = from[i] + share * (to[i] - from[i]);
  }
  return starts;
}

/// Whether grains move against the drift of spots, and the lines along which spots drift.
class StochasticFlowRule : public Measurement {
 public:
  explicit StochasticFlowRule(const MeasurementSetting& setting)
      : lattice_(setting.lattice),
        box_(setting.box),
        least_phi_(number_option(setting.options, "phi_min")),
        angles_(0, std::numbers::pi, count_option(setting.options, "bins"),
                independence(setting.lattice.voxel(), setting.kernel)),
        starts_(starts_of(setting.options)),
        length_(number_option(setting.options, "length") > 0 ? number_option(setting.options, "length")
                                                             : 10 * setting.kernel.cutoff()) {
    describe_lines();
  }

  void take(const OutputFields& fields) override {
    for_each_value(fields, {"phi", "spot_drift", "velocity"}, [&](const Coord&, std::span<const double> v) {
      if (v[0] >= least_phi_) compare(v.subspan<1, 3>(), v.subspan<4, 3>());
    });
    if (!starts_.empty()) follow(fields.fields.at("spot_drift"));
    ++outputs_;
  }

  std::vector<Table> tables() override {
    std::vector<Table> all{angle_table()};
    if (!starts_.empty()) all.push_back(lines_);
    return all;
  }

 private:
  void compare(std::span<const double, 3> drift, std::span<const double, 3> velocity) {
    const Vec3 cross{drift[1] * velocity[2] - drift[2] * velocity[1], drift[2] * velocity[0] - drift[0] * velocity[2],
                     drift[0] * velocity[1] - drift[1] * velocity[0]};
    const double against = -(drift[0] * velocity[0] + drift[1] * velocity[1] + drift[2] * velocity[2]);
    const double speed = std::hypot(velocity[0], velocity[1], velocity[2]);
    const bool has_drift = std::hypot(drift[0], drift[1], drift[2]) > 0;
    angles_.add(has_drift ? std::atan2(std::hypot(cross[0], cross[1], cross[2]), against) : std::nan(""), speed);
  }

  void follow(const SparseField& drift) {
    const double step = lattice_.voxel() / 2;
    const std::vector<Streamline> found = streamlines(lattice_, box_, drift, starts_, step, length_);
    std::size_t empty = 0;
    for (std::size_t n = 0; n < found.size(); ++n) {
      if (found[n].points.empty()) ++empty;
      for (std::size_t k = 0; k < found[n].points.size(); ++k) {
        const Vec3& x = found[n].points[k];
        const double row[] = {static_cast<double>(k) * step, x[0], x[1], x[2], static_cast<double>(n),
                              static_cast<double>(outputs_)};
        for (std::size_t c = 0; c < std::size(row); ++c) lines_.columns[c].values.push_back(row[c]);
      }
    }
    if (empty > 0)
      lines_.remarks.push_back("Output " + std::to_string(outputs_) + ": " + std::to_string(empty) +
                               " lines start where the drift is undefined.");
  }

  void describe_lines() {
    lines_.name = "spot_streamlines";
    lines_.description = "lines along which spots drift";
    lines_.equation = "dx/ds = D1/|D1|";
    lines_.columns = {{"way", dimension::length, "along the line from its start"},
                      {"x", dimension::length, "place, unwrapped"},
                      {"y", dimension::length, "place, unwrapped"},
                      {"z", dimension::length, "place, unwrapped"},
                      {"line", dimension::none, "number of the line, from 0"},
                      {"output", dimension::none, "number of the output time, from 0"}};
  }

  Table angle_table() const {
    Table t{.name = "stochastic_flow_rule",
            .description = "distribution of the angle between the velocity and the way opposite to the drift of spots",
            .equation = "acos(-u.D1/(|u| |D1|)), weight |u|; random directions: density sin(angle)/2, mean pi/2 rad"};
    t.columns = {{"angle", dimension::none, "middle of the bin [rad]", angles_.histogram().centres()},
                 {"density", dimension::none, "share of the weight by width of the bin [1/rad]",
                  angles_.histogram().densities()}};
    t.numbers = angles_.numbers("the angle [rad]");
    if (angles_.empty()) t.remarks.emplace_back("No voxel has both a velocity and a drift of spots.");
    return t;
  }

  Lattice lattice_;
  Box box_;
  double least_phi_;
  Distribution angles_;
  std::vector<Vec3> starts_;
  double length_;
  Table lines_;
  std::size_t outputs_ = 0;
};

std::optional<OptionConflict> conflict_of(const OptionValues& options) {
  const std::size_t from = numbers_option(options, "from").size();
  const std::size_t to = numbers_option(options, "to").size();
  if (from != 0 && from != 3) return OptionConflict{"from", std::to_string(from) + " numbers", "three, or none"};
  if (to != from) return OptionConflict{"to", std::to_string(to) + " numbers", "as many as from has"};
  return std::nullopt;
}

}  // namespace

MeasurementInfo stochastic_flow_rule_measurement() {
  MeasurementInfo m;
  m.name = "stochastic_flow_rule";
  m.description =
      "do grains move against the drift of spots? Angles between them, and the lines along which spots drift";
  m.equation = "acos(-u.D1/(|u| |D1|)); dx/ds = D1/|D1|";
  m.options = {
      least_phi_option(),
      bins_option(36),
      {.name = "from",
       .default_value = std::vector<double>{},
       .help = "streamlines start on a straight line from here, three numbers [length]; none: no streamlines"},
      {.name = "to", .default_value = std::vector<double>{}, .help = "to here, three numbers [length]"},
      {.name = "lines",
       .default_value = std::int64_t{10},
       .help = "number of streamlines, the ends of the line included",
       .minimum = 1,
       .maximum = 100000},
      {.name = "length",
       .default_value = 0.0,
       .help = "of a streamline [length]; 0: ten cutoffs of the kernel, thirty mean diameters where it is usual",
       .minimum = 0}};
  m.conflict = conflict_of;
  m.needs = [](const OptionValues&) { return MeasurementNeeds{{}, {"phi", "spot_drift", "velocity"}}; };
  m.make = [](const MeasurementSetting& setting) { return std::make_unique<StochasticFlowRule>(setting); };
  return m;
}

}  // namespace grainvdb
