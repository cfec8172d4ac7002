#include "measure/state_samples.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "measure/option_values.hpp"

namespace grainvdb {
namespace {

/// Below which temperatures nothing is divided by.
struct TemperatureFloor {
  double least;
  double resolution;

  void set(FlowState& state) const {
    const Vec3& u = state.velocity;
    const double noise = resolution * resolution * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    state.least_temperature = std::max(least, noise);
  }
};

/// Which fields a state is made of: mean diameter and temperature are those of a species, where one is named; the flow
/// is that of all grains.
class StateFields {
 public:
  explicit StateFields(const OptionValues& options) : species_(std::get<std::string>(options.at("species"))) {}

  std::string operator()(const std::string& field) const {
    return !species_.empty() && is_of_grains(field) ? field + '_' + species_ : field;
  }
  bool are_of_species() const { return !species_.empty(); }

 private:
  static bool is_of_grains(const std::string& field) { return field == "mean_diameter" || field == "temperature"; }

  std::string species_;
};

class ProfileSamples : public StateSamples {
 public:
  ProfileSamples(FieldProfile profile, StateFields fields, TemperatureFloor floor, std::size_t quantities,
                 StateQuantities f)
      : profile_(std::move(profile)),
        fields_(std::move(fields)),
        floor_(floor),
        quantities_(quantities),
        f_(std::move(f)) {}

  void take(const OutputFields& output) override { profile_.take(output); }
  std::size_t times() const override { return profile_.times(); }

  std::vector<StateSample> samples() const override {
    std::vector<StateSample> all;
    for (const std::int64_t bin : profile_.bins()) {
      const FieldProfile::Means place(profile_, bin);
      StateSample sample{place.position(), place.height(), {}};
      sample.values = profile_.estimate(bin, quantities_, [&](const FieldProfile::Means& means, std::span<double> out) {
        FlowState state =
            flow_state([&](const char* field, int component = 0) { return means.value(fields_(field), component); });
        floor_.set(state);
        f_(state, out);
      });
      if (!std::isnan(sample.values.front().value)) all.push_back(std::move(sample));
    }
    return all;
  }

 private:
  FieldProfile profile_;
  StateFields fields_;
  TemperatureFloor floor_;
  std::size_t quantities_;
  StateQuantities f_;
};

class VoxelSamples : public StateSamples {
 public:
  VoxelSamples(const BinSpec& spec, const Lattice& lattice, StateFields fields, TemperatureFloor floor,
               std::size_t quantities, StateQuantities f)
      : bins_(spec, lattice), fields_(std::move(fields)), floor_(floor), quantities_(quantities), f_(std::move(f)) {}

  void take(const OutputFields& output) override {
    if (output.time.frame_count == 0) return;
    ++times_;
    std::vector<double> values(quantities_);
    bins_.for_each(*output.fields.at("phi").topology(), [&](const VoxelPlace& place) {
      FlowState state = state_at(output, place);
      floor_.set(state);
      f_(state, values);
      if (std::isnan(values.front())) return;
      StateSample sample{place.position, place.height, {}};
      for (const double v : values) sample.values.push_back({v, FlowState::unknown});
      samples_.push_back(std::move(sample));
    });
  }
  std::size_t times() const override { return times_; }
  std::vector<StateSample> samples() const override { return samples_; }

 private:
  FlowState state_at(const OutputFields& output, const VoxelPlace& place) const {
    const auto value = [&](const char* name, int component = 0) {
      const auto field = output.fields.find(fields_(name));
      if (field == output.fields.end()) return FlowState::unknown;
      return static_cast<double>(field->second.leaf(place.leaf, component)[place.offset]);
    };
    return flow_state(value);
  }

  Bins bins_;
  StateFields fields_;
  TemperatureFloor floor_;
  std::size_t quantities_;
  StateQuantities f_;
  std::size_t times_ = 0;
  std::vector<StateSample> samples_;
};

bool is_from_planes(const OptionValues& options) {
  return std::get<std::string>(options.at("source")) == "planes";
}

}  // namespace

std::vector<OptionInfo> sample_options() {
  std::vector<OptionInfo> options{{.name = "source",
                                   .default_value = std::string("profile"),
                                   .help =
                                       "profile: averages over planes or shells; planes: exact averages over "
                                       "planes, as plane_profile; voxels: each by itself, those of all output times",
                                   .choices = {"profile", "planes", "voxels"}}};
  for (OptionInfo& option : bin_options()) options.push_back(std::move(option));
  options.push_back(plane_area_option());
  options.push_back({.name = "species",
                     .default_value = std::string(),
                     .help =
                         "whose mean diameter and temperature are taken, beside stress, rate and phi of all grains; "
                         "empty: all grains"});
  return options;
}

std::optional<OptionConflict> sample_conflict(const OptionValues& options) {
  if (auto conflict = bin_conflict(options)) return conflict;
  if (!is_from_planes(options)) return std::nullopt;
  const BinSpec spec = bin_spec(options);
  if (spec.geometry == BinSpec::Geometry::shells)
    return OptionConflict{"geometry", "'shells' with source 'planes'", "'planes', or source: profile"};
  if (spec.points > 0)
    return OptionConflict{"points", std::to_string(spec.points) + " with source 'planes'",
                          "0: exact averages are over whole planes"};
  return std::nullopt;
}

MeasurementNeeds sample_needs(const OptionValues& options, std::vector<std::string> fields) {
  if (is_from_planes(options)) return {.planes = plane_needs(options, std::move(fields))};
  return {.fields = std::move(fields)};
}

OptionInfo plane_area_option() {
  return {.name = "area",
          .default_value = 0.0,
          .help = "of a plane, for exact averages [length^2]; 0: that of the box, periodic along both axes",
          .minimum = 0};
}

PlaneNeeds plane_needs(const OptionValues& options, std::vector<std::string> fields) {
  return {{axis_option(options, "axis"), number_option(options, "area")}, std::move(fields)};
}

std::vector<std::string> sample_fields(const OptionValues& options, const std::vector<std::string>& more) {
  const StateFields of_state(options);
  std::vector<std::string> fields;
  for (const std::string& field : flow_fields()) fields.push_back(of_state(field));
  if (of_state.are_of_species()) fields.push_back(volume_weight(of_state("temperature")));
  fields.insert(fields.end(), more.begin(), more.end());
  return fields;
}

std::unique_ptr<StateSamples> make_samples(const MeasurementSetting& setting, std::vector<std::string> fields,
                                           std::size_t quantities, StateQuantities f) {
  const TemperatureFloor floor{option<double>(setting.stages, "gd_over_dv", "temperature_min"),
                               option<double>(setting.stages, "velocity", "resolution")};
  const BinSpec spec = bin_spec(setting.options);
  const StateFields of_state(setting.options);
  if (std::get<std::string>(setting.options.at("source")) == "voxels")
    return std::make_unique<VoxelSamples>(spec, setting.lattice, of_state, floor, quantities, std::move(f));
  return std::make_unique<ProfileSamples>(FieldProfile(spec, setting.lattice, std::move(fields)), of_state, floor,
                                          quantities, std::move(f));
}

std::vector<double> fit_errors(const std::vector<StateSample>& samples, std::size_t index, double floor) {
  std::vector<double> errors;
  for (const StateSample& sample : samples) {
    const Estimate& y = sample.values[index];
    errors.push_back(std::hypot(y.error, floor * y.value));
    if (!(errors.back() > 0)) return {};
  }
  return errors;
}

OptionInfo error_floor_option() {
  return {.name = "error_floor",
          .default_value = 0.01,
          .help =
              "part of a value that is added to its standard error, in squares, for its weight in fits: errors "
              "from few output times are uncertain themselves",
          .minimum = 0};
}

}  // namespace grainvdb
