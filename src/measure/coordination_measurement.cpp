#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "measure/contact_graph.hpp"
#include "measure/counted_region.hpp"
#include "measure/grains.hpp"
#include "measure/option_values.hpp"
#include "measure/structure.hpp"

namespace grainvdb {
namespace {

constexpr double contact_gap = 0.01;  // mean diameters

bool by_dump(const OptionValues& options) {
  return std::get<std::string>(options.at("contacts")) == "dump";
}

class Coordination : public Measurement {
 public:
  explicit Coordination(const OptionValues& options)
      : options_(options), region_(options), least_(count_option(options, "rattlers_below")) {}

  void add(const Frame& frame) override {
    const Particles& grains = frame.particles;
    if (grains.size() == 0) return;
    ++frames_;
    const ContactGraph graph = graph_of(frame);
    const std::vector<bool> stays = backbone(graph, least_);
    for (std::size_t i = 0; i < graph.size(); ++i) {
      if (!region_.holds(wrapped(frame.box, grains.position, i))) continue;
      const std::size_t z = graph.degree(i);
      if (counts_.size() <= z) counts_.resize(z + 1);
      ++counts_[z];
      if (!stays[i]) continue;
      ++kept_;
      for (std::size_t c = graph.start[i]; c < graph.start[i + 1]; ++c)
        kept_contacts_ += graph.partner[c] == ContactGraph::outside || stays[graph.partner[c]] ? 1 : 0;
    }
  }

  std::vector<Table> tables() override {
    Table table{"coordination", "numbers of contacts of grains", "z = 1/N sum_i z_i"};
    TableColumn contacts{"contacts", dimension::none, "contacts of a grain"};
    TableColumn share{"share", dimension::none, "share of the grains"};
    double grains = 0, sum = 0, squares = 0;
    for (std::size_t z = 0; z < counts_.size(); ++z) {
      const auto value = static_cast<double>(z);
      grains += counts_[z];
      sum += value * counts_[z];
      squares += value * value * counts_[z];
    }
    for (std::size_t z = 0; z < counts_.size(); ++z) {
      contacts.values.push_back(static_cast<double>(z));
      share.values.push_back(counts_[z] / grains);
    }
    if (grains == 0) table.remarks.emplace_back(no_grains);
    const double mean = sum / grains;
    const double rattlers = 1 - kept_ / grains;
    // Of the grains of one frame: in later frames they are mostly the same.
    const double independent = grains / frames_;
    table.numbers = {
        {.name = "coordination",
         .value = mean,
         .error = std::sqrt((squares / grains - mean * mean) / independent),
         .dimension = dimension::none,
         .description = "mean number of contacts of a grain"},
        {.name = "rattlers",
         .value = rattlers,
         .error = std::sqrt(rattlers * (1 - rattlers) / independent),
         .dimension = dimension::none,
         .description = "share of the grains that too few others hold, those that rest on such grains included"},
        {.name = "coordination_backbone",
         .value = kept_contacts_ / kept_,
         .dimension = dimension::none,
         .description = "mean number of contacts among the grains that are no rattlers"}};
    table.columns = {std::move(contacts), std::move(share)};
    return {table};
  }

 private:
  ContactGraph graph_of(const Frame& frame) {
    const Particles& grains = frame.particles;
    if (by_dump(options_)) return contacts_of_dump(grains, frame.contacts);
    if (!gap_) gap_ = length_option(options_, "gap", contact_gap, mean_diameter(grains.radius));
    return contacts_by_gap(frame.box, grains.position, grains.radius, *gap_);
  }

  OptionValues options_;
  CountedRegion region_;
  std::size_t least_;
  std::optional<double> gap_;
  std::vector<double> counts_;  // of grains with so many contacts
  double frames_ = 0, kept_ = 0, kept_contacts_ = 0;
};

}  // namespace

MeasurementInfo coordination_measurement() {
  MeasurementInfo info;
  info.name = "coordination";
  info.description = "coordination number, its distribution, and the share of rattlers";
  info.equation = "z = 1/N sum_i z_i";
  info.options = CountedRegion::options(
      {{.name = "contacts",
        .default_value = std::string("gap"),
        .help = "gap: grains whose surfaces are near touch; dump: the contacts of the dump, those with grains that are "
                "not selected included",
        .choices = {"gap", "dump"}},
       {.name = "gap",
        .default_value = 0.0,
        .help =
            "greatest distance between the surfaces of grains that touch [length]; 0: a hundredth of the mean diameter",
        .minimum = 0},
       {.name = "rattlers_below",
        .default_value = std::int64_t{2},
        .help = "grains with fewer contacts are rattlers: 2 with friction, 4 without",
        .minimum = 0,
        .maximum = 100}});
  info.conflict = CountedRegion::conflict;
  info.needs = [](const OptionValues& options) {
    return MeasurementNeeds{ColumnSet(by_dump(options) ? Column::contacts : Column::radius), {}};
  };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<Coordination>(setting.options); };
  return info;
}

}  // namespace grainvdb
