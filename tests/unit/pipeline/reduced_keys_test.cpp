/// The section output.reduced of pipeline files.
#include <gmock/gmock.h>

#include "unit/pipeline/support.hpp"

namespace grainvdb::reduced_keys_test {
namespace {

using test::load;
using test::minimal_text;
using test::refusal;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* beads = "{diameter: 0.8e-3, gravity: 9.81, density: 2500}";
constexpr const char* traced = "trace: {seeds: {points: [[1, 1, 1]]}, duration: 1, steps: 2}\n";

// The minimal file with this as output.reduced, on line 10.
std::string with(const std::string& reduced) {
  return minimal_text() + "  reduced: " + reduced + '\n';
}

// The minimal file whose output, on line 8, is this.
std::string with_output(const std::string& output, const std::string& more = "") {
  const std::string text = minimal_text();
  return text.substr(0, text.find("output:")) + "output: " + output + '\n' + more;
}

TEST(ReducedKeys, AreDiameterGravityAndDensity) {
  EXPECT_FALSE(load(minimal_text()).reduced);
  const Pipeline p = load(with(beads));
  ASSERT_TRUE(p.reduced);
  EXPECT_EQ(p.reduced->diameter, 0.8e-3);
  EXPECT_EQ(p.reduced->gravity, 9.81);
  EXPECT_EQ(p.reduced->density, 2500);
  EXPECT_THAT(p.resolved, HasSubstr("  reduced:\n    diameter: 8.0e-04\n    gravity: 9.81\n    density: 2500.0"));
}

TEST(ReducedKeys, CanBeSetOneByOne) {
  const Pipeline p =
      load(minimal_text(), {"output.reduced.diameter=2", "output.reduced.gravity=3", "output.reduced.density=4"});
  ASSERT_TRUE(p.reduced);
  EXPECT_EQ(p.reduced->diameter * p.reduced->gravity * p.reduced->density, 24);
}

TEST(ReducedKeys, AreAllNeeded) {
  EXPECT_THAT(refusal(with("{diameter: 1, gravity: 1}")),
              StartsWith("FILE:10: the key 'output.reduced.density' is missing"));
}

TEST(ReducedKeys, ArePositiveNumbers) {
  for (const char* value : {"0", "-1", ".inf", "heavy"})
    EXPECT_THAT(refusal(with(std::string("\n    diameter: 1\n    gravity: 1\n    density: ") + value)),
                AllOf(StartsWith("FILE:13: output.reduced.density"), HasSubstr("a number > 0")))
        << value;
}

TEST(ReducedKeys, MakeUnitsInWhichNumbersCanBeWritten) {
  EXPECT_THAT(
      refusal(with("{diameter: 1e-20, gravity: 1, density: 1}")),
      AllOf(StartsWith("FILE:10: a unit of output.reduced is out of the range of numbers"), HasSubstr("rho_p d^3 = ")));
}

TEST(ReducedKeys, NeedNoFieldsWhereTracersAreWritten) {
  const Pipeline p = load(with_output(std::string("{reduced: ") + beads + '}', traced));
  EXPECT_TRUE(p.reduced);
  EXPECT_TRUE(p.fields.empty());
  EXPECT_TRUE(p.formats.empty());
  // What was resolved can be run again.
  EXPECT_THAT(p.resolved, Not(HasSubstr("hdf5")));
}

TEST(ReducedKeys, DoNotStandForFields) {
  constexpr const char* missing = "FILE:8: the key 'output.fields' is missing";
  EXPECT_THAT(refusal(with_output(std::string("{reduced: ") + beads + '}')), StartsWith(missing));
  EXPECT_THAT(refusal(with_output("{formats: vdb}", traced)), StartsWith(missing));
  EXPECT_THAT(refusal(with_output(std::string("{formats: vdb, reduced: ") + beads + '}', traced)), StartsWith(missing));
  EXPECT_THAT(refusal(with_output("{formats: vdb}")), StartsWith(missing));
}

}  // namespace
}  // namespace grainvdb::reduced_keys_test
