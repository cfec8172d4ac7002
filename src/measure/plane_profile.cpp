#include <cmath>
#include <string>
#include <utility>

#include "grainvdb/error.hpp"
#include "measure/bins.hpp"
#include "measure/estimate_columns.hpp"
#include "measure/option_values.hpp"
#include "measure/plane_means.hpp"
#include "measure/register.hpp"

namespace grainvdb {
namespace {

constexpr std::size_t profile_quantities = 7;  // phi, density, velocity (three), temperature, mean diameter

class PlaneProfile : public Measurement {
 public:
  explicit PlaneProfile(const MeasurementSetting& setting)
      : axis_(axis_option(setting.options, "axis")),
        from_(number_option(setting.options, "from")),
        to_(number_option(setting.options, "to")),
        area_(number_option(setting.options, "area")),
        lattice_(setting.lattice),
        kernel_(setting.kernel),
        sums_(PlaneMeans::channels) {}

  void add(const Frame& frame) override {
    const PlaneMeans means = plane_means(frame.particles, lattice_, kernel_, axis_, area_of(frame));
    sums_.begin_time();
    for (std::size_t n = 0; n < means.planes(); ++n) {
      const auto plane = means.first + static_cast<std::int32_t>(n);
      const double z = lattice_.centre(axis_, plane);
      if (from_ != to_ && !(z >= from_ && z < to_)) continue;
      const std::span<double> sums = sums_.at(plane);
      for (std::size_t c = 0; c < sums.size(); ++c) sums[c] = means.values[n * PlaneMeans::channels + c];
    }
  }

  std::vector<Table> tables() override {
    Table table{"plane_profile", "exact averages over planes, straight from the particles",
                "<q> = sum V q w_1(z-z_a)/sum V w_1, w_1 the kernel integrated over the plane; T about the mean of "
                "the plane and frame"};
    table.columns.push_back(
        {std::string(1, static_cast<char>('x' + axis_)), dimension::length, "position of the plane"});
    add_estimate_columns(table, "phi", dimension::none, "packing fraction (6)");
    add_estimate_columns(table, "density", dimension::density, "sum m w_1/A");
    for (const char* component : {"x", "y", "z"})
      add_estimate_columns(table, std::string("velocity_") + component, dimension::velocity, "mean velocity (7)");
    add_estimate_columns(table, "temperature", dimension::velocity_squared,
                         "dv^2, the sum over components, about the mean of plane and frame (A15)");
    add_estimate_columns(table, "mean_diameter", dimension::length, "volume-weighted (A19)");
    for (const std::int64_t plane : sums_.bins()) {
      table.columns[0].values.push_back(lattice_.centre(axis_, static_cast<std::int32_t>(plane)));
      const auto estimates =
          jackknife(sums_.times(), profile_quantities, [&](std::optional<std::size_t> without, std::span<double> out) {
            const double frames = static_cast<double>(sums_.times() - (without ? 1 : 0));
            const std::vector<double> sum = sums_.total(plane, without);
            out[0] = sum[PlaneMeans::volume] / frames;
            out[1] = sum[PlaneMeans::mass] / frames;
            for (std::size_t a = 0; a < 3; ++a) out[2 + a] = sum[PlaneMeans::momentum_x + a] / sum[PlaneMeans::volume];
            out[5] = sum[PlaneMeans::heat] / sum[PlaneMeans::volume];
            out[6] = sum[PlaneMeans::diameter] / sum[PlaneMeans::volume];
          });
      for (std::size_t n = 0; n < profile_quantities; ++n) append(table, 1 + 2 * n, estimates[n]);
    }
    table.remarks.push_back(error_remark(sums_.times(), "frame"));
    return {std::move(table)};
  }

 private:
  double area_of(const Frame& frame) const {
    if (area_ > 0) return area_;
    double area = 1;
    for (int a = 0; a < 3; ++a) {
      if (a == axis_) continue;
      if (!frame.box.periodic[static_cast<std::size_t>(a)])
        throw InputError({frame.file, "a plane profile needs the area of its planes",
                          std::string("a box that is not periodic along ") + static_cast<char>('x' + a),
                          "a box periodic along both axes of the planes, or measure.plane_profile.area",
                          "where the material does not fill the planes evenly, measure `profile` instead"});
      area *= frame.box.length(a);
    }
    return area;
  }

  int axis_;
  double from_, to_, area_;
  Lattice lattice_;
  LucyKernel kernel_;
  TimeSums sums_;
};

MeasurementInfo plane_profile() {
  MeasurementInfo info;
  info.name = "plane_profile";
  info.description = "exact averages over planes by the kernel's marginal, without splatting a field";
  info.equation = "w_1(z) = 21/(16c) (1-|z|/c)^4 (1 + 4|z|/c + 5 z^2/c^2)";
  info.options = {{.name = "axis",
                   .default_value = std::string("z"),
                   .help = "the normal of the planes",
                   .choices = {"x", "y", "z"}},
                  {.name = "from",
                   .default_value = 0.0,
                   .help = "planes below are left out [length]; no bounds where from and to are 0"},
                  {.name = "to", .default_value = 0.0, .help = "planes from here on are left out [length]"},
                  {.name = "area",
                   .default_value = 0.0,
                   .help = "of a plane [length^2]; 0: that of the box, which must be periodic along both axes",
                   .minimum = 0}};
  info.conflict = height_conflict;
  info.needs = [](const OptionValues&) {
    return MeasurementNeeds{Column::velocity | Column::radius | Column::mass, {}, true};
  };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<PlaneProfile>(setting); };
  return info;
}

}  // namespace

std::vector<MeasurementInfo> plane_profile_measurements() {
  return {plane_profile()};
}

}  // namespace grainvdb
