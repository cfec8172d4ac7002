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
#include "measure/spot_options.hpp"
#include "measure/spots.hpp"

namespace grainvdb {
namespace {

class DensityDrop : public Measurement {
 public:
  explicit DensityDrop(const OptionValues& options)
      : loosening_(smooth_box(options), static_cast<std::size_t>(axis_option(options, "up")), reference_of(options)),
        flow_from_(std::get<std::int64_t>(options.at("flow_from"))) {
    if (const double phi = number_option(options, "phi_at_rest"); phi > 0) loosening_.rest(phi);
  }

  void add(const Frame& frame) override {
    if (frame.particles.size() == 0) return;
    if (!loosening_.has_reference()) return loosening_.rest(frame);
    if (frame.step < flow_from_) return;
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
    const Loosening::Result r = loosening_.result();
    add("phi_at_rest", r.at_rest, volume, dimension::none, "packing fraction where nothing flows, by the reference");
    add("phi", r.density, volume, dimension::none, "packing fraction in flow");
    add("drop", r.drop, volume, dimension::none, "the difference");
    add("flux", r.flux, volume, dimension::velocity, "phi v, downward");
    add("speed", r.speed, 1, dimension::velocity, "velocity upward of what loosens the material");
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
  info.options = CountedRegion::options({up_option(), reference_option(), flow_from_option(), phi_at_rest_option()});
  info.conflict = whole_box_conflict;
  info.needs = [](const OptionValues&) { return MeasurementNeeds{Column::radius | Column::velocity, {}}; };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<DensityDrop>(setting.options); };
  return info;
}

}  // namespace grainvdb
