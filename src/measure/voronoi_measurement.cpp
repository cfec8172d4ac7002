#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/error.hpp"
#include "grainvdb/moment.hpp"
#include "measure/counted_region.hpp"
#include "measure/grains.hpp"
#include "measure/local_packing.hpp"
#include "measure/option_values.hpp"
#include "measure/packing_map.hpp"
#include "measure/spread.hpp"
#include "measure/structure.hpp"

namespace grainvdb {
namespace {

constexpr double default_window = 2.2;  // mean diameters
constexpr const char* no_map = "none";

/// The grains whose centres lie on the right side of all walls, and in the box along axes that are not periodic: others
/// have no cell.
struct Inside {
  Columns3 position;
  std::vector<double> radius;
  std::vector<std::int64_t> id;
  std::size_t behind_walls = 0, outside_box = 0;
};

Inside inside(const Frame& frame, const WallDomain& walls) {
  Inside in;
  for (std::size_t i = 0; i < frame.particles.size(); ++i) {
    const Vec3 x = wrapped(frame.box, frame.particles.position, i);
    bool is_inside = true;
    for (std::size_t a = 0; a < 3; ++a) is_inside = is_inside && x[a] >= frame.box.lo[a] && x[a] <= frame.box.hi[a];
    if (!walls.contains(x)) {
      ++in.behind_walls;
      continue;
    }
    if (!is_inside) {
      ++in.outside_box;
      continue;
    }
    push_back(in.position, x);
    in.radius.push_back(frame.particles.radius[i]);
    in.id.push_back(frame.particles.id[i]);
  }
  return in;
}

/// Middles of windows a radius apart that lie wholly within a box; anywhere along an axis that it fills with its
/// period.
std::vector<double> middles(const Box& box, const Box& counted, std::size_t axis, double radius) {
  const int a = static_cast<int>(axis);
  const bool around = box.periodic[axis] && counted.length(a) >= box.length(a);
  const double lo = counted.lo[axis] + (around ? 0 : radius);
  const double room = counted.length(a) - (around ? 0 : 2 * radius);
  std::vector<double> at;
  if (!(room >= 0)) return at;
  const double steps = std::max(1.0, std::floor(room / radius));
  const auto count = static_cast<std::size_t>(steps) + (around || room == 0 ? 0 : 1);
  for (std::size_t k = 0; k < count; ++k) at.push_back(lo + room * static_cast<double>(k) / steps);
  return at;
}

class Voronoi : public Measurement {
 public:
  explicit Voronoi(const MeasurementSetting& setting)
      : options_(setting.options), region_(setting.options), kernel_(setting.kernel), walls_(setting.walls) {}

  void add(const Frame& frame) override {
    const Inside grains = inside(frame, walls_);
    outside_box_ += grains.outside_box;
    behind_walls_ += grains.behind_walls;
    if (grains.radius.empty()) return;
    if (const auto pair = coincident_pair(frame.box, grains.position, grains.radius))
      throw InputError(
          {{frame.file},
           "two grains at one place have no Voronoi cells",
           "ids " + std::to_string(grains.id[pair->first]) + " and " + std::to_string(grains.id[pair->second]),
           "centres at least 1e-6 diameters apart",
           "Leave one of them out with select, or do without measure.voronoi"});
    if (!(window_ > 0)) set_lengths(mean_diameter(grains.radius));
    const VoronoiCells cells = voronoi_cells(frame.box, grains.position, grains.radius, walls_);
    const LocalPacking packing(frame.box, grains.position, grains.radius, cells, window_);
    const std::vector<double> smooth = kernel_packing(frame.box, grains.position, grains.radius, kernel_);
    for (std::size_t i = 0; i < grains.radius.size(); ++i) {
      if (!region_.holds(vector_at(grains.position, i))) continue;
      if (!packing.is_enclosed(i)) {
        ++not_enclosed_;
        continue;
      }
      if (cells.at_wall[i]) ++at_walls_;
      cell_.add(packing.of_cell(i));
      local_.add(packing.about(i));
      kernel_phi_.add(smooth[i]);
      volume_ += sphere_volume(grains.radius[i]);
      cell_volume_ += cells.volume[i];
      if (map_) map_->add(vector_at(grains.position, i), sphere_volume(grains.radius[i]), cells.volume[i], smooth[i]);
    }
    add_windows(frame.box, packing, region_.within(frame.box, grains.position));
  }

  std::vector<Table> tables() override {
    std::vector<Table> all{cells_table(), windows_table()};
    if (map_) all.push_back(map_->table());
    return all;
  }

 private:
  void set_lengths(double diameter) {
    window_ = length_option(options_, "window", default_window, diameter);
    const std::string& axis = std::get<std::string>(options_.at("map_across"));
    if (axis != no_map)
      map_.emplace(static_cast<std::size_t>(axis[0] - 'x'), length_option(options_, "map_bin", 1, diameter));
  }

  void add_windows(const Box& box, const LocalPacking& packing, const Box& counted) {
    const auto xs = middles(box, counted, 0, window_), ys = middles(box, counted, 1, window_);
    for (const double z : middles(box, counted, 2, window_))
      for (const double y : ys)
        for (const double x : xs) {
          const LocalPacking::Window w = packing.window({x, y, z});
          if (!w.enclosed || walls_.distance({x, y, z}) < window_) {
            ++skipped_;
            continue;
          }
          by_centres_.add(w.by_centres);
          by_volume_.add(w.by_volume);
          by_cells_.add(w.by_cells);
        }
  }

  TableColumn middle(std::size_t bins) const {
    TableColumn phi{"phi", dimension::none, "packing fraction, the middle of the bin"};
    for (std::size_t k = 0; k < bins; ++k) phi.values.push_back((static_cast<double>(k) + 0.5) * width_);
    return phi;
  }

  static TableColumn density(const Spread& spread, std::size_t bins, std::string name, std::string description) {
    TableColumn column{std::move(name), dimension::none, std::move(description)};
    for (std::size_t k = 0; k < bins; ++k) column.values.push_back(spread.density(k));
    return column;
  }

  static void add_moments(Table& table, const Spread& spread, const std::string& name, const std::string& what) {
    table.numbers.push_back({.name = name, .value = spread.mean(), .description = "mean " + what});
    table.numbers.push_back(
        {.name = name + "_deviation", .value = spread.deviation(), .description = "standard deviation of the " + what});
  }

  Table cells_table() const {
    Table table{"voronoi", "packing fraction by the Voronoi cells of grains", "phi_i = V_i/V_cell,i"};
    const std::size_t bins = std::max({cell_.bins(), local_.bins(), kernel_phi_.bins()});
    table.columns = {
        middle(bins), density(cell_, bins, "cells", "probability density of the packing fraction of single cells"),
        density(local_, bins, "local", "the same of the local average: sum V/sum V_cell within a window of a grain"),
        density(kernel_phi_, bins, "kernel", "the same of the field phi at the centres of the grains")};
    table.numbers.push_back({.name = "phi",
                             .value = cell_volume_ > 0 ? volume_ / cell_volume_ : std::nan(""),
                             .description = "packing fraction of all counted grains, sum V/sum V_cell"});
    add_moments(table, cell_, "cells", "packing fraction of single cells");
    add_moments(table, local_, "local", "local average about a grain");
    add_moments(table, kernel_phi_, "kernel", "field phi at the centres of the grains");
    const double all = cell_.count() + not_enclosed_;
    table.numbers.push_back({.name = "at_faces",
                             .value = not_enclosed_ / all,
                             .description = "share of the grains whose cell ends at a face of the box: left out"});
    table.numbers.push_back({.name = "at_walls",
                             .value = at_walls_ / cell_.count(),
                             .description = "share of the counted grains whose cell ends at a wall"});
    if (cell_.count() == 0)
      table.remarks.emplace_back("No grain that counts has a cell that ends at other grains alone.");
    if (outside_box_ > 0)
      table.remarks.push_back(std::to_string(outside_box_) +
                              " times a grain lay outside the box along an axis that is not periodic: it has no cell.");
    if (behind_walls_ > 0)
      table.remarks.push_back(std::to_string(behind_walls_) + " times a grain lay behind a wall: it has no cell.");
    return table;
  }

  Table windows_table() const {
    Table table{"voronoi_windows", "packing fraction in spherical windows, by three measures",
                "by centres: n V/V_w; by volume: the part of each grain inside; by cells: sum V/sum V_cell"};
    const std::size_t bins = std::max({by_centres_.bins(), by_volume_.bins(), by_cells_.bins()});
    table.columns = {
        middle(bins),
        density(by_centres_, bins, "by_centres", "probability density where grains count by their centres"),
        density(by_volume_, bins, "by_volume", "the same where the part of each grain inside counts"),
        density(by_cells_, bins, "by_cells", "the same by the cells of the grains with centres inside")};
    add_moments(table, by_centres_, "by_centres", "packing fraction by centres");
    add_moments(table, by_volume_, "by_volume", "packing fraction by volume");
    add_moments(table, by_cells_, "by_cells", "packing fraction by cells");
    table.numbers.push_back({.name = "windows", .value = by_cells_.count(), .description = "windows, in all frames"});
    table.numbers.push_back({.name = "radius",
                             .value = window_ > 0 ? window_ : std::nan(""),
                             .dimension = dimension::length,
                             .description = "radius of a window"});
    if (skipped_ > 0)
      table.remarks.push_back(
          std::to_string(skipped_) +
          " windows were left out: they reach behind a wall, or hold no grain, or one whose cell ends at a face.");
    if (by_cells_.count() == 0) table.remarks.emplace_back("No window lies wholly within the counted region.");
    return table;
  }

  OptionValues options_;
  CountedRegion region_;
  LucyKernel kernel_;
  WallDomain walls_;
  double width_ = number_option(options_, "bin_width");
  double window_ = 0;
  Spread cell_{width_}, local_{width_}, kernel_phi_{width_}, by_centres_{width_}, by_volume_{width_}, by_cells_{width_};
  std::optional<PackingMap> map_;
  double volume_ = 0, cell_volume_ = 0, not_enclosed_ = 0, at_walls_ = 0;
  std::size_t outside_box_ = 0, behind_walls_ = 0, skipped_ = 0;
};

}  // namespace

MeasurementInfo voronoi_measurement() {
  MeasurementInfo info;
  info.name = "voronoi";
  info.description = "packing fraction by Voronoi cells: distribution, local averages, and windows by three measures";
  info.equation = "phi_i = V_i/V_cell,i";
  info.options = CountedRegion::options(
      {{.name = "window",
        .default_value = 0.0,
        .help = "radius of windows and of local averages [length]; 0: 2.2 mean diameters of the first frame",
        .minimum = 0},
       {.name = "bin_width",
        .default_value = 0.01,
        .help = "width of the bins of packing fraction",
        .minimum = 1e-4,
        .maximum = 1},
       {.name = "map_across",
        .default_value = std::string(no_map),
        .help = "axis along which grains are taken together in a map of the packing fraction: table voronoi_map",
        .choices = {no_map, "x", "y", "z"}},
       {.name = "map_bin",
        .default_value = 0.0,
        .help = "edge of the squares of the map [length]; 0: a mean diameter of the first frame",
        .minimum = 0}});
  info.conflict = CountedRegion::conflict;
  info.needs = [](const OptionValues&) { return MeasurementNeeds{ColumnSet(Column::radius), {}, true}; };
  info.make = [](const MeasurementSetting& setting) { return std::make_unique<Voronoi>(setting); };
  return info;
}

}  // namespace grainvdb
