#include "stability/regimes.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ostream>
#include <stdexcept>

#include "support/lattice_packing.hpp"

namespace grainvdb::testing {
namespace {

template <class F>
void for_each_velocity(Scene& scene, F&& change) {
  for (Frame& f : scene.frames)
    for (std::size_t a = 0; a < 3; ++a)
      for (double& v : f.particles.velocity[a]) change(v, a);
}

Scene static_packing() {
  return in_plug_flow(walled_scene(), {0, 0, 0});
}

// A packing that still creeps: velocities far below any that matters, from a dump with six digits.
Scene creeping_packing() {
  Scene scene = walled_scene();
  for_each_velocity(scene, [](double& v, std::size_t) { v = six_digits(1e-12 * v); });
  return scene;
}

// A plug whose velocity varies by a few units of the sixth digit: nothing else is left of its fluctuation.
Scene rounded_plug() {
  Scene scene = walled_scene();
  for_each_velocity(scene, [](double& v, std::size_t a) { v = six_digits(3.5 - static_cast<double>(a) + 1e-5 * v); });
  return scene;
}

Scene without_contacts(Scene scene) {
  for (Frame& f : scene.frames) f.contacts = {};
  return scene;
}

// Grains that fall side by side, faster in every frame.
Scene free_fall() {
  Scene scene = without_contacts(walled_scene());
  double speed = 1.1;
  for (Frame& f : scene.frames) {
    for (std::size_t a = 0; a < 3; ++a)
      std::fill(f.particles.velocity[a].begin(), f.particles.velocity[a].end(), a == 2 ? -speed : 0.0);
    speed += 0.7;
  }
  return scene;
}

Scene gas() {
  return without_contacts(dilute_scene());
}

Scene tension() {
  Scene scene = walled_scene();
  for (Frame& f : scene.frames)
    for (std::vector<double>& force : f.contacts.force)
      for (double& x : force) x = -x;
  return scene;
}

// Forces that cancel in the mean but not at every voxel: pressures of both signs.
Scene mixed_stress() {
  Scene scene = periodic_scene();
  for (Frame& f : scene.frames)
    for (std::size_t k = 0; k < f.contacts.size(); ++k)
      for (std::vector<double>& force : f.contacts.force) force[k] *= k % 2 == 0 ? 1 : -1;
  return scene;
}

Scene isotropic_stress() {
  return {"isotropic", {bonded_packing(6, {-2, -2, -2})}, 0.5, {0.25, 0.25, 0.25}, 3, {}};
}

Scene uniaxial_stress() {
  return {"uniaxial", {bonded_packing(6, {0, 0, -2})}, 0.5, {0.25, 0.25, 0.25}, 3, {}};
}

Scene fast_flow() {
  Scene scene = walled_scene();
  for_each_velocity(scene, [](double& v, std::size_t a) { v += a == 0 ? 3e3 : -2e3; });
  return scene;
}

// Kernels that hold one grain each: the narrowest that a velocity can be interpolated with.
Scene narrow_kernel() {
  Scene scene = walled_scene();
  scene.cutoff = 0.8661;
  return scene;
}

// Half the shortest period.
Scene wide_kernel() {
  Scene scene = periodic_scene();
  scene.cutoff = 3;
  return scene;
}

Scene lone_grain() {
  Scene scene{"lone", {one_particle({0.3, 0.2, 0.1})}, 0.5, {0, 0, 0}, 1.5, {}};
  for (std::size_t a = 0; a < 3; ++a) scene.frames[0].particles.velocity[a][0] = 1.7;
  return scene;
}

// One layer of grains: neighbours along two axes only where the kernels overlap.
Scene monolayer() {
  Scene scene{"layer", {cubic_packing(5, false, [](const Vec3& x) { return Vec3{0.1 * x[1], 0.3, 0}; })}, 1, {}, 1.8,
              {}};
  Particles& all = scene.frames[0].particles;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.position[2][i] > 0) all.type[i] = 2;
  scene.select.types = {1};
  return scene;
}

// Material in one frame only, and wall grains whose contacts reach where no material does.
Scene mostly_empty() {
  Scene scene = walled_scene();
  for (std::size_t k = 1; k < scene.frames.size(); ++k)
    for (int& type : scene.frames[k].particles.type) type = 2;
  return scene;
}

Scene few_selected() {
  Scene scene = periodic_scene();
  scene.select.ids = {11, 40};
  return scene;
}

Scene spinning_alike() {
  Scene scene = walled_scene();
  for (Frame& f : scene.frames)
    for (std::vector<double>& spin : f.particles.angular_velocity) std::fill(spin.begin(), spin.end(), 7.3);
  return scene;
}

}  // namespace

void PrintTo(const Regime& regime, std::ostream* out) {
  *out << regime.name;
}

std::vector<Regime> regimes() {
  return {{"static_packing", static_packing},
          {"creeping_packing", creeping_packing},
          {"rounded_plug", rounded_plug},
          {"free_fall", free_fall},
          {"gas", gas},
          {"tension", tension},
          {"mixed_stress", mixed_stress},
          {"isotropic_stress", isotropic_stress},
          {"uniaxial_stress", uniaxial_stress},
          {"fast_flow", fast_flow},
          {"narrow_kernel", narrow_kernel},
          {"wide_kernel", wide_kernel},
          {"lone_grain", lone_grain},
          {"monolayer", monolayer},
          {"mostly_empty", mostly_empty},
          {"few_selected", few_selected},
          {"spinning_alike", spinning_alike},
          {"shear", walled_scene}};
}

Scene scene_of(const std::string& regime) {
  for (const Regime& r : regimes())
    if (r.name == regime) return r.scene();
  throw std::out_of_range(regime);
}

Scene in_plug_flow(Scene scene, const Vec3& velocity) {
  for_each_velocity(scene, [&](double& v, std::size_t a) { v = velocity[a]; });
  for (Frame& f : scene.frames)
    for (std::vector<double>& spin : f.particles.angular_velocity) std::fill(spin.begin(), spin.end(), 0.0);
  return scene;
}

double six_digits(double x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", x);
  return std::strtod(text.data(), nullptr);
}

Frame bonded_packing(int n, const Vec3& force) {
  Frame f = cubic_packing(n, true, [](const Vec3&) { return Vec3{}; });
  const auto id = [n](int i, int j, int k) { return 1 + ((i % n) * n + j % n) * n + k % n; };
  struct Bond {
    std::int64_t a, b;
    std::size_t axis;
    Vec3 site;
  };
  std::vector<Bond> bonds;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const Vec3 site{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        bonds.push_back({id(i, j, k), id(i + 1, j, k), 0, site});
        bonds.push_back({id(i, j, k), id(i, j + 1, k), 1, site});
        bonds.push_back({id(i, j, k), id(i, j, k + 1), 2, site});
      }
  std::sort(bonds.begin(), bonds.end(),
            [](const Bond& p, const Bond& q) { return std::pair(p.a, p.b) < std::pair(q.a, q.b); });
  for (const Bond& bond : bonds) {
    Vec3 on_a{};
    on_a[bond.axis] = force[bond.axis];
    Vec3 point = bond.site;
    point[bond.axis] += 0.5;
    add_contact(f.contacts, bond.a, bond.b, on_a, point);
  }
  return f;
}

}  // namespace grainvdb::testing
