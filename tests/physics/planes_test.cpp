// Fields as exact averages over planes: against those on voxels, by their definitions, and in exact cases.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "grainvdb/kernel.hpp"
#include "grainvdb/moment.hpp"
#include "support/kernel_sums.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"
#include "support/static_columns.hpp"

namespace grainvdb::testing::planes_test {
namespace {

/// What a sum in single precision may err by, relative to Σ |terms|.
constexpr double e = 1e-5;

double area_of(const Box& box, int axis) {
  return box.length((axis + 1) % 3) * box.length((axis + 2) % 3);
}

Result run_on_planes(Pipeline p, int axis, const std::vector<Frame>& frames) {
  p.planes = Planes{axis, area_of(frames[0].box, axis)};
  return run(p, frames);
}

/// The voxel of a plane, of a column that has one voxel along the planes.
Coord in_column(int axis, int plane) {
  return shifted({0, 0, 0}, axis, plane);
}

/// The plane run of every voxel of the column.
template <class F>
std::size_t for_each_plane(const FieldCopy& f, int axis, const F& body) {
  std::size_t planes = 0;
  f.for_each_active([&](const Coord& c) {
    EXPECT_EQ(c, in_column(axis, c[axis]));
    body(c);
    ++planes;
  });
  return planes;
}

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

/// Sums over the planes by their definition: Σ q w₁(z - z_α)/A over grains and their images.
class BruteForce {
 public:
  BruteForce(const Scene& scene, int axis) : scene_(scene), axis_(axis), kernel_(scene.cutoff) {}

  double centre(const Coord& c) const {
    return scene_.origin[static_cast<std::size_t>(axis_)] + (c[axis_] + 0.5) * scene_.voxel;
  }
  /// f(z) of every image, z from there to the plane.
  double over_images(const Box& box, double start, double z, const std::function<double(double)>& f) const {
    if (!box.periodic[static_cast<std::size_t>(axis_)]) return f(z - start);
    double sum = 0;
    const double length = box.length(axis_);
    const double d = (z - start) - length * std::round((z - start) / length);
    for (int k = -2; k <= 2; ++k) sum += f(d + k * length);
    return sum;
  }
  double sum(const Frame& frame, const Particles& p, double z, const std::function<double(std::size_t)>& q) const {
    double sum = 0;
    for (std::size_t n = 0; n < p.size(); ++n)
      sum += q(n) * over_images(frame.box, p.position[static_cast<std::size_t>(axis_)][n], z,
                                [&](double d) { return kernel_.marginal(d); });
    return sum / area_of(frame.box, axis_);
  }
  const LucyKernel& kernel() const { return kernel_; }

 private:
  const Scene& scene_;
  int axis_;
  LucyKernel kernel_;
};

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
        EXPECT_GT(compared, 400U);
      }
}

// Half branches by their definition, with the closed form of the marginal along them (which its own tests hold to
// quadrature).
TEST(Planes, ContactStressEqualsItsDefinition) {
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
      EXPECT_GT(planes, 14U);
    }
}

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

Lattice lattice_of(const Scene& scene) {
  Lattice lattice(scene.voxel, scene.origin);
  lattice.set_periods(scene.frames[0].box);
  return lattice;
}

// -Σ m u' u' w₁/A and Σ V u'² w₁/Σ V w₁ about the velocity that was written: of the frame, of the mean over frames, and
// u + L (z_α - z) for moments.
TEST(Planes, FluctuationsEqualTheirDefinition) {
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
          double volume = 0, heat = 0;
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
              for (std::size_t i = 0; i < 3; ++i) heat += v * std::pow(m.velocity[i][n] - u[n][i], 2);
            }
          }
          for (int k = 0; k < 9; ++k) {
            const auto at = static_cast<std::size_t>(k);
            // u, from float fields here and from sums in double there, to single precision.
            const double trace = terms[0] + terms[4] + terms[8];
            EXPECT_NEAR(w.field("kinetic_stress").at(c, k), stress[at], 2 * e * trace) << k << " at " << c[axis];
          }
          if (of_frame && volume > 0)
            EXPECT_NEAR(w.field("temperature").at(c), heat / volume, 3 * e * heat / volume) << c[axis];
        });
        EXPECT_GT(planes, 14U);
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

// A large mean velocity hides nothing of the fluctuations.
TEST(Planes, LoseNothingToALargeVelocity) {
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
TEST(Planes, StressOfAColumnAtRestCarriesItsWeight) {
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
    EXPECT_GT(compared, 20U);
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
    if (std::isnan(mu)) return;
    ++defined;
    EXPECT_NEAR(mu, w.field("shear_stress").at(c) / p, 1e-6 * mu);
    const double d = w.field("mean_diameter").at(c), rate = w.field("shear_rate").at(c);
    const FieldCopy& g = w.field("velocity_gradient");
    // Simple shear and dilation along z: 2 D':D' = γ_x² + γ_y² + 4/3 ε².
    EXPECT_NEAR(rate * rate, std::pow(g.at(c, 2), 2) + std::pow(g.at(c, 5), 2) + 4.0 / 3 * std::pow(g.at(c, 8), 2),
                1e-5 * rate * rate);
    if (const double i = w.field("inertial_number").at(c); !std::isnan(i))
      EXPECT_NEAR(i, rate * d * std::sqrt(w.field("density").at(c) / w.field("phi").at(c) / p), 1e-5 * i);
    if (const double f = w.field("gd_over_dv").at(c); !std::isnan(f))
      EXPECT_NEAR(f, rate / mu * d / std::sqrt(w.field("temperature").at(c)), 1e-5 * f);
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
