#include "grainvdb/followed_input.hpp"

#include "unit/read/dump_files.hpp"

namespace grainvdb::followed_input_test {
namespace {

using namespace testing_dumps;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::string grains(std::int64_t step) {
  return particle_dump(step, "id x y z radius", {"1 0.1 0.2 0.3 0.5", "2 1.1 0.2 0.3 0.61"});
}
std::string dump_name(int step) {
  return std::string("d").append(std::to_string(step));
}
std::string contacts(std::int64_t step) {
  return contact_dump(step, "id1 id2 fx fy fz", {"1 2 1 2 3"});
}

class FollowedInputTest : public ::testing::Test {
 protected:
  void append(const std::string& name, const std::string& text) {
    std::ofstream(files_.path(name), std::ios::app | std::ios::binary) << text;
  }
  std::vector<std::int64_t> steps(std::optional<std::int64_t> last = {}) {
    std::vector<std::int64_t> result;
    if (const auto source = input_.look(last))
      for (const FrameInfo& frame : source->frames()) result.push_back(frame.step);
    return result;
  }

  DumpFiles files_;
  InputSpec spec_ = particles_in({files_.path("d*")});
  FollowedInput input_{spec_};
};

TEST_F(FollowedInputTest, AFrameIsThereWhenItIsCompleteAndSettled) {
  EXPECT_THAT(steps(), IsEmpty());  // not even a file
  const std::string text = grains(10);
  std::size_t written = 0;
  for (const std::size_t until :
       {std::size_t{1}, text.find("ATOMS"), text.size() / 2, text.size() - 2, text.size() - 1}) {
    append("d10", text.substr(written, until - written));
    written = until;
    // What was cut off may look complete: 0.6 in place of 0.61. That it has settled makes no frame of it.
    for (int look = 0; look < 3; ++look) EXPECT_THAT(steps(), IsEmpty()) << until;
  }
  append("d10", text.substr(written));
  EXPECT_THAT(steps(), IsEmpty());  // it has only just changed
  EXPECT_THAT(steps(), ElementsAre(10));
  EXPECT_THAT(steps(), ElementsAre(10));
}

TEST_F(FollowedInputTest, FramesOfAFileThatGrowsAreThereWhenAnotherFollows) {
  append("d", grains(10));
  EXPECT_THAT(steps(), IsEmpty());
  append("d", grains(20));
  EXPECT_THAT(steps(), ElementsAre(10));
  append("d", grains(30).substr(0, 100));
  EXPECT_THAT(steps(), ElementsAre(10, 20));
  EXPECT_THAT(steps(), ElementsAre(10, 20));
}

TEST_F(FollowedInputTest, FramesThatAreThereCanBeReadWhileTheFileGrows) {
  append("d", grains(10));
  steps();
  steps();
  const auto source = input_.look();
  ASSERT_NE(source, nullptr);
  append("d", grains(20));
  EXPECT_EQ(source->read(0, Column::radius).particles.radius.at(1), 0.61);
}

TEST_F(FollowedInputTest, FramesWaitForTheirContacts) {
  spec_.contacts.files = {files_.path("c*")};
  FollowedInput input(spec_);
  const auto count = [&] {
    const auto source = input.look();
    return source ? source->frames().size() : 0;
  };
  for (int step : {10, 20, 30}) append(dump_name(step), grains(step));
  append("c10", contacts(10));
  count();
  EXPECT_EQ(count(), 1U);
  append("c20", contacts(20).substr(0, contacts(20).size() - 3));
  count();
  EXPECT_EQ(count(), 1U);
  append("c20", contacts(20).substr(contacts(20).size() - 3));
  append("c30", contacts(30));
  count();
  EXPECT_EQ(count(), 3U);
}

// A file that is listed twice grows once: it must not be taken for one that has settled where it is met again.
TEST_F(FollowedInputTest, AFileOfBothSortsOfContactsIsJudgedOnce) {
  spec_.periodic = "none";
  spec_.contacts.files = spec_.wall_contacts.files = {files_.path("n.fstat*")};
  FollowedInput input(spec_);
  const auto count = [&] {
    const auto source = input.look();
    return source ? source->frames().size() : 0;
  };
  const std::string rest_of_header = " 0 0 1 1 1\n# 1 1 0 0 0 0\n";
  for (const std::string time : {"0", "1", "2"})
    append("d", "1 " + time + " 0 0 0 1 1 1\n0 0 0 0 0 0 1 0 0 0 0 0 0 0\n");
  append("n.fstat.0", "# 0 1\n# 0" + rest_of_header);
  count();
  EXPECT_EQ(count(), 1U);
  append("n.fstat.1", "# 1 1\n# 0");
  append("n.fstat.2", "# 2 1\n# 0" + rest_of_header);
  EXPECT_EQ(count(), 1U);
  append("n.fstat.1", rest_of_header);
  count();
  EXPECT_EQ(count(), 3U);
}

// Frames that were there must not get others before them.
TEST_F(FollowedInputTest, FramesWaitForFilesBeforeThem) {
  append("d1", grains(10) + grains(20));
  append("d2", grains(30) + grains(40));
  EXPECT_THAT(steps(), ElementsAre(10));  // whether 20 is whole will show, and 30 comes after it
  EXPECT_THAT(steps(), ElementsAre(10, 20, 30, 40));
  append("d3", grains(50) + grains(60));
  append("d2", grains(45));
  EXPECT_THAT(steps(), ElementsAre(10, 20, 30, 40));
  EXPECT_THAT(steps(), ElementsAre(10, 20, 30, 40, 45, 50, 60));
}

// A dump that was cut off, and another behind it: it will not be completed, and must not be left out in silence.
TEST_F(FollowedInputTest, WhatIsBadBeforeAnotherFrameIsKnownToBeBad) {
  append("d10", grains(10));
  append("d20", grains(20).substr(0, grains(20).size() - 5));
  steps();
  EXPECT_THAT(steps(), ElementsAre(10));
  append("d30", grains(30));
  EXPECT_THAT(steps(), ElementsAre(10));
  EXPECT_THAT(steps(), ElementsAre(10, 20, 30));
  const auto source = input_.look();
  ASSERT_NE(source, nullptr);
  EXPECT_THROW(source->read(1, Column::radius), InputError);
}

TEST_F(FollowedInputTest, AMalformedHeaderBeforeAnotherFrameIsAnErrorOrSkipped) {
  append("d10", grains(10));
  append("d20", "ITEM: TIMESTEP\ntwenty\n");
  append("d30", grains(30));
  FollowedInput failing(spec_);
  EXPECT_EQ(failing.look(), nullptr);  // all may still be written to
  EXPECT_THROW(failing.look(), InputError);
  spec_.on_error = OnError::skip_frame;
  FollowedInput skipping(spec_);
  skipping.look();
  const auto source = skipping.look();
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(source->frames().size(), 2U);
  ASSERT_EQ(source->unreadable().size(), 1U);
  EXPECT_THAT(source->unreadable()[0].reason, ::testing::HasSubstr("d20:2"));
}

TEST_F(FollowedInputTest, EndsWithTheLastStep) {
  for (int step : {10, 20, 30}) append(dump_name(step), grains(step));
  steps();
  EXPECT_THAT(steps(25), ElementsAre(10, 20));
}

TEST_F(FollowedInputTest, CompressedFilesAreThereWhenTheyAreWhole) {
  const std::string whole = gzipped(grains(10));
  append("d10.gz", whole.substr(0, whole.size() - 4));
  for (int look = 0; look < 3; ++look) EXPECT_THAT(steps(), IsEmpty());
  append("d10.gz", whole.substr(whole.size() - 4));
  steps();
  EXPECT_THAT(steps(), ElementsAre(10));
}

}  // namespace
}  // namespace grainvdb::followed_input_test
