#pragma once
/// Dump files for tests: a directory that removes itself, compressors, and the texts of dumps.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <zlib.h>
#include <zstd.h>

#include "grainvdb/error.hpp"
#include "grainvdb/frame_source.hpp"

namespace grainvdb::testing_dumps {

class DumpFiles {
 public:
  DumpFiles() {
    std::string path = (std::filesystem::temp_directory_path() / "grainvdb-read-XXXXXX").string();
    if (::mkdtemp(path.data()) == nullptr) throw std::runtime_error("cannot make a temporary directory");
    directory_ = path;
  }
  ~DumpFiles() { std::filesystem::remove_all(directory_); }
  DumpFiles(const DumpFiles&) = delete;
  DumpFiles& operator=(const DumpFiles&) = delete;

  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& content) const {
    const std::string path = this->path(name);
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    std::ofstream file(path, std::ios::binary);
    file << content;
    file.close();
    if (!file) throw std::runtime_error("cannot write " + path);
    return path;
  }
  std::string path(const std::string& name) const { return (directory_ / name).string(); }
  std::string directory() const { return directory_.string(); }

 private:
  std::filesystem::path directory_;
};

inline std::string gzipped(const std::string& text) {
  z_stream z{};
  if (deflateInit2(&z, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::runtime_error("zlib");
  std::string out(deflateBound(&z, text.size()) + 64, '\0');
  z.next_in = reinterpret_cast<z_const Bytef*>(const_cast<char*>(text.data()));
  z.avail_in = static_cast<uInt>(text.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  if (deflate(&z, Z_FINISH) != Z_STREAM_END) throw std::runtime_error("zlib");
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}

inline std::string zstd_compressed(const std::string& text) {
  std::string out(ZSTD_compressBound(text.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), text.data(), text.size(), 3));
  return out;
}

/// A frame of a particle dump with a box of 10 × 10 × 20, periodic along x and y.
inline std::string particle_dump(std::int64_t step, const std::string& columns, const std::vector<std::string>& rows) {
  std::string text = "ITEM: TIMESTEP\n" + std::to_string(step) + "\nITEM: NUMBER OF ATOMS\n" +
                     std::to_string(rows.size()) + "\nITEM: BOX BOUNDS pp pp ff\n0 10\n0 10\n-5 15\nITEM: ATOMS " +
                     columns + "\n";
  for (const std::string& row : rows) text += row + "\n";
  return text;
}

/// The same for contacts.
inline std::string contact_dump(std::int64_t step, const std::string& columns, const std::vector<std::string>& rows) {
  std::string text = "ITEM: TIMESTEP\n" + std::to_string(step) + "\nITEM: NUMBER OF ENTRIES\n" +
                     std::to_string(rows.size()) + "\nITEM: BOX BOUNDS pp pp ff\n0 10\n0 10\n-5 15\nITEM: ENTRIES " +
                     columns + "\n";
  for (const std::string& row : rows) text += row + "\n";
  return text;
}

/// Line of the column names, and of the first row, in the dumps above.
inline constexpr int columns_line = 9;
inline constexpr int first_row_line = 10;

/// The texts one after another.
inline std::string cat(std::initializer_list<std::string_view> texts) {
  std::string all;
  for (const std::string_view text : texts) all += text;
  return all;
}

inline std::string printed(const char* format, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

inline InputSpec particles_in(const std::vector<std::string>& files) {
  InputSpec spec;
  spec.particles = files;
  return spec;
}

inline constexpr ColumnSet every_particle_column =
    Column::velocity | Column::angular_velocity | Column::radius | Column::mass | Column::type;

/// Runs f and checks that it throws an E whose message has all the parts.
template <class E>
void expect_error(const std::function<void()>& f, const std::vector<std::string>& parts) {
  try {
    f();
  } catch (const E& error) {
    for (const std::string& part : parts) EXPECT_THAT(error.what(), ::testing::HasSubstr(part));
    return;
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another kind of error: " << error.what();
    return;
  }
  ADD_FAILURE() << "no error";
}

/// Everything but the file is the same, to the bit.
inline void expect_same(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.box, b.box);
  EXPECT_EQ(a.particles.id, b.particles.id);
  EXPECT_EQ(a.particles.position, b.particles.position);
  EXPECT_EQ(a.particles.velocity, b.particles.velocity);
  EXPECT_EQ(a.particles.angular_velocity, b.particles.angular_velocity);
  EXPECT_EQ(a.particles.radius, b.particles.radius);
  EXPECT_EQ(a.particles.mass, b.particles.mass);
  EXPECT_EQ(a.particles.type, b.particles.type);
  EXPECT_EQ(a.contacts.id1, b.contacts.id1);
  EXPECT_EQ(a.contacts.id2, b.contacts.id2);
  EXPECT_EQ(a.contacts.force, b.contacts.force);
  EXPECT_EQ(a.contacts.point, b.contacts.point);
}

}  // namespace grainvdb::testing_dumps
