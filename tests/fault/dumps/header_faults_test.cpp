/// Malformed headers of text dumps: each gives one error with file, line, what was found and what was expected.
#include "unit/read/dump_files.hpp"

namespace grainvdb::header_faults_test {
namespace {

using namespace testing_dumps;

class HeaderFaults : public ::testing::Test {
 protected:
  /// A header whose parts can be replaced.
  struct Parts {
    std::string step = "ITEM: TIMESTEP\n7\n";
    std::string count = "ITEM: NUMBER OF ATOMS\n1\n";
    std::string box = "ITEM: BOX BOUNDS pp pp ff\n0 1\n0 1\n0 1\n";
    std::string columns = "ITEM: ATOMS id x y z\n";
    std::string rows = "1 0.1 0.2 0.3\n";
    std::string text() const { return step + count + box + columns + rows; }
  };
  void refuses(const std::string& content, int line, std::vector<std::string> parts) {
    const std::string path = files_.write("dump", content);
    parts.push_back(path + ":" + std::to_string(line) + ": ");
    expect_error<InputError>([&] { open_dumps(particles_in({path})); }, parts);
  }
  void refuses(const Parts& header, int line, const std::vector<std::string>& parts) {
    refuses(header.text(), line, parts);
  }
  void refuses_box(const std::string& box, int line, const std::vector<std::string>& parts) {
    Parts p;
    p.box = box;
    refuses(p, line, parts);
  }
  DumpFiles files_;
};

TEST_F(HeaderFaults, TheHeaderOfTheseTestsIsRightAsItStands) {
  EXPECT_EQ(open_dumps(particles_in({files_.write("dump", Parts().text())}))->frames().size(), 1U);
}

TEST_F(HeaderFaults, MissingSections) {
  Parts p;
  p.step = "";
  refuses(p, 7, {"no 'ITEM: TIMESTEP'", "'ITEM: ATOMS'"});
  p = {};
  p.count = "";
  refuses(p, 7, {"no 'ITEM: NUMBER OF ATOMS'"});
  p = {};
  p.box = "";
  refuses(p, 5, {"no 'ITEM: BOX BOUNDS'"});
  p = {};
  p.columns = "";
  refuses(p, 9, {"belongs to no section", "'1 0.1 0.2 0.3'", "ITEM:"});
}

TEST_F(HeaderFaults, RepeatedSections) {
  Parts p;
  p.step += p.step;
  refuses(p, 3, {"second 'ITEM: TIMESTEP'"});
  p = {};
  p.box += p.box;
  refuses(p, 9, {"second 'ITEM: BOX BOUNDS'"});
}

TEST_F(HeaderFaults, UnknownSection) {
  Parts p;
  p.step = "ITEM: TIMESTAMP\n7\n";
  refuses(p, 1, {"unknown section", "ITEM: TIMESTAMP", "TIMESTEP"});
}

TEST_F(HeaderFaults, RowsThatWereNotCounted) {
  Parts p;
  p.columns = "ITEM: ENTRIES id x y z\n";
  refuses(p, 9, {"not what was counted", "ENTRIES", "ATOMS"});
}

TEST_F(HeaderFaults, BadTimestep) {
  for (const char* step : {"-1", "7.5", "1e6", "seven", "", "7 8", "nan", "99999999999999999999"}) {
    Parts p;
    p.step = "ITEM: TIMESTEP\n" + std::string(step) + "\n";
    refuses(p, 2, {"found '" + std::string(step) + "'"});
  }
}

TEST_F(HeaderFaults, BadTime) {
  for (const char* time : {"nan", "inf", "-", "1.5e", "1 2"}) {
    Parts p;
    p.step += "ITEM: TIME\n" + std::string(time) + "\n";
    refuses(p, 4, {"found '" + std::string(time) + "'"});
  }
}

TEST_F(HeaderFaults, BadCount) {
  for (const char* count : {"-1", "1.5", "1e3", "many", "", "1 2", "nan", "99999999999999999999"}) {
    Parts p;
    p.count = "ITEM: NUMBER OF ATOMS\n" + std::string(count) + "\n";
    refuses(p, 4, {"found '" + std::string(count) + "'"});
  }
}

TEST_F(HeaderFaults, AbsurdCountAllocatesNothing) {
  Parts p;
  p.count = "ITEM: NUMBER OF ATOMS\n9223372036854775807\n";
  const std::string path = files_.write("dump", p.text());
  const auto source = open_dumps(particles_in({path}));
  expect_error<InputError>([&] { source->read(0, {}); },
                           {path + ":10", "ends within a frame", "1 rows", "9223372036854775807 ATOMS"});
}

TEST_F(HeaderFaults, BadBounds) {
  refuses_box("ITEM: BOX BOUNDS pp pp ff\n1 1\n0 1\n0 1\n", 6, {"empty along x", "'1 1'", "lo < hi"});
  refuses_box("ITEM: BOX BOUNDS pp pp ff\n0 1\n2 1\n0 1\n", 7, {"empty along y", "'2 1'"});
  refuses_box("ITEM: BOX BOUNDS pp pp ff\n0 1\n0 1\n0 nan\n", 8, {"along z are not numbers", "'0 nan'"});
  refuses_box("ITEM: BOX BOUNDS pp pp ff\n-inf 1\n0 1\n0 1\n", 6, {"along x are not numbers", "'-inf 1'"});
  refuses_box("ITEM: BOX BOUNDS pp pp ff\n-1e308 1e308\n0 1\n0 1\n", 6, {"too long along x"});
  refuses_box("ITEM: BOX BOUNDS pp pp ff\n0\n0 1\n0 1\n", 6, {"along x are not numbers"});
  refuses_box("ITEM: BOX BOUNDS pp pp ff\n0 1 0\n0 1 0\n0 1 0\n", 6, {"too many values", "'0 1 0'"});
  refuses_box("ITEM: BOX BOUNDS pp pp ff\n0 1\n0 1\n", 8, {"along z are not numbers", "ITEM: ATOMS"});
}

TEST_F(HeaderFaults, BadBoundaryLetters) {
  refuses_box("ITEM: BOX BOUNDS\n0 1\n0 1\n0 1\n", 5, {"which axes are periodic", "pp pp ff", "Old versions"});
  refuses_box("ITEM: BOX BOUNDS pp pp\n0 1\n0 1\n0 1\n", 5, {"boundary letters", "pp pp"});
  refuses_box("ITEM: BOX BOUNDS pp pp ff ff\n0 1\n0 1\n0 1\n", 5, {"boundary letters"});
  refuses_box("ITEM: BOX BOUNDS pp pp qq\n0 1\n0 1\n0 1\n", 5, {"boundary letters", "pp pp qq"});
  refuses_box("ITEM: BOX BOUNDS pp ps ff\n0 1\n0 1\n0 1\n", 5, {"periodic on one side only", "'ps'"});
}

TEST_F(HeaderFaults, TiltedBoxes) {
  refuses_box("ITEM: BOX BOUNDS xy xz yz pp pp ff\n0 1 0.25\n0 1 0\n0 1 0\n", 6,
              {"triclinic", "'0 1 0.25'", "orthogonal"});
  refuses_box("ITEM: BOX BOUNDS xy xz yz pp pp ff\n0 1 0\n0 1 0\n0 1 -1e-9\n", 8, {"triclinic"});
  refuses_box("ITEM: BOX BOUNDS abc origin pp pp ff\n1 0 0 0\n0 1 0 0\n0 0 1 0\n", 5,
              {"general triclinic", "orthogonal"});
}

TEST_F(HeaderFaults, ColumnsWithoutNames) {
  Parts p;
  p.columns = "ITEM: ATOMS\n";
  refuses(p, 9, {"no names", "ITEM: ATOMS"});
}

TEST_F(HeaderFaults, NamesThatNobodyCanRead) {
  Parts p;
  p.columns = "ITEM: ATOMS id x y z c_\x01\n";
  refuses(p, 9, {"column name", "'c_\\x01'"});
  p.columns = "ITEM: ATOMS id x y z " + std::string(1000, 'c') + "\n";
  refuses(p, 9, {"column name", "200 printable"});
  p = {};
  p.count = "ITEM: NUMBER OF AT\x01OMS\n1\n";
  refuses(p, 3, {"label", "'AT\\x01OMS'"});
}

TEST_F(HeaderFaults, FilesThatEndWithinTheHeader) {
  const std::string text = Parts().text();
  // Cut after every line of the header, and within every line.
  std::size_t end = 0;
  for (int line = 1; line <= 9; ++line) {
    const std::size_t start = end;
    end = text.find('\n', start) + 1;
    if (end - start > 7) refuses(text.substr(0, end - 2), line, {"ends within the header", "cut off"});
    if (line < 9) refuses(text.substr(0, end), line, {"ends within the header", "cut off"});
  }
}

TEST_F(HeaderFaults, GarbageBetweenFrames) {
  const std::string text = Parts().text();
  std::string second = text;
  second.replace(second.find("\n7\n"), 3, "\n8\n");
  refuses(text + "garbage\n" + second, 11, {"after the last row", "'garbage'", "1 ATOMS"});
  refuses(text + "\n" + second, 11, {"after the last row", "''"});
  refuses(text + "1 2 3", 11, {"after the last row", "'1 2 3'"});
}

}  // namespace
}  // namespace grainvdb::header_faults_test
