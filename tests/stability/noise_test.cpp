// What is left of flows that hardly fluctuate: rounding, and thresholds that keep it out of ratios.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "grainvdb/mask.hpp"
#include "stability/regimes.hpp"
#include "support/kernel_sums.hpp"
#include "support/lattice_packing.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::testing::noise_test {
namespace {

bool has(const Written& w, const Coord& c, Reason r) {
  return (w.mask_at(c) & static_cast<std::uint32_t>(r)) != 0;
}

Pipeline pipeline_for(const Scene& scene, std::vector<std::string> fields) {
  Pipeline p = make_pipeline(scene.voxel, scene.origin, scene.cutoff, std::move(fields));
  p.select = scene.select;
  return p;
}

std::size_t reported(const Result& r, const std::string& reason) {
  for (const auto& [name, count] : r.report.masked)
    if (name == reason) return count;
  return 0;
}

/// What two_pass leaves of the variance of independent velocities on the sites of a cubic lattice of spacing 1, by the
/// sum over sites: 1 - 2 w₀ + Σ w², w the share of each site in the mean.
double left_of_the_variance(double cutoff) {
  double sum = 0;
  double squares = 0;
  const int n = static_cast<int>(cutoff);
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j)
      for (int k = -n; k <= n; ++k) {
        const double w = lucy(std::sqrt(i * i + j * j + k * k), cutoff);
        sum += w;
        squares += w * w;
      }
  return 1 - 2 * lucy(0, cutoff) / sum + squares / (sum * sum);
}

// Velocities around u with 1 ≤ |v_i| < 10, dumped with six digits: their last digit is q = 1e-5, and rounding adds a
// variance of q²/12 per component, T = 3 q²/12 (physics section 7), of which two_pass leaves its share. They vary as
// xy, yz and x² - y², whose mean over the sites around is their value in the middle, so that T is 0 without the
// rounding, voxel centres being sites; and by so much that the errors of neighbours have nothing in common. 9³ sites
// count, three components each; the square of a uniform error has a standard deviation of 0.894 of its mean: four of
// them.
TEST(NoiseOfSixDigits, IsTheTemperatureOfAFlowWithoutFluctuation) {
  const Vec3 u{3.5, -2.5, 1.5};
  for (bool rounded : {false, true}) {
    const Frame f = cubic_packing(21, false, [&](const Vec3& site) {
      const Vec3 x{site[0] - 10, site[1] - 10, site[2] - 10};
      Vec3 v{u[0] + 1.31313e-3 * x[0] * x[1] + 7.7123e-4 * (x[1] * x[1] - x[2] * x[2]),
             u[1] + 1.27173e-3 * x[1] * x[2] + 8.1371e-4 * (x[2] * x[2] - x[0] * x[0]),
             u[2] + 1.41421e-3 * x[2] * x[0] + 6.9713e-4 * (x[0] * x[0] - x[1] * x[1])};
      if (rounded)
        for (double& vi : v) vi = six_digits(vi);
      return v;
    });
    const Result r = run(make_pipeline(1, {-0.5, -0.5, -0.5}, 3, {"temperature"}), {f});
    double sum = 0;
    for (int i = 6; i < 15; ++i)
      for (int j = 6; j < 15; ++j)
        for (int k = 6; k < 15; ++k) sum += static_cast<double>(r.only().field("temperature").at({i, j, k}));
    const double expected = 3 * 1e-10 / 12 * left_of_the_variance(3);
    if (rounded) {
      EXPECT_NEAR(sum / 729 / expected, 1, 4 * 0.894 / std::sqrt(3 * 729.0));
    } else {
      EXPECT_LT(sum / 729, 1e-3 * expected);
    }
  }
}

// By default no ratio is formed with what six digits leave of the fluctuation; without the threshold it is.
TEST(NoiseOfSixDigits, IsKeptOutOfRatios) {
  const Scene scene = scene_of("rounded_plug");
  Pipeline p = pipeline_for(scene, {"fluidity", "gd_over_dv", "temperature", "mask"});
  const Result r = run(p, scene.frames);
  set_option(p, "velocity", "resolution", 0.0);
  const Result unguarded = run(p, scene.frames);
  std::size_t flowing = 0;
  std::size_t finite = 0;
  const Written& w = r.only();
  w.field("fluidity").for_each_active([&](const Coord& c) {
    if (std::isnan(w.field("fluidity").at(c))) return;
    ++flowing;
    EXPECT_TRUE(std::isnan(w.field("gd_over_dv").at(c)));
    EXPECT_TRUE(has(w, c, Reason::no_fluctuation));
    EXPECT_FALSE(std::isnan(w.field("temperature").at(c)));
    if (std::isfinite(unguarded.only().field("gd_over_dv").at(c))) ++finite;
  });
  EXPECT_GT(flowing, 500U);
  EXPECT_GT(finite, flowing / 2);
  EXPECT_EQ(reported(r, "no_fluctuation"), flowing);
}

// Grains that fall side by side have a kinetic pressure of nothing but rounding, below the floor that ρ and u set.
TEST(FreeFall, HasNoPressureToDivideBy) {
  const Scene scene = scene_of("free_fall");
  Pipeline p = pipeline_for(scene, {"phi", "pressure", "pressure_floor", "mu", "inertial_number", "fluidity",
                                    "mu_mohr_coulomb", "temperature", "mask"});
  set_option(p, "kinetic_stress", "reference", std::string("instantaneous"));
  const Result r = run(p, scene.frames);
  const Written& w = r.only();
  std::size_t voxels = 0;
  w.field("phi").for_each_active([&](const Coord& c) {
    if (!(w.field("phi").at(c) > 0)) return;
    ++voxels;
    EXPECT_LE(w.field("pressure").at(c), w.field("pressure_floor").at(c));
    for (const char* name : {"mu", "inertial_number", "fluidity", "mu_mohr_coulomb"})
      EXPECT_TRUE(std::isnan(w.field(name).at(c))) << name;
    EXPECT_TRUE(has(w, c, Reason::low_pressure));
  });
  EXPECT_GT(voxels, 1000U);
  EXPECT_EQ(reported(r, "low_pressure"), w.field("phi").topology->active_voxel_count());
}

// A mean over frames of which each falls faster takes that for fluctuation: Σ (v - v̄)² = 0, 0.7², 0.7² about the
// middle, where all frames weigh alike. That is what the definition says; the frame's own mean knows better (above).
TEST(FreeFall, IsNoSteadyFlow) {
  Scene scene = scene_of("free_fall");
  for (Frame& f : scene.frames) {
    const double v = f.particles.velocity[2][0];
    f.particles = scene.frames[0].particles;
    std::fill(f.particles.velocity[2].begin(), f.particles.velocity[2].end(), v);
  }
  const Result r = run(pipeline_for(scene, {"density", "pressure"}), scene.frames);
  const Written& w = r.only();
  w.field("density").for_each_active([&](const Coord& c) {
    const auto density = static_cast<double>(w.field("density").at(c));
    const double expected = density * (2 * 0.7 * 0.7 / 3) / 3;
    EXPECT_NEAR(static_cast<double>(w.field("pressure").at(c)), expected, 1e-5 * expected + 1e-12);
  });
}

/// The largest component anywhere, by magnitude.
double largest_of(const FieldCopy& f) {
  double largest = 0;
  f.for_each_active([&](const Coord& c) {
    for (int k = 0; k < f.meta.components; ++k)
      largest = std::max(largest, std::abs(static_cast<double>(f.at(c, k))));  // NaN leaves it as it is
  });
  return largest;
}

/// The scene's first frame with so much added to each component of all its velocities and of all its spins.
Scene first_frame_shifted(Scene scene, double velocity, double spin) {
  scene.frames.resize(1);
  for (std::size_t a = 0; a < 3; ++a) {
    for (double& v : scene.frames[0].particles.velocity[a]) v += velocity;
    for (double& w : scene.frames[0].particles.angular_velocity[a]) w += spin;
  }
  return scene;
}

/// A field of fluctuation with the mean it is about and the gradient of that.
struct About {
  const char* fluctuation;
  const char* mean;
  const char* gradient;
};

/// What (c²/12) L:L changes by where rounding the mean to float changes L by up to δL = 2 · 2⁻²⁴|u|/h, |u| the largest
/// component: one-sided differences divide by h.
double change_of_gradient_part(const FieldCopy& gradient, const Coord& c, double largest_mean, const Scene& scene) {
  const double dl = 2 * 0x1p-24 * largest_mean / scene.voxel;
  double sum = 0;
  for (int k = 0; k < 9; ++k) sum += 2 * std::abs(static_cast<double>(gradient.at(c, k))) * dl + dl * dl;
  return scene.cutoff * scene.cutoff / 12 * sum;
}

// The same fluctuations on top of a mean of up to 10⁴ times their size: T and δω² do not change. Sums are taken about a
// local reference and are good to sum_rounding of the deviations from it, a few δv; one_pass is formed in double, where
// (u/δv)² 2⁻⁵² = 2e-8 of T is lost for each of some hundred terms. one_pass_corrected takes off what the gradient of
// the mean makes, a field in single precision. Where that is all of T rounding decides whether any is left.
TEST(Cancellation, OfALargeMeanVelocityLeavesTheTemperature) {
  const Scene scene = walled_scene();
  const About all[] = {{"temperature", "velocity", "velocity_gradient"},
                       {"rotational_fluctuation", "angular_velocity", "angular_velocity_gradient"}};
  for (const std::string mode : {"two_pass", "two_pass_profile", "one_pass", "one_pass_corrected"}) {
    Pipeline p = pipeline_for(scene, {});
    for (const About& about : all) {
      p.fields.insert(p.fields.end(), {about.fluctuation, about.mean, about.gradient});
      set_option(p, about.fluctuation, "mode", mode);
    }
    const Result at_rest = run(p, first_frame_shifted(scene, 0, 0).frames);
    const double largest_t = largest_of(at_rest.only().field("temperature"));
    const double largest_w = largest_of(at_rest.only().field("rotational_fluctuation"));
    for (double ratio : {10.0, 1e3, 1e4}) {
      const Scene moving =
          first_frame_shifted(scene, ratio * std::sqrt(largest_t / 3), ratio * std::sqrt(largest_w / 3));
      const Result fast = run(p, moving.frames);
      for (const About& about : all) {
        SCOPED_TRACE(mode + ", " + about.fluctuation + ", ratio " + std::to_string(ratio));
        const FieldCopy& before = at_rest.only().field(about.fluctuation);
        const FieldCopy& after = fast.only().field(about.fluctuation);
        const double largest_mean = largest_of(fast.only().field(about.mean));
        const double rounding = 4 * sum_rounding * largest_of(before);
        before.for_each_active([&](const Coord& c) {
          if (std::isnan(before.at(c))) return;
          double allowed = rounding;
          if (mode == "one_pass_corrected")
            allowed += change_of_gradient_part(at_rest.only().field(about.gradient), c, largest_mean, scene);
          if (std::isnan(after.at(c)) && before.at(c) <= allowed) return;
          EXPECT_NEAR(static_cast<double>(after.at(c)), static_cast<double>(before.at(c)), allowed);
        });
      }
    }
  }
}

// What the shift is for: plain floats round u to 6e-8, 6e-4 δv at |u|/δv = 10⁴, and u² in the second moments to some
// δv²: one_pass loses T, while two_pass, about the mean itself, keeps it to a per cent. In double nothing is lost.
TEST(Cancellation, OfALargeMeanVelocityShowsInPlainFloats) {
  const Scene scene = walled_scene();
  const auto temperature = [&](const std::string& mode, Accumulation how, double velocity) {
    Pipeline p = pipeline_for(scene, {"temperature"});
    set_option(p, "temperature", "mode", mode);
    p.accumulation = how;
    return run(p, first_frame_shifted(scene, velocity, 0).frames).only().field("temperature");
  };
  const auto largest_change = [](const FieldCopy& before, const FieldCopy& after) {
    double change = 0;
    before.for_each_active([&](const Coord& c) {
      if (!std::isnan(before.at(c)) && !std::isnan(after.at(c)))
        change = std::max(change, std::abs(static_cast<double>(after.at(c)) - static_cast<double>(before.at(c))));
    });
    return change / largest_of(before);
  };
  const FieldCopy one_pass = temperature("one_pass", Accumulation::shifted, 0);
  const FieldCopy two_pass = temperature("two_pass", Accumulation::shifted, 0);
  const double velocity = 1e4 * std::sqrt(largest_of(one_pass) / 3);
  EXPECT_GT(largest_change(one_pass, temperature("one_pass", Accumulation::single, velocity)), 1);
  EXPECT_LT(largest_change(two_pass, temperature("two_pass", Accumulation::single, velocity)), 1e-2);
  for (const char* mode : {"one_pass", "two_pass"})
    EXPECT_LT(largest_change(mode == std::string("one_pass") ? one_pass : two_pass,
                             temperature(mode, Accumulation::twofold, velocity)),
              4 * sum_rounding);
}

// Voxels at which a grain's volume can be off by more than a limit are refused; what it is off by stands in the result.
TEST(Thresholds, CoarseVoxels) {
  Pipeline p = make_pipeline(1, {0, 0, 0}, 1.25, {"phi"});
  EXPECT_THROW(run(p, {one_particle({0.2, 0.3, 0.4})}), LimitError);
  p.limits.volume_error = 0.25;
  const Result r = run(p, {one_particle({0.2, 0.3, 0.4})});
  const auto recorded = std::find_if(r.record.provenance.begin(), r.record.provenance.end(),
                                     [](const auto& entry) { return entry.first == "grain_volume_error"; });
  ASSERT_NE(recorded, r.record.provenance.end());
  EXPECT_NEAR(std::stod(recorded->second), 0.244, 5e-4);
}

// A kernel of one diameter lets φ of a cubic lattice ripple by as much as its mean, one of 1.5 by 4 %.
TEST(Thresholds, KernelsThatShowSingleGrains) {
  const Frame frame = one_particle({0.2, 0.3, 0.4});
  const double diameter = 2 * frame.particles.radius[0];
  const auto narrow = [&](double in_diameters, double least) {
    Pipeline p = make_pipeline(diameter / 4, {0, 0, 0}, in_diameters * diameter, {"phi"});
    p.limits.cutoff_in_diameters = least;
    return run(p, {frame}).report.narrow_kernel;
  };
  const double least = Limits{}.cutoff_in_diameters;
  ASSERT_TRUE(narrow(1.49, least));
  EXPECT_DOUBLE_EQ(narrow(1.49, least)->in_diameters, 1.49);
  EXPECT_FALSE(narrow(1.51, least));
  EXPECT_FALSE(narrow(1.49, 1.48));
}

// Every threshold that leaves a field undefined can be set, and stands in the pipeline that the result records.
TEST(Thresholds, AreRecorded) {
  const Pipeline p = load_pipeline(in_repository("pipelines/minimal.yaml"));
  for (const char* name : {"pressure_min", "temperature_min", "rotational_fluctuation_min", "mu_min", "gap",
                           "shear_rate_min", "resolution", "volume_error", "cutoff_in_diameters"})
    EXPECT_THAT(p.resolved, ::testing::HasSubstr(std::string(name) + ": ")) << name;
}

}  // namespace
}  // namespace grainvdb::testing::noise_test
