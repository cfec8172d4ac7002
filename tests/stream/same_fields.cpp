#include "stream/same_fields.hpp"

#include <cstring>

#include <gtest/gtest.h>

namespace grainvdb::testing {
namespace {

// Undefined values are equal, too.
bool same_bytes(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

void expect_same_voxels(const Topology& a, const Topology& b) {
  ASSERT_EQ(a.origins(), b.origins());
  for (std::size_t l = 0; l < a.leaf_count(); ++l) ASSERT_EQ(a.mask(l), b.mask(l));
}

}  // namespace

void expect_same_fields(const Written& a, const Written& b) {
  EXPECT_EQ(a.time.time, b.time.time);
  EXPECT_EQ(a.time.first_step, b.time.first_step);
  EXPECT_EQ(a.time.last_step, b.time.last_step);
  EXPECT_EQ(a.time.frame_count, b.time.frame_count);
  ASSERT_EQ(a.fields.size(), b.fields.size());
  for (const auto& [name, field] : a.fields) {
    const FieldCopy& other = b.field(name);
    expect_same_voxels(*field.topology, *other.topology);
    EXPECT_TRUE(same_bytes(field.values, other.values)) << name;
  }
  if (a.has_mask && b.has_mask) {
    EXPECT_TRUE(a.mask == b.mask);
  }
}

void expect_same_fields(const Record& a, const Record& b) {
  ASSERT_EQ(a.times.size(), b.times.size());
  for (std::size_t t = 0; t < a.times.size(); ++t) expect_same_fields(a.times[t], b.times[t]);
}

}  // namespace grainvdb::testing
