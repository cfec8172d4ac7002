/// Binary dumps that LAMMPS wrote, compared with the text dumps of the same run, and files that are wrong.
#include <cstring>
#include <limits>

#include "unit/read/sample_formats.hpp"

namespace grainvdb::binary_dump_test {
namespace {

using namespace testing_dumps;
using ::testing::ElementsAre;

constexpr ColumnSet all_columns = every_particle_column | Column::force;

template <class T>
std::string bytes_of(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

/// A frame in the old format: two atoms with the columns x y z id, in two chunks.
struct OldFrame {
  std::int64_t step = 7, atoms = 2;
  std::int32_t tilted = 0, first_boundary = 0, columns = 4, chunks = 2, numbers = 4;
  std::vector<double> tilts{};
  std::vector<double> values{0.25, 0.5, 1, 2, 0.75, 1, 1.5, 1};

  std::string text() const {
    std::string all =
        bytes_of(step) + bytes_of(atoms) + bytes_of(tilted) + bytes_of(first_boundary) + bytes_of(std::int32_t{0});
    for (int side = 0; side < 4; ++side) all += bytes_of(std::int32_t{1});
    for (int axis = 0; axis < 3; ++axis) all += bytes_of(0.0) + bytes_of(2.0 + axis);
    for (const double tilt : tilts) all += bytes_of(tilt);
    all += bytes_of(columns) + bytes_of(chunks);
    for (std::size_t k = 0; k < values.size(); ++k) all += (k % 4 == 0 ? bytes_of(numbers) : "") + bytes_of(values[k]);
    return all;
  }
};

class BinaryDumps : public ::testing::Test {
 protected:
  void expect_refused(const std::string& content, const std::vector<std::string>& parts) const {
    InputSpec spec = particles_in({files_.write("wrong.bin", content)});
    spec.columns = {"x", "y", "z", "id"};
    expect_error<InputError>([&] { open_dumps(spec)->read(0, {}); }, parts);
  }

  DumpFiles files_;
};

TEST_F(BinaryDumps, IsTheTextDumpOfTheSameRun) {
  const auto text = open_dumps(particles_in({sample("lammps.dump")}));
  const auto binary = open_dumps(particles_in({sample("lammps.bin")}));
  ASSERT_EQ(text->frames().size(), 3U);
  ASSERT_EQ(binary->frames().size(), 3U);
  EXPECT_EQ(binary->units().name, "si");
  EXPECT_EQ(binary->particle_columns(), text->particle_columns());
  for (const std::size_t k : {2U, 0U, 1U}) {
    const Frame a = text->read(k, all_columns);
    Frame b = binary->read(k, all_columns);
    // The text of the time has 16 digits.
    ASSERT_TRUE(a.time && b.time);
    EXPECT_NEAR(*a.time, *b.time, 1e-15 * *b.time);
    b.time = a.time;
    expect_same(a, b);
    EXPECT_EQ(a.particles.force, b.particles.force);
    EXPECT_EQ(b.particles.size(), 5U);
  }
}

TEST_F(BinaryDumps, IsTheSameCompressed) {
  const std::string content = content_of(sample("lammps.bin"));
  const Frame plain = open_dumps(particles_in({sample("lammps.bin")}))->read(1, all_columns);
  for (const std::string& name :
       {files_.write("a.bin.gz", gzipped(content)), files_.write("a.bin.zst", zstd_compressed(content))})
    expect_same(open_dumps(particles_in({name}))->read(1, all_columns), plain);
}

/// `dump atom` gives scaled positions.
TEST_F(BinaryDumps, OfTheStyleAtom) {
  const Frame atom = open_dumps(particles_in({sample("lammps_atom.bin")}))->read(2, Column::type);
  const Frame text = open_dumps(particles_in({sample("lammps.dump")}))->read(2, Column::type);
  EXPECT_EQ(atom.particles.id, text.particles.id);
  EXPECT_EQ(atom.particles.type, text.particles.type);
  // Scaling and its inverse round a few times, in numbers up to 0.01.
  expect_near(atom.particles.position, text.particles.position, 4 * std::numeric_limits<double>::epsilon() * 0.01);
}

TEST_F(BinaryDumps, OfTheOldFormatTakesItsColumnsFromTheInput) {
  InputSpec spec = particles_in({files_.write("old.bin", OldFrame().text() + OldFrame{8}.text())});
  expect_error<ConfigError>([&] { open_dumps(spec); }, {"does not say what its 4 columns are", "input.columns"});
  spec.columns = {"x", "id"};
  expect_error<ConfigError>([&] { open_dumps(spec); }, {"input.columns does not fit", "2 names", "4"});
  spec.columns = {"x", "y", "z", "id"};
  const auto source = open_dumps(spec);
  ASSERT_EQ(source->frames().size(), 2U);
  EXPECT_EQ(source->frames()[0].step, 7);
  EXPECT_EQ(source->frames()[1].step, 8);
  EXPECT_FALSE(source->frames()[0].time);
  const Frame frame = source->read(1, {});
  EXPECT_EQ(frame.box, (Box{{0, 0, 0}, {2, 3, 4}, {true, false, false}}));
  EXPECT_THAT(frame.particles.id, ElementsAre(1, 2));
  EXPECT_THAT(frame.particles.position[0], ElementsAre(0.75, 0.25));
  EXPECT_THAT(frame.particles.position[2], ElementsAre(1.5, 1));
}

TEST_F(BinaryDumps, CutOffAnywhereIsNeverAFrame) {
  const std::string content = content_of(sample("lammps.bin"));
  const std::size_t frame = 4 * content.size() / 10;  // within the second frame
  for (std::size_t size = 120; size < frame; size += 37) {
    InputSpec spec = particles_in({files_.write("cut.bin", content.substr(0, size))});
    try {
      const auto source = open_dumps(spec);
      for (std::size_t k = 0; k < source->frames().size(); ++k) {
        const Frame read = source->read(k, all_columns);
        EXPECT_EQ(read.particles.size(), 5U) << size;
        EXPECT_EQ(k, 0U) << size;  // the first frame is whole
      }
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("at byte ")) << size;
      EXPECT_THAT(error.what(), ::testing::HasSubstr("cut off")) << size;
    }
  }
}

TEST_F(BinaryDumps, RefusesWhatCannotBeMeant) {
  const std::string good = content_of(sample("lammps.bin"));
  const auto with = [&](std::size_t at, const std::string& bytes) {
    std::string content = good;
    content.replace(at, bytes.size(), bytes);
    return content;
  };
  // Offsets: 8 + 10 bytes of name, byte order at 18, revision at 22, step at 26, atoms at 34, tilt at 42,
  // boundaries at 46, bounds at 70, columns at 118.
  expect_refused(with(18, bytes_of(std::int32_t{0x01000000})), {"byte order", "at byte 22"});
  expect_refused(with(22, bytes_of(std::int32_t{9})), {"unknown revision", "9"});
  expect_refused(with(26, bytes_of(std::int64_t{-5})), {"timestep is below 0"});
  expect_refused(with(34, bytes_of(std::int64_t{-1})), {"number of atoms is below 0"});
  expect_refused(with(46, bytes_of(std::int32_t{1})), {"boundaries of the box"});
  expect_refused(with(70, bytes_of(5.0)), {"box is empty along x"});
  expect_refused(with(118, bytes_of(std::int32_t{-3})), {"number of columns"});
  expect_refused(with(118, bytes_of(std::int32_t{15})), {"do not have a name each", "16 names", "15"});
  expect_refused(with(122, bytes_of(std::int32_t{1 << 30})), {"length of the units"});
}

/// A count that no file has the rows for takes no memory.
TEST_F(BinaryDumps, ACountIsNotTrusted) {
  std::string content = content_of(sample("lammps.bin"));
  content.replace(34, 8, bytes_of(std::int64_t{1} << 60));
  expect_refused(content, {"ends too early", "5 rows", std::to_string(std::int64_t{1} << 60)});
}

TEST_F(BinaryDumps, RefusesChunksAndValuesThatAreWrong) {
  OldFrame wrong;
  wrong.numbers = 3;
  expect_refused(wrong.text(), {"size that does not fit the frame", "3 numbers", "4 columns"});
  wrong.numbers = -4;
  expect_refused(wrong.text(), {"size that does not fit the frame", "-4 numbers"});
  wrong = {};
  wrong.atoms = 1;
  expect_refused(wrong.text(), {"size that does not fit the frame", "0 of 1"});
  wrong = {};
  wrong.tilted = 1;
  wrong.tilts = {0, 1e-9, 0};
  expect_refused(wrong.text(), {"triclinic", "all tilts 0"});
}

TEST_F(BinaryDumps, ATiltedBoxWithoutTiltIsOrthogonal) {
  OldFrame frame;
  frame.tilted = 1;
  frame.tilts = {0, -0.0, 0};
  InputSpec spec = particles_in({files_.write("old.bin", frame.text())});
  spec.columns = {"x", "y", "z", "id"};
  const Frame read = open_dumps(spec)->read(0, {});
  EXPECT_EQ(read.box, (Box{{0, 0, 0}, {2, 3, 4}, {true, false, false}}));
  EXPECT_EQ(read.particles.size(), 2U);
}

TEST_F(BinaryDumps, RefusesValuesThatAreNoNumbers) {
  std::string content = content_of(sample("lammps.bin"));
  // The first row begins behind the names of the columns, the number of chunks and the size of the first.
  const std::size_t row = content.find("radius mass") + 11 + 4 + 4;
  std::string wrong = content;
  wrong.replace(row, 8, bytes_of(1.5));
  expect_refused(wrong, {"column id of row 1", "1.5", "a whole number"});
  wrong = content;
  wrong.replace(row + 16, 8, bytes_of(std::numeric_limits<double>::quiet_NaN()));
  expect_refused(wrong, {"column x of row 1", "nan", "a finite number"});
}

}  // namespace
}  // namespace grainvdb::binary_dump_test
