#include <cmath>
#include <string>
#include <utility>

#include "measure/estimate_columns.hpp"
#include "measure/fluidity_fit.hpp"
#include "measure/option_values.hpp"
#include "measure/register.hpp"
#include "measure/state_samples.hpp"

namespace grainvdb {
namespace {

// What is asked of a state, in this order.
enum FluidityQuantity : std::size_t { gd_over_dv, packing_fraction, dv_over_d_domega, g_over_domega };

bool with_spin(const OptionValues& options) {
  return std::get<bool>(options.at("spin"));
}

void fluidity_of(const FlowState& state, std::span<double> out) {
  out[gd_over_dv] = state.gd_over_dv();
  out[packing_fraction] = state.phi;
}

void fluidity_and_spin_of(const FlowState& state, std::span<double> out) {
  fluidity_of(state, out);
  out[dv_over_d_domega] = state.dv_over_d_domega();
  out[g_over_domega] = state.g_over_domega();
}

std::vector<std::string> fluidity_fields(const OptionValues& options) {
  return with_spin(options) ? sample_fields(options, {"rotational_fluctuation"}) : sample_fields(options);
}

std::unique_ptr<StateSamples> fluidity_samples(const MeasurementSetting& setting) {
  return with_spin(setting.options) ? make_samples(setting, fluidity_fields(setting.options), 4, &fluidity_and_spin_of)
                                    : make_samples(setting, fluidity_fields(setting.options), 2, &fluidity_of);
}

const std::string published_law = "zhang_kamrin";

/// The law of that name: (3), or one of Table IV.
FluidityLaw law_named(const std::string& name) {
  for (const FluidityFit& row : fluidity_fits)
    if (name == row.name) return row.law;
  return zhang_kamrin_law;
}

double held_c(double given, const std::string& compare) {
  return given > 0 ? given : law_named(compare).c;
}

class FluidityMeasurement : public Measurement {
 public:
  explicit FluidityMeasurement(const MeasurementSetting& setting)
      : spin_(with_spin(setting.options)),
        hold_(std::get<std::string>(setting.options.at("hold_c"))),
        condition_limit_(number_option(setting.options, "condition_limit")),
        error_floor_(number_option(setting.options, "error_floor")),
        compare_(std::get<std::string>(setting.options.at("compare"))),
        c_(held_c(number_option(setting.options, "c"), compare_)),
        samples_(fluidity_samples(setting)) {}

  void take(const OutputFields& output) override { samples_->take(output); }

  std::vector<Table> tables() override {
    const std::vector<StateSample> samples = samples_->samples();
    Table table{"fluidity", "dimensionless granular fluidity against packing fraction, and its law",
                "g d/dv = F(phi) (2), F = A - [(phi-B) + sqrt((phi-B)^2+C)]/D (A20)"};
    const FluidityLawFit fit = fit_samples(samples, table);
    add_rows(samples, fit.law, table);
    add_numbers(fit, table);
    if (fit.fit.fitted() && !fit.fit.doubt.empty())
      table.remarks.push_back("The fit is doubtful: " + fit.fit.doubt + '.');
    add_deviation(samples, table);
    table.remarks.push_back(error_remark(samples_->times(), "output time"));
    table.remarks.push_back(
        "Places nearer than the kernel's cutoff share grains: the errors of the parameters, which take them for "
        "independent, are too small by up to the root of the number of places within a cutoff.");
    return {std::move(table)};
  }

 private:
  FluidityLawFit fit_samples(const std::vector<StateSample>& samples, Table& table) const {
    FluidityData data;
    for (const StateSample& sample : samples) {
      data.phi.push_back(sample.values[packing_fraction].value);
      data.value.push_back(sample.values[gd_over_dv].value);
    }
    data.error = fit_errors(samples, gd_over_dv, error_floor_);
    if (hold_ == "always") return held_fit(data, table);
    FluidityLawFit fit = fit_fluidity_law(data, condition_limit_);
    if (fit.fit.fitted()) return fit;
    table.remarks.push_back("A fit of A, B, C and D is refused: " + fit.fit.refusal + '.');
    return hold_ == "if_refused" ? held_fit(data, table) : fit;
  }

  FluidityLawFit held_fit(const FluidityData& data, Table& table) const {
    FluidityLawFit fit = fit_fluidity_law_with(c_, data, condition_limit_);
    table.remarks.push_back(fit.fit.fitted() ? "C was held while A, B and D were fitted."
                                             : "A fit of A, B and D with C held is refused: " + fit.fit.refusal + '.');
    return fit;
  }

  void add_rows(const std::vector<StateSample>& samples, const FluidityLaw& fitted, Table& table) const {
    table.columns.push_back({"phi", dimension::none, "packing fraction"});
    const std::size_t value = add_estimate_columns(table, "gd_over_dv", dimension::none, "g d/dv (2)");
    table.columns.push_back({"fit", dimension::none, "the fitted law (A20)"});
    table.columns.push_back({"law_3", dimension::none, "the law of Zhang and Kamrin (3)"});
    table.columns.push_back({"position", dimension::length, "along the axis, or from it for shells"});
    table.columns.push_back({"height", dimension::length, "along the axis"});
    if (spin_) {
      add_estimate_columns(table, "dv_over_d_domega", dimension::none, "dv/(d domega) (A25)");
      add_estimate_columns(table, "g_over_domega", dimension::none, "g/domega (A24)");
    }
    for (const StateSample& sample : samples) {
      const double phi = sample.values[packing_fraction].value;
      table.columns[0].values.push_back(phi);
      append(table, value, sample.values[gd_over_dv]);
      table.columns[3].values.push_back(fitted(phi));
      table.columns[4].values.push_back(zhang_kamrin_law(phi));
      table.columns[5].values.push_back(sample.position);
      table.columns[6].values.push_back(sample.height);
      if (!spin_) continue;
      append(table, 7, sample.values[dv_over_d_domega]);
      append(table, 9, sample.values[g_over_domega]);
    }
  }

  void add_numbers(const FluidityLawFit& fit, Table& table) const {
    const FluidityLaw reference = law_named(compare_);
    const std::string by = compare_ == published_law ? "(3)" : "Table IV, " + compare_;
    const auto add = [&](const std::string& name, double FluidityLaw::*part, const std::string& meaning) {
      table.numbers.push_back({name, fit.law.*part, fit.error.*part, dimension::none, meaning});
      table.numbers.push_back({name + "_reference", reference.*part, std::numeric_limits<double>::quiet_NaN(),
                               dimension::none, name + " of " + by});
    };
    add("A", &FluidityLaw::a, "plateau of g d/dv at low phi");
    add("B", &FluidityLaw::b, "phi of the knee");
    add("C", &FluidityLaw::c, "squared width of the knee in phi");
    add("D", &FluidityLaw::d, "twice the fall of phi per unit of g d/dv beyond the knee");
    table.numbers.push_back(
        {.name = "condition", .value = fit.fit.condition, .description = "condition number of the fit"});
    table.numbers.push_back({.name = "reduced_chi_square",
                             .value = fit.fit.reduced_chi_square(),
                             .description = "chi^2 per degree of freedom"});
  }

  /// Root mean square of gd/δv - F(φ) for the law that is compared with, where it is not negative.
  void add_deviation(const std::vector<StateSample>& samples, Table& table) const {
    const FluidityLaw law = law_named(compare_);
    double squares = 0, count = 0;
    for (const StateSample& sample : samples) {
      const double expected = law(sample.values[packing_fraction].value);
      if (expected < 0) continue;
      squares += std::pow(sample.values[gd_over_dv].value - expected, 2);
      ++count;
    }
    table.numbers.push_back(
        {.name = "deviation",
         .value = std::sqrt(squares / count),
         .description = "root mean square of g d/dv less the reference law, where that is positive"});
  }

  bool spin_;
  std::string hold_;
  double condition_limit_, error_floor_;
  std::string compare_;
  double c_;
  std::unique_ptr<StateSamples> samples_;
};

std::vector<OptionInfo> options() {
  std::vector<OptionInfo> all = sample_options();
  std::vector<std::string> laws{published_law};
  for (const FluidityFit& row : fluidity_fits) laws.emplace_back(row.name);
  all.push_back({.name = "spin",
                 .default_value = false,
                 .help = "also dv/(d domega) and g/domega, which need angular velocities"});
  all.push_back({.name = "hold_c",
                 .default_value = std::string("if_refused"),
                 .help = "whether C is held at `c`: never, if_refused (where the data do not determine all four "
                         "parameters), or always",
                 .choices = {"never", "if_refused", "always"}});
  all.push_back(
      {.name = "c", .default_value = 0.0, .help = "the C that is held; 0: that of the law of `compare`", .minimum = 0});
  all.push_back({.name = "condition_limit",
                 .default_value = 1000.0,
                 .help = "a fit is refused where its scaled Jacobian has a larger condition number: 35 to 190 with "
                         "both branches, mostly above 2000 with one",
                 .minimum = 1});
  all.push_back(error_floor_option());
  all.push_back({.name = "compare",
                 .default_value = published_law,
                 .help = "the law whose parameters stand beside the fitted ones: (3), or a row of Table IV",
                 .choices = laws});
  return all;
}

MeasurementInfo fluidity_fit() {
  MeasurementInfo info;
  info.name = "fluidity_fit";
  info.description = "g d/dv against packing fraction, with the law (3) and a fit of (A20)";
  info.equation = "F(phi) = A - [(phi-B) + sqrt((phi-B)^2+C)]/D  (A20)";
  info.options = options();
  info.conflict = [](const OptionValues& values) -> std::optional<OptionConflict> {
    if (with_spin(values) && !std::get<std::string>(values.at("species")).empty())
      return OptionConflict{"spin", "true with a species", "false: spin fluctuations are those of all grains"};
    return sample_conflict(values);
  };
  info.needs = [](const OptionValues& values) { return sample_needs(values, fluidity_fields(values)); };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<FluidityMeasurement>(setting); };
  return info;
}

}  // namespace

std::vector<MeasurementInfo> fluidity_measurements() {
  return {fluidity_fit()};
}

}  // namespace grainvdb
