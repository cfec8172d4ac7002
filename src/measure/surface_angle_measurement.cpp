#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "measure/counted_region.hpp"
#include "measure/frame_series.hpp"
#include "measure/free_surface.hpp"
#include "measure/grains.hpp"
#include "measure/option_values.hpp"
#include "measure/structure.hpp"

namespace grainvdb {
namespace {

constexpr double default_column = 2;  // mean diameters
constexpr double neighbourhood = 1.5;
constexpr double degrees = 180 / std::numbers::pi;

class SurfaceAngle : public Measurement {
 public:
  explicit SurfaceAngle(const OptionValues& options)
      : options_(options), region_(options), vertical_(static_cast<std::size_t>(axis_option(options, "up"))) {}

  void add(const Frame& frame) override {
    const Particles& grains = frame.particles;
    if (grains.size() == 0) return;
    if (!all_) {
      diameter_ = mean_diameter(grains.radius);
      width_ = length_option(options_, "column", default_column, diameter_);
      all_.emplace(vertical_, width_);
      has_slope_ = !frame.box.periodic[(vertical_ + 1) % 3] || !frame.box.periodic[(vertical_ + 2) % 3];
    }
    const std::vector<bool> counts =
        supported(frame.box, grains.position, neighbourhood * diameter_, count_option(options_, "neighbours"));
    Columns3 position;
    std::vector<double> radius;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (!counts[i] || !region_.holds(wrapped(frame.box, grains.position, i))) continue;
      push_back(position, vector_at(grains.position, i));
      radius.push_back(grains.radius[i]);
    }
    FreeSurface one(vertical_, width_);
    one.add(frame.box, position, radius);
    all_->add(frame.box, position, radius);
    series_.add(frame);
    frames_.push_back(one.plane());
  }

  std::vector<Table> tables() override {
    Table table{"surface_angle", "angle of the free surface from the horizontal, frame by frame",
                "h = h_0 + s.x through the tops of columns; angle = atan |s|"};
    if (!all_) {
      table.remarks.emplace_back(no_grains);
      return {table};
    }
    TableColumn angle{"angle", dimension::none, "angle of the surface [degrees]"};
    TableColumn error{"angle_error", dimension::none, "standard error of the angle [degrees]"};
    TableColumn height{"height", dimension::length, "height of the surface in the middle of the columns"};
    TableColumn roughness{"roughness", dimension::length, "standard deviation of the tops about the plane"};
    for (const SurfacePlane& p : frames_) {
      angle.values.push_back(p.angle * degrees);
      error.values.push_back(p.angle_error * degrees);
      height.values.push_back(p.height);
      roughness.values.push_back(p.roughness);
    }
    const SurfacePlane mean = all_->plane();
    table.numbers = {{.name = "angle",
                      .value = mean.angle * degrees,
                      .error = mean.angle_error * degrees,
                      .dimension = dimension::none,
                      .description = "angle of the mean surface of all frames [degrees]"},
                     slope(mean, 0),
                     slope(mean, 1)};
    if (!has_slope_)
      table.remarks.emplace_back("Both horizontal axes are periodic: the surface can have no slope in the mean.");
    else if (!std::isfinite(mean.angle))
      table.remarks.emplace_back("There are too few columns with grains to fit a plane through their tops.");
    table.columns = {series_.column(), std::move(angle), std::move(error), std::move(height), std::move(roughness)};
    return {table};
  }

 private:
  Quantity slope(const SurfacePlane& plane, std::size_t b) const {
    const std::string axis(1, static_cast<char>('x' + (vertical_ + 1 + b) % 3));
    return {.name = "slope_" + axis,
            .value = plane.slope[b],
            .error = plane.slope_error[b],
            .dimension = dimension::none,
            .description = "slope of the mean surface along " + axis + "; 0 where that axis is periodic"};
  }

  OptionValues options_;
  CountedRegion region_;
  std::size_t vertical_;
  double diameter_ = 0, width_ = 0;
  bool has_slope_ = true;
  std::optional<FreeSurface> all_;
  FrameSeries series_;
  std::vector<SurfacePlane> frames_;
};

}  // namespace

MeasurementInfo surface_angle_measurement() {
  MeasurementInfo info;
  info.name = "surface_angle";
  info.description = "angle of the free surface, from a plane through the tops of columns";
  info.equation = "h = h_0 + s.x; angle = atan |s|";
  info.options = CountedRegion::options(
      {{.name = "up", .default_value = std::string("z"), .help = "the vertical axis", .choices = {"x", "y", "z"}},
       {.name = "column",
        .default_value = 0.0,
        .help = "width of columns [length]; 0: two mean diameters of the first frame",
        .minimum = 0},
       {.name = "neighbours",
        .default_value = std::int64_t{3},
        .help = "grains with fewer others within 1.5 mean diameters are in flight, not of the surface",
        .minimum = 0,
        .maximum = 100}});
  info.conflict = CountedRegion::conflict;
  info.needs = [](const OptionValues&) { return MeasurementNeeds{ColumnSet(Column::radius), {}}; };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<SurfaceAngle>(setting.options); };
  return info;
}

}  // namespace grainvdb
