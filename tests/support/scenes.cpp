#include "support/scenes.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "support/random.hpp"
#include "support/run_in_memory.hpp"

namespace grainvdb::testing {
namespace {

struct Grain {
  std::int64_t id;
  int type;
  Vec3 x, v, spin;
  double radius, mass;
};

double sphere_mass(double density, double radius) {
  return density * 4 / 3 * std::numbers::pi * radius * radius * radius;
}

/// A grain that moves with a shear flow and fluctuates; its density is its own, so that weights by mass and by volume
/// differ.
Grain random_grain(Random& random, std::int64_t id, const Vec3& x, double radius) {
  Grain g{id, 1, x, {}, {}, radius, sphere_mass(random.uniform(1.5, 3.5), radius)};
  const Vec3 noise = random.normal3();
  const Vec3 spin = random.normal3();
  const Vec3 flow{0.8 + 0.15 * x[2], -0.3 + 0.1 * x[0], 0.1 - 0.05 * x[1]};
  for (std::size_t a = 0; a < 3; ++a) {
    g.v[a] = flow[a] + 0.3 * noise[a];
    g.spin[a] = 0.4 + 0.7 * spin[a];
  }
  return g;
}

/// Sites of a jittered cubic lattice between lo and hi; one in ten is left empty.
void fill(Random& random, const Vec3& lo, const Vec3& hi, double jitter, std::vector<Grain>& grains) {
  std::array<int, 3> n{};
  for (std::size_t a = 0; a < 3; ++a) n[a] = static_cast<int>(std::floor((hi[a] - lo[a]) / 0.9));
  std::int64_t id = 11;
  for (int i = 0; i < n[0]; ++i)
    for (int j = 0; j < n[1]; ++j)
      for (int k = 0; k < n[2]; ++k) {
        id += 1 + static_cast<std::int64_t>(random.below(3));
        if (random.uniform() < 0.1) continue;
        Vec3 x;
        const std::array<int, 3> site{i, j, k};
        for (std::size_t a = 0; a < 3; ++a)
          x[a] = lo[a] + (site[a] + 0.5) * (hi[a] - lo[a]) / n[a] + random.uniform(-jitter, jitter);
        grains.push_back(random_grain(random, id, x, random.uniform(0.38, 0.56)));
      }
}

/// Contacts of all touching pairs that hold a mobile grain, with a mostly repulsive force.
void add_contacts(Random& random, Frame& frame) {
  const Particles& p = frame.particles;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = i + 1; j < p.size(); ++j) {
      if (p.type[i] != 1 && p.type[j] != 1) continue;
      Vec3 l;  // from i to j
      double r2 = 0;
      for (int a = 0; a < 3; ++a) {
        const auto axis = static_cast<std::size_t>(a);
        l[axis] = frame.box.minimum_image(a, p.position[axis][j] - p.position[axis][i]);
        r2 += l[axis] * l[axis];
      }
      const double reach = p.radius[i] + p.radius[j];
      if (r2 >= reach * reach) continue;
      const double r = std::sqrt(r2);
      const double push = 5 * (reach - r) * random.uniform(-0.1, 1.5) + 0.2 * random.uniform();
      const Vec3 noise = random.normal3();
      Vec3 force;
      Vec3 point;
      for (std::size_t a = 0; a < 3; ++a) {
        force[a] = -push * l[a] / r + 0.05 * noise[a];
        point[a] = p.position[a][i] + l[a] * p.radius[i] / reach;
      }
      add_contact(frame.contacts, p.id[i], p.id[j], force, point);
    }
}

/// A frame of the grains displaced at random; a few of the mobile ones are absent.
Frame snapshot(Random& random, const Box& box, const std::vector<Grain>& grains, std::int64_t step, double absent) {
  Frame f;
  f.file = "memory";
  f.step = step;
  f.box = box;
  for (const Grain& g : grains) {
    if (g.type == 1 && random.uniform() < absent) continue;
    Vec3 x = g.x;
    Vec3 v = g.v;
    if (g.type == 1) {
      const Vec3 dx = random.normal3();
      const Vec3 dv = random.normal3();
      for (std::size_t a = 0; a < 3; ++a) {
        x[a] += 0.08 * dx[a];
        v[a] += 0.2 * dv[a];
      }
    }
    // Unwrapped coordinates, up to two box lengths off.
    for (std::size_t a = 0; a < 3; ++a)
      if (box.periodic[a] && random.uniform() < 0.05)
        x[a] += box.length(static_cast<int>(a)) * (static_cast<double>(random.below(5)) - 2);
    add_particle(f.particles, g.id, g.type, x, v, g.spin, g.radius, g.mass);
  }
  add_contacts(random, f);
  return f;
}

std::vector<Frame> snapshots(Random& random, const Box& box, const std::vector<Grain>& grains, double absent) {
  std::vector<Frame> frames;
  for (std::int64_t step : {100, 250, 400}) frames.push_back(snapshot(random, box, grains, step, absent));
  return frames;
}

}  // namespace

Pipeline Scene::pipeline(std::vector<std::string> fields) const {
  Pipeline p = make_pipeline(voxel, origin, cutoff, std::move(fields));
  p.select = select;
  if (select.empty()) p.walls.types = {3};  // of which there are none: no grain is a wall
  set_option(p, "contact_stress", "line_integral", std::string("exact"));
  return p;
}

void add_particle(Particles& p, std::int64_t id, int type, const Vec3& x, const Vec3& v, const Vec3& spin,
                  double radius, double mass) {
  p.id.push_back(id);
  p.type.push_back(type);
  for (std::size_t a = 0; a < 3; ++a) {
    p.position[a].push_back(x[a]);
    p.velocity[a].push_back(v[a]);
    p.angular_velocity[a].push_back(spin[a]);
  }
  p.radius.push_back(radius);
  p.mass.push_back(mass);
}

void add_contact(Contacts& c, std::int64_t id1, std::int64_t id2, const Vec3& force, const Vec3& point) {
  c.id1.push_back(id1);
  c.id2.push_back(id2);
  for (std::size_t a = 0; a < 3; ++a) {
    c.force[a].push_back(force[a]);
    c.point[a].push_back(point[a]);
  }
}

Scene periodic_scene() {
  Random random(20240601);
  const Box box{{-1.3, 0.7, -2.1}, {5.2, 6.7, 5.4}, {true, true, true}};
  std::vector<Grain> grains;
  fill(random, box.lo, box.hi, 0.15, grains);
  return {"periodic", snapshots(random, box, grains, 0.03), 0.5, {0.17, -0.31, 0.05}, 2.7, {}};
}

Scene walled_scene() {
  Random random(77);
  const Box box{{-1.3, 0.7, -2}, {4.7, 6.2, 12}, {true, true, false}};
  std::vector<Grain> grains;
  fill(random, {box.lo[0], box.lo[1], 0}, {box.hi[0], box.hi[1], 5}, 0.15, grains);
  grains.push_back(random_grain(random, 4001, {1.0, 3.0, 9.3}, 0.5));
  std::int64_t id = 5000;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      const double x = box.lo[0] + i * box.length(0) / 6;
      const double y = box.lo[1] + j * box.length(1) / 6;
      grains.push_back({++id, 2, {x, y, -0.45}, {0, 0, 0}, {0, 0, 0}, 0.5, 1.5});
      grains.push_back({++id, 3, {x, y, 5.4}, {2, 0, 0}, {0, 0, 0}, 0.5, 1.5});
    }
  Scene scene{"walled", snapshots(random, box, grains, 0.03), 0.5, {0.17, -0.31, 0.05}, 1.9, {}};
  scene.select.types = {1};
  return scene;
}

Scene dilute_scene() {
  Random random(5);
  const Box box{{-6.2, 0.3, -4.9}, {4.3, 9.3, 5.1}, {true, true, true}};
  std::vector<Grain> grains;
  std::int64_t id = 0;
  const auto add = [&](const Vec3& x, double radius) { grains.push_back(random_grain(random, ++id, x, radius)); };
  add({-6.1, 0.35, -4.8}, 0.45);  // a pair across the corner of the box
  add({4.1, 9.1, 4.9}, 0.4);
  add({0.2, 3.1, 0.4}, 0.5);  // a chain of three
  add({0.9, 3.4, 0.8}, 0.5);
  add({1.6, 3.9, 1.3}, 0.5);
  add({-3.5, 7.1, 2.0}, 0.3);  // on its own
  return {"dilute", snapshots(random, box, grains, 0.0), 0.5, {0.17, -0.31, 0.05}, 0.95, {}};
}

Scene moving(Scene scene, std::size_t count) {
  Random random(5);
  const std::size_t given = scene.frames.size();
  for (std::size_t k = given; k < count; ++k) {
    Frame f = scene.frames[k % given];
    f.step = scene.frames.back().step + 10;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t i = 0; i < f.particles.size(); ++i) {
        f.particles.position[a][i] += random.uniform(-0.4, 0.4) * scene.voxel;
        f.particles.velocity[a][i] += random.normal();
      }
    scene.frames.push_back(std::move(f));
  }
  return scene;
}

}  // namespace grainvdb::testing
