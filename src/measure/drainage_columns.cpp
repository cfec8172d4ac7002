#include "measure/drainage_columns.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>

#include "grainvdb/run.hpp"
#include "measure/jackknife_error.hpp"
#include "measure/option_values.hpp"
#include "measure/plasticity.hpp"
#include "measure/voxel_values.hpp"

namespace grainvdb {
namespace {

constexpr std::size_t fewest_times = 3;  ///< whose scatter says something

/// The value of a length option, or another where it is 0.
double length_or(const MeasurementSetting& setting, const char* name, double otherwise) {
  const double given = number_option(setting.options, name);
  return given > 0 ? given : otherwise;
}

OptionInfo length_option_info(const char* name, const char* help) {
  return {.name = name, .default_value = 0.0, .help = help, .minimum = 0};
}

}  // namespace

Origin origin_option(const OptionValues& options) {
  return std::get<std::string>(options.at("origin")) == "slot" ? Origin::slot : Origin::fitted;
}

DrainageColumns::DrainageColumns(const MeasurementSetting& setting)
    : lattice_(setting.lattice),
      up_(axis_option(setting.options, "up")),
      across_(axis_option(setting.options, "across")),
      slot_(number_option(setting.options, "slot")),
      bottom_(number_option(setting.options, "bottom")),
      lowest_(length_or(setting, "lowest", setting.kernel.cutoff())),
      highest_(length_or(setting, "highest", std::numeric_limits<double>::infinity())),
      half_width_(length_or(setting, "half_width", std::numeric_limits<double>::infinity())),
      least_phi_(number_option(setting.options, "phi_min")),
      independence_(independence(setting.lattice.voxel(), setting.kernel)) {}

void DrainageColumns::take(const OutputFields& fields) {
  columns_.emplace_back();
  const auto component = [](int axis) { return static_cast<std::size_t>(1 + axis); };
  for_each_value(fields, {"phi", "velocity"}, [&](const Coord& c, std::span<const double> v) {
    const double x = lattice_.centre(across_, c[across_]) - slot_;
    const double z = lattice_.centre(up_, c[up_]) - bottom_;
    if (!(v[0] >= least_phi_) || std::isnan(v[component(up_)])) return;
    if (z < lowest_ || z > highest_ || std::abs(x) > half_width_) return;
    columns_.back()[{c[up_], c[across_]}].add({-v[0] * v[component(up_)], v[0] * v[component(across_)], v[0], 1});
  });
}

void DrainageColumns::Column::add(const Column& other) {
  down += other.down;
  across += other.across;
  phi += other.phi;
  voxels += other.voxels;
}

void DrainageColumns::Column::take_off(const Column& other) {
  down -= other.down;
  across -= other.across;
  phi -= other.phi;
  voxels -= other.voxels;
}

std::vector<Table> DrainageColumns::tables(const TablesOf& tables_of) const {
  const Columns all = sum_over_times();
  std::vector<Table> tables = tables_of(mean_flow(all, columns_.size()));
  widen_errors(all, tables_of, tables);
  return tables;
}

DrainageColumns::Columns DrainageColumns::sum_over_times() const {
  Columns sums;
  for (const Columns& one : columns_)
    for (const auto& [at, column] : one) sums[at].add(column);
  return sums;
}

// Output times tell the same place again, so that a point is no more independent for their number.
std::vector<DrainagePoint> DrainageColumns::mean_flow(const Columns& sums, std::size_t outputs) const {
  std::vector<DrainagePoint> points;
  for (const auto& [at, column] : sums) {
    if (column.voxels == 0) continue;
    const double deep = static_cast<double>(column.voxels) / static_cast<double>(outputs);
    points.push_back({lattice_.centre(across_, at.second) - slot_, lattice_.centre(up_, at.first) - bottom_,
                      column.down / column.phi, std::min(1.0, independence_ * std::max(1.0, deep)),
                      column.across / column.phi});
  }
  return points;
}

void DrainageColumns::widen_errors(const Columns& all, const TablesOf& tables_of, std::vector<Table>& tables) const {
  const std::size_t times = columns_.size();
  if (times < fewest_times) return;
  std::vector<std::vector<double>> without;  // [number of any table][time]
  for (const Columns& one : columns_) {
    Columns others = all;
    for (const auto& [at, column] : one) others[at].take_off(column);
    std::size_t n = 0;
    for (const Table& table : tables_of(mean_flow(others, times - 1)))
      for (const Quantity& q : table.numbers) {
        if (n == without.size()) without.emplace_back();
        without[n++].push_back(q.value);
      }
  }
  std::size_t n = 0;
  for (Table& table : tables) {
    for (Quantity& q : table.numbers) {
      if (std::isfinite(q.error)) q.error = std::max(q.error, jackknife_error(without[n]));
      ++n;
    }
    table.remarks.push_back("Errors are those of the fit or, where these are larger, of leaving out one of the " +
                            std::to_string(times) + " output times at a time.");
  }
}

std::vector<OptionInfo> DrainageColumns::options(std::vector<OptionInfo> others) {
  std::vector<OptionInfo> all{
      up_option(),
      {.name = "across",
       .default_value = std::string("x"),
       .help = "axis across the slot; the flow is averaged over the third",
       .choices = {"x", "y", "z"}},
      {.name = "slot", .default_value = 0.0, .help = "where the middle of the slot is, across [length]"},
      {.name = "bottom", .default_value = 0.0, .help = "where the slot is, up [length]"},
      length_option_info("lowest",
                         "height above the slot from which on the flow counts [length]; 0: the kernel's cutoff, "
                         "usually three mean diameters"),
      length_option_info("highest", "height above the slot up to which it counts [length]; 0: all"),
      length_option_info("half_width", "distance from the middle up to which it counts [length]; 0: all"),
      {.name = "origin",
       .default_value = std::string("slot"),
       .help = "where profiles have no width: slot (at its height) or fitted (below, for a wide slot and kernel)",
       .choices = {"slot", "fitted"}},
      least_phi_option()};
  std::move(others.begin(), others.end(), std::back_inserter(all));
  return all;
}

std::optional<OptionConflict> DrainageColumns::conflict(const OptionValues& options) {
  if (axis_option(options, "up") != axis_option(options, "across")) return std::nullopt;
  return OptionConflict{"across", std::get<std::string>(options.at("across")), "another axis than up"};
}

}  // namespace grainvdb
