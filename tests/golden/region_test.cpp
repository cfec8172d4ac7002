// Fields in a region: the same as without it, and nothing else is computed.
#include "grainvdb/region.hpp"

#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/frame_source.hpp"
#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::testing::region_test {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

Result run_on_dumps(const Pipeline& p) {
  const auto source = open_dumps(p.input);
  return run(p, *source);
}

struct Counts {
  std::size_t inside = 0, outside = 0;
};

/// Every voxel of `part` has the bytes that it has in `whole`, and those of `whole` that are wanted are all there.
template <class Wanted>
Counts expect_part_of(const Written& part, const Written& whole, const Wanted& wanted) {
  Counts n;
  EXPECT_EQ(part.fields.size(), whole.fields.size());
  for (const auto& [name, all] : whole.fields) {
    const FieldCopy& some = part.field(name);
    std::size_t different = 0;
    n = {};
    all.for_each_active([&](const Coord& c) {
      EXPECT_EQ(some.active(c), wanted(c)) << name;
      if (!wanted(c)) {
        ++n.outside;
        return;
      }
      ++n.inside;
      for (int k = 0; k < all.meta.components; ++k) {
        const float a = all.at(c, k);
        const float b = some.at(c, k);
        different += std::memcmp(&a, &b, sizeof(float)) == 0 ? 0 : 1;
      }
      EXPECT_EQ(part.mask_at(c), whole.mask_at(c)) << name;
    });
    EXPECT_EQ(different, 0U) << name;
    EXPECT_EQ(some.topology->active_voxel_count(), n.inside) << name;
  }
  return n;
}

/// Every field of two snapshots, on voxels so small that the cell is several leaves wide.
Pipeline everything(const std::string& temperature) {
  std::vector<std::string> fields = all_fields();
  for (const std::string& error : all_errors()) fields.push_back(error);
  Pipeline p = shear_cell_pipeline(fields);
  p.blocks = 2;
  p.select.types = {1};
  p.frames = {{}, 2, 1};
  p.voxel = 0.2e-3;
  p.cutoff = 0.8e-3;
  set_option(p, "temperature", "mode", std::string(temperature));
  // Means over whole planes hardly follow one particle: there is nothing to correct.
  const bool profile = temperature == "two_pass_profile";
  set_option(p, "temperature", "self_weight", std::string(profile ? "none" : "corrected"));
  return p;
}

struct Case {
  const char* name;
  Vec3 lo, hi;
  const char* temperature;
};

class RegionOfShearCell : public ::testing::TestWithParam<Case> {};

TEST_P(RegionOfShearCell, HasTheFieldsOfTheWhole) {
  const auto& [name, lo, hi, temperature] = GetParam();
  Pipeline p = everything(temperature);
  const Result whole = run_on_dumps(p);
  p.region.emplace(lo, hi);
  const Result part = run_on_dumps(p);
  const Lattice& lattice = whole.record.layouts.at(0).lattice;
  const auto wanted = [&, lo = lo, hi = hi](const Coord& c) {
    for (int a = 0; a < 3; ++a) {
      const auto& period = lattice.period(a);
      bool inside = false;
      for (int image : {-1, 0, 1}) {
        const double x = lattice.centre(a, c[a]) + (period ? image * period->length * lattice.voxel() : 0);
        inside = inside || (lo[static_cast<std::size_t>(a)] <= x && x < hi[static_cast<std::size_t>(a)]);
      }
      if (!inside) return false;
    }
    return true;
  };
  const Counts n = expect_part_of(part.only(), whole.only(), wanted);
  EXPECT_GT(n.inside, 20U);
  EXPECT_GT(n.outside, 1000U);
  EXPECT_LT(part.report.summed_leaves, whole.report.summed_leaves);

  const OutputLayout& layout = part.record.layouts.at(0);
  const auto bounds = part.only().field("phi").topology->bounds();
  EXPECT_EQ(layout.first, bounds->first);
  EXPECT_EQ(layout.last, bounds->last);
}

// The cell is periodic along x and y, 6.4 mm each; the second and third box cross both sides of it.
INSTANTIATE_TEST_SUITE_P(
    Boxes, RegionOfShearCell,
    ::testing::Values(Case{"inside", {1e-3, 2e-3, 6e-3}, {2.5e-3, 4e-3, 7e-3}, "two_pass"},
                      Case{"across", {-1e-3, 5.8e-3, -2e-3}, {0.5e-3, 7e-3, -1e-3}, "two_pass"},
                      Case{"across_profile", {-1e-3, 5.8e-3, -2e-3}, {0.5e-3, 7e-3, -1e-3}, "two_pass_profile"},
                      Case{"above", {-inf, -inf, 7e-3}, {inf, inf, inf}, "one_pass_corrected"}),
    [](const auto& choice) { return std::string(choice.param.name); });

TEST(Region, OfLeavesHasTheFieldsOfTheWhole) {
  const Pipeline p = everything("two_pass");
  const Result whole = run_on_dumps(p);
  const std::vector<Coord> leaves{whole.only().field("phi").topology->origin(0),
                                  whole.only().field("phi").topology->origin(5)};
  const auto source = open_dumps(p.input);
  Written part;
  compute_fields(
      p, make_plan(p), *source,
      [&](OutputFields output) {
        std::vector<const SparseField*> fields;
        for (const auto& [name, field] : output.fields) fields.push_back(&field);
        const auto record = std::make_shared<Record>();
        MemorySink(record).write(output.time, fields, &output.mask);
        part = record->times.at(0);
      },
      {}, Region::leaves(leaves));
  const Counts n = expect_part_of(
      part, whole.only(), [&](const Coord& c) { return leaf_origin(c) == leaves[0] || leaf_origin(c) == leaves[1]; });
  EXPECT_GT(n.inside, 500U);
  EXPECT_GT(n.outside, 1000U);
}

// Sums that need no neighbours are formed on the region's leaves alone.
TEST(Region, SumsNothingBeyondWhatItNeeds) {
  Pipeline p = shear_cell_pipeline({"phi", "velocity", "contact_stress"});
  p.region.emplace(Vec3{0.1e-3, 0.1e-3, 6.5e-3}, Vec3{3.1e-3, 3.1e-3, 9.5e-3});  // voxels 0 … 7, 0 … 7, 16 … 23
  EXPECT_EQ(run_on_dumps(p).report.summed_leaves, 1U);
  // Differences look two voxels beyond the leaf: both leaves along the periodic x and y, and those above and below.
  p.fields = {"velocity_gradient"};
  p.region.emplace(Vec3{0.9e-3, 0.9e-3, 7.3e-3}, Vec3{2.3e-3, 2.3e-3, 8.7e-3});  // voxels 2 … 5
  EXPECT_EQ(run_on_dumps(p).report.summed_leaves, 8U);
}

TEST(Region, WithoutAVoxelInReachIsRefused) {
  Pipeline p = shear_cell_pipeline({"phi"});
  p.region.emplace(Vec3{0, 0, 1}, Vec3{1, 1, 2});
  EXPECT_THROW(run_on_dumps(p), ConfigError);
  p.window = 2;
  EXPECT_THROW(run_on_dumps(p), ConfigError);
  p.region.emplace(Vec3{0.21e-3, 0, 0}, Vec3{0.59e-3, 1, 1});
  EXPECT_THROW(run_on_dumps(p), ConfigError);
}

}  // namespace
}  // namespace grainvdb::testing::region_test
