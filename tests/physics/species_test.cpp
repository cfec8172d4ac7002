// Partial fields of species against those of all grains.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "grainvdb/kernel.hpp"
#include "grainvdb/mask.hpp"
#include "grainvdb/measurement.hpp"
#include "support/lattice_packing.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::species_test {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
/// Of the sums of the walled scene, which has diameters from 0.76 to 1.12.
constexpr double middle = 0.94;
/// What a sum in a float grid may err by, relative to Σ |terms|.
constexpr double e = 1e-5;
constexpr double least = std::numeric_limits<float>::min();

/// Each particle of the walled scene is in one; the last is no material.
std::vector<Species> by_size_and_wall() {
  return {{"fine", {1}, {}, std::pair(0.0, middle)},
          {"coarse", {1}, {}, std::pair(middle, unbounded)},
          {"wall", {2, 3}, {}, {}}};
}

Pipeline with(Pipeline p, std::vector<Species> species) {
  const std::vector<std::string> fields = p.fields;
  for (const Species& s : species)
    for (const std::string& field : fields) p.fields.push_back(field + '_' + s.name);
  p.species = std::move(species);
  return p;
}

/// Σ over species of a field, times another where one is named; a field without a value must have no weight.
double sum_over(const std::vector<Species>& species, const Written& w, const Coord& c, const std::string& field,
                int component, const std::string& weight) {
  double sum = 0;
  for (const Species& s : species) {
    const double q = w.field(field + '_' + s.name).at(c, component);
    const double by = weight.empty() ? 1 : w.field(weight + '_' + s.name).at(c);
    EXPECT_EQ(std::isnan(q), by == 0) << field << '_' << s.name;
    if (by != 0) sum += by * q;
  }
  return sum;
}

/// Σ |F| |a| over all half branches of the mean frame, with arms no longer than the largest radius: a bound of what
/// stands before W(0) in a sum over contacts.
double most_of_contacts(const Scene& scene) {
  double sum = 0;
  for (const Frame& f : scene.frames) {
    const double radius = *std::max_element(f.particles.radius.begin(), f.particles.radius.end());
    for (std::size_t k = 0; k < f.contacts.size(); ++k)
      sum += 2 * radius * std::hypot(f.contacts.force[0][k], f.contacts.force[1][k], f.contacts.force[2][k]);
  }
  return sum / static_cast<double>(scene.frames.size());
}

bool same_bytes(const FieldCopy& a, const FieldCopy& b) {
  return a.values.size() == b.values.size() &&
         std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(float)) == 0;
}

// Both sides are sums that err by up to e Σ |terms|, and the terms of all species are those of the whole: sums differ
// by 2 e Σ |terms|. In w q with q = N/w, w errs by e w, N by e M and q by (e M + e |q| w)/w: 3 e M, and a little of
// second order, on either side. On the rim of the support sums fall below the least normal float, where they err by up
// to that number l: N by l and w by l make l + |q| l of w q, and as much again of its product. The deviations from the
// mean in the terms are the same numbers on both sides.
TEST(Species, PartialFieldsAddUpToTheWhole) {
  const Scene scene = walled_scene();
  const std::vector<Species> species = by_size_and_wall();
  const LucyKernel kernel(scene.cutoff);
  for (const char* weighting : {"volume", "mass"}) {
    SCOPED_TRACE(weighting);
    Pipeline p = scene.pipeline({"phi", "density", "velocity", "temperature", "contact_stress", "kinetic_stress"});
    set_option(p, "velocity", "weighting", std::string(weighting));
    const Reference reference = coarse_grain(scene.frames, p);
    set_option(p, "contact_stress", "line_integral", std::string("adaptive"));
    p = with(p, species);
    p.fields.push_back("mask");
    const Written w = run(p, scene.frames).only();

    // The points of adaptive integrals leave terms that err by up to 3e-5 W(0).
    const double rules = 3e-5 * kernel.value(0) * most_of_contacts(scene);
    const std::string weight = std::string(weighting) == "mass" ? "density" : "phi";
    const auto magnitude = [&](const std::string& field, std::size_t n, int c) {
      const ReferenceField& f = reference.fields.at(field);
      return f.magnitude[f.index(n, c)];
    };
    std::size_t checked = 0;
    w.field("phi").for_each_active([&](const Coord& c) {
      const std::size_t n = reference.box.index(c).value();
      const auto differ = [&](const std::string& field, int k, const std::string& by) {
        const double all = w.field(field).at(c, k) * (by.empty() ? 1 : w.field(by).at(c));
        return std::abs(sum_over(species, w, c, field, k, by) - (std::isnan(all) ? 0 : all));
      };
      const auto ratio = [&](const std::string& field, int k, const std::string& by) {
        const double m = magnitude(by, n, 0);
        const double q = magnitude(field, n, k);
        EXPECT_LE(differ(field, k, by), m > 0 ? 6.01 * e * m * q + 4 * least * (1 + q) : 0) << field << k;
      };
      EXPECT_LE(differ("phi", 0, {}), 2 * e * magnitude("phi", n, 0));
      EXPECT_LE(differ("density", 0, {}), 2 * e * magnitude("density", n, 0));
      for (int k = 0; k < 3; ++k) ratio("velocity", k, weight);
      ratio("temperature", 0, "phi");
      for (int k = 0; k < 9; ++k) {
        EXPECT_LE(differ("contact_stress", k, {}), 2 * e * (magnitude("contact_stress", n, k) + rules)) << k;
        EXPECT_LE(differ("kinetic_stress", k, {}), 2 * e * magnitude("kinetic_stress", n, k)) << k;
      }
      // The walls are grains with contacts, but no material; where there is any, it is not missing.
      EXPECT_EQ(w.field("phi_wall").at(c), 0);
      EXPECT_TRUE(w.mask_at(c) & static_cast<std::uint32_t>(Reason::no_species));
      EXPECT_EQ((w.mask_at(c) & static_cast<std::uint32_t>(Reason::no_material)) == 0, w.field("phi").at(c) > 0);
      ++checked;
    });
    EXPECT_GT(checked, 1000U);
  }
}

// A species is what a run finds that knows of no other grains; contact stress, where all others are walls whose half
// branches are left out.
TEST(Species, IsAsIfOtherGrainsWereNotThere) {
  const Scene scene = walled_scene();
  Pipeline p = scene.pipeline({"phi", "density", "velocity", "mean_diameter", "contact_stress"});
  const Written w = run(with(p, by_size_and_wall()), scene.frames).only();

  std::vector<Frame> frames = scene.frames;
  double fastest = 0;
  for (Frame& f : frames)
    for (std::size_t i = 0; i < f.particles.size(); ++i) {
      if (f.particles.type[i] == 1 && 2 * f.particles.radius[i] >= middle) f.particles.type[i] = 4;
      for (std::size_t a = 0; a < 3; ++a) fastest = std::max(fastest, std::abs(f.particles.velocity[a][i]));
    }
  p.walls.types = {2, 3, 4};
  set_option(p, "contact_stress", "wall_contacts", std::string("exclude"));
  const Written alone = run(p, frames).only();

  const double kernel = LucyKernel(scene.cutoff).value(0);
  std::size_t material = 0, stressed = 0;
  w.field("phi").for_each_active([&](const Coord& c) {
    const auto expect_near = [&](const char* field, int k, double bound) {
      const double partial = w.field(std::string(field) + "_fine").at(c, k), expected = alone.field(field).at(c, k);
      if (std::isnan(expected) || std::isnan(partial)) {
        EXPECT_EQ(std::isnan(partial), alone.field("phi").at(c) == 0) << field;
        return;
      }
      EXPECT_NEAR(partial, expected, bound) << field << k;
    };
    const double phi = alone.field("phi").at(c);
    expect_near("phi", 0, 2.01 * e * phi);
    expect_near("density", 0, 2.01 * e * alone.field("density").at(c));
    for (int k = 0; k < 3; ++k) expect_near("velocity", k, 4.01 * e * fastest);
    expect_near("mean_diameter", 0, 4.01 * e * middle);
    for (int k = 0; k < 9; ++k) {
      const double stress = alone.field("contact_stress").at(c, k);
      expect_near(
          "contact_stress", k,
          2.01 * float_rounding * std::abs(stress) + 2 * contact_sum_rounding * kernel * most_of_contacts(scene));
      if (stress != 0) ++stressed;
    }
    if (phi > 0) ++material;
  });
  EXPECT_GT(material, 1000U);
  EXPECT_GT(stressed, 5000U);
}

// Two kinds of grains on the two halves of a cubic lattice, each moving as one: a step along x takes the sites of one
// to those of the other.
TEST(Species, TwoSublattices) {
  constexpr double h = 0.5, cutoff = 2.7, small = 0.6;
  const Vec3 slow{-0.3, 0.2, 1.1}, fast{2.5, 0.7, -0.4};
  const auto is_odd = [](const Vec3& x) { return std::fmod(x[0] + x[1] + x[2], 2) == 1; };
  Frame f = cubic_packing(8, true, [&](const Vec3& x) { return is_odd(x) ? fast : slow; });
  for (std::size_t i = 0; i < f.particles.size(); ++i) {
    const Columns3& x = f.particles.position;
    if (!is_odd({x[0][i], x[1][i], x[2][i]})) continue;
    f.particles.type[i] = 2;
    f.particles.radius[i] = small / 2;
  }
  Pipeline p = with(make_pipeline(h, {0, 0, 0}, cutoff, {"phi", "velocity", "mean_diameter"}),
                    {{"even", {}, {}, std::pair(1.0, unbounded)}, {"odd", {2}, {}, {}}});
  const Written w = run(p, {f}).only();

  double volume = 0;
  w.field("phi").for_each_active([&](const Coord& c) {
    const double phi = w.field("phi_even").at(c);
    volume += h * h * h * phi;
    const Coord next{(c.x + 1 + 2) % 16 - 1, c.y, c.z};  // the box begins at voxel -1
    const double expected = small * small * small * phi;
    EXPECT_NEAR(w.field("phi_odd").at(next), expected, 2.01 * e * expected);
    EXPECT_NEAR(w.field("mean_diameter_even").at(c), 1, 2.01 * e);
    EXPECT_NEAR(w.field("mean_diameter_odd").at(c), small, 2.01 * e * small);
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(k);
      EXPECT_NEAR(w.field("velocity_even").at(c, k), slow[a], 2.01 * e * std::abs(slow[a]));
      EXPECT_NEAR(w.field("velocity_odd").at(c, k), fast[a], 2.01 * e * std::abs(fast[a]));
    }
  });
  const double expected = 256 * sphere_volume(0.5);
  EXPECT_NEAR(volume, expected, (grain_volume_error(cutoff / h) + e) * expected);
}

// The terms are the same numbers in the same order.
TEST(Species, OfAllGrainsIsTheWholeToTheLastBit) {
  const Scene scene = periodic_scene();
  const std::vector<std::string> fields{"phi",         "phi_error",      "density",        "velocity", "mean_diameter",
                                        "temperature", "contact_stress", "kinetic_stress", "stress",   "stress_error"};
  Pipeline p = scene.pipeline(fields);
  set_option(p, "contact_stress", "line_integral", std::string("adaptive"));
  p.blocks = 3;
  for (const std::string& field : fields) {
    const bool error = field.ends_with("_error");
    p.fields.push_back(error ? field.substr(0, field.size() - 6) + "_every_error" : field + "_every");
  }
  p.species = {{"every", {}, std::pair<std::int64_t, std::int64_t>(0, 100000), {}}};
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return run(p, scene.frames);
  };
  for (const char* self_weight : {"none", "corrected"}) {
    SCOPED_TRACE(self_weight);
    set_option(p, "temperature", "self_weight", std::string(self_weight));
    const Result one = on(1), two = on(2);
    for (std::size_t k = 0; k < fields.size(); ++k)
      EXPECT_TRUE(same_bytes(one.only().field(p.fields[fields.size() + k]), one.only().field(fields[k]))) << fields[k];
    for (const std::string& field : p.fields)
      EXPECT_TRUE(same_bytes(one.only().field(field), two.only().field(field))) << field;
  }
}

// Grains behind a wall are left out and those before it have images, whatever the species; so in planes.
TEST(Species, ProfilesAddUpBesideAMirror) {
  const Scene scene = walled_scene();
  const std::vector<Species> species = by_size_and_wall();
  Pipeline p = with(scene.pipeline({"phi", "velocity"}), species);
  p.walls.kernel = WallSpec::Kernel::mirror;
  p.walls.surfaces = {{Wall::Shape::plane, {0, 0, 0.4}, {0, 0, 1}}};
  OptionValues options;
  for (const OptionInfo& option : find_measurement("profile")->options) options[option.name] = option.default_value;
  options["fields"] = p.fields;
  p.measure["profile"] = options;
  const Result result = run(p, scene.frames);
  ASSERT_EQ(result.report.tables.size(), 1U);
  const auto column = [&](const std::string& name) -> const std::vector<double>& {
    for (const TableColumn& c : result.report.tables[0].columns)
      if (c.name == name) return c.values;
    throw std::out_of_range(name);
  };
  double fastest = 0;
  for (const Frame& f : scene.frames)
    for (const double v : f.particles.velocity[0]) fastest = std::max(fastest, std::abs(v));
  std::size_t planes = 0;
  for (std::size_t n = 0; n < column("z").size(); ++n) {
    const double phi = column("phi")[n];
    if (!(phi > 0)) continue;
    double sum = 0, flux = 0;
    for (const Species& s : species) {
      const double part = column("phi_" + s.name)[n];
      sum += part;
      if (part > 0) flux += part * column("velocity_" + s.name + "_x")[n];
    }
    EXPECT_NEAR(sum, phi, 2 * e * phi) << n;
    EXPECT_NEAR(flux, phi * column("velocity_x")[n], 6.01 * e * phi * fastest) << n;
    ++planes;
  }
  EXPECT_GT(planes, 10U);
}

TEST(Species, RefusesAGrainOfTwo) {
  Frame f = cubic_packing(3, false, [](const Vec3&) { return Vec3{}; });
  f.particles.radius[4] = 0.6;
  Pipeline p = make_pipeline(0.5, {0, 0, 0}, 2, {"phi_plain"});
  p.species = {{"plain", {1}, {}, {}}, {"large", {}, {}, std::pair(1.1, unbounded)}};
  try {
    run(p, {f});
    ADD_FAILURE() << "not refused";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::AllOf(::testing::HasSubstr("particle 5 of type 1 and diameter 1.2"),
                                               ::testing::HasSubstr("'plain' and in 'large'")));
  }
}

}  // namespace
}  // namespace grainvdb::testing::species_test
