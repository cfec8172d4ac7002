#include <algorithm>
#include <cmath>
#include <iterator>

#include "grainvdb/run.hpp"
#include "measure/binned_curve.hpp"
#include "measure/option_values.hpp"
#include "measure/plasticity.hpp"
#include "measure/voxel_values.hpp"

namespace grainvdb {
namespace {

const std::vector<std::string>& quantities(const OptionValues& options) {
  return std::get<std::vector<std::string>>(options.at("of"));
}

struct Quantified {
  const char* field;
  Dimension unit;
};
constexpr Quantified offered[] = {{"shear_rate", dimension::rate},      {"mu", dimension::none},
                                  {"mu_mohr_coulomb", dimension::none}, {"inertial_number", dimension::none},
                                  {"gd_over_dv", dimension::none},      {"temperature", dimension::velocity_squared}};

std::vector<std::string> names_of_offered() {
  std::vector<std::string> names;
  for (const Quantified& q : offered) names.emplace_back(q.field);
  return names;
}

Dimension dimension_of(const std::string& field) {
  return std::find_if(std::begin(offered), std::end(offered), [&](const Quantified& q) { return q.field == field; })
      ->unit;
}

std::vector<std::string> with_phi(std::vector<std::string> fields) {
  fields.insert(fields.begin(), "phi");
  return fields;
}

/// Fields against the packing fraction, and how well it tells them.
class CollapseOnPhi : public Measurement {
 public:
  explicit CollapseOnPhi(const MeasurementSetting& setting)
      : fields_(with_phi(quantities(setting.options))),
        least_phi_(number_option(setting.options, "phi_min")),
        plain_(quantities(setting.options).size(), BinnedCurve(width(setting))),
        logarithmic_(plain_) {}

  void take(const OutputFields& fields) override {
    for_each_value(fields, fields_, [&](const Coord&, std::span<const double> v) {
      if (!(v[0] >= least_phi_)) return;
      for (std::size_t k = 0; k < plain_.size(); ++k) {
        plain_[k].add(v[0], v[k + 1]);
        logarithmic_[k].add(v[0], std::log(v[k + 1]));  // not finite, and left out, where the value is not positive
      }
    });
  }

  std::vector<Table> tables() override {
    std::vector<Table> all;
    for (std::size_t k = 0; k < plain_.size(); ++k) all.push_back(table(fields_[k + 1], plain_[k], logarithmic_[k]));
    return all;
  }

 private:
  static double width(const MeasurementSetting& setting) { return number_option(setting.options, "width"); }

  static Table table(const std::string& field, const BinnedCurve& curve, const BinnedCurve& logarithmic) {
    const Dimension unit = dimension_of(field);
    Table t{.name = "collapse_" + field,
            .description = field + " of the voxels in bins of the packing fraction",
            .equation = "collapse = 1 - scatter^2/spread^2, scatter^2 = sum (y - mean of bin)^2/(points - bins)"};
    t.columns = {{"phi", dimension::none, "middle of the bin", {}},
                 {"mean", unit, "mean in the bin", {}},
                 {"spread", unit, "standard deviation in the bin", {}},
                 {"points", dimension::none, "voxels in the bin", {}}};
    for (const BinnedCurve::Bin& bin : curve.bins()) {
      t.columns[0].values.push_back(bin.x);
      t.columns[1].values.push_back(bin.y.mean());
      t.columns[2].values.push_back(bin.y.spread());
      t.columns[3].values.push_back(static_cast<double>(bin.y.count()));
    }
    t.numbers = {
        {.name = "collapse",
         .value = curve.collapse(),
         .error = curve.collapse_noise(),
         .description = "1 where phi tells the value, 0 where it tells nothing; error: of the latter, by chance"},
        {.name = "collapse_log",
         .value = logarithmic.collapse(),
         .error = logarithmic.collapse_noise(),
         .description = "the same of the logarithm, where the value is positive"},
        {.name = "scatter", .value = curve.scatter(), .dimension = unit, .description = "about the bins' means"},
        {.name = "spread", .value = curve.spread(), .dimension = unit, .description = "of all voxels"}};
    if (std::isnan(curve.collapse())) t.remarks.push_back("Too few voxels have " + field + " to speak of a collapse.");
    return t;
  }

  std::vector<std::string> fields_;
  double least_phi_;
  std::vector<BinnedCurve> plain_;
  std::vector<BinnedCurve> logarithmic_;
};

}  // namespace

MeasurementInfo collapse_measurement() {
  MeasurementInfo m;
  m.name = "collapse";
  m.description = "does the packing fraction tell shear rate and friction? Binned curves, and how well they collapse";
  m.equation = "collapse = 1 - scatter^2/spread^2";
  m.options = {{.name = "of",
                .default_value = std::vector<std::string>{"shear_rate", "mu"},
                .help = "what to draw against the packing fraction",
                .choices = names_of_offered()},
               {.name = "width",
                .default_value = 0.005,
                .help = "of a bin of the packing fraction; bins lie at whole multiples, the same for all runs",
                .minimum = 1e-6,
                .maximum = 1},
               least_phi_option()};
  m.needs = [](const OptionValues& options) { return MeasurementNeeds{{}, with_phi(quantities(options))}; };
  m.make = [](const MeasurementSetting& setting) { return std::make_unique<CollapseOnPhi>(setting); };
  return m;
}

}  // namespace grainvdb
