/// Malformed rows of particle dumps.
#include "unit/read/dump_files.hpp"

namespace grainvdb::row_faults_test {
namespace {

using namespace testing_dumps;

constexpr const char* columns = "id type x y z vx vy vz radius mass";
constexpr const char* good = "1 1 0.1 0.2 0.3 1 2 3 0.5 2";

class RowFaults : public ::testing::Test {
 protected:
  void refuses_text(const std::string& text, int line, std::vector<std::string> parts, ColumnSet wanted) {
    const std::string path = files_.write("dump", text);
    parts.push_back(path + ":" + std::to_string(line) + ": ");
    expect_error<InputError>([&] { open_dumps(particles_in({path}))->read(0, wanted); }, parts);
  }
  void refuses(const std::vector<std::string>& rows, int line, const std::vector<std::string>& parts) {
    refuses_text(particle_dump(0, columns, rows), line, parts, everything);
  }
  static constexpr ColumnSet everything = Column::velocity | Column::radius | Column::mass | Column::type;
  DumpFiles files_;
};

TEST_F(RowFaults, TheRowOfTheseTestsIsRightAsItStands) {
  const auto source = open_dumps(particles_in({files_.write("dump", particle_dump(0, columns, {good}))}));
  EXPECT_EQ(source->read(0, everything).particles.size(), 1U);
}

TEST_F(RowFaults, ValuesThatAreNoFiniteNumbers) {
  for (const char* value : {"nan", "-nan", "inf", "-inf", "1.5e", "1,5", "abc", "0x1", "1e999", "--1", "1.5.5"}) {
    refuses({good, cat({"2 1 0.1 ", value, " 0.3 1 2 3 0.5 2"})}, 11, {"column y", cat({"'", value, "'"}), "finite"});
    refuses({good, cat({"2 1 0.1 0.2 0.3 1 2 ", value, " 0.5 2"})}, 11, {"column vz", cat({"'", value, "'"})});
    refuses({good, cat({"2 1 0.1 0.2 0.3 1 2 3 0.5 ", value})}, 11, {"column mass", cat({"'", value, "'"})});
  }
}

TEST_F(RowFaults, IdsAndTypesThatAreNotWhole) {
  for (const char* value : {"1.5", "x", "nan", "1e2", "99999999999999999999"}) {
    refuses({cat({value, " 1 0 0 0 0 0 0 1 1"})}, 10, {"column id", cat({"'", value, "'"}), "whole number"});
    refuses({cat({"1 ", value, " 0 0 0 0 0 0 1 1"})}, 10, {"column type", cat({"'", value, "'"})});
  }
  refuses({"1e+06 1 0 0 0 0 0 0 1 1"}, 10, {"column id", "dump_modify"});
  refuses({"0 1 0 0 0 0 0 0 1 1"}, 10, {"column id", "found 0", "from 1"});
  refuses({good, "-4 1 0 0 0 0 0 0 1 1"}, 11, {"column id", "found -4"});
  refuses({"9007199254740992 1 0 0 0 0 0 0 1 1"}, 10, {"column id", "2^53"});
  refuses({"1 3000000000 0 0 0 0 0 0 1 1"}, 10, {"column type", "3000000000"});
}

TEST_F(RowFaults, ShortAndLongRows) {
  refuses({good, "2 1 0.1 0.2"}, 11, {"too short", "4 fields", "10 (id type x y z vx vy vz radius mass)"});
  refuses({good, ""}, 11, {"too short", "0 fields"});
  refuses({good, std::string(good) + " 7"}, 11, {"too long", "11 fields", "10 (id"});
}

TEST_F(RowFaults, ShortRowsAreFoundWhateverColumnsAreWanted) {
  refuses_text(particle_dump(0, columns, {"1 1 0.1 0.2 0.3 1 2 3 0.5"}), 10, {"too short", "9 fields"}, {});
  refuses_text(particle_dump(0, columns, {std::string(good) + " 1"}), 10, {"too long", "11 fields"}, {});
}

TEST_F(RowFaults, DuplicateIds) {
  refuses({"5 1 0 0 0 0 0 0 1 1", "7 1 0 0 0 0 0 0 1 1", "5 1 1 1 1 0 0 0 1 1"}, 12, {"id 5 comes twice", "line 10"});
}

TEST_F(RowFaults, RadiusAndMassMustBePositive) {
  for (const char* value : {"0", "-1", "-0.0", "1e-999"}) {
    refuses({good, cat({"2 1 0 0 0 0 0 0 ", value, " 1"})}, 11, {"column radius", "above 0"});
    refuses({good, cat({"2 1 0 0 0 0 0 0 1 ", value})}, 11, {"column mass", "above 0"});
  }
  refuses_text(particle_dump(0, "id x y z diameter", {"1 0 0 0 0"}), 10, {"column diameter", "found 0", "above 0"},
               Column::radius);
  refuses_text(particle_dump(0, "id x y z radius density", {"1 0 0 0 1 -2"}), 10, {"column density", "found -2"},
               Column::mass);
  refuses_text(particle_dump(0, "id x y z radius density", {"1 0 0 0 -1 2"}), 10, {"column radius", "found -1"},
               Column::mass);
}

TEST_F(RowFaults, MissingRows) {
  std::string text = particle_dump(0, columns, {good, "2 1 0 0 0 0 0 0 1 1"});
  text.replace(text.find("ATOMS\n2"), 7, "ATOMS\n3");
  refuses_text(text, 11, {"ends within a frame", "2 rows", "3 ATOMS", "cut off"}, everything);
}

TEST_F(RowFaults, MissingRowsBeforeAnotherFrame) {
  std::string text = particle_dump(0, columns, {good, "2 1 0 0 0 0 0 0 1 1"});
  text.replace(text.find("ATOMS\n2"), 7, "ATOMS\n3");
  refuses_text(text + particle_dump(1, columns, {good}), 12, {"begins too early", "after 2 rows", "3 ATOMS"},
               everything);
}

TEST_F(RowFaults, MoreRowsThanAnnounced) {
  std::string text = particle_dump(0, columns, {good, "2 1 0 0 0 0 0 0 1 1"});
  text.replace(text.find("ATOMS\n2"), 7, "ATOMS\n1");
  refuses_text(text, 11, {"after the last row", "1 ATOMS"}, everything);
  text.replace(text.find("ATOMS\n1"), 7, "ATOMS\n0");
  refuses_text(text, 10, {"after the last row", "0 ATOMS"}, everything);
}

TEST_F(RowFaults, ALastLineWithoutNewlineIsIncompleteEvenIfItParses) {
  std::string text = particle_dump(0, columns, {good, "2 1 0 0 0 0 0 0 1 0.61"});
  text.pop_back();
  refuses_text(text, 11, {"newline", "incomplete", "2 ATOMS"}, everything);
  text.pop_back();  // 0.61 is 0.6 now
  refuses_text(text, 11, {"newline", "incomplete"}, everything);
  text += '\n';
  EXPECT_EQ(open_dumps(particles_in({files_.write("dump", text)}))->read(0, everything).particles.mass[1], 0.6);
}

TEST_F(RowFaults, MissingColumns) {
  const std::string text = particle_dump(0, "id type xs y zs c_radius", {"1 1 0 0 0 1"});
  refuses_text(text, 9,
               {"lacks columns", "found id type xs y zs c_radius", "x y z (or xu yu zu", "vx vy vz",
                "omegax omegay omegaz", "radius or diameter", "mass or density", "input.radius", "input.density"},
               every_particle_column);
  refuses_text(particle_dump(0, "x y z", {"0 0 0"}), 9, {"lacks columns", "found x y z", "expected id"}, {});
  refuses_text(particle_dump(0, "id x y z", {"1 0 0 0"}), 9, {"expected type"}, Column::type);
}

TEST_F(RowFaults, RadiiAreNeededForMassesFromADensity) {
  InputSpec spec = particles_in({files_.write("dump", particle_dump(0, "id x y z", {"1 0 0 0"}))});
  spec.density = 2500;
  expect_error<InputError>([&] { open_dumps(spec)->read(0, Column::mass); },
                           {":9", "radius or diameter", "input.radius"});
}

TEST_F(RowFaults, AColumnTwice) {
  refuses_text(particle_dump(0, "id x y z x", {"1 0 0 0 0"}), 9, {"two columns are named x"}, {});
}

TEST_F(RowFaults, LinesAreCountedAfterDecompressionToo) {
  const std::string text =
      particle_dump(0, columns, {good}) + particle_dump(1, columns, {good, "2 1 0 0 0 0 0 0 1 nan"});
  for (const std::string& content : {gzipped(text), zstd_compressed(text)}) {
    const std::string path = files_.write("dump", content);
    const auto source = open_dumps(particles_in({path}));
    source->read(0, everything);
    expect_error<InputError>([&] { source->read(1, everything); }, {path + ":21", "column mass", "'nan'"});
  }
}

}  // namespace
}  // namespace grainvdb::row_faults_test
