/// Files that are not dumps, are damaged, or do not go together.
#include "unit/read/dump_files.hpp"

namespace grainvdb::file_faults_test {
namespace {

using namespace testing_dumps;

std::string frame(std::int64_t step) {
  return particle_dump(step, "id x y z", {"1 1 2 3", "2 4 5 6"});
}

class FileFaults : public ::testing::Test {
 protected:
  void refuses(const std::string& content, std::vector<std::string> parts) {
    const std::string path = files_.write("dump", content);
    parts.push_back(path);
    expect_error<InputError>([&] { open_dumps(particles_in({path})); }, parts);
  }
  DumpFiles files_;
};

TEST_F(FileFaults, EmptyFile) {
  refuses("", {"an empty file", "text dump"});
}

TEST_F(FileFaults, EmptyCompressedFile) {
  refuses(gzipped(""), {"an empty file"});
}

TEST_F(FileFaults, OtherFormatsAreNamed) {
  refuses("\x89HDF\r\n\x1a\n....", {"an HDF5 file"});
  refuses("# vtk DataFile Version 3.0\n", {"a legacy VTK file"});
  refuses("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">", {"a VTK XML file"});
  refuses(
      "\xf6\xff\xff\xff\xff\xff\xff\xff"
      "DUMPCUSTOM",
      {"ends within a frame, at byte 18", "cut off"});
  refuses("CDF\x01", {"a NetCDF file"});
  refuses("BZh91AY", {"a bzip2-compressed file"});
  refuses(std::string("\xfd") + "7zXZ", {"an xz-compressed file"});
  refuses("PK\x03\x04", {"a zip archive"});
  refuses("LIGGGHTS (Version 3.8)\n", {"a log file"});
  refuses("from a script\n\n100 atoms\n2 atom types\n", {"a LAMMPS data file"});
  refuses(std::string("\0\1\2", 3), {"binary data"});
  refuses("id,x,y,z\n1,2,3,4\n", {"a table of values separated by commas (CSV)"});
  refuses(gzipped("id,x,y,z\n"), {"a table of values separated by commas (CSV), compressed with gzip"});
}

TEST_F(FileFaults, CutOffCompressedFile) {
  for (const std::string& whole : {gzipped(frame(0)), zstd_compressed(frame(0))})
    refuses(whole.substr(0, whole.size() - 5), {"cut off"});
}

TEST_F(FileFaults, CorruptCompressedFile) {
  std::string gz = gzipped(frame(0)), zst = zstd_compressed(frame(0));
  gz[gz.size() / 2] = static_cast<char>(gz[gz.size() / 2] ^ 0x55);
  refuses(gz, {"corrupt"});
  refuses(gzipped(frame(0)) + "more", {"goes on with something else"});
  refuses(zstd_compressed(frame(0)) + "more of it", {"corrupt"});
}

TEST_F(FileFaults, WrongChecksumOfAGzipFile) {
  std::string gz = gzipped(frame(0));
  gz[gz.size() - 6] = static_cast<char>(gz[gz.size() - 6] ^ 1);
  refuses(gz, {"corrupt"});
}

TEST_F(FileFaults, MissingFileAndPatternWithoutMatch) {
  expect_error<IoError>([&] { open_dumps(particles_in({files_.path("none")})); }, {files_.path("none"), "cannot open"});
  InputSpec spec = particles_in({files_.path("dump*")});
  spec.where["input.particles"] = {"run.yaml", 3};
  expect_error<InputError>([&] { open_dumps(spec); }, {"run.yaml:3", "no file matches", "dump*"});
}

TEST_F(FileFaults, NoFramesAtAll) {
  expect_error<InputError>([] { open_dumps({}); }, {"no particle dumps are given"});
  files_.write("log", "a log");
  expect_error<InputError>([&] { open_dumps(particles_in({files_.directory()})); },
                           {"no particle dump in", files_.directory()});
}

TEST_F(FileFaults, OneStepInTwoFiles) {
  const std::string a = files_.write("a", frame(7)), b = files_.write("b", frame(3) + frame(7));
  expect_error<InputError>([&] { open_dumps(particles_in({a, b})); }, {"timestep 7 comes twice", a + ":1", b + ":12"});
}

TEST_F(FileFaults, OneStepTwiceInAFile) {
  refuses(frame(7) + frame(7), {"timestep 7 comes twice", "dump:1", "dump:12"});
}

TEST_F(FileFaults, ContactsAmongTheParticles) {
  refuses(contact_dump(0, "id1 id2 fx fy fz", {}), {":9", "dump of contacts", "among the particles"});
}

TEST_F(FileFaults, AFileThatChangesAfterItWasIndexed) {
  const std::string path = files_.write("dump", frame(0));
  const auto source = open_dumps(particles_in({path}));
  files_.write("dump", frame(5));
  expect_error<InputError>([&] { source->read(0, {}); }, {path + ":1", "changed", "timestep 0"});
}

TEST_F(FileFaults, AnEndlessLine) {
  refuses("ITEM: TIMESTEP\n" + std::string(2'000'000, '1'), {":2", "longer than 1 MiB"});
}

TEST_F(FileFaults, UnitsInConflictOrWithoutMeaning) {
  const std::string lj = files_.write("a", "ITEM: UNITS\nlj\n" + frame(0)),
                    si = files_.write("b", "ITEM: UNITS\nsi\n" + frame(1));
  expect_error<InputError>(
      [&] {
        open_dumps(particles_in({lj, si}));
      },
      {si + ":2", "units", "found 'si'", "'lj'", lj + ":2"});
  InputSpec spec = particles_in({lj});
  spec.units = "si";
  spec.where["input.units"] = {"run.yaml", 5};
  expect_error<InputError>([&] { open_dumps(spec); }, {lj + ":2", "units", "found lj", "si", "run.yaml:5"});
  for (const char* units : {"real", "metal", "electron", "furlong"}) {
    refuses("ITEM: UNITS\n" + std::string(units) + "\n" + frame(0), {":2", "not supported", units, "si, cgs"});
    InputSpec named = particles_in({si});
    named.units = units;
    expect_error<ConfigError>([&] { open_dumps(named); }, {"unknown units", units});
  }
}

TEST_F(FileFaults, ValuesOfThePipelineFileThatCannotBeMeant) {
  const std::string path = files_.write("dump", frame(0));
  for (double value : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    InputSpec dt = particles_in({path}), density = dt, radius = dt;
    dt.dt = density.density = radius.radius = value;
    dt.where["input"] = {"run.yaml", 1};
    expect_error<ConfigError>([&] { open_dumps(dt); }, {"run.yaml:1", "input.dt"});
    expect_error<ConfigError>([&] { open_dumps(density); }, {"input.density"});
    expect_error<ConfigError>([&] { open_dumps(radius); }, {"input.radius"});
  }
}

}  // namespace
}  // namespace grainvdb::file_faults_test
