// One run, the same bytes: whatever the threads, the encoding of the files or the order of their rows.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "grainvdb/frame_source.hpp"
#include "support/dump_text.hpp"
#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"
#include "support/uncertain.hpp"

namespace grainvdb::testing::determinism_test {
namespace {

const std::array<int, 5> steps{60000, 64000, 68000, 72000, 76000};

std::string original(const std::string& kind, int step) {
  return in_repository("sample_dumps/shear_cell/" + kind + std::to_string(step) + ".liggghts");
}

/// Every field of the sample shear cell and every standard error, mean of the five snapshots.
Pipeline everything() {
  std::vector<std::string> fields = all_fields();
  for (const std::string& error : all_errors()) fields.push_back(error);
  Pipeline p = shear_cell_pipeline(fields);
  p.blocks = steps.size();
  p.select.types = {1};
  return p;
}

/// The same read from elsewhere.
Result run_all_fields(const InputSpec& input) {
  Pipeline p = everything();
  p.input = input;
  const auto source = open_dumps(p.input);
  return run(p, *source);
}

const Result& plain() {
  static const Result result = run_all_fields(shear_cell_input());
  return result;
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

void expect_same_bytes(const Result& a, const Result& b) {
  const Written& x = a.only();
  const Written& y = b.only();
  ASSERT_EQ(x.fields.size(), y.fields.size());
  EXPECT_GT(x.fields.size(), 20U);
  for (const auto& [name, field] : x.fields) {
    const FieldCopy& other = y.field(name);
    EXPECT_EQ(field.topology->origins(), other.topology->origins()) << name;
    for (std::size_t l = 0; l < field.topology->leaf_count(); ++l)
      ASSERT_EQ(field.topology->mask(l), other.topology->mask(l)) << name;
    EXPECT_TRUE(same_bytes(field.values, other.values)) << name;
  }
  EXPECT_TRUE(same_bytes(x.mask, y.mask));
}

TEST(Determinism, AnyNumberOfThreads) {
  for (std::size_t threads : {1U, 2U, 3U}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    SCOPED_TRACE(threads);
    expect_same_bytes(plain(), run_all_fields(shear_cell_input()));
  }
}

/// The kinetic stress about the time mean takes a second sweep, whose frames are read while the first is at work.
TEST(Determinism, AnyNumberOfFramesInFlight) {
  for (std::size_t threads : {1U, 3U})
    for (std::size_t frames : {1U, 2U, 5U, 30U}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      SCOPED_TRACE(std::to_string(threads) + " threads, " + std::to_string(frames) + " frames");
      Pipeline p = everything();
      p.limits.frames_in_flight = frames;
      const auto source = open_dumps(p.input);
      expect_same_bytes(plain(), run(p, *source));
    }
}

/// The five snapshots written anew by `write(path, text)` with this ending, one file each.
InputSpec rewritten(const TemporaryFolder& folder, const std::string& ending,
                    const std::function<void(const std::string&, const std::string&)>& write) {
  for (const char* kind : {"dump", "contacts"})
    for (int step : steps)
      write(folder.path() + "/" + kind + std::to_string(step) + ending, read_dump_text(original(kind, step)).text());
  return shear_cell_input(folder.path());
}

/// All snapshots in one file of each kind.
InputSpec in_one_file(const TemporaryFolder& folder, const std::string& ending,
                      const std::function<void(const std::string&, const std::string&)>& write) {
  for (const char* kind : {"dump", "contacts"}) {
    std::string all;
    for (int step : steps) all += read_dump_text(original(kind, step)).text();
    write(folder.path() + "/" + kind + ending, all);
  }
  return shear_cell_input(folder.path());
}

TEST(Determinism, AnyEncoding) {
  struct Encoding {
    const char* ending;
    void (*write)(const std::string&, const std::string&);
  };
  for (const Encoding& e : {Encoding{".txt", write_plain}, Encoding{".gz", write_gzip}, Encoding{".zst", write_zstd}}) {
    SCOPED_TRACE(e.ending);
    const TemporaryFolder each;
    expect_same_bytes(plain(), run_all_fields(rewritten(each, e.ending, e.write)));
    const TemporaryFolder together;
    expect_same_bytes(plain(), run_all_fields(in_one_file(together, e.ending, e.write)));
  }
}

TEST(Determinism, AnyOrderOfRows) {
  std::mt19937 random(4);
  const TemporaryFolder folder;
  for (const char* kind : {"dump", "contacts"})
    for (int step : steps) {
      DumpText dump = read_dump_text(original(kind, step));
      const std::vector<std::string> before = dump.rows;
      std::shuffle(dump.rows.begin(), dump.rows.end(), random);
      ASSERT_NE(dump.rows, before);
      write_plain(folder.path() + "/" + kind + std::to_string(step), dump.text());
    }
  expect_same_bytes(plain(), run_all_fields(shear_cell_input(folder.path())));
}

std::string printed(double x, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, x);
  return text.data();
}

/// The five snapshots with positions replaced: x y z renamed, each value by f(axis, x, lo, length, row).
InputSpec with_positions(const TemporaryFolder& folder, const std::array<std::string, 3>& names,
                         const std::function<std::string(int, double, double, double, std::size_t)>& f) {
  for (int step : steps) {
    DumpText dump = read_dump_text(original("dump", step));
    std::array<double, 3> lo{};
    std::array<double, 3> length{};
    for (std::size_t a = 0; a < 3; ++a) {
      double hi = 0;
      std::istringstream(dump.header[5 + a]) >> lo[a] >> hi;
      length[a] = hi - lo[a];
    }
    std::string heading = "ITEM: ATOMS";
    for (const std::string& name : dump.columns())
      heading += " " + (name == "x" ? names[0] : name == "y" ? names[1] : name == "z" ? names[2] : name);
    dump.header.back() = heading;
    for (std::size_t r = 0; r < dump.rows.size(); ++r) {
      std::istringstream words(dump.rows[r]);
      std::string row;
      std::size_t column = 0;
      for (std::string word; words >> word; ++column) {
        if (column >= 2 && column < 5) {  // id type x y z …
          const std::size_t a = column - 2;
          word = f(static_cast<int>(a), std::stod(word), lo[a], length[a], r);
        }
        row += word + " ";
      }
      dump.rows[r] = row;
    }
    write_plain(folder.path() + "/dump" + std::to_string(step), dump.text());
    write_plain(folder.path() + "/contacts" + std::to_string(step), read_dump_text(original("contacts", step)).text());
  }
  return shear_cell_input(folder.path());
}

/// φ within `bound` everywhere.
void expect_near(const Result& a, const Result& b, double bound) {
  const FieldCopy& x = a.only().field("phi");
  const FieldCopy& y = b.only().field("phi");
  double worst = 0;
  x.for_each_active([&](const Coord& c) {
    worst = std::max(worst, std::abs(static_cast<double>(x.at(c)) - static_cast<double>(y.at(c))));
  });
  EXPECT_LE(worst, bound);
}

// Positions that are off by δ shift φ by at most Σ V |∇W| δ. With |∇W| ≤ 3.7136/c⁴ (physics section 2), and no more
// than 0.74 of the sphere of radius c filled, but for grains that stick out of it (all within c + r: (1.2)³ = 1.73):
// |Δφ| ≤ 3.7136 (4π/3) 0.74 · 1.73 δ/c = 20 δ/c. Storing as float adds 6e-8.
TEST(Determinism, ScaledAndUnwrappedPositions) {
  const double cutoff = 2.4e-3;
  const TemporaryFolder scaled_folder;
  const Result scaled = run_all_fields(with_positions(
      scaled_folder, {"xs", "ys", "zs"},
      [](int, double x, double lo, double length, std::size_t) { return printed((x - lo) / length, 9); }));
  // Half a unit of the ninth digit of a number up to 1, times the longest edge of the box, 14.5 mm, on three axes.
  const double shift = std::sqrt(3.0) * 0.5e-9 * 14.6e-3;
  expect_near(plain(), scaled, 20 * shift / cutoff + float_rounding);

  const TemporaryFolder unwrapped_folder;
  const Result unwrapped = run_all_fields(with_positions(
      unwrapped_folder, {"xu", "yu", "zu"}, [](int axis, double x, double, double length, std::size_t r) {
        return printed(axis < 2 ? x + length * (static_cast<double>(r % 7) - 3) : x, 17);
      }));
  // Up to four box lengths away the printed numbers are good to an ulp of 26 mm, and so is their wrapped image.
  expect_near(plain(), unwrapped, 20 * std::sqrt(3.0) * 2 * 0x1p-52 * 26e-3 / cutoff + float_rounding);
}

}  // namespace
}  // namespace grainvdb::testing::determinism_test
