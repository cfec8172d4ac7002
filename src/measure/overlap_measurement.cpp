#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "measure/frame_series.hpp"
#include "measure/overlaps.hpp"
#include "measure/structure.hpp"

namespace grainvdb {
namespace {

class OverlapMeasurement : public Measurement {
 public:
  explicit OverlapMeasurement(const OptionValues& options) : region_(options) {}

  void add(const Frame& frame) override {
    series_.add(frame);
    frames_.push_back(overlaps(frame.box, frame.particles.position, frame.particles.radius, region_));
  }

  std::vector<Table> tables() override {
    Table table{"overlap", "overlaps of grains, frame by frame",
                "B = 1/N sum_i sum_j (delta_ij/d_ij)^2, d_ij = r_i + r_j"};
    TableColumn badness{"badness", dimension::none, "overlap badness B"};
    TableColumn error{"badness_error", dimension::none, "standard error of B, pairs taken as independent"};
    TableColumn largest{"largest", dimension::none, "largest overlap of a pair, over the sum of its radii"};
    TableColumn share{"overlapping", dimension::none, "share of the grains that overlap another"};
    Overlaps all;
    double weighted = 0, squares = 0;
    for (const Overlaps& o : frames_) {
      const auto n = static_cast<double>(o.grains);
      badness.values.push_back(o.badness);
      error.values.push_back(o.error);
      largest.values.push_back(o.largest);
      share.values.push_back(o.overlapping);
      all.largest = std::max(all.largest, o.largest);
      all.largest_length = std::max(all.largest_length, o.largest_length);
      all.grains += o.grains;
      if (o.grains == 0) continue;
      weighted += n * o.badness;
      squares += n * o.error * o.error;
    }
    if (all.grains == 0) table.remarks.emplace_back(no_grains);
    const auto grains = static_cast<double>(all.grains);
    table.numbers = {{.name = "badness",
                      .value = weighted / grains,
                      .error = std::sqrt(squares / grains),
                      .dimension = dimension::none,
                      .description = "mean overlap badness of all frames; its error is that of one frame"},
                     {.name = "largest",
                      .value = all.largest,
                      .dimension = dimension::none,
                      .description = "largest overlap of a pair, over the sum of its radii"},
                     {.name = "largest_length",
                      .value = all.largest_length,
                      .dimension = dimension::length,
                      .description = "largest overlap"}};
    table.columns = {series_.column(), std::move(badness), std::move(error), std::move(largest), std::move(share)};
    return {table};
  }

 private:
  CountedRegion region_;
  FrameSeries series_;
  std::vector<Overlaps> frames_;
};

}  // namespace

MeasurementInfo overlap_measurement() {
  MeasurementInfo info;
  info.name = "overlap";
  info.description = "overlap badness and the largest overlap, frame by frame";
  info.equation = "B = 1/N sum_i sum_j (delta_ij/d_ij)^2";
  info.options = CountedRegion::options({});
  info.conflict = CountedRegion::conflict;
  info.needs = [](const OptionValues&) { return MeasurementNeeds{ColumnSet(Column::radius), {}}; };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<OverlapMeasurement>(setting.options); };
  return info;
}

}  // namespace grainvdb
