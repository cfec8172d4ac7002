#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "measure/counted_region.hpp"
#include "measure/dispersion.hpp"
#include "measure/grains.hpp"
#include "measure/option_values.hpp"
#include "measure/structure.hpp"

namespace grainvdb {
namespace {

class Diffusion : public Measurement {
 public:
  explicit Diffusion(const OptionValues& options)
      : options_(options), dispersion_(CountedRegion(options), count_option(options, "lags")) {}

  void add(const Frame& frame) override {
    if (!(diameter_ > 0) && frame.particles.size() > 0) {
      diameter_ = mean_diameter(frame.particles.radius);
      motion_ = mean_motion(options_, diameter_);
    }
    dispersion_.add(frame, motion_);
  }

  std::vector<Table> tables() override {
    Table table{"diffusion", "variance of the displacements of grains about their mean motion",
                "Var(dx) = 2 D t = 2 b s, s the way travelled; Pe = U d/D = d/b"};
    TableColumn time{"time", dimension::time, "time since the first frame of a window"};
    TableColumn travelled{"travelled", dimension::length, "length of the mean displacement"};
    TableColumn grains{"grains", dimension::none, "grains that were followed so far, in all windows"};
    for (std::size_t k = 0; k < dispersion_.lags(); ++k) {
      time.values.push_back(dispersion_.time(k));
      travelled.values.push_back(dispersion_.travelled(k));
      grains.values.push_back(dispersion_.grains(k));
    }
    table.columns = {std::move(time), std::move(travelled)};
    for (std::size_t a = 0; a < 3; ++a) add_axis(table, a);
    table.columns.push_back(std::move(grains));
    if (dispersion_.lags() == 0 || dispersion_.grains(0) == 0)
      table.remarks.emplace_back("No grain could be followed from one frame to the next.");
    if (dispersion_.refused_steps() > 0)
      table.remarks.push_back(
          std::to_string(dispersion_.refused_steps()) +
          " steps between frames were refused: a grain may have moved by more than half of a periodic "
          "length, so that its nearest image need not be it. Take frames nearer to each other.");
    return {table};
  }

 private:
  void add_axis(Table& table, std::size_t a) const {
    const std::string axis(1, static_cast<char>('x' + a));
    TableColumn variance{"variance_" + axis, {0, 2, 0}, "variance of the displacement along " + axis};
    for (std::size_t k = 0; k < dispersion_.lags(); ++k) variance.values.push_back(dispersion_.variance(k, a));
    table.columns.push_back(std::move(variance));
    const double from = number_option(options_, "fit_from");
    const Diffusivity by_time = dispersion_.diffusivity(a, Dispersion::Against::time, from);
    const Diffusivity by_way = dispersion_.diffusivity(a, Dispersion::Against::travelled, from);
    const double peclet = diameter_ / by_way.value;
    table.numbers.push_back({.name = "diffusivity_" + axis,
                             .value = by_time.value,
                             .error = by_time.error,
                             .dimension = {0, 2, -1},
                             .description = "D along " + axis + ", half the slope of the variance against time"});
    table.numbers.push_back({.name = "diffusion_length_" + axis,
                             .value = by_way.value,
                             .error = by_way.error,
                             .dimension = dimension::length,
                             .description = "b along " + axis + ", half the slope against the way travelled"});
    table.numbers.push_back({.name = "peclet_" + axis,
                             .value = peclet,
                             .error = std::abs(peclet) * by_way.error / std::abs(by_way.value),
                             .dimension = dimension::none,
                             .description = "Peclet number d/b along " + axis + ", d the mean diameter"});
  }

  OptionValues options_;
  Dispersion dispersion_;
  MeanMotion motion_;
  double diameter_ = 0;
};

}  // namespace

MeasurementInfo diffusion_measurement() {
  MeasurementInfo info;
  info.name = "diffusion";
  info.description = "diffusion of grains against time and way travelled, and Peclet numbers";
  info.equation = "Var(dx) = 2 D t = 2 b s; Pe = d/b";
  std::vector<OptionInfo> own{
      {.name = "lags",
       .default_value = std::int64_t{0},
       .help =
           "steps between frames in a window; grains are followed from the first frame of each. 0: one window of all",
       .minimum = 0,
       .maximum = 1e6},
      {.name = "fit_from",
       .default_value = 0.0,
       .help = "least time since the first frame that is fitted [time]; 0: all",
       .minimum = 0}};
  for (OptionInfo& option : mean_motion_options()) own.push_back(std::move(option));
  info.options = CountedRegion::options(std::move(own));
  info.conflict = CountedRegion::conflict;
  info.needs = [](const OptionValues&) { return MeasurementNeeds{Column::radius | Column::velocity, {}}; };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<Diffusion>(setting.options); };
  return info;
}

}  // namespace grainvdb
