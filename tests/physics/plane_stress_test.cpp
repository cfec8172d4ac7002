// Stresses and temperatures as exact averages over planes: by their definitions and in exact cases.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/kernel.hpp"
#include "grainvdb/moment.hpp"
#include "physics/planes_scene.hpp"
#include "support/kernel_sums.hpp"
#include "support/reference.hpp"
#include "support/static_columns.hpp"

namespace grainvdb::testing::planes_test {
namespace {

// Half branches by their definition, with the closed form of the marginal along them (which its own tests hold to
// quadrature).
TEST(PlaneStress, OfContactsEqualsItsDefinition) {
  for (const Scene& scene : {periodic_scene(), walled_scene(), dilute_scene()})
    for (const int axis : {scene.name == "walled" ? 2 : 0, 2}) {
      SCOPED_TRACE(scene.name + std::to_string(axis));
      const auto a = static_cast<std::size_t>(axis);
      const Result result = run_on_planes(scene.pipeline({"contact_stress"}), axis, scene.frames);
      const FieldCopy& stress = result.only().field("contact_stress");
      const BruteForce brute(scene, axis);
      const std::size_t planes = for_each_plane(stress, axis, [&](const Coord& c) {
        std::array<double, 9> sum{}, terms{};
        for (const Frame& f : scene.frames) {
          const Branches b = branches_of(f);
          for (std::size_t n = 0; n < b.size(); ++n) {
            const double w = brute.over_images(f.box, b.start[n][a], brute.centre(c), [&](double z) {
              return brute.kernel().marginal_line_integral(z, b.arm[n][a]);
            });
            for (std::size_t k = 0; k < 9; ++k) {
              const double term = -b.force[n][k / 3] * b.arm[n][k % 3] * w / area_of(f.box, axis) /
                                  static_cast<double>(scene.frames.size());
              sum[k] += term;
              terms[k] += std::abs(term);
            }
          }
        }
        for (int k = 0; k < 9; ++k) {
          const auto at = static_cast<std::size_t>(k);
          EXPECT_NEAR(stress.at(c, k), sum[at], float_rounding * std::abs(sum[at]) + 1e-11 * terms[at] + 1e-25) << k;
        }
      });
      EXPECT_GT(planes, 8U);
    }
}

/// Of velocities up to 5 in single precision.
constexpr double rounding = 5 * e / 10;

/// u at the height of grains: linear between the planes of a written velocity.
Vec3 velocity_at(const FieldCopy& u, int axis, const Lattice& lattice, double position) {
  const double index = lattice.wrap_index(axis, lattice.to_index(axis, position));
  const double below = std::floor(index);
  Vec3 result{};
  for (const int side : {0, 1}) {
    const double share = side == 1 ? index - below : 1 - (index - below);
    const Coord c = in_column(axis, lattice.wrap(axis, static_cast<std::int32_t>(below) + side));
    if (share == 0) continue;
    for (int k = 0; k < 3; ++k) result[static_cast<std::size_t>(k)] += share * u.at(c, k);
  }
  return result;
}

// -Σ m u' u' w₁/A and Σ V u'² w₁/Σ V w₁ about the velocity that was written: of the frame, of the mean over frames, and
// u + L (z_α - z) for moments.
TEST(PlaneStress, FluctuationsEqualTheirDefinition) {
  for (const Scene& scene : {periodic_scene(), walled_scene()})
    for (const char* reference : {"instantaneous", "time_mean", "time_mean_moments"})
      for (const char* weighting : {"volume", "mass"}) {
        const int axis = 2;
        SCOPED_TRACE(scene.name + ' ' + reference + ' ' + weighting);
        Pipeline p = scene.pipeline({"velocity", "velocity_gradient", "kinetic_stress", "temperature"});
        set_option(p, "kinetic_stress", "reference", std::string(reference));
        set_option(p, "velocity", "weighting", std::string(weighting));
        const bool of_frame = std::string(reference) == "instantaneous";
        const std::vector<Frame> frames =
            of_frame ? std::vector<Frame>{scene.frames[0]} : std::vector<Frame>{scene.frames[0], scene.frames[1]};
        const Result result = run_on_planes(p, axis, frames);
        const Written& w = result.only();
        const BruteForce brute(scene, axis);
        const Lattice lattice = lattice_of(scene);
        const bool from_moments = std::string(reference) == "time_mean_moments";
        const std::size_t planes = for_each_plane(w.field("velocity"), axis, [&](const Coord& c) {
          const double z = brute.centre(c);
          std::array<double, 9> stress{}, terms{};
          double volume = 0, heat = 0, density = 0;
          for (const Frame& f : frames) {
            const Particles m = material(f, scene.select);
            std::vector<Vec3> u;
            for (std::size_t n = 0; n < m.size(); ++n)
              u.push_back(velocity_at(w.field("velocity"), axis, lattice, m.position[2][n]));
            for (std::size_t n = 0; n < m.size(); ++n) {
              const auto term = [&](std::size_t k, double d) {
                Vec3 from = u[n];
                if (from_moments)
                  for (int i = 0; i < 3; ++i)
                    from[static_cast<std::size_t>(i)] =
                        w.field("velocity").at(c, i) - d * w.field("velocity_gradient").at(c, 3 * i + axis);
                return -m.mass[n] * (m.velocity[k / 3][n] - from[k / 3]) * (m.velocity[k % 3][n] - from[k % 3]) *
                       brute.kernel().marginal(d) / area_of(f.box, axis) / static_cast<double>(frames.size());
              };
              for (std::size_t k = 0; k < 9; ++k) {
                const double t = brute.over_images(f.box, m.position[2][n], z, [&](double d) { return term(k, d); });
                stress[k] += t;
                terms[k] += std::abs(t);
              }
              const double v =
                  sphere_volume(m.radius[n]) *
                  brute.over_images(f.box, m.position[2][n], z, [&](double d) { return brute.kernel().marginal(d); });
              volume += v;
              density += m.mass[n] / sphere_volume(m.radius[n]) * v / area_of(f.box, axis);
              for (std::size_t i = 0; i < 3; ++i) heat += v * std::pow(m.velocity[i][n] - u[n][i], 2);
            }
          }
          for (int k = 0; k < 9; ++k) {
            const auto at = static_cast<std::size_t>(k);
            // u of float fields here and of sums there differs by rounding, of which a lone grain shows the square.
            const double trace = terms[0] + terms[4] + terms[8];
            EXPECT_NEAR(w.field("kinetic_stress").at(c, k), stress[at], 2 * e * trace + density * rounding * rounding)
                << k << " at " << c[axis];
          }
          if (of_frame && volume > 0) {
            EXPECT_NEAR(w.field("temperature").at(c), heat / volume, 3 * e * heat / volume + rounding * rounding)
                << c[axis];
          }
        });
        EXPECT_GT(planes, 8U);
      }
}

// A large mean velocity hides nothing of the fluctuations.
TEST(PlaneStress, LoseNothingToALargeVelocity) {
  Scene scene = periodic_scene();
  const Pipeline p = scene.pipeline({"temperature", "kinetic_stress"});
  std::vector<Frame> frames{scene.frames[0]};
  const Result at_rest = run_on_planes(p, 2, frames);
  for (double& v : frames[0].particles.velocity[0]) v += 1e4;
  const Result fast = run_on_planes(p, 2, frames);
  for_each_plane(at_rest.only().field("temperature"), 2, [&](const Coord& c) {
    const double t = at_rest.only().field("temperature").at(c);
    EXPECT_NEAR(fast.only().field("temperature").at(c), t, 1e-4 * t);
    for (const int k : {0, 2, 8}) {
      const double s = at_rest.only().field("kinetic_stress").at(c, 8);
      EXPECT_NEAR(fast.only().field("kinetic_stress").at(c, k), at_rest.only().field("kinetic_stress").at(c, k),
                  1e-3 * std::abs(s));
    }
  });
}

// Physics section 6, to what a float holds: -A σ_zz(z) = Σ m g CDF((z_α - z)/c), and without the half branches in the
// wall less the forces of the wall, Σ F CDF((z_c - z)/c): that is ∂σ_zz/∂z + f_z = ρ g integrated from z upwards.
TEST(PlaneStress, OfAColumnAtRestCarriesItsWeight) {
  const StaticColumns columns(31);
  const double c = 3;
  Pipeline p = make_pipeline(0.5, {0, 0, 0.1}, c, {"contact_stress", "wall_force", "density"});
  p.select.types = {1};
  for (const bool whole : {true, false}) {
    set_option(p, "contact_stress", "wall_contacts", std::string(whole ? "include" : "exclude"));
    const Result result = run_on_planes(p, 2, {columns.frame});
    const FieldCopy& stress = result.only().field("contact_stress");
    std::size_t compared = 0;
    for_each_plane(stress, 2, [&](const Coord& at) {
      const double z = 0.1 + (at.z + 0.5) * 0.5;
      if (whole && z < c) return;  // branches in the floor count below
      double expected = 0;
      for (std::size_t n = 0; n < columns.height.size(); ++n)
        expected += columns.weight[n] * marginal_cdf((columns.height[n] - z) / c);
      if (!whole)
        for (std::size_t n = 0; n < columns.foot_height.size(); ++n)
          expected -= columns.foot_load[n] * marginal_cdf((columns.foot_height[n] - z) / c);
      EXPECT_NEAR(-columns.area() * stress.at(at, 8), expected,
                  float_rounding * std::abs(expected) + 1e-10 * columns.total_weight())
          << z;
      ++compared;
    });
    EXPECT_GE(compared, 20U);
  }
}

/// The columns on a wall that is no grain: contacts with the grains below them become contacts with it.
Frame on_a_mesh(const StaticColumns& columns) {
  Frame frame = columns.frame;
  const Particles& p = columns.frame.particles;
  frame.contacts = {};
  const Contacts& all = columns.frame.contacts;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Vec3 force{all.force[0][k], all.force[1][k], all.force[2][k]};
    const Vec3 point{all.point[0][k], all.point[1][k], all.point[2][k]};
    const auto below = static_cast<std::size_t>(std::find(p.id.begin(), p.id.end(), all.id2[k]) - p.id.begin());
    if (p.type[below] == 1) {
      add_contact(frame.contacts, all.id1[k], all.id2[k], force, point);
      continue;
    }
    frame.wall_contacts.id.push_back(all.id1[k]);
    for (std::size_t a = 0; a < 3; ++a) {
      frame.wall_contacts.force[a].push_back(force[a]);
      frame.wall_contacts.point[a].push_back(point[a]);
    }
  }
  return frame;
}

// Contacts with walls have a half branch in the grain alone, so that stress and force of the wall balance either way.
TEST(PlaneStress, TakesInContactsWithWalls) {
  const StaticColumns columns(31);
  const double c = 3;
  Pipeline p = make_pipeline(0.5, {0, 0, 0.1}, c, {"contact_stress", "wall_force"});
  p.select.types = {1};
  const Frame frame = on_a_mesh(columns);
  ASSERT_EQ(frame.wall_contacts.size(), columns.foot_height.size());
  const Result result = run_on_planes(p, 2, {frame});
  const double allowed = 1e-10 * columns.total_weight();
  const std::size_t planes = for_each_plane(result.only().field("contact_stress"), 2, [&](const Coord& at) {
    const double z = 0.1 + (at.z + 0.5) * 0.5;
    double below = 0, of_wall = 0;
    for (std::size_t n = 0; n < columns.height.size(); ++n)
      below += columns.weight[n] * marginal_cdf((columns.height[n] - z) / c);
    for (std::size_t n = 0; n < columns.foot_height.size(); ++n) {
      below -= columns.foot_load[n] * marginal_cdf((columns.foot_height[n] - z) / c);
      of_wall += columns.foot_load[n] * LucyKernel(c).marginal(z - columns.foot_height[n]);
    }
    EXPECT_NEAR(-columns.area() * result.only().field("contact_stress").at(at, 8), below,
                float_rounding * std::abs(below) + allowed);
    EXPECT_NEAR(columns.area() * result.only().field("wall_force").at(at, 2), of_wall,
                float_rounding * std::abs(of_wall) + allowed);
  });
  EXPECT_GT(planes, 20U);
}

}  // namespace
}  // namespace grainvdb::testing::planes_test
