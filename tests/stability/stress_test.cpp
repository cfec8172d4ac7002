// Stresses that have no ratio, or no axes.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/mask.hpp"
#include "stability/regimes.hpp"
#include "support/run_in_memory.hpp"

namespace grainvdb::testing::stress_test {
namespace {

bool has(const Written& w, const Coord& c, Reason r) {
  return (w.mask_at(c) & static_cast<std::uint32_t>(r)) != 0;
}

/// The stress of a bonded packing at the sites of its lattice, where it has the symmetry of the forces.
Result at_the_sites(const Vec3& force) {
  return run(make_pipeline(1, {-0.5, -0.5, -0.5}, 3,
                           {"stress", "pressure", "mu", "fluidity", "mu_mohr_coulomb", "principal_stress",
                            "principal_axes", "principal_gap", "slip_lines", "coaxiality_angle", "mask"}),
             {bonded_packing(6, force)});
}

// Bonds of length 1 along each axis, one of each kind per unit of volume: σ = diag(force). At a site the lattice sum of
// the bonds' line integrals differs from 1 by the ripple at the reciprocal vectors, less than that of φ, 0.22 %.
constexpr double ripple = 2.2e-3;

// Physics section 7: P ≤ 0 has no stress ratio.
TEST(Tension, HasNoStressRatio) {
  const Result r = at_the_sites({1, 2, 3});
  const Written& w = r.only();
  std::size_t voxels = 0;
  w.field("pressure").for_each_active([&](const Coord& c) {
    ++voxels;
    EXPECT_NEAR(static_cast<double>(w.field("pressure").at(c)), -2, 2 * ripple);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(static_cast<double>(w.field("principal_stress").at(c, k)), 3 - k, 3 * ripple);
    for (const char* name : {"mu", "fluidity", "mu_mohr_coulomb", "slip_lines"})
      EXPECT_TRUE(std::isnan(w.field(name).at(c))) << name;
    EXPECT_TRUE(has(w, c, Reason::low_pressure));
    EXPECT_TRUE(has(w, c, Reason::tensile_stress));
    EXPECT_FLOAT_EQ(w.field("principal_axes").at(c, 2), 1.0F);  // row 0, the most tensile: z
  });
  EXPECT_EQ(voxels, 216U);
  for (const char* reason : {"low_pressure", "tensile_stress"}) {
    bool found = false;
    for (const auto& [name, count] : r.report.masked) found = found || (name == reason && count == voxels);
    EXPECT_TRUE(found) << reason;
  }
}

// No axes, and a μ that is nothing but rounding: no fluidity. The gap is reported.
TEST(IsotropicStress, HasNoAxes) {
  const Result r = at_the_sites({-2, -2, -2});
  const Written& w = r.only();
  w.field("pressure").for_each_active([&](const Coord& c) {
    EXPECT_NEAR(static_cast<double>(w.field("pressure").at(c)), 2, 2 * ripple);
    EXPECT_LE(w.field("mu").at(c), 1e-6F);
    EXPECT_TRUE(has(w, c, Reason::no_shear_stress));
    EXPECT_TRUE(has(w, c, Reason::degenerate_stress_axes));
    EXPECT_LE(w.field("principal_gap").at(c), 1e-5F);
    for (const char* name : {"fluidity", "slip_lines", "coaxiality_angle"})
      EXPECT_TRUE(std::isnan(w.field(name).at(c))) << name;
    for (int k = 0; k < 9; ++k) EXPECT_TRUE(std::isnan(w.field("principal_axes").at(c, k))) << k;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(static_cast<double>(w.field("principal_stress").at(c, k)), -2, 2 * ripple);
  });
}

// Two equal principal stresses leave the third axis.
TEST(AxisymmetricStress, HasOneAxis) {
  const Result r = at_the_sites({-1, -1, -3});
  const Written& w = r.only();
  w.field("pressure").for_each_active([&](const Coord& c) {
    for (int k = 0; k < 6; ++k) EXPECT_TRUE(std::isnan(w.field("principal_axes").at(c, k))) << k;
    EXPECT_NEAR(static_cast<double>(w.field("principal_axes").at(c, 8)), 1, 1e-6);
    EXPECT_TRUE(has(w, c, Reason::degenerate_stress_axes));
    // |σ|/P and (p₃ - p₁)/(2 √(p₃ p₁)) of diag(-1, -1, -3).
    EXPECT_NEAR(static_cast<double>(w.field("mu").at(c)), std::sqrt(4.0 / 3) / (5.0 / 3), 3 * ripple);
    EXPECT_NEAR(static_cast<double>(w.field("mu_mohr_coulomb").at(c)), 1 / std::sqrt(3.0), 3 * ripple);
  });
}

// Sums are averaged over time, then ratios are formed: two frames whose stresses are each other's mirror image have an
// isotropic mean and μ = 0, where the mean of the frames' μ is ½.
TEST(RatiosOfAverages, Stress) {
  const std::vector<Frame> frames{bonded_packing(6, {-1, -2, -3}), bonded_packing(6, {-3, -2, -1})};
  Pipeline p = make_pipeline(1, {-0.5, -0.5, -0.5}, 3, {"mu", "pressure"});
  const Result mean = run(p, frames);
  p.window = 1;
  const Result each = run(p, frames);
  ASSERT_EQ(each.record.times.size(), 2U);
  mean.only().field("mu").for_each_active([&](const Coord& c) {
    EXPECT_LE(mean.only().field("mu").at(c), 1e-6F);
    for (const Written& w : each.record.times) EXPECT_NEAR(static_cast<double>(w.field("mu").at(c)), 0.5, 3 * ripple);
  });
}

// One grain of velocity 1 in the first frame, two of velocity 4 in its place in the second: u = (1·1 + 2·4)/3 = 3,
// where the mean of the frames' u is 2.5; d likewise. T is about each frame's own mean: 0, where a variance over both
// frames is 2.
TEST(RatiosOfAverages, Velocity) {
  Scene scene{"one and two", {}, 0.5, {0, 0, 0}, 1.5, {}};
  for (int k = 0; k < 2; ++k) {
    Frame f;
    f.file = "memory";
    f.step = k;
    f.box = {{-2, -2, -2}, {2, 2, 2}, {false, false, false}};
    for (int n = 0; n <= k; ++n)
      add_particle(f.particles, n + 1, 1, {0.1, 0.2, 0.3}, {k == 0 ? 1.0 : 4.0, 0, 0}, {0, 0, 0}, 0.5, 1);
    scene.frames.push_back(f);
  }
  const Result r = run(make_pipeline(0.5, {0, 0, 0}, 1.5, {"phi", "velocity", "temperature", "frames"}), scene.frames);
  const Written& w = r.only();
  w.field("phi").for_each_active([&](const Coord& c) {
    EXPECT_NEAR(static_cast<double>(w.field("velocity").at(c, 0)), 3, 1e-6);
    EXPECT_LE(w.field("temperature").at(c), 1e-12F);
    EXPECT_EQ(w.field("frames").at(c), 2.0F);
  });
}

}  // namespace
}  // namespace grainvdb::testing::stress_test
