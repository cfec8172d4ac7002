#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/nan.hpp"
#include "grainvdb/run.hpp"
#include "grainvdb/spot_diffusion.hpp"
#include "measure/counted_region.hpp"
#include "measure/loosening.hpp"
#include "measure/option_values.hpp"
#include "measure/plane_counts.hpp"
#include "measure/plasticity.hpp"
#include "measure/spot_options.hpp"
#include "measure/spot_parameters.hpp"
#include "measure/spots.hpp"
#include "measure/structure.hpp"
#include "measure/time_groups.hpp"

namespace grainvdb {
namespace {

constexpr double default_rise = 0.1;    // mean diameters, as published
constexpr std::size_t plane_count = 5;  // at which the flow is counted

// Against a frame at rest, the whole width of the silo counts: what flows down within the box came from places where
// the spots were fewer when they first came by, and has lost less than the spots around it say. Between two planes
// right across, what is missing is what flowed out below before the flow began above.
SmoothBox drop_box(const OptionValues& options) {
  SmoothBox box = smooth_box(options);
  if (reference_of(options) == Loosening::Reference::layers || number_option(options, "phi_at_rest") > 0) return box;
  for (const std::size_t a : {0, 1}) {
    box.lo[a] = -std::numeric_limits<double>::infinity();
    box.hi[a] = std::numeric_limits<double>::infinity();
  }
  return box;
}

std::vector<double> plane_heights(const OptionValues& options) {
  const double lo = numbers_option(options, "lo")[2], hi = numbers_option(options, "hi")[2];
  std::vector<double> heights;
  for (std::size_t k = 0; k < plane_count; ++k)
    heights.push_back(lo + (hi - lo) * static_cast<double>(k) / (plane_count - 1));
  return heights;
}

Estimate number_of(const std::vector<Table>& tables, const std::string& table, const std::string& name) {
  for (const Table& t : tables)
    for (const Quantity& q : t.numbers)
      if (t.name == table && q.name == name) return {q.value, q.error};
  return {};
}

/// With the larger of two errors, where there are both.
Estimate widened(const Estimate& e, double other) {
  return {e.value, std::isfinite(other) ? std::max(e.error, other) : e.error};
}

/// The error of the mean of values of successive windows of time.
double error_of_mean(const std::vector<double>& values) {
  std::vector<double> known;
  std::copy_if(values.begin(), values.end(), std::back_inserter(known), [](double x) { return std::isfinite(x); });
  return mean_by_time_groups(known).error;
}

/// A measurement of the registry as a part of this one, with options of its own.
class Part {
 public:
  Part(MeasurementInfo info, const OptionValues& given) : info_(std::move(info)) {
    for (const OptionInfo& o : info_.options) options_[o.name] = o.default_value;
    for (const auto& [name, value] : given) options_.at(name) = value;
  }

  std::unique_ptr<Measurement> make(const MeasurementSetting& setting) const {
    return info_.make(
        {options_, setting.stages, setting.lattice, setting.kernel, setting.box, setting.grain_density, setting.walls});
  }
  MeasurementNeeds needs() const { return info_.needs(options_); }

 private:
  MeasurementInfo info_;
  OptionValues options_;
};

Part widths_part(const OptionValues& o) {
  return {kinematic_fit_measurement(),
          {{"slot", o.at("slot")},
           {"bottom", o.at("bottom")},
           {"lowest", o.at("lowest")},
           {"highest", o.at("highest")},
           {"half_width", o.at("half_width")},
           {"phi_min", o.at("phi_min")},
           {"origin", std::string("fitted")}}};
}

Part correlation_part(const OptionValues& o) {
  return {velocity_correlation_measurement(),
          {{"lo", o.at("lo")},
           {"hi", o.at("hi")},
           {"reach", o.at("reach")},
           {"about", o.at("about")},
           {"components", o.at("components")}}};
}

Part diffusion_part(const OptionValues& o) {
  return {diffusion_measurement(),
          {{"lo", o.at("lo")},
           {"hi", o.at("hi")},
           {"lags", o.at("lags")},
           {"fit_from", o.at("fit_from")},
           {"about", o.at("about")}}};
}

class SpotCalibration : public Measurement {
 public:
  explicit SpotCalibration(const MeasurementSetting& setting)
      : options_(setting.options),
        stages_(setting.stages),
        lattice_(setting.lattice),
        setting_{options_, stages_, lattice_, setting.kernel, setting.box, setting.grain_density},
        flow_from_(std::get<std::int64_t>(options_.at("flow_from"))),
        lags_(count_option(options_, "lags")),
        widths_(widths_part(options_).make(setting_)),
        correlation_(correlation_part(options_).make(setting_)),
        diffusion_(diffusion_part(options_).make(setting_)),
        region_(smooth_box(options_), 2),
        region_at_rest_(smooth_box(options_), 2),
        loosening_(drop_box(options_), 2, reference_of(options_)),
        counts_(2, plane_heights(options_)) {
    if (const double phi = number_option(options_, "phi_at_rest"); phi > 0) loosening_.rest(phi);
  }

  void take(const OutputFields& output) override {
    if (output.time.frame_count == 0 || output.time.first_step < flow_from_) return;
    widths_->take(output);
    ++outputs_;
  }

  void add(const Frame& frame) override {
    if (frame.particles.size() == 0) return;
    if (!(diameter_ > 0)) diameter_ = 2 * frame.particles.radius.front();
    if (!loosening_.has_reference()) {
      region_at_rest_.add(frame, diameter_);
      return loosening_.rest(frame);
    }
    if (frame.step < flow_from_) return;
    for (Measurement* part : {correlation_.get(), diffusion_.get()}) part->add(frame);
    region_.add(frame, diameter_);
    loosening_.add(frame);
    counts_.add(frame);
    add_to_window(frame);
  }

  std::vector<Table> tables() override {
    std::vector<Table> all = diffusion_->tables();
    for (auto* part : {correlation_.get(), widths_.get()})
      for (Table& table : part->tables()) all.push_back(std::move(table));
    const Loosening::Result loosened = loosening_.result();
    Table table =
        parameter_table(observations(all, loosened), loosened, number_of(all, "velocity_correlation", "amplitude"),
                        number_of(all, "kinematic_width", "offset"));
    for (Table& part : all) part.name = "spot_calibration_" + part.name;
    all.insert(all.begin(), std::move(table));
    return all;
  }

 private:
  // Windows of a few frames, each measured by itself: what these scatter by is an error that neighbours in space cannot
  // tell.
  void add_to_window(const Frame& frame) {
    if (lags_ == 0) return;
    if (!window_diffusion_) begin_window();
    window_correlation_->add(frame);
    window_diffusion_->add(frame);
    if (frames_in_window_++ < lags_) return;
    const std::vector<Table> spread = window_diffusion_->tables(), common = window_correlation_->tables();
    diffusions_.push_back(number_of(spread, "diffusion", "diffusion_length_y").value);
    radii_.push_back(number_of(common, "velocity_correlation", "correlation_radius").value);
    begin_window();
    window_diffusion_->add(frame);  // a window begins where the one before ends
    frames_in_window_ = 1;
  }

  void begin_window() {
    window_correlation_ = correlation_part(options_).make(setting_);
    window_diffusion_ = diffusion_part(options_).make(setting_);
    frames_in_window_ = 0;
  }

  SpotObservations observations(const std::vector<Table>& tables, const Loosening::Result& loosened) const {
    SpotObservations o;
    o.radius = widened(number_of(tables, "velocity_correlation", "correlation_radius"), error_of_mean(radii_));
    o.b = number_of(tables, "kinematic_width", "b");
    o.grain_diffusion = widened(number_of(tables, "diffusion", "diffusion_length_y"), error_of_mean(diffusions_));
    if (loosening_.frames() > 0) o.number_density = mean_by_time_groups(region_.density());
    o.speed = loosened.speed;
    o.speed.error = std::hypot(o.speed.error, o.speed.value * relative_drop(loosened));
    o.outflow = counts_.mean_rate();
    for (const Table& t : tables)
      if (t.name == "diffusion")
        for (const double time : t.columns.front().values)
          if (std::isfinite(time) && time >= number_option(options_, "fit_from")) o.times.push_back(time);
    o.rise = length_option(options_, "rise", default_rise, diameter_);
    return o;
  }

  // A spot carries more where grains are denser, and those that come from above are denser or looser than the spots
  // around them make them. What is missing therefore tells the speed to the part of the grains that is missing.
  double relative_drop(const Loosening::Result& loosened) const {
    if (region_at_rest_.density().empty()) return loosened.drop.value / loosened.at_rest.value;
    return 1 - mean_by_time_groups(region_.density()).value / region_at_rest_.density().front();
  }

  Table parameter_table(const SpotObservations& o, const Loosening::Result& loosened, const Estimate& amplitude,
                        const Estimate& offset) const {
    const SpotParameterEstimates p = spot_parameters(o);
    Table t{"spot_calibration", "parameters of the spot model that makes this flow",
            "C(r) = 1 - 3r/4R + r^3/16R^3; s^2 = 2 b z + offset; w = s b/b_p; Q = lambda N/w; c = <phi v>/drop"};
    t.columns = {{"time", dimension::time, "time in which grains spread", o.times},
                 {"share", dimension::none, "s: spread over what it would be if a spot never came back", {}}};
    add_shares(t, o, p);
    t.numbers = spot_quantities(o, p);
    const double volume = loosening_.grain_volume();
    const auto add = [&](const char* name, Estimate e, const Dimension& d, const char* description) {
      t.numbers.push_back(
          {.name = name, .value = e.value, .error = e.error, .dimension = d, .description = description});
    };
    add("amplitude", amplitude, dimension::none, "A of the correlation: 1 where spots are all that moves grains");
    add("offset", offset, {0, 2, 0}, "variance of the widths of profiles at the height of the slot");
    const auto times = [](double factor, const Estimate& e) { return Estimate{factor * e.value, factor * e.error}; };
    add("phi", times(volume, o.number_density), dimension::none, "packing fraction in flow");
    add("drop", times(1 / loosened.at_rest.value, loosened.drop), dimension::none,
        "grains that are missing in flow, as a share of those at rest");
    add_remarks(loosened, t);
    return t;
  }

  static void add_shares(Table& t, const SpotObservations& o, const SpotParameterEstimates& p) {
    const bool known = std::isfinite(p.share.value);
    std::optional<DiffusionShare> share;
    if (known) share.emplace(SpotWalk{o.radius.value, {p.step.value, p.step.value, o.rise}});
    for (const double time : o.times)
      t.columns[1].values.push_back(known ? share->after(p.hop_rate.value * time) : nan);
  }

  void add_remarks(const Loosening::Result& loosened, Table& t) const {
    if (loosening_.frames() == 0) t.remarks.emplace_back("No frame after the packing at rest belongs to the flow.");
    if (loosened.drop.value <= 0)
      t.remarks.emplace_back(
          "The flow is no looser than what it is compared with, so that spots have no speed: give phi_at_rest, or "
          "reference: layers.");
    if (counts_.times().size() < loosening_.frames())
      t.remarks.emplace_back("Frames without a time have no rates: give input.dt, the time step of the simulation.");
    if (outputs_ < 3)
      t.remarks.emplace_back(
          "Fewer than three output times lie in the flow, so that the error of b is that of one fit, which is too "
          "small. Make average.window shorter.");
    if (radii_.size() < 4)
      t.remarks.emplace_back(
          "Fewer than four windows of frames lie in the flow: errors of radius and diffusion_length are from leaving "
          "out slabs alone. Make lags less, or take more frames.");
  }

  OptionValues options_;
  StageSettings stages_;
  Lattice lattice_;
  MeasurementSetting setting_;  ///< refers to the three above
  std::int64_t flow_from_;
  std::size_t lags_, outputs_ = 0;
  std::unique_ptr<Measurement> widths_, correlation_, diffusion_;
  BoxFlow region_, region_at_rest_;
  Loosening loosening_;
  PlaneCounts counts_;
  std::unique_ptr<Measurement> window_correlation_, window_diffusion_;
  std::size_t frames_in_window_ = 0;
  std::vector<double> radii_, diffusions_;  ///< of each window
  double diameter_ = 0;
};

OptionInfo length_info(const char* name, const char* help) {
  return {.name = name, .default_value = 0.0, .help = help, .minimum = 0};
}

std::vector<OptionInfo> calibration_options() {
  return CountedRegion::options(
      {{.name = "slot", .default_value = 0.0, .help = "x of the middle of the slot, which runs along y [length]"},
       {.name = "bottom", .default_value = 0.0, .help = "z of the slot and the floor [length]"},
       length_info("slot_width", "along x [length]; 'grainvdb spot calibrate' needs it for its spot file"),
       {.name = "side_walls",
        .default_value = std::vector<double>{},
        .help = "x of the two side walls [length]; empty: as far out as there are grains"},
       length_info("lowest", "height above the slot from which on widths count [length]; 0: the kernel's cutoff"),
       length_info("highest", "height up to which they count [length]; 0: all"),
       length_info("half_width", "distance from the middle up to which they count [length]; 0: all"),
       {.name = "phi_min",
        .default_value = 0.4,
        .help = "voxels with a packing fraction below this do not count for widths",
        .minimum = 0,
        .maximum = 1},
       {.name = "about",
        .default_value = std::string("none"),
        .help = "mean motion that is taken off velocities and displacements: none along the slot by symmetry; the mean "
                "or the linear flow of the box, where it slides as a whole or other components count",
        .choices = {"none", "mean", "linear"}},
       {.name = "components",
        .default_value = std::vector<std::string>{"y"},
        .help = "of the velocity, whose correlation tells the radius",
        .choices = {"x", "y", "z"}},
       length_info("reach", "greatest distance of the velocity correlation [length]; 0: eight mean diameters"),
       {.name = "lags",
        .default_value = std::int64_t{4},
        .help = "steps between frames of a window in which grains spread, see 'diffusion'; 0: one window of all",
        .minimum = 0,
        .maximum = 1e6},
       {.name = "fit_from",
        .default_value = 0.0,
        .help = "least time in a window that is fitted [time]; 0: all",
        .minimum = 0},
       reference_option(),
       flow_from_option(),
       phi_at_rest_option(),
       length_info("rise", "of a spot in one step [length]; 0: a tenth of the diameter")});
}

}  // namespace

MeasurementInfo spot_calibration_measurement() {
  MeasurementInfo info;
  info.name = "spot_calibration";
  info.description = "parameters of the spot model for a silo with a slot: radius, steps, influence and rates";
  info.equation = "w = s b/b_p; N = n 4/3 pi R^3; Q = lambda N/w; c = <phi v>/(phi_rest - phi)";
  info.options = calibration_options();
  info.conflict = [](const OptionValues& options) -> std::optional<OptionConflict> {
    const std::vector<double>& walls = numbers_option(options, "side_walls");
    if (!walls.empty() && !(walls.size() == 2 && walls[0] < walls[1]))
      return OptionConflict{"side_walls", std::to_string(walls.size()) + " numbers", "two numbers in order, or none"};
    if (std::get<std::vector<std::string>>(options.at("components")).empty())
      return OptionConflict{"components", "none", "at least one of x, y, z"};
    return whole_box_conflict(options);
  };
  info.needs = [](const OptionValues& options) {
    return MeasurementNeeds{Column::radius | Column::velocity, widths_part(options).needs().fields};
  };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<SpotCalibration>(setting); };
  return info;
}

}  // namespace grainvdb
