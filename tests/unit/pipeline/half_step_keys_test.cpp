/// The section input.contacts.half_step of pipeline files.
#include <gmock/gmock.h>

#include "unit/pipeline/support.hpp"

namespace grainvdb::half_step_keys_test {
namespace {

using test::minimal_text;
using test::refusal;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

// The minimal file with contacts whose half_step section holds this, on line 5.
std::string with(const std::string& keys, const std::string& dt = "") {
  std::string text = minimal_text();
  const auto end_of_input = text.find('\n', text.find("particles:")) + 1;
  return text.insert(end_of_input, dt + "  contacts: {files: c*, half_step: {" + keys + "}}\n");
}

HalfStep half_step(const std::string& keys, const std::string& dt = "") {
  return test::load(with(keys, dt)).input.contacts.half_step.value();
}

TEST(HalfStepKeys, AreThoseOfTheLaw) {
  const HalfStep rate = half_step("law: rate, rate: 50, dt: 1e-4, frozen_types: [2], whole_steps: [0, 100]");
  EXPECT_EQ(rate.law, DampingLaw::rate);
  EXPECT_EQ(rate.rate, 50);
  EXPECT_EQ(rate.dt, 1e-4);
  EXPECT_EQ(rate.frozen_types, std::vector<int>{2});
  EXPECT_EQ(rate.whole_steps, (std::vector<std::int64_t>{0, 100}));
  EXPECT_FALSE(rate.friction);
  const HalfStep hooke = half_step(
      "law: hooke, youngs_modulus: 1e9, poisson_ratio: 0, restitution: 0.1, characteristic_velocity: 2, friction: 0.4, "
      "still_types: [2, 3]",
      "  dt: 1e-6\n");
  EXPECT_EQ(hooke.law, DampingLaw::hooke);
  EXPECT_EQ(hooke.dt, 1e-6);  // input.dt
  EXPECT_EQ(hooke.youngs_modulus, 1e9);
  EXPECT_EQ(hooke.poisson_ratio, 0);
  EXPECT_EQ(hooke.restitution, 0.1);
  EXPECT_EQ(hooke.characteristic_velocity, 2);
  EXPECT_EQ(hooke.friction, 0.4);
  EXPECT_EQ(hooke.still_types, (std::vector<int>{2, 3}));
}

TEST(HalfStepKeys, OfAnotherLawAreRefused) {
  EXPECT_THAT(refusal(with("law: rate, youngs_modulus: 1e9, dt: 1")),
              AllOf(HasSubstr("the keys of input.contacts.half_step are not those of its law"),
                    HasSubstr("found youngs_modulus; expected rate")));
  EXPECT_THAT(refusal(with("law: hertz, youngs_modulus: 1e9, restitution: 0.5, dt: 1")),
              HasSubstr("found youngs_modulus, restitution; expected youngs_modulus, poisson_ratio, restitution"));
  EXPECT_THAT(refusal(with("law: rate, rate: 50")), HasSubstr("needs the time step of the run"));
  EXPECT_THAT(refusal(with("law: hook, dt: 1")), HasSubstr("Did you mean 'hooke'?"));
}

}  // namespace
}  // namespace grainvdb::half_step_keys_test
