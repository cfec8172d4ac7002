#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "measure/counted_region.hpp"
#include "measure/frame_series.hpp"
#include "measure/loosening.hpp"
#include "measure/option_values.hpp"
#include "measure/spots.hpp"

namespace grainvdb {
namespace {

SmoothBox box_of(const OptionValues& options) {
  const auto& lo = std::get<std::vector<double>>(options.at("lo"));
  const auto& hi = std::get<std::vector<double>>(options.at("hi"));
  return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

class DensityDrop : public Measurement {
 public:
  explicit DensityDrop(const OptionValues& options)
      : loosening_(box_of(options), static_cast<std::size_t>(std::get<std::string>(options.at("up"))[0] - 'x')),
        flow_from_(std::get<std::int64_t>(options.at("flow_from"))) {
    if (const double phi = number_option(options, "phi_at_rest"); phi > 0) loosening_.rest(phi);
  }

  void add(const Frame& frame) override {
    if (!loosening_.has_rest()) return loosening_.rest(frame);
    if (frame.step < flow_from_ || frame.particles.size() == 0) return;
    loosening_.add(frame);
    series_.add(frame);
  }

  std::vector<Table> tables() override {
    Table table{"density_drop",
                "how much looser the material is in flow than at rest, and the velocity of what loosens it",
                "c = <phi v>/(phi_rest - phi), v downward"};
    const double volume = loosening_.grain_volume();
    TableColumn phi{"phi", dimension::none, "packing fraction in the box", {}};
    for (const double n : loosening_.density()) phi.values.push_back(volume * n);
    table.columns = {series_.column(), std::move(phi)};
    if (loosening_.frames() == 0) {
      table.remarks.emplace_back("No frame has grains that flow.");
      return {table};
    }
    const auto add = [&](const char* name, Estimate e, double factor, const Dimension& d, const char* description) {
      table.numbers.push_back({.name = name,
                               .value = factor * e.value,
                               .error = factor * e.error,
                               .dimension = d,
                               .description = description});
    };
    add("phi_at_rest", {loosening_.density_at_rest()}, volume, dimension::none, "packing fraction at rest");
    add("phi", loosening_.number_density(), volume, dimension::none, "packing fraction in flow");
    add("drop", loosening_.drop(), volume, dimension::none, "the difference");
    add("flux", loosening_.flux(), volume, dimension::velocity, "phi v, downward");
    add("speed", loosening_.speed(), 1, dimension::velocity, "velocity upward of what loosens the material");
    return {table};
  }

 private:
  Loosening loosening_;
  std::int64_t flow_from_;
  FrameSeries series_;
};

}  // namespace

MeasurementInfo density_drop_measurement() {
  MeasurementInfo info;
  info.name = "density_drop";
  info.description = "packing fraction in flow below that at rest, and the velocity of what loosens the material";
  info.equation = "c = <phi v>/(phi_rest - phi)";
  info.options = CountedRegion::options(
      {{.name = "up", .default_value = std::string("z"), .help = "axis against gravity", .choices = {"x", "y", "z"}},
       {.name = "flow_from",
        .default_value = std::int64_t{0},
        .help = "step of the first frame of the steady flow; those between the first and it count for nothing"},
       {.name = "phi_at_rest",
        .default_value = 0.0,
        .help = "packing fraction of the box at rest; 0: that of the first frame",
        .minimum = 0,
        .maximum = 1}});
  info.conflict = whole_box_conflict;
  info.needs = [](const OptionValues&) { return MeasurementNeeds{Column::radius | Column::velocity, {}}; };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<DensityDrop>(setting.options); };
  return info;
}

std::optional<OptionConflict> whole_box_conflict(const OptionValues& options) {
  for (const std::string name : {"lo", "hi"})
    if (std::get<std::vector<double>>(options.at(name)).empty())
      return OptionConflict{name, "none", "three numbers: a box within the material"};
  return CountedRegion::conflict(options);
}

}  // namespace grainvdb
