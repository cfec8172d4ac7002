#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "measure/counted_region.hpp"
#include "measure/field_motion.hpp"
#include "measure/fluctuations.hpp"
#include "measure/grains.hpp"
#include "measure/option_values.hpp"
#include "measure/structure.hpp"
#include "measure/velocity_correlation.hpp"

namespace grainvdb {
namespace {

constexpr double velocity_reach = 8;  // mean diameters
constexpr double default_from = 1;

bool about_field(const OptionValues& options) {
  return std::get<std::string>(options.at("about")) == "field";
}

/// Whether each of the components counts.
std::array<bool, 3> counted_components(const OptionValues& options) {
  std::array<bool, 3> counted{};
  for (const std::string& name : std::get<std::vector<std::string>>(options.at("components")))
    counted[static_cast<std::size_t>(name[0] - 'x')] = true;
  return counted;
}

/// C(r) of the bins that are fitted.
struct Points {
  std::vector<double> r, c;
};

class VelocityCorrelationMeasurement : public Measurement {
 public:
  explicit VelocityCorrelationMeasurement(const MeasurementSetting& setting)
      : options_(setting.options), region_(setting.options) {
    if (about_field(options_)) field_.emplace(setting.lattice);
  }

  void take(const OutputFields& output) override { field_->take(output); }

  void add(const Frame& frame) override {
    if (field_ && !field_->covers(frame.step)) {
      ++frames_without_field_;
      return;
    }
    Columns3 position, velocity;
    for (std::size_t i = 0; i < frame.particles.size(); ++i) {
      const Vec3 x = wrapped(frame.box, frame.particles.position, i);
      if (!region_.holds(x)) continue;
      Vec3 v = vector_at(frame.particles.velocity, i);
      if (field_) {
        const std::optional<Vec3> u = field_->at(frame.step, x);
        if (!u) {
          ++grains_without_field_;
          continue;
        }
        for (std::size_t a = 0; a < 3; ++a) v[a] -= (*u)[a];
      }
      push_back(position, x);
      push_back(velocity, v);
    }
    if (position[0].empty()) return;
    if (!correlation_) {
      const double d = mean_diameter(frame.particles.radius);
      motion_ = mean_motion(options_, d);
      from_ = length_option(options_, "fit_from", default_from, d);
      slabs_.emplace(region_.within(frame.box, frame.particles.position));
      correlation_.emplace(length_option(options_, "reach", velocity_reach, d), count_option(options_, "bins"));
    }
    Columns3 rest = field_ ? velocity : fluctuations(motion_, position, velocity);
    const std::array<bool, 3> counted = counted_components(options_);
    for (std::size_t a = 0; a < 3; ++a)
      if (!counted[a]) std::fill(rest[a].begin(), rest[a].end(), 0.0);
    correlation_->add(frame.box, position, rest, *slabs_);
  }

  std::vector<Table> tables() override {
    Table table{"velocity_correlation", "correlation of the velocity fluctuations of two grains",
                "C(r) = <u'(0).u'(r)>/sqrt(<u'(0)^2><u'(r)^2>); fit A (1 - 3r/4R + r^3/16R^3)"};
    add_remarks(table);
    if (!correlation_) {
      table.remarks.emplace_back(no_grains);
      return {table};
    }
    const VelocityCorrelation& c = *correlation_;
    TableColumn r{"r", dimension::length, "distance, the middle of the bin"};
    TableColumn value{"c", dimension::none, "correlation"};
    TableColumn error{"c_error", dimension::none, "standard error, by leaving out tenths of the material"};
    TableColumn fit{"fit", dimension::none, "the fitted law"};
    TableColumn pairs{"pairs", dimension::none, "pairs of grains, in both orders"};
    for (std::size_t k = 0; k < c.bins(); ++k) {
      r.values.push_back(c.middle(k));
      value.values.push_back(c.c(k));
      error.values.push_back(c.error(k));
      pairs.values.push_back(static_cast<double>(c.pairs(k)));
    }
    const SphereFit law = fitted(value.values);
    for (const double x : r.values) fit.values.push_back(law.amplitude * sphere_law(x, law.radius));
    std::vector<double> amplitudes, radii;
    for (std::size_t slab = 0; slab < Slabs::count; ++slab) {
      const std::vector<double> without = c.without(slab);
      if (without.empty()) continue;
      const SphereFit one = fitted(without);
      amplitudes.push_back(one.amplitude);
      radii.push_back(one.radius);
    }
    if (!std::isfinite(law.radius)) table.remarks.emplace_back("The law of spheres of influence could not be fitted.");
    table.numbers = {{.name = "correlation_radius",
                      .value = law.radius,
                      .error = jackknife_error(radii),
                      .dimension = dimension::length,
                      .description = "radius R of the spheres of influence; C vanishes at 2R"},
                     {.name = "amplitude",
                      .value = law.amplitude,
                      .error = jackknife_error(amplitudes),
                      .dimension = dimension::none,
                      .description = "A, the part of the fluctuations that neighbours share"}};
    table.columns = {std::move(r), std::move(value), std::move(error), std::move(fit), std::move(pairs)};
    return {table};
  }

 private:
  void add_remarks(Table& table) const {
    if (frames_without_field_ > 0)
      table.remarks.push_back(
          "Frames in no output time, whose grains have no field to fluctuate about, were left out: " +
          std::to_string(frames_without_field_) + ".");
    if (grains_without_field_ > 0)
      table.remarks.push_back("Grains where the velocity field is undefined were left out, in all frames: " +
                              std::to_string(grains_without_field_) + ".");
  }

  SphereFit fitted(const std::vector<double>& c) const {
    Points points;
    for (std::size_t k = 0; k < c.size(); ++k) {
      if (!std::isfinite(c[k]) || correlation_->middle(k) < from_) continue;
      points.r.push_back(correlation_->middle(k));
      points.c.push_back(c[k]);
    }
    return fit_sphere_law(points.r, points.c);
  }

  OptionValues options_;
  CountedRegion region_;
  MeanMotion motion_;
  std::optional<FieldMotion> field_;  ///< takes the place of motion_ for `about: field`
  std::size_t frames_without_field_ = 0, grains_without_field_ = 0;
  double from_ = 0;
  std::optional<Slabs> slabs_;
  std::optional<VelocityCorrelation> correlation_;
};

}  // namespace

MeasurementInfo velocity_correlation_measurement() {
  MeasurementInfo info;
  info.name = "velocity_correlation";
  info.description = "correlation of velocity fluctuations with distance, and the radius of what moves together";
  info.equation = "C(r) = <u'(0).u'(r)>/sqrt(<u'(0)^2><u'(r)^2>)";
  std::vector<OptionInfo> own{{.name = "reach",
                               .default_value = 0.0,
                               .help = "greatest distance [length]; 0: eight mean diameters of the first frame",
                               .minimum = 0},
                              {.name = "bins",
                               .default_value = std::int64_t{40},
                               .help = "number of equal bins of distance",
                               .minimum = 1,
                               .maximum = 1e6},
                              {.name = "fit_from",
                               .default_value = 0.0,
                               .help = "least distance that is fitted [length]; 0: one mean diameter",
                               .minimum = 0},
                              {.name = "components",
                               .default_value = std::vector<std::string>{"x", "y", "z"},
                               .help = "of the velocity, which are correlated",
                               .choices = {"x", "y", "z"}}};
  for (OptionInfo& option : mean_motion_options()) {
    if (option.name == "about") {
      option.help +=
          "; or (field) the velocity field of the output time that the frame is in: the time mean where average.window "
          "is all";
      option.choices.emplace_back("field");
    }
    own.push_back(std::move(option));
  }
  info.options = CountedRegion::options(std::move(own));
  info.conflict = [](const OptionValues& options) -> std::optional<OptionConflict> {
    if (std::get<std::vector<std::string>>(options.at("components")).empty())
      return OptionConflict{"components", "none", "at least one of x, y, z"};
    return CountedRegion::conflict(options);
  };
  info.needs = [](const OptionValues& options) {
    MeasurementNeeds needs{Column::radius | Column::velocity, {}};
    if (about_field(options)) needs.fields = {"velocity"};
    return needs;
  };
  info.make = [](const MeasurementSetting& setting) {
    return std::make_unique<VelocityCorrelationMeasurement>(setting);
  };
  return info;
}

}  // namespace grainvdb
