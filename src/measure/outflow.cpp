#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "measure/option_values.hpp"
#include "measure/plane_counts.hpp"
#include "measure/spots.hpp"

namespace grainvdb {
namespace {

class Outflow : public Measurement {
 public:
  explicit Outflow(const OptionValues& options)
      : counts_(static_cast<std::size_t>(axis_option(options, "up")), numbers_option(options, "heights")) {}

  void add(const Frame& frame) override { counts_.add(frame); }

  std::vector<Table> tables() override {
    Table planes{"outflow", "grains that pass down through planes, per time", "Q = -d/dt N(above the plane)"};
    planes.columns = {{"height", dimension::length, "of the plane", counts_.heights()},
                      {"rate", dimension::rate, "grains per time", {}},
                      {"rate_error", dimension::rate, "its standard error, by groups of frames", {}}};
    for (std::size_t plane = 0; plane < counts_.heights().size(); ++plane) {
      const Estimate rate = counts_.rate(plane);
      planes.columns[1].values.push_back(rate.value);
      planes.columns[2].values.push_back(rate.error);
    }
    const Estimate rate = counts_.mean_rate();
    planes.numbers = {{.name = "rate",
                       .value = rate.value,
                       .error = rate.error,
                       .dimension = dimension::rate,
                       .description = "Q, grains per time, mean over the planes"}};
    if (counts_.times().size() < 2) planes.remarks.emplace_back("Fewer than two frames have a time: there is no rate.");
    return {std::move(planes), in_time()};
  }

 private:
  Table in_time() const {
    Table table{"outflow_in_time", "grains above the lowest and the highest of the planes", "N(t)"};
    const auto& heights = counts_.heights();
    const auto extremes = std::minmax_element(heights.begin(), heights.end());
    const auto lowest = static_cast<std::size_t>(extremes.first - heights.begin());
    const auto highest = static_cast<std::size_t>(extremes.second - heights.begin());
    table.columns = {{"time", dimension::time, "time of the frame", counts_.times()},
                     {"above_lowest", dimension::none, "grains above the lowest plane", {}},
                     {"above_highest", dimension::none, "grains above the highest plane", {}}};
    for (std::size_t frame = 0; frame < counts_.times().size(); ++frame) {
      table.columns[1].values.push_back(counts_.above(frame, lowest));
      table.columns[2].values.push_back(counts_.above(frame, highest));
    }
    if (counts_.times().empty()) table.remarks.emplace_back("No frame has a time.");
    return table;
  }

  PlaneCounts counts_;
};

}  // namespace

MeasurementInfo outflow_measurement() {
  MeasurementInfo info;
  info.name = "outflow";
  info.description = "grains per time that pass down through planes, such as an orifice";
  info.equation = "Q = -d/dt N(above the plane)";
  info.options = {
      up_option(),
      {.name = "heights", .default_value = std::vector<double>{0.0}, .help = "where the planes are, up [length]"}};
  info.conflict = [](const OptionValues& options) -> std::optional<OptionConflict> {
    if (!numbers_option(options, "heights").empty()) return std::nullopt;
    return OptionConflict{"heights", "none", "at least one height"};
  };
  info.needs = [](const OptionValues&) { return MeasurementNeeds{ColumnSet(), {}}; };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<Outflow>(setting.options); };
  return info;
}

}  // namespace grainvdb
