#include <cmath>
#include <cstddef>
#include <numbers>

#include "grainvdb/run.hpp"
#include "measure/distribution.hpp"
#include "measure/option_values.hpp"
#include "measure/plasticity.hpp"
#include "measure/voxel_values.hpp"

namespace grainvdb {
namespace {

constexpr double right_angle = std::numbers::pi / 2;

/// The angle between the major axes of stress and strain rate, where the material flows.
class Coaxiality : public Measurement {
 public:
  explicit Coaxiality(const MeasurementSetting& setting)
      : least_phi_(number_option(setting.options, "phi_min")),
        angles_(0, right_angle, count_option(setting.options, "bins"),
                independence(setting.lattice.voxel(), setting.kernel)) {}

  void take(const OutputFields& fields) override {
    for_each_value(fields, {"phi", "coaxiality_angle", "shear_rate"}, [&](const Coord&, std::span<const double> v) {
      if (v[0] >= least_phi_) angles_.add(v[1], v[2]);
    });
  }

  std::vector<Table> tables() override {
    Table t{.name = "coaxiality",
            .description = "distribution of the angle between the major axes of stress and strain rate, by shear rate",
            .equation = "acos|a(sigma).a(D)|, weight |gd|; random axes: density sin(angle), mean 1 rad"};
    const Histogram& histogram = angles_.histogram();
    std::vector<double> random;
    const double width = right_angle / static_cast<double>(histogram.bins());
    for (std::size_t k = 0; k < histogram.bins(); ++k)
      random.push_back((std::cos(histogram.lower(k)) - std::cos(histogram.lower(k) + width)) / width);
    t.columns = {{"angle", dimension::none, "middle of the bin [rad]", histogram.centres()},
                 {"density", dimension::none, "share of the weight by width of the bin [1/rad]", histogram.densities()},
                 {"random", dimension::none, "the same for axes that know nothing of each other [1/rad]", random}};
    t.numbers = angles_.numbers("the angle [rad]");
    if (angles_.empty()) t.remarks.emplace_back("No voxel that flows has both axes.");
    return {std::move(t)};
  }

 private:
  double least_phi_;
  Distribution angles_;
};

}  // namespace

MeasurementInfo coaxiality_measurement() {
  MeasurementInfo m;
  m.name = "coaxiality";
  m.description = "are stress and strain rate aligned? The angle between their major axes, weighted by the shear rate";
  m.equation = "acos|a(sigma).a(D)|, weight |gd|";
  m.options = {least_phi_option(), bins_option(18)};
  m.needs = [](const OptionValues&) { return MeasurementNeeds{{}, {"phi", "coaxiality_angle", "shear_rate"}}; };
  m.make = [](const MeasurementSetting& setting) { return std::make_unique<Coaxiality>(setting); };
  return m;
}

}  // namespace grainvdb
