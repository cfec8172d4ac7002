#include <cmath>
#include <cstddef>
#include <utility>

#include "grainvdb/run.hpp"
#include "measure/distribution.hpp"
#include "measure/option_values.hpp"
#include "measure/plasticity.hpp"
#include "measure/voxel_values.hpp"

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
        least_phi_(number_option(setting.options, "phi_min")),
        ratio_(distribution(setting, 0, number_option(setting.options, "mu_max"))),
        deviators_(3, distribution(setting, -1, 2)) {}

  void take(const OutputFields& fields) override {
    for_each_value(fields, {"phi", "mu_mohr_coulomb", "principal_stress", weight_},
                   [&](const Coord&, std::span<const double> v) {
                     if (v[0] >= least_phi_) add(v[1], v.subspan<2, 3>(), v[5]);
                   });
  }

  std::vector<Table> tables() override { return {ratio_table(), deviator_table()}; }

 private:
  static Distribution distribution(const MeasurementSetting& setting, double lo, double hi) {
    return {lo, hi, count_option(setting.options, "bins"), independence(setting.lattice.voxel(), setting.kernel)};
  }

  void add(double mu, std::span<const double, 3> principal, double weight) {
    ratio_.add(mu, weight);
    if (std::isnan(mu)) return;
    const double pressure = -(principal[0] + principal[1] + principal[2]) / 3;
    for (std::size_t k = 0; k < 3; ++k) deviators_[k].add((-principal[k] - pressure) / pressure, weight);
  }

  Table ratio_table() const {
    Table t{.name = "incipient_yield",
            .description = "distribution of the Mohr-Coulomb stress ratio; narrow where the material yields everywhere",
            .equation = "mu_MC = (p3 - p1)/(2 sqrt(p3 p1)), p1 < p3 the extreme principal stresses"};
    t.columns = {
        {"mu_mohr_coulomb", dimension::none, "middle of the bin", ratio_.histogram().centres()},
        {"density", dimension::none, "share of the weight by width of the bin", ratio_.histogram().densities()}};
    t.numbers = ratio_.numbers("mu_MC");
    t.numbers.push_back({.name = "relative_spread",
                         .value = ratio_.spread() / ratio_.mean(),
                         .description = "spread/mean: 0 at incipient yield everywhere"});
    if (ratio_.empty()) t.remarks.emplace_back("No voxel has a Mohr-Coulomb ratio and a weight.");
    return t;
  }

  Table deviator_table() const {
    Table t{.name = "principal_deviator",
            .description = "distribution of the principal stresses after the background pressure is taken off",
            .equation = "(p_k - P)/P, P = (p1 + p2 + p3)/3, compression positive"};
    t.columns = {{"deviator", dimension::none, "middle of the bin", deviators_[0].histogram().centres()}};
    const char* const names[] = {"least", "middle", "most"};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string name = names[k];
      const std::string what = "the " + name + " compressive";
      const Distribution& deviator = deviators_[k];
      t.columns.push_back({name, dimension::none, "density of " + what, deviator.histogram().densities()});
      for (Quantity q : {deviator.mean_of(what), deviator.spread_of(what)}) {
        q.name = name + "_" + q.name;
        t.numbers.push_back(std::move(q));
      }
    }
    return t;
  }

  std::string weight_;
  double least_phi_;
  Distribution ratio_;
  std::vector<Distribution> deviators_;
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
