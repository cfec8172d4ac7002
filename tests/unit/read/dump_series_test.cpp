/// The index of frames, the counters, and how files are told apart, through the public interface.
#include "unit/read/dump_files.hpp"

namespace grainvdb::dump_series_test {
namespace {

using namespace testing_dumps;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

std::vector<std::int64_t> steps(const FrameSource& source) {
  std::vector<std::int64_t> result;
  for (const FrameInfo& frame : source.frames()) result.push_back(frame.step);
  return result;
}

/// n rows of one length.
std::vector<std::string> rows(int n) {
  std::vector<std::string> result;
  for (int i = 1; i <= n; ++i) result.push_back(std::to_string(100'000 + i) + " 1.00000 2.00000 3.00000 0.50000");
  return result;
}
std::string frame(std::int64_t step, int n = 1) {
  return particle_dump(step, "id x y z radius", rows(n));
}
std::string contacts(std::int64_t step) {
  return contact_dump(step, "id1 id2 fx fy fz", {"100001 100002 1 2 " + std::to_string(step)});
}

class DumpSeriesTest : public ::testing::Test {
 protected:
  DumpFiles files_;
};

TEST_F(DumpSeriesTest, FramesAreSortedByStepWhateverTheNames) {
  files_.write("dump1000", frame(1000));
  files_.write("dump10000", frame(10000));
  files_.write("dump2000", frame(2000));
  files_.write("z", frame(0));
  EXPECT_THAT(steps(*open_dumps(particles_in({files_.directory()}))), ElementsAre(0, 1000, 2000, 10000));
}

TEST_F(DumpSeriesTest, FramesOfSeveralFilesInterleave) {
  const std::string a = files_.write("a", frame(0, 3) + frame(200, 4)),
                    b = files_.write("b", frame(100, 5) + frame(50, 6));
  const auto source = open_dumps(particles_in({a, b}));
  EXPECT_THAT(steps(*source), ElementsAre(0, 50, 100, 200));
  EXPECT_EQ(source->frames()[1].file, b);
  EXPECT_EQ(source->frames()[1].index_in_file, 1U);
  EXPECT_EQ(source->frames()[1].particle_count, 6U);
  for (const std::size_t k : {3, 1, 0, 2})
    EXPECT_EQ(source->read(k, {}).particles.size(), source->frames()[k].particle_count);
}

TEST_F(DumpSeriesTest, TimeFromTheDumpOrFromTheStep) {
  const std::string with_time = files_.write("a", "ITEM: TIME\n7.5\n" + frame(10));
  const std::string without = files_.write("b", frame(20));
  InputSpec spec = particles_in({with_time, without});
  EXPECT_EQ(open_dumps(spec)->frames()[0].time, 7.5);
  EXPECT_FALSE(open_dumps(spec)->frames()[1].time);
  spec.dt = 0.25;
  const auto source = open_dumps(spec);
  EXPECT_EQ(source->frames()[0].time, 7.5);
  EXPECT_EQ(source->frames()[1].time, 5.0);
  EXPECT_EQ(source->read(1, {}).time, 5.0);
}

TEST_F(DumpSeriesTest, UnitsFromTheDumpOrThePipelineFile) {
  const std::string bare = files_.write("a", frame(0)), named = files_.write("b", "ITEM: UNITS\nlj\n" + frame(1));
  EXPECT_EQ(open_dumps(particles_in({bare, named}))->units().name, "lj");
  InputSpec spec = particles_in({bare});
  EXPECT_EQ(open_dumps(spec)->units().name, "unspecified");
  EXPECT_EQ(open_dumps(spec)->units().symbol(dimension::velocity), "length/time");
  spec.units = "cgs";
  EXPECT_EQ(open_dumps(spec)->units().name, "cgs");
}

TEST_F(DumpSeriesTest, FilesAreListedWithTheirSizesAndContactsStayClosed) {
  const std::string particles = files_.write("dump0", frame(0)), contact = files_.write("contacts0", contacts(0));
  InputSpec spec = particles_in({particles});
  spec.contacts.files = {contact};
  const auto source = open_dumps(spec);
  EXPECT_THAT(source->files(), UnorderedElementsAre(std::pair(particles, std::uintmax_t{frame(0).size()}),
                                                    std::pair(contact, std::uintmax_t{contacts(0).size()})));
  source->read(0, Column::radius);
  EXPECT_THAT(source->counters().files_opened, ElementsAre(particles));
  EXPECT_THAT(source->counters().columns_parsed, UnorderedElementsAre("id", "x", "y", "z", "radius"));
  EXPECT_EQ(source->counters().frames_read, 1U);
  EXPECT_EQ(source->counters().rows_read, 1U);
  EXPECT_THAT(source->read(0, Column::contacts).contacts.force[0], ElementsAre(1));
  EXPECT_THAT(source->counters().files_opened, Contains(contact));
  EXPECT_EQ(source->counters().rows_read, 3U);
}

TEST_F(DumpSeriesTest, ContactColumnsOpenTheFirstContactFileOnly) {
  const std::string particles = files_.write("dump0", frame(0)), first = files_.write("contacts0", contacts(0)),
                    second = files_.write("contacts1", contacts(1));
  InputSpec spec = particles_in({particles});
  EXPECT_THAT(open_dumps(spec)->contact_columns(), IsEmpty());
  spec.contacts.files = {second, first};
  const auto source = open_dumps(spec);
  EXPECT_THAT(source->contact_columns(), ElementsAre("id1", "id2", "fx", "fy", "fz"));
  EXPECT_THAT(source->counters().files_opened, Not(Contains(second)));
  EXPECT_THAT(source->particle_columns(), ElementsAre("id", "x", "y", "z", "radius"));
}

TEST_F(DumpSeriesTest, ContactsArePairedByStep) {
  files_.write("dump1", frame(100));
  files_.write("dump2", frame(200));
  files_.write("contacts_a", contacts(200) + contacts(100));
  InputSpec spec = particles_in({files_.path("dump*")});
  spec.contacts.files = {files_.path("contacts*")};
  const auto source = open_dumps(spec);
  EXPECT_THAT(source->read(0, Column::contacts).contacts.force[2], ElementsAre(100));
  EXPECT_THAT(source->read(1, Column::contacts).contacts.force[2], ElementsAre(200));
}

TEST_F(DumpSeriesTest, ADirectoryMayHoldContactsAndOtherFilesToo) {
  const std::string dump = files_.write("dump0", frame(0)), contact = files_.write("contacts0", contacts(0));
  files_.write("log", "a log\n");
  files_.write("empty", "");
  files_.write("in.shear", "units si\n");
  InputSpec spec = particles_in({files_.directory()});
  spec.contacts.files = {files_.directory()};
  const auto source = open_dumps(spec);
  EXPECT_THAT(steps(*source), ElementsAre(0));
  const auto count = [](const auto& files, const std::string& path) {
    return std::count_if(files.begin(), files.end(), [&](const auto& file) { return file.first == path; });
  };
  EXPECT_EQ(count(source->files(), dump), 1);
  EXPECT_EQ(source->read(0, Column::contacts).contacts.size(), 1U);
  EXPECT_THAT(source->files(), UnorderedElementsAre(std::pair(dump, std::uintmax_t{frame(0).size()}),
                                                    std::pair(contact, std::uintmax_t{contacts(0).size()})));
  // Contact files that a glob names are not opened while particle dumps are looked for in their directory.
  spec.contacts.files = {files_.path("contacts*")};
  EXPECT_THAT(open_dumps(spec)->counters().files_opened, Not(Contains(contact)));
}

TEST_F(DumpSeriesTest, FilesOfOneFrameAreIndexedByTheirHeaders) {
  std::size_t total = 0;
  for (int k = 0; k < 10; ++k) {
    const std::string text = frame(k, 5000 + 100 * k);  // 0.19 MB and more
    total += text.size();
    files_.write("dump" + std::to_string(k), text);
  }
  const auto source = open_dumps(particles_in({files_.path("dump*")}));
  EXPECT_EQ(source->frames().size(), 10U);
  // The first file is read through, of the others only their first 16 KiB and the 512 bytes that tell the format.
  EXPECT_LE(source->counters().bytes_read, frame(0, 5000).size() + 9 * 16'384U + 10 * 512U);
  const std::size_t before = source->counters().bytes_read;
  for (std::size_t k = 0; k < 10; ++k) EXPECT_EQ(source->read(k, {}).particles.size(), 5000 + 100 * k);
  EXPECT_LE(source->counters().bytes_read - before, total + 10 * 512U);
}

TEST_F(DumpSeriesTest, AFileOfSeveralFramesAmongFilesOfOneIsNoticed) {
  const auto source_of = [&](std::string (*encode)(const std::string&)) {
    files_.write("dump0", encode(frame(0, 5000)));
    files_.write("dump1", encode(frame(1, 5000)));
    files_.write("dump2", encode(frame(2, 5000) + frame(3, 2000)));
    return open_dumps(particles_in({files_.path("dump*")}));
  };
  EXPECT_THAT(steps(*source_of([](const std::string& text) { return text; })), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(steps(*source_of(gzipped)), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(steps(*source_of(zstd_compressed)), ElementsAre(0, 1, 2, 3));
}

TEST_F(DumpSeriesTest, ASmallSecondFrameThatTheIndexMissesIsFoundWhenRead) {
  files_.write("dump0", frame(0, 5000));
  const std::string path = files_.write("dump1", frame(1, 5000) + frame(2, 10));
  const auto source = open_dumps(particles_in({files_.path("dump*")}));
  EXPECT_EQ(source->read(0, {}).particles.size(), 5000U);
  ASSERT_EQ(source->frames().size(), 2U);
  expect_error<InputError>([&] { source->read(1, {}); }, {path + ":5010", "another frame"});
}

TEST_F(DumpSeriesTest, ARowTooManyThatTheIndexMissesIsFoundWhenRead) {
  files_.write("dump0", frame(0, 5000));
  const std::string path = files_.write("dump1", frame(1, 5000) + "100000 1 2 3 0.5\n");
  const auto source = open_dumps(particles_in({files_.path("dump*")}));
  ASSERT_EQ(source->frames().size(), 2U);
  expect_error<InputError>([&] { source->read(1, {}); }, {path + ":5010", "after the last row", "5000 ATOMS"});
}

TEST_F(DumpSeriesTest, FramesOfOneFileReadInAnyOrderSeekDirectly) {
  std::string text;
  for (int k = 0; k < 20; ++k) text += frame(k, 2000);
  const auto source = open_dumps(particles_in({files_.write("dump", text)}));
  const std::size_t before = source->counters().bytes_read;
  source->read(19, {});
  source->read(3, {});
  // Two frames of 76 kB, each with the buffers before and after it.
  EXPECT_LE(source->counters().bytes_read - before, 2 * (frame(0, 2000).size() + 200'000));
}

TEST_F(DumpSeriesTest, ATruncatedLastFrameLeavesTheOthersUsable) {
  std::string text = frame(0, 50) + frame(1, 50);
  text.resize(text.size() - 3);
  const std::string path = files_.write("dump", text);
  const auto source = open_dumps(particles_in({path}));
  EXPECT_THAT(steps(*source), ElementsAre(0, 1));
  EXPECT_EQ(source->read(0, {}).particles.size(), 50U);
  expect_error<InputError>([&] { source->read(1, {}); }, {path + ":118", "newline"});
}

}  // namespace
}  // namespace grainvdb::dump_series_test
