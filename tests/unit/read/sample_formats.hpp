#pragma once
/// The same five grains in the formats of several programs: sample_dumps/formats.
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "unit/read/dump_files.hpp"

namespace grainvdb::testing_dumps {

inline std::string sample(const std::string& name) {
  return std::string(GRAINVDB_SOURCE_DIR) + "/sample_dumps/formats/" + name;
}

inline std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot open " + path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The text dumps of LIGGGHTS, which all its other files are compared with. Contacts have six digits.
inline InputSpec liggghts_text() {
  InputSpec spec = particles_in({sample("liggghts_20.dump"), sample("liggghts_40.dump")});
  spec.contacts.files = {sample("liggghts_contacts_20.dump"), sample("liggghts_contacts_40.dump")};
  spec.contacts.columns = {{"id1", {"c_cl[7]"}}, {"id2", {"c_cl[8]"}}, {"force", {"c_cl[10]", "c_cl[11]", "c_cl[12]"}}};
  spec.dt = 1e-6;
  return spec;
}

inline void expect_near(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

inline void expect_near(const Columns3& a, const Columns3& b, double tolerance) {
  for (std::size_t axis = 0; axis < 3; ++axis) expect_near(a[axis], b[axis], tolerance);
}

/// Reads the only frame of a file with that content.
inline Frame read_only_frame(InputSpec spec, ColumnSet columns = {}) {
  const auto source = open_dumps(spec);
  EXPECT_EQ(source->frames().size(), 1U);
  return source->read(0, columns);
}

}  // namespace grainvdb::testing_dumps
