/// One run in every encoding gives the same frames.
#include "unit/read/dump_files.hpp"

namespace grainvdb::encodings_test {
namespace {

using namespace testing_dumps;

constexpr const char* columns = "id type x y z vx vy vz omegax omegay omegaz radius mass";
const std::vector<std::size_t> counts{300, 0, 6000, 5000};  ///< 6000 rows are 0.6 MB: many buffers

std::vector<std::string> rows_of(std::size_t frame) {
  std::mt19937 random(static_cast<unsigned>(frame) + 1);
  std::uniform_real_distribution<double> number(0, 1);
  std::vector<std::string> rows;
  for (std::size_t i = 0; i < counts[frame]; ++i) {
    // Sparse ids, in no order of their own.
    std::string row = cat({std::to_string(1 + (i * 7919 + frame) % 100'003), " ", std::to_string(1 + i % 3)});
    for (int c = 0; c < 9; ++c)
      row += cat({" ", printed("%.9g", number(random) * (c < 3 ? 10 : 1) - (c > 2 ? 0.5 : 0))});
    row += cat({" ", printed("%g", 0.1 + number(random)) + " " + printed("%g", 1 + number(random))});
    rows.push_back(row);
  }
  return rows;
}
std::string frame_text(std::size_t frame) {
  return particle_dump(static_cast<std::int64_t>(1000 * frame), columns, rows_of(frame));
}
std::string contacts_text(std::size_t frame) {
  std::vector<std::string> rows;
  for (std::size_t i = 1; i < counts[frame]; ++i)
    rows.push_back(std::to_string(i) + " " + std::to_string(i + 1) + " 0.5 " + std::to_string(i) + " -1");
  return contact_dump(static_cast<std::int64_t>(1000 * frame), "id1 id2 fx fy fz", rows);
}
std::string all(std::string (*text)(std::size_t)) {
  std::string joined;
  for (std::size_t k = 0; k < counts.size(); ++k) joined += text(k);
  return joined;
}
std::string with_crlf(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\n') result += '\r';
    result += c;
  }
  return result;
}

using Encode = std::string (*)(const std::string&);
std::string plain(const std::string& text) {
  return text;
}

/// Compresses each frame apart: a file of many members or frames.
std::string members(std::string (*text)(std::size_t), Encode encode) {
  std::string joined;
  for (std::size_t k = 0; k < counts.size(); ++k) joined += encode(text(k));
  return joined;
}

class EncodingsTest : public ::testing::Test {
 protected:
  std::unique_ptr<FrameSource> one_file_per_frame(const std::string& name, Encode encode) {
    for (std::size_t k = 0; k < counts.size(); ++k) {
      const std::string number = std::to_string(1000 * k);
      files_.write(name + "/dump" + number, encode(frame_text(k)));
      files_.write(name + "/contacts" + number, encode(contacts_text(k)));
    }
    InputSpec spec = particles_in({files_.path(name) + "/dump*"});
    spec.contacts.files = {files_.path(name) + "/contacts*"};
    return open_dumps(spec);
  }
  std::unique_ptr<FrameSource> one_file(const std::string& name, const std::string& particles,
                                        const std::string& contacts) {
    InputSpec spec = particles_in({files_.write(name + ".dump", particles)});
    spec.contacts.files = {files_.write(name + ".contacts", contacts)};
    return open_dumps(spec);
  }
  static constexpr ColumnSet everything = every_particle_column | Column::contacts;

  void expect_reference(FrameSource& source) {
    if (reference_.empty()) {
      const auto plain_source = one_file_per_frame("reference", plain);
      for (std::size_t k = 0; k < counts.size(); ++k) reference_.push_back(plain_source->read(k, everything));
    }
    ASSERT_EQ(source.frames().size(), counts.size());
    for (const std::size_t k : {0, 1, 2, 3, 2, 3, 0, 1}) {
      EXPECT_EQ(source.frames()[k].particle_count, counts[k]);
      expect_same(source.read(k, everything), reference_[k]);
    }
  }

  DumpFiles files_;
  std::vector<Frame> reference_;
};

TEST_F(EncodingsTest, ReferenceIsWhatWasWritten) {
  const Frame frame = one_file_per_frame("plain", plain)->read(2, everything);
  EXPECT_EQ(frame.particles.size(), 6000U);
  EXPECT_EQ(frame.contacts.size(), 5999U);
  EXPECT_TRUE(std::is_sorted(frame.particles.id.begin(), frame.particles.id.end()));
  EXPECT_EQ(frame.contacts.force[1][41], 42.0);
}

TEST_F(EncodingsTest, OneFilePerFrameCompressed) {
  expect_reference(*one_file_per_frame("gz", gzipped));
  expect_reference(*one_file_per_frame("zst", zstd_compressed));
}

TEST_F(EncodingsTest, ManyFramesPerFile) {
  expect_reference(*one_file("multi", all(frame_text), all(contacts_text)));
}

TEST_F(EncodingsTest, ManyFramesPerFileCompressed) {
  expect_reference(*one_file("gz", gzipped(all(frame_text)), gzipped(all(contacts_text))));
  expect_reference(*one_file("zst", zstd_compressed(all(frame_text)), zstd_compressed(all(contacts_text))));
}

TEST_F(EncodingsTest, ManyCompressedMembersPerFile) {
  expect_reference(*one_file("gz", members(frame_text, gzipped), members(contacts_text, gzipped)));
  expect_reference(*one_file("zst", members(frame_text, zstd_compressed), members(contacts_text, zstd_compressed)));
}

TEST_F(EncodingsTest, LinesThatEndInCrLf) {
  expect_reference(*one_file("crlf", with_crlf(all(frame_text)), with_crlf(all(contacts_text))));
}

TEST_F(EncodingsTest, AnyOrderOfRows) {
  const auto sorted = open_dumps(particles_in({files_.write("a", frame_text(3))}));
  std::vector<std::string> rows = rows_of(3);
  std::mt19937 random(11);
  std::shuffle(rows.begin(), rows.end(), random);
  const auto shuffled = open_dumps(particles_in({files_.write("b", particle_dump(3000, columns, rows))}));
  expect_same(sorted->read(0, every_particle_column), shuffled->read(0, every_particle_column));
}

/// Positions as they are, scaled, and unwrapped: the same to the printed digits.
TEST_F(EncodingsTest, PositionEncodingsAgreeToTheirPrintedDigits) {
  const Vec3 lo{0, 0, -5}, length{10, 10, 20};  // of the box of particle_dump
  std::mt19937 random(5);
  std::uniform_real_distribution<double> fraction(0, 1);
  std::vector<std::string> x, xs, xu, xsu;
  for (int i = 1; i <= 1000; ++i) {
    std::string id = std::to_string(i), a = id, b = id, c = id, d = id;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double s = fraction(random), image = axis < 2 ? static_cast<double>(random() % 7) - 3 : 0;
      a += cat({" ", printed("%.9g", lo[axis] + s * length[axis])});
      b += cat({" ", printed("%.9g", s)});
      c += cat({" ", printed("%.9g", lo[axis] + (s + image) * length[axis])});
      d += cat({" ", printed("%.9g", s + image)});
    }
    x.push_back(a), xs.push_back(b), xu.push_back(c), xsu.push_back(d);
  }
  const auto read = [&](const std::string& names, const std::vector<std::string>& rows) {
    return open_dumps(particles_in({files_.write("x", particle_dump(0, "id " + names, rows))}))->read(0, {});
  };
  const Frame wrapped = read("x y z", x), scaled = read("xs ys zs", xs), unwrapped = read("xu yu zu", xu),
              both = read("xsu ysu zsu", xsu);
  // Half a unit of the ninth digit: 5e-8 below 100, 5e-9 below 10 and 5e-10 below 1.
  const auto close = [&](const Frame& f, int axis, std::size_t i, double tolerance) {
    const double other = f.particles.position[static_cast<std::size_t>(axis)][i];
    const double difference = other - wrapped.particles.position[static_cast<std::size_t>(axis)][i];
    EXPECT_NEAR(wrapped.box.minimum_image(axis, difference), 0, tolerance);
  };
  for (std::size_t i = 0; i < 1000; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const double l = length[static_cast<std::size_t>(axis)];
      close(scaled, axis, i, 5e-8 + 5e-10 * l);
      close(unwrapped, axis, i, 5e-8 + 5e-8);
      close(both, axis, i, 5e-8 + 5e-9 * l);
    }
}

}  // namespace
}  // namespace grainvdb::encodings_test
