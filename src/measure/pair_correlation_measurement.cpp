#include <optional>
#include <utility>

#include "measure/counted_region.hpp"
#include "measure/grains.hpp"
#include "measure/option_values.hpp"
#include "measure/pair_correlation.hpp"
#include "measure/structure.hpp"

namespace grainvdb {
namespace {

constexpr double correlation_reach = 5;  // mean diameters

class PairCorrelation : public Measurement {
 public:
  explicit PairCorrelation(const OptionValues& options) : options_(options), region_(options) {}

  void add(const Frame& frame) override {
    const Particles& grains = frame.particles;
    if (grains.size() == 0) return;
    if (!counts_)
      counts_.emplace(length_option(options_, "reach", correlation_reach, mean_diameter(grains.radius)),
                      count_option(options_, "bins"));
    counts_->add(frame.box, grains.position, region_);
  }

  std::vector<Table> tables() override {
    Table table{"pair_correlation", "radial distribution function of the centres of grains",
                "g(r) = sum_i n_i(r)/sum_i rho V_i(r), V_i the part of the shell within the material"};
    if (!counts_ || counts_->grains() == 0) {
      table.remarks.emplace_back(no_grains);
      return {table};
    }
    const PairCounts& c = *counts_;
    TableColumn r{"r", dimension::length, "distance, the middle of the bin"};
    TableColumn g{"g", dimension::none, "radial distribution function"};
    TableColumn error{"g_error", dimension::none, "counting error of g, for pairs that come independently"};
    TableColumn neighbours{"neighbours", dimension::none,
                           "mean number of grains nearer than the outer end of the bin, not corrected at faces"};
    std::size_t peak = 0;
    for (std::size_t k = 0; k < c.bins(); ++k) {
      r.values.push_back(0.5 * (c.edge(k) + c.edge(k + 1)));
      g.values.push_back(c.g(k));
      error.values.push_back(c.error(k));
      neighbours.values.push_back(c.neighbours(k));
      if (c.g(k) > c.g(peak) || !(c.g(peak) >= 0)) peak = k;
    }
    table.numbers = {
        {.name = "closest",
         .value = c.closest(),
         .dimension = dimension::length,
         .description = "distance of the closest pair of centres"},
        {.name = "peak",
         .value = r.values[peak],
         .error = 0.5 * (c.edge(1) - c.edge(0)),
         .dimension = dimension::length,
         .description = "where g is greatest; its error is half a bin"},
        {.name = "number_density",
         .value = c.density(),
         .dimension = {0, -3, 0},
         .description = "other grains that count, by volume of the counted region"},
    };
    table.columns = {std::move(r), std::move(g), std::move(error), std::move(neighbours)};
    return {table};
  }

 private:
  OptionValues options_;
  CountedRegion region_;
  std::optional<PairCounts> counts_;
};

}  // namespace

MeasurementInfo pair_correlation_measurement() {
  MeasurementInfo info;
  info.name = "pair_correlation";
  info.description = "radial distribution function g(r), exact for periodic boxes, slabs and closed boxes";
  info.equation = "g(r) = sum_i n_i(r)/sum_i rho V_i(r)";
  info.options =
      CountedRegion::options({{.name = "reach",
                               .default_value = 0.0,
                               .help = "greatest distance [length]; 0: five mean diameters of the first frame",
                               .minimum = 0},
                              {.name = "bins",
                               .default_value = std::int64_t{200},
                               .help = "number of equal bins of distance",
                               .minimum = 1,
                               .maximum = 1e6}});
  info.conflict = CountedRegion::conflict;
  info.needs = [](const OptionValues&) { return MeasurementNeeds{ColumnSet(Column::radius), {}}; };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<PairCorrelation>(setting.options); };
  return info;
}

}  // namespace grainvdb
