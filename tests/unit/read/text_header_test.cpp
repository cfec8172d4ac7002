#include "read/text_header.hpp"

#include "unit/read/dump_files.hpp"

namespace grainvdb::text_header_test {
namespace {

using namespace testing_dumps;
using ::testing::ElementsAre;

class TextHeaderTest : public ::testing::Test {
 protected:
  FrameHeader header(const std::string& text) {
    LineReader lines(open_bytes(files_.write("dump", text), counter_).bytes, "dump");
    const auto result = TextHeaderReader(lines).read();
    if (!result) throw std::runtime_error("no header");
    return *result;
  }
  DumpFiles files_;
  std::size_t counter_ = 0;
};

TEST_F(TextHeaderTest, Liggghts) {
  const FrameHeader h = header(
      "ITEM: TIMESTEP\n306000\nITEM: NUMBER OF ATOMS\n7688\nITEM: BOX BOUNDS pp pp ff\n0 0.0096\n0 0.0096\n-0.0016 "
      "0.0457055\n"
      "ITEM: ATOMS id type x y z radius mass \n");
  EXPECT_EQ(h.step, 306000);
  EXPECT_EQ(h.rows, 7688U);
  EXPECT_EQ(h.kind, RowKind::particles);
  EXPECT_EQ(h.box, (Box{{0, 0, -0.0016}, {0.0096, 0.0096, 0.0457055}, {true, true, false}}));
  EXPECT_THAT(h.columns, ElementsAre("id", "type", "x", "y", "z", "radius", "mass"));
  EXPECT_EQ(h.columns_line, 9U);
  EXPECT_FALSE(h.time);
  EXPECT_FALSE(h.units);
}

TEST_F(TextHeaderTest, LammpsWithUnitsAndTime) {
  const FrameHeader h = header(
      "ITEM: UNITS\nlj\nITEM: TIME\n0.35\nITEM: TIMESTEP\n7000\nITEM: NUMBER OF ATOMS\n3\n"
      "ITEM: BOX BOUNDS fs pp mm\n-1.6000000000000000e+01 1.6000000000000000e+01\n0 8\n-10 80\nITEM: ATOMS id xs ys "
      "zs\n");
  EXPECT_EQ(h.units, "lj");
  EXPECT_EQ(h.units_line, 2U);
  EXPECT_EQ(h.time, 0.35);
  EXPECT_EQ(h.step, 7000);
  EXPECT_EQ(h.box, (Box{{-16, 0, -10}, {16, 8, 80}, {false, true, false}}));
}

TEST_F(TextHeaderTest, SectionsInAnotherOrder) {
  const FrameHeader h = header(
      "ITEM: NUMBER OF ATOMS\n0\nITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\nITEM: TIMESTEP\n5\nITEM: TIME\n-2\nITEM: "
      "ATOMS id\n");
  EXPECT_EQ(h.step, 5);
  EXPECT_EQ(h.time, -2.0);
  EXPECT_EQ(h.rows, 0U);
}

TEST_F(TextHeaderTest, ContactsUnderTheirUsualAndAnotherLabel) {
  const std::string box = "ITEM: BOX BOUNDS pp pp ff\n0 1\n0 1\n0 1\n";
  const FrameHeader usual =
      header("ITEM: TIMESTEP\n1\nITEM: NUMBER OF ENTRIES\n2\n" + box + "ITEM: ENTRIES c_a[1] c_a[2] \n");
  EXPECT_EQ(usual.kind, RowKind::contacts);
  const FrameHeader other =
      header("ITEM: TIMESTEP\n1\nITEM: NUMBER OF MY PAIRS\n2\n" + box + "ITEM: MY PAIRS c_a[1] c_a[2]\n");
  EXPECT_EQ(other.kind, RowKind::contacts);
  EXPECT_THAT(other.columns, ElementsAre("c_a[1]", "c_a[2]"));
}

TEST_F(TextHeaderTest, CarriageReturnsAreNoPartOfNames) {
  const FrameHeader h = header(
      "ITEM: TIMESTEP\r\n1\r\nITEM: NUMBER OF ATOMS\r\n0\r\nITEM: BOX BOUNDS pp pp ff\r\n0 1\r\n0 1\r\n0 1\r\nITEM: "
      "ATOMS id x\r\n");
  EXPECT_THAT(h.columns, ElementsAre("id", "x"));
}

TEST_F(TextHeaderTest, ATiltedBoxWithoutTiltIsOrthogonal) {
  const FrameHeader h = header(
      "ITEM: TIMESTEP\n1\nITEM: NUMBER OF ATOMS\n0\nITEM: BOX BOUNDS xy xz yz pp pp ff\n0 1 0\n0 2 0.0\n0 3 "
      "-0.0\nITEM: ATOMS id\n");
  EXPECT_EQ(h.box, (Box{{0, 0, 0}, {1, 2, 3}, {true, true, false}}));
}

}  // namespace
}  // namespace grainvdb::text_header_test
