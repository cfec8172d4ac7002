// Reading a text dump into a sorted frame, against what one would write in its place, and against reading its bytes.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <numeric>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include "check.hpp"
#include "grainvdb/frame_source.hpp"
#include "threads.hpp"

namespace grainvdb::bench {
namespace {

constexpr std::size_t atoms = 1'000'000, header_lines = 9, columns = 13;

/// Uniform and normal numbers that are the same with every standard library.
class Numbers {
 public:
  double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
  /// Nearly: the sum of twelve uniform numbers.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }
  std::size_t below(std::size_t n) { return engine_() % n; }

 private:
  std::mt19937_64 engine_{1};
};

/// A dump as LAMMPS prints it, with %g, in a temporary file. Rows are in the order of their ids, or in none.
class DumpFile {
 public:
  explicit DumpFile(bool sorted) {
    path_ = (std::filesystem::temp_directory_path() / "grainvdb-bench-XXXXXX").string();
    const int made = ::mkstemp(path_.data());
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(made < 0 ? nullptr : ::fdopen(made, "w"), &std::fclose);
    if (!file) throw std::runtime_error("cannot write " + path_);
    std::fprintf(file.get(), "ITEM: TIMESTEP\n100000\nITEM: NUMBER OF ATOMS\n%zu\nITEM: BOX BOUNDS pp pp ff\n", atoms);
    std::fprintf(file.get(), "0 0.1\n0 0.1\n0 0.1\n");
    std::fprintf(file.get(), "ITEM: ATOMS id type x y z vx vy vz omegax omegay omegaz radius mass\n");
    std::vector<std::size_t> id(atoms);
    std::iota(id.begin(), id.end(), std::size_t{1});
    Numbers numbers;
    if (!sorted)
      for (std::size_t i = atoms - 1; i > 0; --i) std::swap(id[i], id[numbers.below(i + 1)]);
    for (const std::size_t i : id) {
      std::fprintf(file.get(), "%zu 1", i);
      for (int a = 0; a < 3; ++a) std::fprintf(file.get(), " %g", 0.1 * numbers.uniform());
      std::fprintf(file.get(), " %g", numbers.normal());
      for (int a = 0; a < 2; ++a) std::fprintf(file.get(), " %g", 0.1 * numbers.normal());
      for (int a = 0; a < 3; ++a) std::fprintf(file.get(), " %g", 10 * numbers.normal());
      std::fprintf(file.get(), " %g %g \n", 4e-4 * (0.9 + 0.2 * numbers.uniform()),
                   6.7e-7 * (1 + 0.1 * numbers.uniform()));
    }
    if (std::fflush(file.get()) != 0) throw std::runtime_error("cannot write " + path_);
    size_ = std::filesystem::file_size(path_);
  }
  ~DumpFile() { std::filesystem::remove(path_); }
  DumpFile(const DumpFile&) = delete;
  DumpFile& operator=(const DumpFile&) = delete;

  const std::string& path() const { return path_; }
  std::size_t size() const { return size_; }

 private:
  std::string path_;
  std::size_t size_ = 0;
};

const DumpFile& dump(bool sorted) {
  static const DumpFile in_order(true);
  if (sorted) return in_order;
  static const DumpFile shuffled(false);
  return shuffled;
}

/// All columns as a program without the library would keep them.
struct Columns {
  std::vector<std::int64_t> id, type;
  std::array<std::vector<double>, columns - 2> real;

  Columns() {
    id.reserve(atoms);
    type.reserve(atoms);
    for (auto& column : real) column.reserve(atoms);
  }
};

Columns with_istringstream(const std::string& path) {
  Columns result;
  std::ifstream file(path);
  std::string line;
  for (std::size_t i = 0; i < header_lines; ++i) std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    std::int64_t id = 0, type = 0;
    fields >> id >> type;
    result.id.push_back(id);
    result.type.push_back(type);
    for (auto& column : result.real) {
      double value = 0;
      fields >> value;
      column.push_back(value);
    }
    if (!fields) throw std::runtime_error("a bad row");
  }
  return result;
}

Columns with_from_chars(const std::string& path) {
  Columns result;
  std::ifstream file(path, std::ios::binary);
  std::string text(std::filesystem::file_size(path), '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  const char *p = text.data(), *const end = p + text.size();
  for (std::size_t i = 0; i < header_lines; ++i)
    p = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(end - p))) + 1;
  const auto parse = [&](auto& column) {
    while (p != end && (*p == ' ' || *p == '\n')) ++p;
    typename std::decay_t<decltype(column)>::value_type value{};
    const auto [next, error] = std::from_chars(p, end, value);
    if (error != std::errc()) throw std::runtime_error("a bad number");
    p = next;
    column.push_back(value);
  };
  for (std::size_t i = 0; i < atoms; ++i) {
    parse(result.id);
    parse(result.type);
    for (auto& column : result.real) parse(column);
  }
  return result;
}

std::size_t read_bytes(const std::string& path) {
  std::vector<char> buffer(std::size_t{1} << 18);
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  std::size_t size = 0;
  for (ssize_t got = 1; got > 0; size += static_cast<std::size_t>(got)) {
    got = ::read(file, buffer.data(), buffer.size());
    if (got < 0) throw std::runtime_error("cannot read " + path);
  }
  ::close(file);
  return size;
}

constexpr ColumnSet every_column =
    Column::velocity | Column::angular_velocity | Column::radius | Column::mass | Column::type;
/// All but type and angular velocity.
constexpr ColumnSet nine_columns = Column::velocity | Column::radius | Column::mass;

std::unique_ptr<FrameSource> open(const DumpFile& file) {
  InputSpec spec;
  spec.particles = {file.path()};
  return open_dumps(spec);
}

/// 0 where a frame holds, to the bit, what the baseline holds.
double disagreement(const Particles& a, const Columns& b) {
  bool same = a.id == b.id && std::equal(a.type.begin(), a.type.end(), b.type.begin(), b.type.end());
  const auto compare = [&](const Columns3& three, std::size_t first) {
    for (std::size_t i = 0; i < 3; ++i) same = same && three[i] == b.real[first + i];
  };
  compare(a.position, 0);
  compare(a.velocity, 3);
  compare(a.angular_velocity, 6);
  same = same && a.radius == b.real[9] && a.mass == b.real[10];
  return same ? 0 : 2;
}

bool check_library() {
  return check_once("parse/grainvdb", [] {
    return disagreement(open(dump(true))->read(0, every_column).particles, with_from_chars(dump(true).path()));
  });
}

bool check_shuffled() {
  return check_once("parse/grainvdb_unsorted", [] {
    const Particles particles = open(dump(false))->read(0, every_column).particles;
    const bool ordered = std::is_sorted(particles.id.begin(), particles.id.end()) && particles.size() == atoms;
    return ordered ? 0.0 : 2.0;
  });
}

void count(benchmark::State& state, const DumpFile& file) {
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * file.size()));
  state.counters["rows"] =
      benchmark::Counter(static_cast<double>(atoms), benchmark::Counter::kIsIterationInvariantRate);
}

template <class Read>
void run(benchmark::State& state, const DumpFile& file, const Read& read) {
  for (auto _ : state) benchmark::DoNotOptimize(read());
  count(state, file);
}

void istringstream(benchmark::State& state) {
  const bool agrees = check_once("parse/istringstream", [] {
    return disagreement(open(dump(true))->read(0, every_column).particles, with_istringstream(dump(true).path()));
  });
  if (!agrees) return state.SkipWithError("the results disagree");
  run(state, dump(true), [] { return with_istringstream(dump(true).path()); });
}

void from_chars(benchmark::State& state) {
  run(state, dump(true), [] { return with_from_chars(dump(true).path()); });
}

void read2(benchmark::State& state) {
  run(state, dump(true), [] { return read_bytes(dump(true).path()); });
}

/// Each iteration reads the frame of a dump that was indexed before, as a series of dumps is read.
void library(benchmark::State& state, bool sorted, ColumnSet wanted) {
  if (!(sorted ? check_library() : check_shuffled())) return state.SkipWithError("the results disagree");
  const auto source = open(dump(sorted));
  run(state, dump(sorted), [&] { return source->read(0, wanted); });
}

/// Each iteration also finds out what the file holds.
void library_with_index(benchmark::State& state) {
  if (!check_library()) return state.SkipWithError("the results disagree");
  run(state, dump(true), [] { return open(dump(true))->read(0, every_column); });
}

void library_with_threads(benchmark::State& state) {
  use_threads(static_cast<std::size_t>(state.range(0)));
  library(state, true, every_column);
  use_threads(1);
}

BENCHMARK(istringstream)->Name("parse/istringstream")->Unit(benchmark::kMillisecond);
BENCHMARK(from_chars)->Name("parse/from_chars")->Unit(benchmark::kMillisecond);
BENCHMARK(read2)->Name("parse/read2")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(library, all, true, every_column)->Name("parse/grainvdb")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(library, nine, true, nine_columns)->Name("parse/grainvdb_9_of_13")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(library, unsorted, false, every_column)
    ->Name("parse/grainvdb_unsorted")
    ->Unit(benchmark::kMillisecond);
BENCHMARK(library_with_index)->Name("parse/grainvdb_with_index")->Unit(benchmark::kMillisecond);
BENCHMARK(library_with_threads)
    ->Name("parse/grainvdb_threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace grainvdb::bench
