#include "tune/field_error.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace grainvdb::field_error_test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// All voxels of some leaves along x, and two leaves in each other direction.
std::shared_ptr<const Topology> box_of_leaves(int along_x) {
  std::vector<Coord> origins;
  LeafMask full;
  for (int v = 0; v < leaf_size; ++v) full.set(v);
  for (int i = 0; i < along_x; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) origins.push_back({8 * i, 8 * j, 8 * k});
  const std::vector<LeafMask> masks(origins.size(), full);
  return std::make_shared<const Topology>(origins, masks);
}

/// The field f(x) on a lattice; `background` NaN makes it a ratio.
template <class F>
FieldSet fields_of(const Lattice& lattice, int leaves, float background, const F& f) {
  const auto topology = box_of_leaves(leaves);
  SparseField field({"f", "1", 1, "", "", background}, topology, lattice);
  for (std::size_t l = 0; l < topology->leaf_count(); ++l)
    topology->mask(l).for_each(
        [&](int v) { field.leaf(l)[v] = static_cast<float>(f(lattice.centre(voxel_at(topology->origin(l), v)))); });
  FieldSet set{lattice, {}};
  set.fields.emplace("f", std::move(field));
  return set;
}

const Lattice coarse(1, {0, 0, 0});
/// Half the voxel, inside the centres of the coarse one's sixteen.
const Lattice fine(0.5, {0.6, 0.7, 0.8});

FieldError compare(const FieldSet& reference, const FieldSet& found) {
  return field_errors(reference_points(reference, {"f"}, "", 1'000'000), found).at(0);
}

// Interpolation is exact for what is linear in each direction; both sides are stored as floats, of up to 40.
TEST(FieldErrors, AreNoneOfALinearField) {
  const auto linear = [](const Vec3& x) { return 1 + x[0] - 2 * x[1] + 0.5 * x[2]; };
  const FieldError e = compare(fields_of(fine, 3, 0, linear), fields_of(coarse, 2, 0, linear));
  EXPECT_EQ(e.points, 3U * 4 * 512);
  EXPECT_EQ(e.undefined, 0U);
  EXPECT_LT(e.rms, 1e-6);
}

// 3 against 2: |f - r|² = 1 and r² = 4 everywhere.
TEST(FieldErrors, AreRelativeToTheReference) {
  const FieldError e = compare(fields_of(fine, 3, 0, [](const Vec3&) { return 2.0; }),
                               fields_of(coarse, 2, 0, [](const Vec3&) { return 3.0; }));
  EXPECT_NEAR(e.rms, 0.5, 1e-6);
  EXPECT_NEAR(e.largest, 0.5, 1e-6);
}

// Halfway between centres linear interpolation of x² is off by h²/4, between at u of h by u (1 - u) h².
TEST(FieldErrors, CountWhatInterpolationMisses) {
  const auto square = [](const Vec3& x) { return x[0] * x[0]; };
  const FieldSet reference = fields_of(fine, 3, 0, square);
  const FieldError e = compare(reference, fields_of(coarse, 2, 0, square));
  double difference = 0, sum = 0;
  for (int i = 0; i < 24; ++i) {
    const double x = fine.centre(0, i);
    const double u = coarse.to_index(0, x) - std::floor(coarse.to_index(0, x));
    difference += std::pow(u * (1 - u), 2);
    sum += std::pow(x, 4);
  }
  EXPECT_NEAR(e.rms, std::sqrt(difference / sum), 1e-4 * e.rms);
}

// Beyond its voxels a sum is 0, and a ratio has no value: such points are counted apart.
TEST(FieldErrors, OutsideTheVoxels) {
  const auto one = [](const Vec3&) { return 1.0; };
  const FieldSet reference = fields_of(fine, 4, 0, one);
  // One leaf along x ends at its last centre, 7.5: between that and 8.5 the sum falls to 0, behind it is 0.
  const FieldError sum = compare(reference, fields_of(coarse, 1, 0, one));
  EXPECT_EQ(sum.undefined, 0U);
  EXPECT_GT(sum.rms, 0.5);
  const FieldError ratio = compare(reference, fields_of(coarse, 1, nan, one));
  EXPECT_GT(ratio.undefined, 0U);
  EXPECT_EQ(ratio.points + ratio.undefined, sum.points);
  EXPECT_EQ(ratio.rms, 0);
  const FieldSet nothing{coarse, {}};
  EXPECT_EQ(compare(reference, nothing).undefined, sum.points);
  EXPECT_EQ(compare(reference, nothing).points, 0U);
}

// Points are spread evenly: each eighth of the box has about an eighth of them.
TEST(ReferencePoints, AreAFairSample) {
  const FieldSet reference = fields_of(fine, 4, 0, [](const Vec3&) { return 1.0; });
  const std::size_t most = 2000;
  const ReferencePoints points = reference_points(reference, {"f"}, "", most);
  EXPECT_LE(points.position.size(), most);
  EXPECT_GT(points.position.size(), most - 4 * static_cast<std::size_t>(std::sqrt(most)));
  std::vector<double> parts(8);
  for (const Vec3& x : points.position)
    ++parts[static_cast<std::size_t>((x[0] > 8.6 ? 4 : 0) + (x[1] > 4.7 ? 2 : 0) + (x[2] > 4.8 ? 1 : 0))];
  for (double n : parts) EXPECT_NEAR(n, most / 8.0, 4 * std::sqrt(most / 8.0) + 20);
}

}  // namespace
}  // namespace grainvdb::field_error_test
