// Fields beside walls, in each of the ways to treat the kernel there.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "physics/walls_scene.hpp"
#include "support/kernel_sums.hpp"
#include "support/random.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"
#include "support/static_columns.hpp"

namespace grainvdb::testing::walls_test {
namespace {

using namespace testing::walls_scene;  // NOLINT: what the tests of this scene share

// Layers at (k + ½) s above a wall at 0 are the midpoint rule for the kernel's part inside, off by (s²/24) w₁'(z) with
// w₁' = -(210/16) ζ (1+3ζ) (1-ζ)³ (c = 1); the next term is of the order of s⁴/100. In the planes the lattice is as
// good as a continuum to 4e-6.
TEST(Walls, RenormalisedPackingFractionIsConstantUpToAPlane) {
  for (const double z : {0.0, 0.1, 0.25, 0.5, 0.75}) {
    const double h = 0.2;
    Pipeline p = with_walls(Kernel::cut, h, {0, 0, z - h / 2}, {"phi"});
    p.walls.faces = {{2, false}};
    const double cut = static_cast<double>(run(p, {layers()}).only().field("phi").at({3, 3, 0}));
    p.walls.kernel = Kernel::renormalise;
    const double found = static_cast<double>(run(p, {layers()}).only().field("phi").at({3, 3, 0}));
    const double inside = marginal_cdf(z);
    const double layers_off = spacing * spacing / 24 * 210.0 / 16 * z * (1 + 3 * z) * std::pow(1 - z, 3);
    EXPECT_NEAR(cut, inside, layers_off + 1e-5) << z;
    EXPECT_NEAR(found, 1, (layers_off + 1e-5) / inside) << z;
    EXPECT_NEAR(cut / found, inside, 1e-6) << z;
  }
}

// The images complete the lattice, which ripples by 4e-6 at c = 10 s; sums are good to 1e-5. Between walls nearer than
// a kernel, and in corners, by images of images.
TEST(Walls, MirroredPackingFractionIsConstantEverywhere) {
  struct Case {
    Frame frame;
    std::vector<BoxFace> faces;
  };
  for (const Case& k :
       {Case{layers(), {{2, false}}},
        Case{filled({0.6, 1.2, 2}, {false, false, true}), {{0, false}, {0, true}, {1, false}, {1, true}}},
        Case{filled({1, 1, 1}, {false, false, false}),
             {{0, false}, {0, true}, {1, false}, {1, true}, {2, false}, {2, true}}}}) {
    Pipeline p = with_walls(Kernel::mirror, 0.2, {0, 0, 0}, {"phi"});
    p.walls.faces = k.faces;
    const Result r = run(p, {k.frame});
    std::size_t inside = 0, behind = 0;
    r.only().field("phi").for_each_active([&](const Coord& c) {
      bool in = true;
      for (const BoxFace& face : k.faces) {
        const double x = (c[face.axis] + 0.5) * p.voxel;
        in = in && (face.high ? x <= k.frame.box.hi[static_cast<std::size_t>(face.axis)] : x >= 0);
      }
      const auto phi = static_cast<double>(r.only().field("phi").at(c));
      EXPECT_EQ((r.only().mask_at(c) & bit(Reason::behind_wall)) == 0, in);
      EXPECT_EQ(std::isnan(phi), !in);
      ++(in ? inside : behind);
      // Away from the free surface of the layers.
      if (in && (c.z + 1.5) * p.voxel < 1.5) {
        EXPECT_NEAR(phi, 1, 1.5e-5);
      }
    });
    EXPECT_GT(inside, 0U);
    EXPECT_GT(behind, 0U);
  }
}

// What leaks through the wall comes back: the voxels inside hold all of the material where the voxels are their own
// mirror images, to what the lattice makes of a grain.
TEST(Walls, MirrorKeepsTheVolume) {
  Random random(8);
  Frame f;
  f.file = "memory";
  f.box = {{0, 0, 0}, {3, 3, 2}, {true, true, false}};
  double volume = 0;
  for (int i = 0; i < 40; ++i) {
    const double r = random.uniform(0.2, 0.4);
    add_particle(f.particles, i + 1, 1, {random.uniform(0, 3), random.uniform(0, 3), random.uniform(0, 2)}, {0, 0, 0},
                 {0, 0, 0}, r, 1);
    volume += 4.0 / 3 * std::numbers::pi * r * r * r;
  }
  Pipeline p = with_walls(Kernel::mirror, 0.25, {0, 0, 0}, {"phi"});
  p.walls.faces = {{2, false}, {2, true}};
  const Result r = run(p, {f});
  double sum = 0;
  r.only().field("phi").for_each_active([&](const Coord& c) {
    const auto phi = static_cast<double>(r.only().field("phi").at(c));
    if (!std::isnan(phi)) sum += phi * std::pow(p.voxel, 3);
  });
  EXPECT_NEAR(sum / volume, 1, grain_volume_error(4));
}

/// Rings of grains (k + ½) s about an axis, each with the volume of its part of a cylinder of radius 2.
Frame column() {
  Frame f;
  f.file = "memory";
  f.box = {{-4, -4, 0}, {4, 4, 2}, {false, false, true}};
  std::int64_t id = 0;
  for (int ring = 0; ring < 20; ++ring) {
    const double r = (ring + 0.5) * spacing;
    const int n = static_cast<int>(std::ceil(2 * std::numbers::pi * r / spacing));
    const double volume = 2 * std::numbers::pi * r * spacing * spacing / n;
    for (int k = 0; k < 20; ++k)
      for (int i = 0; i < n; ++i) {
        const double angle = 2 * std::numbers::pi * (i + 0.5 * (k % 2)) / n;
        add_particle(f.particles, ++id, 1, {r * std::cos(angle), r * std::sin(angle), (k + 0.5) * spacing}, {0, 0, 0},
                     {0, 0, 0}, radius_of(volume), 1);
      }
  }
  return f;
}

// The rings are a midpoint rule along the radius, as the layers above are beside a plane: off by 1e-3 at the wall, of a
// part of the kernel inside that is 0.45 at the least, and by (s²/24) 2π ∫W dz = 4.4e-3 on the axis, where ∫W dz
// = 1.671 along a line through the centre.
TEST(Walls, RenormalisedPackingFractionIsConstantUpToACylinder) {
  Pipeline p = with_walls(Kernel::renormalise, 0.25, {0, 0, 0}, {"phi"});
  p.walls.surfaces = {{Wall::Shape::cylinder, {0, 0, 7}, {0, 0, -2}, 2}};
  const Result r = run(p, {column()});
  p.walls.kernel = Kernel::cut;
  const Result cut = run(p, {column()});
  double least = 1;
  std::size_t checked = 0;
  r.only().field("phi").for_each_active([&](const Coord& c) {
    const auto phi = static_cast<double>(r.only().field("phi").at(c));
    const double distance = 2 - std::hypot((c.x + 0.5) * p.voxel, (c.y + 0.5) * p.voxel);
    EXPECT_EQ(std::isnan(phi), distance < 0);
    if (distance < 0) return;
    ++checked;
    least = std::min(least, static_cast<double>(cut.only().field("phi").at(c)));
    EXPECT_NEAR(phi, 1, distance < 1 ? 3e-3 : 5e-3) << "at " << distance << " from the wall";
  });
  EXPECT_GT(checked, 1000U);
  EXPECT_LT(least, 0.55);  // so much was there to be made good
}

/// A frame's grains that are not behind a wall.
Frame inside(Frame f, const WallDomain& domain) {
  const Particles all = f.particles;
  f.particles = {};
  const auto row = [](const Columns3& v, std::size_t n) { return Vec3{v[0][n], v[1][n], v[2][n]}; };
  for (std::size_t n = 0; n < all.size(); ++n)
    if (domain.contains(row(all.position, n)))
      add_particle(f.particles, all.id[n], all.type[n], row(all.position, n), row(all.velocity, n), {0, 0, 0},
                   all.radius[n], all.mass[n]);
  return f;
}

// Whatever the walls, sums are of the grains inside and divided by what WallDomain says of the voxel; beside one
// cylinder, from a table of what it says elsewhere at the same distance, which may err by 4e-3 as it may itself.
TEST(Walls, SumsAreDividedByThePartInside) {
  const std::vector<Wall> corner{{Wall::Shape::plane, {0, 0, 0.3}, {0, 0, 1}},
                                 {Wall::Shape::plane, {0.3, 0, 0}, {1, 0, 0.2}}};
  const std::vector<Wall> tube{{Wall::Shape::cylinder, {1, 1, 0}, {0, 0.1, 1}, 0.7}};
  const std::vector<Wall> post{{Wall::Shape::cylinder, {1, 1, 0}, {0.1, 0, 1}, 0.3, 0, false}};
  const std::vector<Wall> hopper{{Wall::Shape::cone, {1, 1, -0.4}, {0, 0, 1}, 0, 0.6}, floor_at(0.4)};
  const Frame all = filled({2, 2, 2}, {false, false, false});
  constexpr double rounding = 1e-6, quadrature = 2 * 4e-3;
  for (const auto& [walls, error] :
       {std::pair{corner, rounding}, {tube, quadrature}, {post, quadrature}, {hopper, rounding}}) {
    Pipeline p = with_walls(Kernel::renormalise, 0.25, {0.1, 0.05, 0}, {"phi", "velocity", "density"});
    p.walls.surfaces = walls;
    const WallDomain domain(walls);
    const Result r = run(p, {all});
    p.walls.kernel = Kernel::cut;
    const Result cut = run(p, {inside(all, domain)});
    std::size_t checked = 0;
    r.only().field("phi").for_each_active([&](const Coord& c) {
      Vec3 x;
      for (int a = 0; a < 3; ++a)
        x[static_cast<std::size_t>(a)] = p.origin[static_cast<std::size_t>(a)] + (c[a] + 0.5) * p.voxel;
      const auto value = [&](const Result& result, const char* name) {
        return static_cast<double>(result.only().field(name).at(c));
      };
      EXPECT_EQ(std::isnan(value(r, "phi")), !domain.contains(x));
      if (!domain.contains(x)) return;
      const double inside = domain.inside_fraction(LucyKernel(1), x);
      if (inside < 1) ++checked;
      for (const char* name : {"phi", "density"})
        EXPECT_NEAR(value(r, name) * inside, value(cut, name), error * value(r, name)) << name;
      // A ratio is what it was, to the rounding of a float.
      EXPECT_NEAR(value(r, "velocity"), value(cut, "velocity"), 2e-7 * std::abs(value(cut, "velocity")));
    });
    EXPECT_GT(checked, 50U);
  }
}

/// The grains of type 1 above z = 0 of a scene with walls, and the contacts among them.
Frame grains_alone() {
  const Frame all = walled_scene().frames[0];
  Frame f;
  f.file = all.file;
  f.box = all.box;
  std::map<std::int64_t, bool> kept;
  const Particles& q = all.particles;
  for (std::size_t n = 0; n < q.size(); ++n) {
    const auto column = [&](const Columns3& v) { return Vec3{v[0][n], v[1][n], v[2][n]}; };
    if (q.type[n] != 1 || q.position[2][n] < 0) continue;
    kept[q.id[n]] = true;
    add_particle(f.particles, q.id[n], 1, column(q.position), column(q.velocity), column(q.angular_velocity),
                 q.radius[n], q.mass[n]);
  }
  for (std::size_t k = 0; k < all.contacts.size(); ++k) {
    if (!kept.contains(all.contacts.id1[k]) || !kept.contains(all.contacts.id2[k])) continue;
    add_contact(f.contacts, all.contacts.id1[k], all.contacts.id2[k],
                {all.contacts.force[0][k], all.contacts.force[1][k], all.contacts.force[2][k]},
                {all.contacts.point[0][k], all.contacts.point[1][k], all.contacts.point[2][k]});
  }
  return f;
}

/// The same with the mirror image of every grain and contact behind z = 0.
Frame with_all_images(Frame f) {
  const std::int64_t image = 1'000'000;
  const std::size_t grains = f.particles.size();
  for (std::size_t n = 0; n < grains; ++n) {
    const Particles& q = f.particles;
    const Vec3 x{q.position[0][n], q.position[1][n], -q.position[2][n]};
    const Vec3 v{q.velocity[0][n], q.velocity[1][n], -q.velocity[2][n]};
    const Vec3 w{-q.angular_velocity[0][n], -q.angular_velocity[1][n], q.angular_velocity[2][n]};
    add_particle(f.particles, q.id[n] + image, 1, x, v, w, q.radius[n], q.mass[n]);
  }
  const std::size_t contacts = f.contacts.size();
  for (std::size_t k = 0; k < contacts; ++k) {
    const Contacts& c = f.contacts;
    add_contact(f.contacts, c.id1[k] + image, c.id2[k] + image, {c.force[0][k], c.force[1][k], -c.force[2][k]},
                {c.point[0][k], c.point[1][k], -c.point[2][k]});
  }
  return f;
}

// Images near the wall stand for all of them: every field is what it is with each grain mirrored by hand, whatever
// interpolates between voxels and grains on the way. Only the order of summation differs.
TEST(Walls, ImagesGoAsDeepAsFieldsNeed) {
  const Frame f = grains_alone();
  Pipeline p = walled_scene().pipeline({"phi", "velocity", "temperature", "rotational_fluctuation", "contact_stress",
                                        "kinetic_stress", "shear_rate", "angular_velocity"});
  p.origin[2] = 0;
  set_option(p, "temperature", "self_weight", std::string("corrected"));
  p.walls.surfaces = {floor_at(0)};
  p.walls.kernel = Kernel::mirror;
  const Result r = run(p, {f});
  p.walls = {};
  const Result whole = run(p, {with_all_images(f)});
  std::map<std::string, double> scale;
  for (const auto& [name, field] : whole.only().fields)
    for (const float v : field.values)
      if (std::isfinite(v)) scale[name] = std::max(scale[name], std::abs(static_cast<double>(v)));
  std::size_t inside = 0;
  whole.only().field("phi").for_each_active([&](const Coord& c) {
    if (c.z < 0) return;
    ++inside;
    for (const std::string& name : p.fields)
      for (int k = 0; k < whole.only().field(name).meta.components; ++k) {
        const auto expected = static_cast<double>(whole.only().field(name).at(c, k));
        const auto found = static_cast<double>(r.only().field(name).at(c, k));
        EXPECT_EQ(std::isnan(found), std::isnan(expected)) << name;
        if (!std::isnan(expected)) {
          EXPECT_NEAR(found, expected, 1e-5 * scale[name]) << name << ' ' << c.z;
        }
      }
  });
  EXPECT_GT(inside, 1000U);
}

// Both leave the values where the kernel is whole alone, and differ at the wall. Velocities near it stay those of the
// grains on one side: of a shear rate γ̇ next to a wall, renormalised sums show 1 - w₁(0) M/¼ = 0.385, with
// M = 21/16 (1/30 + 4/105 + 1/56) the first moment of half the marginal; mirrored ones 0. As a midpoint rule the layers
// add (s²/24) w₁(0) to M, and -(s²/24) w₁''(0) = (s²/24) 210/16 to w₁(0); the next terms are 1e-4.
TEST(Walls, GradientsAtAWallAreThoseOfTheSmoothedVelocity) {
  const double layer = spacing * spacing / 24;
  const double moment = 21.0 / 16 * (1.0 / 30 + 4.0 / 105 + 1.0 / 56) + layer * 21 / 16;
  const double renormalised = 1 - (21.0 / 16 + layer * 210 / 16) * moment / 0.25;
  EXPECT_NEAR(renormalised, 0.385, 0.006);
  for (const auto& [kernel, expected] : {std::pair{Kernel::renormalise, renormalised}, {Kernel::mirror, 0.0}}) {
    Pipeline p = with_walls(kernel, 0.2, {0, 0, -0.1}, {"velocity_gradient"});
    p.walls.surfaces = {floor_at(0)};
    set_option(p, "velocity_gradient", "method", std::string("kernel"));
    const Result r = run(p, {layers()});
    EXPECT_NEAR(static_cast<double>(r.only().field("velocity_gradient").at({4, 4, 0}, 2)), expected, 1e-3);
    EXPECT_NEAR(static_cast<double>(r.only().field("velocity_gradient").at({4, 4, 6}, 2)), 1, 1e-4);
  }
}

}  // namespace
}  // namespace grainvdb::testing::walls_test
