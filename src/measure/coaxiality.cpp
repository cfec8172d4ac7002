#include <cmath>
#include <cstddef>
#include <numbers>

#include "grainvdb/run.hpp"
#include "measure/histogram.hpp"
#include "measure/plasticity.hpp"
#include "measure/voxel_values.hpp"
#include "measure/weighted_sample.hpp"

namespace grainvdb {
namespace {

constexpr double right_angle = std::numbers::pi / 2;

/// The angle between the major axes of stress and strain rate, where the material flows.
class Coaxiality : public Measurement {
 public:
  explicit Coaxiality(const MeasurementSetting& setting)
      : least_phi_(std::get<double>(setting.options.at("phi_min"))),
        independence_(independence(setting.lattice.voxel(), setting.kernel)),
        histogram_(0, right_angle, static_cast<std::size_t>(std::get<std::int64_t>(setting.options.at("bins")))) {}

  void take(const OutputFields& fields) override {
    for_each_value(fields, {"phi", "coaxiality_angle", "shear_rate"}, [&](const Coord&, std::span<const double> v) {
      if (!(v[0] >= least_phi_) || std::isnan(v[2])) return;
      offered_ += v[2];
      histogram_.add(v[1], v[2]);
      angles_.add(v[1], v[2]);
    });
  }

  std::vector<Table> tables() override {
    Table t{.name = "coaxiality",
            .description = "distribution of the angle between the major axes of stress and strain rate, by shear rate",
            .equation = "acos|a(sigma).a(D)|, weight |gd|; random axes: density sin(angle)"};
    std::vector<double> random;
    const double width = right_angle / static_cast<double>(histogram_.bins());
    for (std::size_t k = 0; k < histogram_.bins(); ++k)
      random.push_back((std::cos(histogram_.lower(k)) - std::cos(histogram_.lower(k) + width)) / width);
    t.columns = {
        {"angle", dimension::none, "middle of the bin [rad]", histogram_.centres()},
        {"density", dimension::none, "share of the weight by width of the bin [1/rad]", histogram_.densities()},
        {"random", dimension::none, "the same for axes that know nothing of each other [1/rad]", random}};
    t.numbers = {{.name = "mean",
                  .value = angles_.mean(),
                  .error = angles_.mean_error(independence_),
                  .description = "weighted mean angle [rad]: 0 where coaxial, 1 for random axes"},
                 {.name = "spread", .value = angles_.spread(), .description = "weighted standard deviation [rad]"},
                 {.name = "median", .value = angles_.quantile(0.5), .description = "half the weight lies below [rad]"},
                 {.name = "undefined_share",
                  .value = 1 - angles_.weight() / offered_,
                  .description = "weight of voxels where an axis is undefined"}};
    if (angles_.size() == 0) t.remarks.emplace_back("No voxel that flows has both axes.");
    return {std::move(t)};
  }

 private:
  double least_phi_;
  double independence_;
  Histogram histogram_;
  WeightedSample angles_;
  double offered_ = 0;
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
