#include <cmath>
#include <cstddef>

#include "grainvdb/run.hpp"
#include "measure/histogram.hpp"
#include "measure/plasticity.hpp"
#include "measure/voxel_values.hpp"
#include "measure/weighted_sample.hpp"

namespace grainvdb {
namespace {

std::string weight_of(const OptionValues& options) {
  return std::get<std::string>(options.at("weight"));
}

/// Whether μ_MC is the same everywhere, and how the stress deviates from its pressure.
class IncipientYield : public Measurement {
 public:
  explicit IncipientYield(const MeasurementSetting& setting)
      : weight_(weight_of(setting.options)),
        least_phi_(std::get<double>(setting.options.at("phi_min"))),
        independence_(independence(setting.lattice.voxel(), setting.kernel)),
        ratio_(0, std::get<double>(setting.options.at("mu_max")), bins(setting)),
        deviators_(3, Histogram(-1, 2, bins(setting))),
        deviator_(3) {}

  void take(const OutputFields& fields) override {
    for_each_value(fields, {"phi", "mu_mohr_coulomb", "principal_stress", weight_},
                   [&](const Coord&, std::span<const double> v) {
                     if (v[0] >= least_phi_) add(v[1], v.subspan<2, 3>(), v[5]);
                   });
  }

  std::vector<Table> tables() override { return {ratio_table(), deviator_table()}; }

 private:
  static std::size_t bins(const MeasurementSetting& setting) {
    return static_cast<std::size_t>(std::get<std::int64_t>(setting.options.at("bins")));
  }

  void add(double mu, std::span<const double, 3> principal, double weight) {
    if (std::isnan(weight)) return;
    offered_ += weight;
    if (std::isnan(mu)) return;
    mu_.add(mu, weight);
    ratio_.add(mu, weight);
    const double pressure = -(principal[0] + principal[1] + principal[2]) / 3;
    for (std::size_t k = 0; k < 3; ++k) {
      const double deviator = (-principal[k] - pressure) / pressure;
      deviator_[k].add(deviator, weight);
      deviators_[k].add(deviator, weight);
    }
  }

  Table ratio_table() const {
    Table t{.name = "incipient_yield",
            .description = "distribution of the Mohr-Coulomb stress ratio; narrow where the material yields everywhere",
            .equation = "mu_MC = (p3 - p1)/(2 sqrt(p3 p1)), p1 < p3 the extreme principal stresses"};
    t.columns = {{"mu_mohr_coulomb", dimension::none, "middle of the bin", ratio_.centres()},
                 {"density", dimension::none, "share of the weight by width of the bin", ratio_.densities()}};
    t.numbers = {{.name = "mean",
                  .value = mu_.mean(),
                  .error = mu_.mean_error(independence_),
                  .description = "weighted mean of mu_MC; error as if the stress were uncorrelated beyond the kernel"},
                 {.name = "spread", .value = mu_.spread(), .description = "weighted standard deviation of mu_MC"},
                 {.name = "relative_spread",
                  .value = mu_.spread() / mu_.mean(),
                  .description = "spread/mean: 0 at incipient yield everywhere"}};
    for (int percent : {5, 25, 50, 75, 95})
      t.numbers.push_back({.name = "quantile_" + std::to_string(percent),
                           .value = mu_.quantile(percent / 100.0),
                           .description = std::to_string(percent) + " % of the weight lies below"});
    t.numbers.push_back({.name = "undefined_share",
                         .value = 1 - mu_.weight() / offered_,
                         .description = "weight of voxels without mu_MC: tensile, or hardly any pressure"});
    t.numbers.push_back({.name = "outside_share",
                         .value = ratio_.outside(),
                         .description = "weight beyond mu_max, which no bin shows but mean and spread hold"});
    if (mu_.size() == 0) t.remarks.emplace_back("No voxel has a Mohr-Coulomb ratio and a weight.");
    return t;
  }

  Table deviator_table() const {
    Table t{.name = "principal_deviator",
            .description = "distribution of the principal stresses after the background pressure is taken off",
            .equation = "(p_k - P)/P, P = (p1 + p2 + p3)/3, compression positive"};
    t.columns = {{"deviator", dimension::none, "middle of the bin", deviators_[0].centres()}};
    const char* const names[] = {"least", "middle", "most"};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string name = names[k];
      t.columns.push_back(
          {name, dimension::none, "density of the " + name + " compressive", deviators_[k].densities()});
      t.numbers.push_back({.name = name + "_mean",
                           .value = deviator_[k].mean(),
                           .error = deviator_[k].mean_error(independence_),
                           .description = "weighted mean of the " + name + " compressive"});
      t.numbers.push_back(
          {.name = name + "_spread", .value = deviator_[k].spread(), .description = "its weighted standard deviation"});
    }
    return t;
  }

  std::string weight_;
  double least_phi_;
  double independence_;
  Histogram ratio_;
  std::vector<Histogram> deviators_;
  WeightedSample mu_;
  std::vector<WeightedSample> deviator_;
  double offered_ = 0;  // the weight of all voxels, with and without a ratio
};

}  // namespace

MeasurementInfo incipient_yield_measurement() {
  MeasurementInfo m;
  m.name = "incipient_yield";
  m.description = "is the Mohr-Coulomb stress ratio the same everywhere? Its distribution, and that of the deviator";
  m.equation = "mu_MC = (p3 - p1)/(2 sqrt(p3 p1)); (p_k - P)/P";
  m.options = {
      {.name = "weight",
       .default_value = std::string("phi"),
       .help = "what voxels count by: phi (material) or shear_rate (where it flows)",
       .choices = {"phi", "shear_rate"}},
      least_phi_option(),
      bins_option(40),
      {.name = "mu_max", .default_value = 2.0, .help = "upper end of the histogram of mu_MC", .minimum = 1e-6}};
  m.needs = [](const OptionValues& options) {
    MeasurementNeeds needs{{}, {"phi", "mu_mohr_coulomb", "principal_stress"}};
    if (weight_of(options) != "phi") needs.fields.push_back(weight_of(options));
    return needs;
  };
  m.make = [](const MeasurementSetting& setting) { return std::make_unique<IncipientYield>(setting); };
  return m;
}

}  // namespace grainvdb
