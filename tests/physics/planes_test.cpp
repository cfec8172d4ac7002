// Fields as exact averages over planes: against those on voxels and by their definitions.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "grainvdb/kernel.hpp"
#include "grainvdb/moment.hpp"
#include "physics/planes_scene.hpp"
#include "support/reference.hpp"

namespace grainvdb::testing::planes_test {
namespace {

/// The mean over a plane of a field on voxels, times another where one is given.
double mean_over(const Box& box, double h, const FieldCopy& f, int component, int axis, int plane,
                 const FieldCopy* weight = nullptr) {
  double sum = 0;
  f.for_each_active([&](const Coord& c) {
    if (c[axis] != plane) return;
    const double w = weight == nullptr ? 1 : weight->at(c);
    if (w != 0) sum += w * f.at(c, component);
  });
  return sum * h * h / area_of(box, axis);
}

// The mean over voxels is a lattice sum of W along the planes, which is good to 1e-4 of the terms at 5.4 voxels a
// cutoff and to single precision at twice as many (measured: 6e-5 and 5e-6).
TEST(Planes, AreTheMeansOfFieldsOverVoxels) {
  for (const Scene& scene : {periodic_scene(), walled_scene()})
    for (const int refined : {1, 2})
      for (int axis = scene.name == "walled" ? 2 : 0; axis < 3; ++axis) {
        SCOPED_TRACE(scene.name + ' ' + std::to_string(refined) + ' ' + std::to_string(axis));
        const std::vector<std::string> sums{"phi", "density", "contact_stress", "wall_force"};
        Pipeline p = scene.pipeline({"phi", "density", "contact_stress", "velocity", "mean_diameter", "temperature",
                                     "angular_velocity", "rotational_fluctuation"});
        const bool walls = scene.name == "walled";
        if (walls) p.fields.push_back("wall_force");
        p.voxel = scene.voxel / refined;
        for (const char* stage : {"temperature", "rotational_fluctuation"}) {
          set_option(p, stage, "mode", std::string("two_pass_profile"));
          std::vector<std::string> along;
          for (int a = 0; a < 3; ++a)
            if (a != axis) along.emplace_back(1, static_cast<char>('x' + a));
          set_option(p, stage, "homogeneous", along);
        }
        const std::vector<Frame> frames{scene.frames[0]};
        const Written voxels = run(p, frames).only();
        const Result result = run_on_planes(p, axis, frames);
        const Written& planes = result.only();
        const double ratio = scene.cutoff / p.voxel;
        const double error = ratio > 6 ? 2 * e : ratio > 5 ? 2e-4 : 2e-3;
        const Box& box = frames[0].box;
        std::size_t compared = 0;
        for (const auto& [name, field] : planes.fields) {
          const bool sum = std::find(sums.begin(), sums.end(), name) != sums.end();
          double largest = 0;
          field.for_each_active([&](const Coord& c) {
            for (int k = 0; k < field.meta.components; ++k)
              if (!std::isnan(field.at(c, k))) largest = std::max<double>(largest, std::abs(field.at(c, k)));
          });
          for_each_plane(field, axis, [&](const Coord& c) {
            const double phi = planes.field("phi").at(c);
            if (!sum && !(phi > 1e-3)) return;  // of faint planes the mean has other digits than the sums
            for (int k = 0; k < field.meta.components; ++k) {
              const FieldCopy& on_voxels = voxels.field(name);
              double mean = mean_over(box, p.voxel, on_voxels, k, axis, c[axis], sum ? nullptr : &voxels.field("phi"));
              if (!sum) mean /= mean_over(box, p.voxel, voxels.field("phi"), 0, axis, c[axis]);
              EXPECT_NEAR(field.at(c, k), mean, 3 * error * largest) << name << k << " at " << c[axis];
              ++compared;
            }
          });
        }
        EXPECT_GT(compared, 200U);
      }
}

// Along the planes nothing varies. Across them: differences of the velocities of planes, or sums of w₁'.
TEST(Planes, GradientIsThatOfTheVelocityOfPlanes) {
  const Scene scene = periodic_scene();
  const int axis = 2;
  for (const char* method : {"central", "kernel"}) {
    Pipeline p = scene.pipeline({"velocity", "velocity_gradient"});
    set_option(p, "velocity_gradient", "method", std::string(method));
    const std::vector<Frame> frames{scene.frames[0]};
    const Result result = run_on_planes(p, axis, frames);
    const Written& w = result.only();
    const FieldCopy &u = w.field("velocity"), &gradient = w.field("velocity_gradient");
    const BruteForce brute(scene, axis);
    const Lattice lattice = lattice_of(scene);
    const Particles m = material(frames[0], scene.select);
    for_each_plane(gradient, axis, [&](const Coord& c) {
      for (int k = 0; k < 9; ++k) {
        if (k % 3 != axis) {
          EXPECT_EQ(gradient.at(c, k), 0) << method << k;
          continue;
        }
        double expected;
        if (std::string(method) == "central") {
          const auto at = [&](int by) { return in_column(axis, lattice.wrap(axis, c[axis] + by)); };
          expected = (static_cast<double>(u.at(at(1), k / 3)) - u.at(at(-1), k / 3)) / (2 * scene.voxel);
        } else {
          double slopes = 0, of_velocity = 0, volume = 0;
          for (std::size_t n = 0; n < m.size(); ++n) {
            const double v = sphere_volume(m.radius[n]);
            const double slope = v * brute.over_images(frames[0].box, m.position[2][n], brute.centre(c),
                                                       [&](double d) { return brute.kernel().marginal_gradient(d); });
            slopes += slope;
            of_velocity += slope * m.velocity[static_cast<std::size_t>(k / 3)][n];
            volume += v * brute.over_images(frames[0].box, m.position[2][n], brute.centre(c),
                                            [&](double d) { return brute.kernel().marginal(d); });
          }
          expected = (of_velocity - u.at(c, k / 3) * slopes) / volume;
        }
        EXPECT_NEAR(gradient.at(c, k), expected, 1e-4) << method << k << " at " << c[axis];  // of rates of order 1
      }
    });
  }
}

std::vector<Species> by_size_and_wall() {
  return {{"fine", {1}, {}, std::pair(0.0, 0.94)}, {"coarse", {1}, {}, std::pair(0.94, 9.0)}, {"wall", {2, 3}, {}, {}}};
}

// Sums of species make up the whole, to what single precision leaves of the sums of grains and to rounding for those of
// contacts, which are formed in double.
TEST(Planes, SpeciesAddUpToTheWhole) {
  const Scene scene = walled_scene();
  const std::vector<std::string> fields{"phi",         "density",        "velocity",       "mean_diameter",
                                        "temperature", "contact_stress", "kinetic_stress", "stress"};
  Pipeline p = scene.pipeline(fields);
  p.species = by_size_and_wall();
  for (const Species& s : p.species)
    for (const std::string& field : fields) p.fields.push_back(field + '_' + s.name);
  const Result result = run_on_planes(p, 2, scene.frames);
  const Written& w = result.only();
  const std::size_t planes = for_each_plane(w.field("phi"), 2, [&](const Coord& c) {
    if (!(w.field("phi").at(c) > 1e-6)) return;
    for (const std::string& field : fields) {
      const bool by_volume = field == "velocity" || field == "mean_diameter" || field == "temperature";
      for (int k = 0; k < w.field(field).meta.components; ++k) {
        double sum = 0, terms = 0;
        for (const Species& s : p.species) {
          const double weight = by_volume ? w.field("phi_" + s.name).at(c) : 1;
          if (weight == 0) continue;
          const double term = weight * w.field(field + '_' + s.name).at(c, k);
          sum += term;
          terms += std::abs(term);
        }
        if (by_volume) sum /= w.field("phi").at(c), terms /= w.field("phi").at(c);
        // Components cancel within a species; 5 bounds the speeds of the scene.
        const double scale = field == "velocity" ? 5 : field == "contact_stress" ? 0 : terms;
        EXPECT_NEAR(w.field(field).at(c, k), sum, 4 * e * scale + 4 * float_rounding * terms + 1e-6 * terms)
            << field << k;
      }
    }
  });
  EXPECT_GT(planes, 20U);
}

// What is formed of sums over planes is formed of the written ones.
TEST(Planes, RatiosAreOfTheSumsOverPlanes) {
  const Scene scene = walled_scene();
  const Result result = run_on_planes(
      scene.pipeline({"phi", "density", "mean_diameter", "temperature", "stress", "shear_rate", "pressure",
                      "shear_stress", "mu", "inertial_number", "gd_over_dv", "velocity_gradient"}),
      2, scene.frames);
  const Written& w = result.only();
  std::size_t defined = 0;
  for_each_plane(w.field("mu"), 2, [&](const Coord& c) {
    const double mu = w.field("mu").at(c), p = w.field("pressure").at(c);
    const FieldCopy& s = w.field("stress");
    EXPECT_NEAR(p, -(double{s.at(c, 0)} + s.at(c, 4) + s.at(c, 8)) / 3, 1e-5 * std::abs(p) + 1e-12);
    if (std::isnan(mu) || std::isnan(w.field("shear_rate").at(c))) return;
    ++defined;
    EXPECT_NEAR(mu, w.field("shear_stress").at(c) / p, 1e-6 * mu);
    const double d = w.field("mean_diameter").at(c), rate = w.field("shear_rate").at(c);
    const FieldCopy& g = w.field("velocity_gradient");
    // Simple shear and dilation along z: 2 D':D' = γ_x² + γ_y² + 4/3 ε².
    EXPECT_NEAR(rate * rate, std::pow(g.at(c, 2), 2) + std::pow(g.at(c, 5), 2) + 4.0 / 3 * std::pow(g.at(c, 8), 2),
                1e-5 * rate * rate);
    if (const double i = w.field("inertial_number").at(c); !std::isnan(i)) {
      EXPECT_NEAR(i, rate * d * std::sqrt(w.field("density").at(c) / w.field("phi").at(c) / p), 1e-5 * i);
    }
    if (const double f = w.field("gd_over_dv").at(c); !std::isnan(f)) {
      EXPECT_NEAR(f, rate / mu * d / std::sqrt(w.field("temperature").at(c)), 1e-5 * f);
    }
  });
  EXPECT_GT(defined, 10U);
}

TEST(Planes, BytesDoNotDependOnThreads) {
  const Scene scene = periodic_scene();
  const Pipeline p = scene.pipeline({"phi", "velocity", "temperature", "stress", "gd_over_dv", "stress_error"});
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Pipeline few = p;
    few.blocks = 2;
    return run_on_planes(few, 1, scene.frames);
  };
  const Result one = on(1), two = on(2);
  for (const std::string& field : p.fields) {
    const FieldCopy &a = one.only().field(field), &b = two.only().field(field);
    ASSERT_EQ(a.values.size(), b.values.size());
    EXPECT_EQ(std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(float)), 0) << field;
  }
}

}  // namespace
}  // namespace grainvdb::testing::planes_test
