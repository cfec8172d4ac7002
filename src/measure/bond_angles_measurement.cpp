#include <numbers>
#include <optional>
#include <utility>

#include "measure/contact_graph.hpp"
#include "measure/counted_region.hpp"
#include "measure/grains.hpp"
#include "measure/option_values.hpp"
#include "measure/structure.hpp"

namespace grainvdb {
namespace {

constexpr double neighbour_gap = 0.1;  // mean diameters
constexpr double in_degrees = 180 / std::numbers::pi;

class BondAnglesMeasurement : public Measurement {
 public:
  explicit BondAnglesMeasurement(const OptionValues& options)
      : options_(options), region_(options), angles_(count_option(options, "bins")) {}

  void add(const Frame& frame) override {
    const Particles& grains = frame.particles;
    if (grains.size() == 0) return;
    if (!gap_) gap_ = length_option(options_, "gap", neighbour_gap, mean_diameter(grains.radius));
    const ContactGraph graph = contacts_by_gap(frame.box, grains.position, grains.radius, *gap_);
    for (std::size_t i = 0; i < graph.size(); ++i)
      if (region_.holds(wrapped(frame.box, grains.position, i))) angles_.add(graph, i);
  }

  std::vector<Table> tables() override {
    Table table{"bond_angles", "angles between two contacts of one grain",
                "p(a) = n(a)/(n da); of directions without preference p = sin(a)/2"};
    TableColumn angle{"angle", dimension::none, "angle, the middle of the bin [degrees]"};
    TableColumn density{"density", dimension::none, "share of the angles, per degree"};
    TableColumn relative{"relative", dimension::none, "the same over that of directions without preference"};
    TableColumn count{"count", dimension::none, "pairs of contacts"};
    for (std::size_t k = 0; k < angles_.bins(); ++k) {
      angle.values.push_back(0.5 * (angles_.edge(k) + angles_.edge(k + 1)) * in_degrees);
      density.values.push_back(angles_.density(k) / in_degrees);
      relative.values.push_back(angles_.relative(k));
      count.values.push_back(angles_.count(k));
    }
    const double total = angles_.total();
    if (total == 0) table.remarks.emplace_back("No grain that counts has two contacts.");
    table.numbers = {{.name = "pairs",
                      .value = total,
                      .dimension = dimension::none,
                      .description = "pairs of contacts of one grain, in all frames"}};
    table.columns = {std::move(angle), std::move(density), std::move(relative), std::move(count)};
    return {table};
  }

 private:
  OptionValues options_;
  CountedRegion region_;
  BondAngles angles_;
  std::optional<double> gap_;
};

}  // namespace

MeasurementInfo bond_angles_measurement() {
  MeasurementInfo info;
  info.name = "bond_angles";
  info.description = "distribution of the angles between two contacts of one grain";
  info.equation = "p(a), a between x_j - x_i and x_k - x_i for neighbours j, k of i";
  info.options = CountedRegion::options(
      {{.name = "gap",
        .default_value = 0.0,
        .help = "greatest distance between the surfaces of neighbours [length]; 0: a tenth of the mean diameter",
        .minimum = 0},
       {.name = "bins",
        .default_value = std::int64_t{90},
        .help = "number of equal bins of 0 to 180 degrees",
        .minimum = 1,
        .maximum = 1e6}});
  info.conflict = CountedRegion::conflict;
  info.needs = [](const OptionValues&) { return MeasurementNeeds{ColumnSet(Column::radius), {}}; };
  info.make = [](const MeasurementSetting& setting) {
    return std::make_unique<BondAnglesMeasurement>(setting.options);
  };
  return info;
}

}  // namespace grainvdb
