#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <optional>

#include "derive/tensor.hpp"
#include "grainvdb/run.hpp"
#include "measure/affine_fit.hpp"
#include "measure/box_grid.hpp"
#include "measure/option_values.hpp"
#include "measure/plasticity.hpp"
#include "measure/voxel_values.hpp"

namespace grainvdb {
namespace {

constexpr const char* components[] = {"xx", "yy", "zz", "xy", "xz", "yz"};
constexpr std::size_t places[] = {0, 4, 8, 1, 2, 5};  // of these in a tensor

/// Σφ ∇u and Σφ over the voxels of a box.
struct GridMean {
  Tensor sum{};
  double weight = 0;
  Tensor gradient() const {
    Tensor g = sum;
    for (double& x : g) x /= weight;  // NaN without a voxel
    return g;
  }
};

/// How well one number tells another that should be the same: the slope through zero, with its error.
struct Agreement {
  double ab = 0, aa = 0, bb = 0;
  std::size_t count = 0;
  void add(double a, double b) {
    ab += a * b;
    aa += a * a;
    bb += b * b;
    ++count;
  }
  double slope() const { return ab / aa; }
  double error() const {
    return count > 1 ? std::sqrt(std::max(0.0, bb - ab * ab / aa) / (static_cast<double>(count - 1) * aa))
                     : std::numeric_limits<double>::quiet_NaN();
  }
};

/// Strain rates of particles in boxes, beside those of the grid.
class BoxStrainRate : public Measurement {
 public:
  explicit BoxStrainRate(const MeasurementSetting& setting)
      : size_(numbers_option(setting.options, "size")),
        fewest_(count_option(setting.options, "particles_min")),
        condition_max_(number_option(setting.options, "condition_max")),
        lattice_(setting.lattice),
        box_(setting.box) {}

  void add(const Frame& frame) override {
    const Particles& p = frame.particles;
    if (p.size() == 0) return;
    if (!grid_) grid_.emplace(edges(p), box_, lattice_.origin());
    for (std::size_t a = 0; a < p.size(); ++a) {
      const Vec3 x{p.position[0][a], p.position[1][a], p.position[2][a]};
      fits_[grid_->index(x)].add(grid_->offset(x), {p.velocity[0][a], p.velocity[1][a], p.velocity[2][a]});
    }
  }

  // Kept until the end: the boxes are not known before the first frame with particles.
  void take(const OutputFields& fields) override {
    const auto frames = static_cast<double>(fields.time.frame_count);
    for_each_value(fields, {"phi", "velocity_gradient"}, [&](const Coord& c, std::span<const double> v) {
      Voxel voxel{lattice_.centre(c), frames * v[0], {}};
      std::copy(v.begin() + 1, v.end(), voxel.gradient.begin());
      if (voxel.weight > 0 && std::none_of(v.begin(), v.end(), [](double x) { return std::isnan(x); }))
        voxels_.push_back(voxel);
    });
  }

  std::vector<Table> tables() override {
    Table t = empty_table();
    std::map<BoxIndex, GridMean> means;
    if (grid_)
      for (const Voxel& voxel : voxels_) {
        GridMean& mean = means[grid_->index(voxel.x)];
        for (std::size_t k = 0; k < 9; ++k) mean.sum[k] += voxel.weight * voxel.gradient[k];
        mean.weight += voxel.weight;
      }
    std::size_t few = 0;
    std::size_t flat = 0;
    Agreement agreement;
    for (const auto& [index, fit] : fits_) {
      const double condition = fit.condition(grid_->edge());
      if (fit.count() < fewest_) {
        ++few;
      } else if (!(condition <= condition_max_)) {
        ++flat;
      } else {
        add_row(t, index, fit, condition, means[index].gradient(), agreement);
      }
    }
    add_numbers(t, few, flat, agreement);
    return {std::move(t)};
  }

 private:
  struct Voxel {
    Vec3 x{};
    double weight = 0;
    Tensor gradient{};
  };

  Vec3 edges(const Particles& particles) const {
    if (!size_.empty()) return {size_[0], size_[1], size_[2]};
    const double d = mean_diameter(particles.radius);
    return {2.5 * d, 8 * d, 2.5 * d};
  }

  static Table empty_table() {
    Table t{.name = "box_strain_rate",
            .description = "strain rate of the particles of each box by least squares, and the grid's in the same box",
            .equation = "v = M x + v0, D = (M + M^T)/2; grid: mean of the velocity gradient by phi"};
    for (const char* axis : {"x", "y", "z"})
      t.columns.push_back({axis, dimension::length, std::string("middle of the box along ") + axis});
    t.columns.push_back({"particles", dimension::none, "in the box, over all frames"});
    t.columns.push_back({"condition", dimension::none, "condition number of their places, in units of the box"});
    t.columns.push_back({"shear_rate", dimension::rate, "of the particles"});
    t.columns.push_back({"shear_rate_error", dimension::rate, "its standard error, for independent velocities"});
    t.columns.push_back({"grid_shear_rate", dimension::rate, "of the grid's mean gradient"});
    for (const std::string from : {"", "grid_"})
      for (const char* component : components)
        t.columns.push_back({from + "strain_rate_" + component, dimension::rate,
                             std::string("component of D of the ") + (from.empty() ? "particles" : "grid")});
    return t;
  }

  void add_row(Table& t, const BoxIndex& index, const AffineFit& fit, double condition, const Tensor& grid,
               Agreement& agreement) const {
    const AffineVelocity velocity = fit.fit();
    const Vec3 centre = grid_->centre(index);
    std::vector<double> row{centre[0],
                            centre[1],
                            centre[2],
                            static_cast<double>(fit.count()),
                            condition,
                            shear_rate_of(velocity.gradient),
                            shear_rate_error(velocity),
                            shear_rate_of(grid)};
    const Tensor of_particles = symmetric_part(velocity.gradient);
    const Tensor of_grid = symmetric_part(grid);
    for (const Tensor* d : {&of_particles, &of_grid})
      for (std::size_t place : places) row.push_back((*d)[place]);
    for (std::size_t place : places)
      if (std::isfinite(of_grid[place])) agreement.add(of_particles[place], of_grid[place]);
    for (std::size_t c = 0; c < row.size(); ++c) t.columns[c].values.push_back(row[c]);
  }

  void add_numbers(Table& t, std::size_t few, std::size_t flat, const Agreement& agreement) const {
    t.numbers = {{.name = "grid_over_boxes",
                  .value = agreement.slope(),
                  .error = agreement.error(),
                  .description = "slope through zero of the grid's D against the boxes', all components"},
                 {.name = "boxes",
                  .value = static_cast<double>(t.columns[0].values.size()),
                  .description = "with a strain rate"},
                 {.name = "refused_few",
                  .value = static_cast<double>(few),
                  .description = "boxes with fewer particles than particles_min"},
                 {.name = "refused_condition",
                  .value = static_cast<double>(flat),
                  .description = "boxes whose particles leave a direction out"}};
    if (few > 0)
      t.remarks.push_back(std::to_string(few) + " boxes hold fewer than " + std::to_string(fewest_) +
                          " particles over all frames and have no strain rate.");
    if (flat > 0)
      t.remarks.push_back(std::to_string(flat) +
                          " boxes have particles nearly in a plane or line (condition number above condition_max) and "
                          "have no strain rate.");
  }

  std::vector<double> size_;
  std::size_t fewest_;
  double condition_max_;
  Lattice lattice_;
  Box box_;
  std::optional<BoxGrid> grid_;
  std::map<BoxIndex, AffineFit> fits_;
  std::vector<Voxel> voxels_;
};

}  // namespace

MeasurementInfo box_strain_rate_measurement() {
  MeasurementInfo m;
  m.name = "box_strain_rate";
  m.description = "strain rate of the particles in boxes by least squares, beside the grid's gradient";
  m.equation = "v = M x + v0, D = (M + M^T)/2";
  m.options = {
      {.name = "size",
       .default_value = std::vector<double>{},
       .help = "edges of a box, three numbers [length]; none: 2.5, 8 and 2.5 mean diameters; along periodic axes "
               "stretched to fill the period",
       .minimum = 1e-300},
      {.name = "particles_min",
       .default_value = std::int64_t{20},
       .help = "boxes with fewer particles over all frames are refused",
       .minimum = 5,
       .maximum = 1e9},
      {.name = "condition_max",
       .default_value = 10.0,
       .help = "boxes are refused whose particles spread this many times less along one direction than along "
               "another, in units of the box",
       .minimum = 1}};
  m.conflict = [](const OptionValues& options) -> std::optional<OptionConflict> {
    const std::size_t n = numbers_option(options, "size").size();
    if (n == 0 || n == 3) return std::nullopt;
    return OptionConflict{"size", std::to_string(n) + " numbers", "three, along x, y and z, or none"};
  };
  m.needs = [](const OptionValues& options) {
    ColumnSet columns = Column::velocity;
    if (numbers_option(options, "size").empty()) columns |= Column::radius;
    return MeasurementNeeds{columns, {"phi", "velocity_gradient"}};
  };
  m.make = [](const MeasurementSetting& setting) { return std::make_unique<BoxStrainRate>(setting); };
  return m;
}

}  // namespace grainvdb
