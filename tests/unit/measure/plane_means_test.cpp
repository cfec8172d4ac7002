#include "measure/plane_means.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "grainvdb/error.hpp"
#include "measure/register.hpp"
#include "support/random.hpp"
#include "unit/measure/synthetic.hpp"

namespace grainvdb::plane_means_test {
namespace {

using testing::column_of;

constexpr double cutoff = 1.5, voxel = 0.25, area = 12;
// splat_planes is exact to 1e-5 of the sum of magnitudes.
constexpr double splat_error = 1e-5;
const Lattice lattice(voxel, {0, 0, 0});

void add_grain(Particles& p, const Vec3& x, const Vec3& v, double radius) {
  p.id.push_back(static_cast<std::int64_t>(p.size()) + 1);
  for (std::size_t a = 0; a < 3; ++a) {
    p.position[a].push_back(x[a]);
    p.velocity[a].push_back(v[a]);
  }
  p.radius.push_back(radius);
  p.mass.push_back(2.5 * 4 / 3 * std::numbers::pi * std::pow(radius, 3));
}

double volume_of(double radius) {
  return 4.0 / 3 * std::numbers::pi * std::pow(radius, 3);
}

TEST(PlaneMeans, OneGrainIsTheMarginal) {
  Particles p;
  add_grain(p, {1, 2, 0.4}, {3, -1, 2}, 0.5);
  const LucyKernel kernel(cutoff);
  const PlaneMeans means = plane_means(p, lattice, kernel, 2, area);
  ASSERT_EQ(means.planes(), 12U);
  for (std::size_t n = 0; n < means.planes(); ++n) {
    const double z = lattice.centre(2, means.first + static_cast<std::int32_t>(n));
    const double volume = volume_of(0.5) * kernel.marginal(z - 0.4) / area;
    const double tolerance = splat_error * volume_of(0.5) * kernel.marginal(0) / area;
    EXPECT_NEAR(means.value(n, PlaneMeans::volume), volume, tolerance);
    EXPECT_NEAR(means.value(n, PlaneMeans::mass), 2.5 * volume, 2.5 * tolerance);
    EXPECT_NEAR(means.value(n, PlaneMeans::momentum_x), 3 * volume, 3 * tolerance);
    EXPECT_NEAR(means.value(n, PlaneMeans::momentum_y), -volume, tolerance);
    EXPECT_NEAR(means.value(n, PlaneMeans::diameter), volume, tolerance);
    // A grain is its own mean.
    EXPECT_NEAR(means.value(n, PlaneMeans::heat), 0, 20 * tolerance);
  }
}

// Two grains at one height with u ± w: the mean is u, and δv² = w².
TEST(PlaneMeans, TemperatureIsAboutThePlane) {
  Particles p;
  add_grain(p, {1, 2, 0.4}, {5 + 0.3, 0, 0.4}, 0.5);
  add_grain(p, {7, 1, 0.4}, {5 - 0.3, 0, -0.4}, 0.5);
  const PlaneMeans means = plane_means(p, lattice, LucyKernel(cutoff), 2, area);
  for (std::size_t n = 2; n + 2 < means.planes(); ++n)
    EXPECT_NEAR(means.value(n, PlaneMeans::heat) / means.value(n, PlaneMeans::volume), 0.25, 1e-4) << n;
}

Frame random_frame(std::uint64_t seed) {
  Frame frame;
  frame.box = {{0, 0, 0}, {4, 3, 5}, {true, true, true}};
  testing::Random random(seed);
  for (int n = 0; n < 200; ++n)
    add_grain(frame.particles, {random.uniform(0, 4), random.uniform(0, 3), random.uniform(0, 5)}, {7, 0, -1},
              random.uniform(0.2, 0.3));
  return frame;
}

// The mean over the periodic height is Σ V/volume, to the error of the trapezoidal rule at c/h = 6 (2.4e-5, physics
// section 6) and that of the splat.
TEST(PlaneProfile, HoldsAllMaterialAndRigidMotion) {
  const MeasurementInfo info = plane_profile_measurements().front();
  const OptionValues options = testing::defaults_of(info);
  const StageSettings stages;
  Lattice periodic = lattice;
  const Frame frame = random_frame(1);
  periodic.set_periods(frame.box);
  const auto measurement = info.make({options, stages, periodic, LucyKernel(cutoff), frame.box, {}});
  measurement->add(frame);
  measurement->add(random_frame(2));
  const std::vector<Table> tables = measurement->tables();
  ASSERT_EQ(tables.size(), 1U);

  double volume = 0;
  for (std::uint64_t seed : {1, 2})
    for (const double radius : random_frame(seed).particles.radius) volume += volume_of(radius) / 2;
  double sum = 0;
  for (const double phi : column_of(tables[0], "phi")) sum += phi * voxel * 12;
  EXPECT_EQ(column_of(tables[0], "phi").size(), 20U);
  EXPECT_NEAR(sum, volume, 5e-5 * volume);
  for (std::size_t n = 0; n < 20; ++n) {
    EXPECT_NEAR(column_of(tables[0], "velocity_x")[n], 7, 7 * 2 * splat_error);
    EXPECT_NEAR(column_of(tables[0], "velocity_z")[n], -1, 2 * splat_error);
    EXPECT_NEAR(column_of(tables[0], "temperature")[n], 0, 50 * 4 * splat_error * splat_error * 25);
    EXPECT_GT(column_of(tables[0], "phi_error")[n], 0);
  }
}

TEST(PlaneProfile, NeedsAnArea) {
  const MeasurementInfo info = plane_profile_measurements().front();
  OptionValues options = testing::defaults_of(info);
  const StageSettings stages;
  Frame frame = random_frame(1);
  frame.box.periodic[1] = false;
  const auto without = info.make({options, stages, lattice, LucyKernel(cutoff), frame.box, {}});
  EXPECT_THROW(without->add(frame), InputError);
  options["area"] = 12.0;
  const auto with = info.make({options, stages, lattice, LucyKernel(cutoff), frame.box, {}});
  EXPECT_NO_THROW(with->add(frame));
}

}  // namespace
}  // namespace grainvdb::plane_means_test
