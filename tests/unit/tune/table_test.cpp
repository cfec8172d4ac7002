#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/tune.hpp"

namespace grainvdb::table_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TuneReport report() {
  TuneReport r;
  r.reference = {"lattice.voxel=1"};
  r.reference_points = 123;
  r.fields = {"phi"};
  r.not_compared = {"frames"};
  r.trials = {{{}, {2, 3}, {{"phi", 0.01, 0.02, 9, 1}}, {}},
              {{"frames=::2", "lattice.origin=[0,0,0]"}, {1, 1}, {{"phi", 0.03, 0.05, 8, 2}}, {}},
              {{"lattice.voxel=9"}, {}, {}, "too coarse"}};
  r.front = {true, true, false};
  r.proposed = 1;
  r.proposal_meets = true;
  return r;
}

TEST(TuneTable, ShowsWhatWasTriedAndProposesASetting) {
  const std::string text = describe(report(), {{"phi", 0.05}});
  EXPECT_THAT(text, AllOf(HasSubstr("as it is"), HasSubstr("123 points"), HasSubstr("Not compared: frames"),
                          HasSubstr("Not possible: lattice.voxel=9: too coarse")));
  EXPECT_THAT(text, HasSubstr("--set frames=::2 --set 'lattice.origin=[0,0,0]'"));
  EXPECT_THAT(text, HasSubstr("0.5 of the time now"));
}

TEST(TuneTable, SaysWhereNothingIsGoodEnough) {
  TuneReport r = report();
  r.proposed = 0;
  r.proposal_meets = false;
  EXPECT_THAT(describe(r, {{"phi", 0.001}}),
              HasSubstr("Nothing that was tried keeps to phi 0.001. The closest, as it is"));
  EXPECT_THAT(describe(r, {}), AllOf(HasSubstr("--tolerance phi=1e-3"), Not(HasSubstr("Nothing that"))));
}

TEST(TuneTable, SaysWhereTheCurrentSettingStays) {
  TuneReport r = report();
  r.proposed = 0;
  EXPECT_THAT(describe(r, {{"phi", 0.05}}), HasSubstr("The current setting keeps to phi 0.05, and none of those"));
}

TEST(TuneTable, SaysWhatPlanesAndTracersAreHeldAgainst) {
  TuneReport r = report();
  EXPECT_THAT(describe(r, {}), AllOf(Not(HasSubstr("profile:")), Not(HasSubstr("position:"))));
  r.fields = {"profile.phi", "position"};
  r.reference_points = 0;
  EXPECT_THAT(describe(r, {}), AllOf(HasSubstr("profile: the same sum over planes"),
                                     HasSubstr("position: rms distance of tracers"), Not(HasSubstr("points between"))));
}

TEST(TuneTable, HasARowPerSettingAndField) {
  EXPECT_EQ(
      to_csv(report(), {{"phi", 0.05}}),
      "setting,current,proposed,front,best_seconds,worst_seconds,repeats,field,rms,largest,points,undefined,tolerance\n"
      "\"\",1,0,1,2,3,2,phi,0.01,0.02,9,1,0.05\n"
      "\"frames=::2 lattice.origin=[0,0,0]\",0,1,1,1,1,2,phi,0.03,0.05,8,2,0.05\n");
}

}  // namespace
}  // namespace grainvdb::table_test
