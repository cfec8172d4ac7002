// Every field, in every regime and by every method: no NaN without a reason, no number where there is none.
#include "support/soundness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "grainvdb/mask.hpp"
#include "stability/regimes.hpp"

namespace grainvdb::testing::soundness_test {
namespace {

struct Methods {
  const char* name;
  const char* fluctuation;
  const char* self_weight;
  const char* gradient;
  const char* weighting;
  const char* reference;
  std::size_t window;
};

constexpr Methods all_methods[] = {
    {"two_pass", "two_pass", "none", "central", "volume", "time_mean", 0},
    {"profile", "two_pass_profile", "none", "kernel", "mass", "instantaneous", 0},
    {"one_pass", "one_pass", "none", "central", "volume", "instantaneous", 1},
    {"two_pass, corrected", "two_pass", "corrected", "kernel", "volume", "time_mean", 1},
    {"moments", "two_pass", "none", "central", "volume", "time_mean_moments", 0},
    {"one_pass_corrected, corrected", "one_pass_corrected", "corrected", "central", "mass", "time_mean", 2}};

void set_methods(Pipeline& p, const Methods& m) {
  for (const char* stage : {"temperature", "rotational_fluctuation"}) {
    set_option(p, stage, "mode", std::string(m.fluctuation));
    set_option(p, stage, "self_weight", std::string(m.self_weight));
  }
  for (const char* stage : {"velocity_gradient", "angular_velocity_gradient"})
    set_option(p, stage, "method", std::string(m.gradient));
  set_option(p, "velocity", "weighting", std::string(m.weighting));
  set_option(p, "kinetic_stress", "reference", std::string(m.reference));
  p.window = m.window;
}

Pipeline pipeline_for(const Scene& scene, std::vector<std::string> fields) {
  Pipeline p = make_pipeline(scene.voxel, scene.origin, scene.cutoff, std::move(fields));
  p.select = scene.select;
  if (p.select.empty()) p.walls.types = {3};
  return p;
}

/// The scene with three frames or more: one alone stands still.
Scene of_three_frames(Scene scene) {
  while (scene.frames.size() < 3) {
    scene.frames.push_back(scene.frames.back());
    scene.frames.back().step += 10;
  }
  return scene;
}

/// A wall that passes a quarter of a diameter below the centre of the lowest grain that is material.
Wall floor_of(const Scene& scene) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Frame& f : scene.frames)
    for (std::size_t i = 0; i < f.particles.size(); ++i)
      if (scene.select.types.empty() || f.particles.type[i] == scene.select.types.front())
        lowest = std::min(lowest, f.particles.position[2][i] - f.particles.radius[i] / 2);
  return {Wall::Shape::plane, {0, 0, lowest}, {0, 0, 1}};
}

/// Two size classes, of which many regimes have one alone, and wall grains, which are no material.
std::vector<Species> size_classes() {
  return {{"small", {1}, {}, std::pair(0.0, 0.95)},
          {"large", {1}, {}, std::pair(0.95, std::numeric_limits<double>::infinity())},
          {"wall", {2, 3}, {}, {}}};
}

/// Those that can have a wall below: there is none across a period.
std::vector<Regime> regimes_open_below() {
  std::vector<Regime> all = regimes();
  std::erase_if(all, [](const Regime& each) { return each.scene().frames[0].box.periodic[2]; });
  return all;
}

bool masked(const Result& r, const std::string& reason) {
  return std::any_of(r.report.masked.begin(), r.report.masked.end(),
                     [&](const auto& entry) { return entry.first == reason && entry.second > 0; });
}

class Soundness : public ::testing::TestWithParam<Regime> {};
class SoundnessAtWalls : public ::testing::TestWithParam<Regime> {};

TEST_P(Soundness, OfEveryField) {
  const Scene scene = GetParam().scene();
  for (const Methods& methods : all_methods) {
    SCOPED_TRACE(methods.name);
    Pipeline p = pipeline_for(scene, all_fields());
    set_methods(p, methods);
    EXPECT_THAT(unsoundness(run(p, scene.frames)), ::testing::IsEmpty());
  }
}

TEST_P(SoundnessAtWalls, OfEveryField) {
  const Scene scene = GetParam().scene();
  for (const WallSpec::Kernel kernel :
       {WallSpec::Kernel::cut, WallSpec::Kernel::renormalise, WallSpec::Kernel::mirror, WallSpec::Kernel::mask}) {
    SCOPED_TRACE(static_cast<int>(kernel));
    Pipeline p = pipeline_for(scene, all_fields());
    p.walls.kernel = kernel;
    p.walls.surfaces = {floor_of(scene)};
    const Result r = run(p, scene.frames);
    EXPECT_THAT(unsoundness(r), ::testing::IsEmpty());
    EXPECT_EQ(masked(r, "behind_wall"), kernel != WallSpec::Kernel::cut);
    EXPECT_EQ(masked(r, "near_wall"), kernel == WallSpec::Kernel::mask);
  }
}

// Partial fields and standard errors. A ratio of a species has a value exactly where there is some of the species.
TEST_P(Soundness, OfErrorsAndSpecies) {
  const Scene scene = of_three_frames(GetParam().scene());
  const std::vector<const char*> ratios{"velocity", "mean_diameter", "temperature"};
  Pipeline p = pipeline_for(scene, all_fields());
  for (const std::string& name : all_errors()) p.fields.push_back(name);
  p.species = size_classes();
  for (const Species& s : p.species) {
    for (const char* sum : {"phi", "density", "contact_stress", "kinetic_stress", "stress"})
      for (const char* ending : {"", "_error"}) p.fields.push_back(std::string(sum) + '_' + s.name + ending);
    for (const char* ratio : ratios)
      for (const char* ending : {"", "_error"}) p.fields.push_back(std::string(ratio) + '_' + s.name + ending);
  }
  p.blocks = 3;
  const Result r = run(p, scene.frames);
  EXPECT_THAT(unsoundness(r), ::testing::IsEmpty());
  const Written& w = r.only();
  for (const Species& s : p.species)
    for (const char* ratio : ratios) {
      const FieldCopy& phi = w.field("phi_" + s.name);
      const FieldCopy& q = w.field(std::string(ratio) + '_' + s.name);
      std::size_t wrong = 0;
      phi.for_each_active([&](const Coord& c) {
        const bool absent = !(phi.at(c) > 0);
        if (std::isnan(q.at(c)) != absent) ++wrong;
        if (absent && (w.mask_at(c) & static_cast<std::uint32_t>(Reason::no_species)) == 0) ++wrong;
      });
      EXPECT_EQ(wrong, 0U) << ratio << '_' << s.name;
    }
}

INSTANTIATE_TEST_SUITE_P(Regimes, Soundness, ::testing::ValuesIn(regimes()),
                         [](const auto& each) { return each.param.name; });

INSTANTIATE_TEST_SUITE_P(Regimes, SoundnessAtWalls, ::testing::ValuesIn(regimes_open_below()),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace grainvdb::testing::soundness_test
