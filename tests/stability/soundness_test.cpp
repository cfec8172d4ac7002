// Every field, in every regime and by every method: no NaN without a reason, no number where there is none.
#include "support/soundness.hpp"

#include <ostream>
#include <string>

#include <gmock/gmock.h>

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

class Soundness : public ::testing::TestWithParam<Regime> {};

TEST_P(Soundness, OfEveryField) {
  const Scene scene = GetParam().scene();
  for (const Methods& methods : all_methods) {
    SCOPED_TRACE(methods.name);
    Pipeline p = make_pipeline(scene.voxel, scene.origin, scene.cutoff, all_fields());
    p.select = scene.select;
    if (p.select.empty()) p.walls.types = {3};
    set_methods(p, methods);
    EXPECT_THAT(unsoundness(run(p, scene.frames)), ::testing::IsEmpty());
  }
}

INSTANTIATE_TEST_SUITE_P(Regimes, Soundness, ::testing::ValuesIn(regimes()),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace grainvdb::testing::soundness_test
