#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "measure/estimate_columns.hpp"
#include "measure/option_values.hpp"
#include "measure/regime.hpp"
#include "measure/register.hpp"
#include "measure/rheology_fits.hpp"
#include "measure/state_samples.hpp"

namespace grainvdb {
namespace {

// What is asked of a state, in this order.
enum RheologyQuantity : std::size_t {
  friction,
  inertial_number,
  packing,
  pressure,
  shear_rate,
  bagnold,
  p_star,
  rate_star,
  skt_steady,
  skt_pressure,
  skt_mu,
  quantity_count
};

struct QuantityInfo {
  RheologyQuantity quantity;
  const char* name;
  Dimension dimension;
  const char* description;
};
constexpr std::array<QuantityInfo, quantity_count> described{{
    {inertial_number, "inertial_number", dimension::none, "I = |gd| d sqrt(rho_p/P)"},
    {friction, "mu", dimension::none, "|sigma|/P"},
    {packing, "phi", dimension::none, "packing fraction nu"},
    {pressure, "pressure", dimension::stress, "P"},
    {shear_rate, "shear_rate", dimension::rate, "|gd|"},
    {bagnold, "bagnold_pressure", dimension::none,
     "P/(rho_p d^2 gd^2), a function of phi where Bagnold's scaling holds"},
    {p_star, "p_star", dimension::none, "P d/k_n"},
    {rate_star, "rate_star", dimension::none, "gd sqrt(rho_p d^3/k_n)"},
    {skt_steady, "skt_steady_pressure", dimension::none, "P/(rho_p d^2 gd^2) by kinetic theory in steady shear"},
    {skt_pressure, "skt_pressure", dimension::none, "P/(rho_p d^2 gd^2) by kinetic theory at the measured T/3"},
    {skt_mu, "skt_mu", dimension::none, "tau/p by kinetic theory at the measured T/3"},
}};

StateQuantities quantities(double stiffness, double restitution, double skt_most) {
  return [=](const FlowState& state, std::span<double> out) {
    out[friction] = state.mu();
    out[inertial_number] = state.inertial_number();
    out[packing] = state.phi;
    out[pressure] = state.pressure();
    out[shear_rate] = state.shear_rate();
    out[bagnold] = bagnold_pressure(state);
    out[p_star] = stiffness > 0 ? soft_pressure(state, stiffness) : FlowState::unknown;
    out[rate_star] = stiffness > 0 ? soft_rate(state, stiffness) : FlowState::unknown;
    const KineticPrediction theory = kinetic_prediction(state, restitution, skt_most);
    out[skt_steady] = theory.steady_pressure;
    out[skt_pressure] = theory.pressure;
    out[skt_mu] = theory.mu;
  };
}

class RheologyMeasurement : public Measurement {
 public:
  explicit RheologyMeasurement(const MeasurementSetting& setting)
      : stiffness_(number_option(setting.options, "stiffness")),
        rate_min_(number_option(setting.options, "rate_min")),
        rate_fraction_(number_option(setting.options, "rate_fraction")),
        condition_limit_(number_option(setting.options, "condition_limit")),
        error_floor_(number_option(setting.options, "error_floor")),
        skt_most_(number_option(setting.options, "skt_phi_max")),
        bounds_{number_option(setting.options, "quasi_static_below"), number_option(setting.options, "inertial_above")},
        samples_(make_samples(setting, sample_fields(setting.options), quantity_count,
                              quantities(stiffness_, number_option(setting.options, "restitution"), skt_most_))) {}

  void take(const OutputFields& output) override { samples_->take(output); }

  std::vector<Table> tables() override {
    const std::vector<StateSample> samples = samples_->samples();
    const double band_rate = least_rate(samples);
    std::vector<StateSample> band;
    for (const StateSample& sample : samples)
      if (sample.values[shear_rate].value >= band_rate) band.push_back(sample);

    Table table{"rheology", "stress ratio and packing fraction against inertial number, with both scalings of pressure",
                "mu(I) = mu_0 + (mu_infinity-mu_0)/(I_0/I+1), times 1 - sqrt(p*/p_0*); nu = nu_c (1+p*/p_c*) (1 - I "
                "sqrt(nu)/I_c)"};
    add_columns(table);
    const FrictionLawFit mu = fit_friction(band, table);
    const PackingLawFit nu = fit_packing(band, table);
    for (const StateSample& sample : samples) add_row(sample, band_rate, mu.law, nu.law, table);
    table.numbers.push_back({.name = "band_rate",
                             .value = band_rate,
                             .dimension = dimension::rate,
                             .description = "shear rate from which a place belongs to the shear band"});
    table.numbers.push_back({.name = "quasi_static_below",
                             .value = bounds_.quasi_static,
                             .description = "inertial number below which the regime is quasi-static"});
    table.numbers.push_back({.name = "inertial_above",
                             .value = bounds_.inertial,
                             .description = "inertial number above which the regime is inertial"});
    add_remarks(samples, table);
    return {std::move(table)};
  }

 private:
  double least_rate(const std::vector<StateSample>& samples) const {
    double most = 0;
    for (const StateSample& sample : samples) most = std::max(most, sample.values[shear_rate].value);
    return std::max(rate_min_, rate_fraction_ * most);
  }

  static void add_columns(Table& table) {
    for (const QuantityInfo& q : described) add_estimate_columns(table, q.name, q.dimension, q.description);
    table.columns.push_back({"mu_fit", dimension::none, "the fitted mu(I, p*)"});
    table.columns.push_back({"mu_law", dimension::none, "mu(I) with 0.12, 0.55 and 0.2, for frictionless grains"});
    table.columns.push_back({"phi_fit", dimension::none, "the fitted nu(I, p*)"});
    table.columns.push_back({"regime", dimension::none, "0 quasi-static, 1 intermediate, 2 inertial"});
    table.columns.push_back({"in_band", dimension::none, "1 in the shear band, 0 outside: fits leave that out"});
    table.columns.push_back({"position", dimension::length, "along the axis, or from it for shells"});
    table.columns.push_back({"height", dimension::length, "along the axis"});
  }

  void add_row(const StateSample& sample, double band_rate, const SoftFrictionLaw& mu, const PackingLaw& nu,
               Table& table) const {
    for (std::size_t n = 0; n < described.size(); ++n) append(table, 2 * n, sample.values[described[n].quantity]);
    const double i = sample.values[inertial_number].value;
    const double soft = stiffness_ > 0 ? sample.values[p_star].value : 0;
    std::size_t column = 2 * described.size();
    for (const double value :
         {mu(i, soft), FrictionLaw{}(i), nu(i, soft), static_cast<double>(bounds_(i)),
          sample.values[shear_rate].value >= band_rate ? 1.0 : 0.0, sample.position, sample.height})
      table.columns[column++].values.push_back(value);
  }

  /// What laws of `quantity` are fitted to: places that shear.
  RheologyData data_of(const std::vector<StateSample>& band, RheologyQuantity quantity) const {
    RheologyData data;
    std::vector<StateSample> used;
    for (const StateSample& sample : band)
      if (sample.values[inertial_number].value > 0) used.push_back(sample);
    for (const StateSample& sample : used) {
      data.inertial_number.push_back(sample.values[inertial_number].value);
      data.value.push_back(sample.values[quantity].value);
      if (stiffness_ > 0) data.soft_pressure.push_back(sample.values[p_star].value);
    }
    data.error = fit_errors(used, quantity, error_floor_);
    return data;
  }

  static void add_fit_quality(const std::string& name, const std::string& law, const Fit& fit, Table& table) {
    table.numbers.push_back(
        {.name = name + "_condition", .value = fit.condition, .description = "condition number of the fit of " + law});
    table.numbers.push_back({.name = name + "_reduced_chi_square",
                             .value = fit.reduced_chi_square(),
                             .description = "chi^2 per degree of freedom of the fit of " + law});
    if (!fit.fitted()) {
      table.remarks.push_back("A fit of " + law + " is refused: " + fit.refusal + '.');
    } else if (!fit.doubt.empty()) {
      table.remarks.push_back("The fit of " + law + " is doubtful: " + fit.doubt + '.');
    }
  }

  /// The soft law where p* is known and the data show what it does, else the rigid one.
  template <class LawFit>
  LawFit fit_law(LawFit (*fit)(const RheologyData&, double), const std::string& name, RheologyData data,
                 Table& table) const {
    LawFit found = fit(data, condition_limit_);
    if (found.fit.fitted() || data.soft_pressure.empty()) return found;
    table.remarks.push_back("A fit of " + name + " with softness is refused: " + found.fit.refusal +
                            ". Grains are taken as rigid.");
    data.soft_pressure.clear();
    return fit(data, condition_limit_);
  }

  FrictionLawFit fit_friction(const std::vector<StateSample>& band, Table& table) const {
    const FrictionLawFit found = fit_law(fit_friction_law, "mu(I)", data_of(band, friction), table);
    const FrictionLaw& law = found.law.hard;
    const FrictionLaw& error = found.error.hard;
    table.numbers.push_back({"mu_0", law.mu_0, error.mu_0, dimension::none, "mu of slow flow"});
    table.numbers.push_back({"mu_infinity", law.mu_infinity, error.mu_infinity, dimension::none, "mu of fast flow"});
    table.numbers.push_back({"I_0", law.i_0, error.i_0, dimension::none, "I at which mu is half-way"});
    if (std::isfinite(found.law.p_0))
      table.numbers.push_back({"p_0", found.law.p_0, found.error.p_0, dimension::none, "p* at which mu vanishes"});
    add_fit_quality("mu_fit", "mu(I)", found.fit, table);
    return found;
  }

  PackingLawFit fit_packing(const std::vector<StateSample>& band, Table& table) const {
    const PackingLawFit found = fit_law(fit_packing_law, "nu(I)", data_of(band, packing), table);
    const auto& [i_c, p_c, nu_c] = found.law;
    table.numbers.push_back({"nu_c", nu_c, found.error.nu_c, dimension::none, "packing fraction of slow flow"});
    table.numbers.push_back({"I_c", i_c, found.error.i_c, dimension::none, "scale of I in nu(I)"});
    if (std::isfinite(p_c))
      table.numbers.push_back({"p_c", p_c, found.error.p_c, dimension::none, "scale of p* in nu(p*)"});
    add_fit_quality("nu_fit", "nu(I)", found.fit, table);
    return found;
  }

  void add_remarks(const std::vector<StateSample>& samples, Table& table) const {
    const auto dense = std::count_if(samples.begin(), samples.end(), [this](const StateSample& sample) {
      return !(sample.values[packing].value <= skt_most_);
    });
    if (dense > 0)
      table.remarks.push_back("Kinetic theory is not compared at " + std::to_string(dense) + " of " +
                              std::to_string(samples.size()) + " places: their phi exceeds skt_phi_max.");
    if (!(stiffness_ > 0)) table.remarks.push_back("Without `stiffness` there is no p*, and grains are rigid.");
    table.remarks.push_back(error_remark(samples_->times(), "output time"));
  }

  double stiffness_, rate_min_, rate_fraction_, condition_limit_, error_floor_, skt_most_;
  RegimeBounds bounds_;
  std::unique_ptr<StateSamples> samples_;
};

std::vector<OptionInfo> options() {
  std::vector<OptionInfo> all = sample_options();
  all.push_back({.name = "stiffness",
                 .default_value = 0.0,
                 .help = "k_n of the contacts [mass/time^2], for p* = P d/k_n; 0: rigid grains, no p*",
                 .minimum = 0});
  all.push_back({.name = "restitution",
                 .default_value = 0.7,
                 .help = "e of the grains, for the kinetic theory",
                 .minimum = 0,
                 .maximum = 1});
  all.push_back({.name = "skt_phi_max",
                 .default_value = 0.5,
                 .help = "kinetic theory is compared up to this packing fraction",
                 .minimum = 0,
                 .maximum = 1});
  all.push_back({.name = "quasi_static_below",
                 .default_value = 1e-3,
                 .help = "inertial number below which the regime is quasi-static",
                 .minimum = 0});
  all.push_back({.name = "inertial_above",
                 .default_value = 0.1,
                 .help = "inertial number above which the regime is inertial",
                 .minimum = 0});
  all.push_back({.name = "rate_min",
                 .default_value = 0.0,
                 .help = "the shear band is where the shear rate is no less [1/time]",
                 .minimum = 0});
  all.push_back({.name = "rate_fraction",
                 .default_value = 0.0,
                 .help = "the shear band is where the shear rate is no less than this part of the largest",
                 .minimum = 0,
                 .maximum = 1});
  all.push_back({.name = "condition_limit",
                 .default_value = 1000.0,
                 .help = "a fit is refused where its scaled Jacobian has a larger condition number",
                 .minimum = 1});
  all.push_back(error_floor_option());
  return all;
}

std::optional<OptionConflict> conflict(const OptionValues& values) {
  if (number_option(values, "quasi_static_below") > number_option(values, "inertial_above"))
    return OptionConflict{
        "inertial_above", std::to_string(number_option(values, "inertial_above")),
        "no less than quasi_static_below, which is " + std::to_string(number_option(values, "quasi_static_below"))};
  return sample_conflict(values);
}

MeasurementInfo rheology() {
  MeasurementInfo info;
  info.name = "rheology";
  info.description = "mu(I), nu(I, p*), Bagnold's scaling and kinetic theory, with fits and regimes";
  info.equation = "mu(I) = mu_0 + (mu_infinity-mu_0)/(I_0/I+1)";
  info.options = options();
  info.conflict = conflict;
  info.needs = [](const OptionValues& values) { return sample_needs(values, sample_fields(values)); };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<RheologyMeasurement>(setting); };
  return info;
}

}  // namespace

std::vector<MeasurementInfo> rheology_measurements() {
  return {rheology()};
}

}  // namespace grainvdb
