#include "write/hdf5_sink.hpp"

#include <cmath>
#include <set>
#include <tuple>

#include <gmock/gmock.h>

#include "grainvdb/error.hpp"
#include "unit/write/hdf5_reader.hpp"
#include "unit/write/hdf5_scene.hpp"
#include "unit/write/support.hpp"

namespace grainvdb::hdf5_sink_test {
namespace {

using namespace testing::hdf5_scene;  // NOLINT: what the tests of this scene share

using namespace testing;  // NOLINT: the folder's own helpers
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

TEST(Hdf5Sink, WritesEveryValueOfAStaticResult) {
  const TemporaryFolder folder;
  const Scene scene;
  write_scene(scene, folder.path());
  expect_scene_in(scene, folder / "fields.hdf");
  EXPECT_THAT(folder.names(), ElementsAre("fields.hdf"));
}

TEST(Hdf5Sink, WritesEveryValueOfASeriesWhoseTopologyChanges) {
  const TemporaryFolder folder;
  Scene scene;
  scene.times = 3;
  scene.active = [](const Coord& c, int t) { return (c.x + c.y + c.z + t) % 4 != 0 && c.x > 10 * t - 5; };
  write_scene(scene, folder.path());
  expect_scene_in(scene, folder / "fields.hdf");
  const Hdf5Reader file(folder / "fields.hdf");
  EXPECT_THAT(file.read<double>("/time"), ElementsAre(0.5, 0.625, 0.75));
  EXPECT_THAT(file.read<std::int64_t>("/first_step"), ElementsAre(1000, 1010, 1020));
  EXPECT_THAT(file.read<std::int64_t>("/last_step"), ElementsAre(1009, 1019, 1029));
  EXPECT_THAT(file.read<std::int64_t>("/frame_count"), ElementsAre(3, 4, 5));
}

// Sizes around the edges of leaves (8) and chunks (32), and boxes one voxel thick.
struct Box {
  Coord first, last;
};
class Hdf5SinkBoxes : public ::testing::TestWithParam<Box> {};
TEST_P(Hdf5SinkBoxes, WritesEveryValue) {
  const TemporaryFolder folder;
  Scene scene;
  scene.first = GetParam().first;
  scene.last = GetParam().last;
  scene.times = 2;
  write_scene(scene, folder.path());
  expect_scene_in(scene, folder / "fields.hdf");
}
INSTANTIATE_TEST_SUITE_P(Sizes, Hdf5SinkBoxes,
                         ::testing::Values(Box{{1, 0, 0}, {1, 0, 0}}, Box{{-1, -1, -1}, {0, 0, 0}},
                                           Box{{-40, 3, 7}, {-9, 3, 39}}, Box{{0, -20, 5}, {32, -5, 5}},
                                           Box{{-17, -16, -15}, {16, 15, 50}}, Box{{5, 6, 7}, {69, 14, 22}}));

TEST(Hdf5Sink, HoldsTheImageAttributesThatVtkReads) {
  const TemporaryFolder folder;
  const Scene scene;
  write_scene(scene, folder.path());
  const Hdf5Reader file(folder / "fields.hdf");
  EXPECT_TRUE(file.attribute_stored_as("/VTKHDF", "Version", H5T_STD_I64LE));
  EXPECT_THAT(file.attribute<std::int64_t>("/VTKHDF", "Version"), ElementsAre(1, 0));
  EXPECT_THAT(file.attribute<std::int64_t>("/VTKHDF", "WholeExtent"), ElementsAre(0, 40, 0, 11, 0, 13));
  EXPECT_THAT(file.attribute<double>("/VTKHDF", "Origin"), ElementsAre(1 - 2.5 * 0.25, 2 - 4.5 * 0.25, 3 - 8.5 * 0.25));
  EXPECT_THAT(file.attribute<double>("/VTKHDF", "Spacing"), ElementsAre(0.25, 0.25, 0.25));
  EXPECT_THAT(file.attribute<double>("/VTKHDF", "Direction"), ElementsAre(1, 0, 0, 0, 1, 0, 0, 0, 1));

  const hid_t text = H5Tcopy(H5T_C_S1);  // fixed length, ASCII
  H5Tset_size(text, 9);
  H5Tset_strpad(text, H5T_STR_NULLPAD);
  ASSERT_TRUE(file.attribute_stored_as("/VTKHDF", "Type", text));
  std::string type(9, ' ');
  const hid_t attribute = H5Aopen_by_name(file.id(), "/VTKHDF", "Type", H5P_DEFAULT, H5P_DEFAULT);
  H5Aread(attribute, text, type.data());
  H5Aclose(attribute);
  H5Tclose(text);
  EXPECT_EQ(type, "ImageData");
  EXPECT_FALSE(file.has("/VTKHDF/Steps"));
}

TEST(Hdf5Sink, HoldsTheStepsThatVtkReadsInASeries) {
  const TemporaryFolder folder;
  Scene scene;
  scene.times = 3;
  write_scene(scene, folder.path());
  const Hdf5Reader file(folder / "fields.hdf");
  EXPECT_THAT(file.attribute<std::int64_t>("/VTKHDF", "Version"), ElementsAre(2, 0));
  EXPECT_THAT(file.attribute<std::int64_t>("/VTKHDF/Steps", "NSteps"), ElementsAre(3));
  EXPECT_THAT(file.read<double>("/VTKHDF/Steps/Values"), ElementsAre(0.5, 0.625, 0.75));
}

TEST(Hdf5Sink, DoesNotOfferVtkAnImageThatItWouldMisread) {
  Scene scene;
  scene.first = {0, 0, 0};
  for (const Coord& last : {Coord{9, 9, 0}, Coord{9, 0, 9}, Coord{0, 0, 0}}) {
    const TemporaryFolder folder;
    scene.last = last;
    write_scene(scene, folder.path());
    const Hdf5Reader file(folder / "fields.hdf");
    EXPECT_FALSE(file.has_attribute("/VTKHDF", "Type"));
    EXPECT_THAT(folder.names(), ElementsAre("fields.hdf", "fields.xmf2"));
  }
  const TemporaryFolder folder;
  scene.last = {0, 9, 9};
  write_scene(scene, folder.path());
  EXPECT_TRUE(Hdf5Reader(folder / "fields.hdf").has_attribute("/VTKHDF", "Type"));
  EXPECT_THAT(folder.names(), ElementsAre("fields.hdf"));
}

TEST(Hdf5Sink, DescribesEveryDataset) {
  const TemporaryFolder folder;
  write_scene(Scene{}, folder.path());
  const Hdf5Reader file(folder / "fields.hdf");
  EXPECT_EQ(file.text_of(points + "velocity", "units"), "Pa");
  EXPECT_EQ(file.text_of(points + "velocity", "long_name"), "made up: velocity");
  EXPECT_EQ(file.text_of(points + "velocity", "equation"), "Σ velocity W (6)");
  EXPECT_TRUE(std::isnan(file.fill_value<float>(points + "velocity")));
  EXPECT_TRUE(std::isnan(file.attribute<float>(points + "velocity", "_FillValue").at(0)));
  EXPECT_EQ(file.fill_value<float>(points + "phi"), 0.0F);
  EXPECT_FALSE(file.has_attribute(points + "phi", "_FillValue"));
  EXPECT_EQ(file.fill_value<std::uint32_t>(points + "mask"), outside);

  const auto masks = file.attribute<std::uint32_t>(points + "mask", "flag_masks");
  const auto lines = file.texts_of(points + "mask", "flags");
  std::string names;
  ASSERT_EQ(masks.size(), reasons().size());
  ASSERT_EQ(lines.size(), reasons().size());
  for (std::size_t i = 0; i < masks.size(); ++i) {
    const ReasonInfo& r = reasons()[i];
    EXPECT_EQ(masks[i], static_cast<std::uint32_t>(r.reason));
    EXPECT_EQ(lines[i], std::to_string(masks[i]) + " " + std::string(r.name) + ": " + std::string(r.meaning));
    if (i > 0) names += " ";
    names += r.name;
  }
  EXPECT_EQ(file.text_of(points + "mask", "flag_meanings"), names);

  for (const char* set :
       {"/x", "/y", "/z", "/time", "/first_step", "/last_step", "/frame_count", "/component3", "/component9"}) {
    EXPECT_FALSE(file.text_of(set, "units").empty()) << set;
    EXPECT_FALSE(file.text_of(set, "long_name").empty()) << set;
  }
  EXPECT_EQ(file.text_of("/y", "units"), "m");
  EXPECT_EQ(file.text_of("/time", "units"), "s");
}

TEST(Hdf5Sink, PutsTheAxesAtTheVoxelCentres) {
  const TemporaryFolder folder;
  const Scene scene;
  write_scene(scene, folder.path());
  const Hdf5Reader file(folder / "fields.hdf");
  for (int axis = 0; axis < 3; ++axis) {
    const auto centres = file.read<double>(std::string("/") + "xyz"[axis]);
    ASSERT_EQ(static_cast<int>(centres.size()), scene.last[axis] - scene.first[axis] + 1);
    for (std::size_t i = 0; i < centres.size(); ++i)  // multiples of 1/8: exact in double
      EXPECT_EQ(centres[i], 1 + axis + (scene.first[axis] + static_cast<double>(i) + 0.5) * 0.25);
  }
}

/// The name of the scale attached to each axis of a dataset, found by the references that netCDF and xarray follow.
std::vector<std::string> scales_of(const Hdf5Reader& file, const std::string& path) {
  const hid_t attribute = H5Aopen_by_name(file.id(), path.c_str(), "DIMENSION_LIST", H5P_DEFAULT, H5P_DEFAULT);
  const hid_t type = H5Aget_type(attribute);
  const hid_t space = H5Aget_space(attribute);
  std::vector<hvl_t> lists(file.dims(path).size());
  H5Aread(attribute, type, lists.data());
  std::vector<std::string> names;
  for (const hvl_t& list : lists) {
    EXPECT_EQ(list.len, 1U);
    std::string name(64, '\0');
    const hid_t scale = H5Rdereference2(file.id(), H5P_DEFAULT, H5R_OBJECT, list.p);
    name.resize(static_cast<std::size_t>(H5Iget_name(scale, name.data(), name.size())));
    names.push_back(name);
    H5Dclose(scale);
  }
  H5Dvlen_reclaim(type, space, H5P_DEFAULT, lists.data());
  H5Sclose(space);
  H5Tclose(type);
  H5Aclose(attribute);
  return names;
}

TEST(Hdf5Sink, AttachesAScaleToEveryAxis) {
  const TemporaryFolder folder;
  write_scene(Scene{}, folder / "static");
  const Hdf5Reader fixed(folder / "static/fields.hdf");
  EXPECT_THAT(scales_of(fixed, points + "phi"), ElementsAre("/z", "/y", "/x"));
  EXPECT_THAT(scales_of(fixed, points + "stress"), ElementsAre("/z", "/y", "/x", "/component9"));
  EXPECT_THAT(scales_of(fixed, "/first_step"), ElementsAre("/time"));
  Scene scene;
  scene.times = 2;
  write_scene(scene, folder / "series");
  const Hdf5Reader series(folder / "series/fields.hdf");
  EXPECT_THAT(scales_of(series, points + "velocity"), ElementsAre("/time", "/z", "/y", "/x", "/component3"));
  EXPECT_THAT(scales_of(series, points + "mask"), ElementsAre("/time", "/z", "/y", "/x"));
}

TEST(Hdf5Sink, KeepsTheProvenance) {
  const TemporaryFolder folder;
  write_scene(Scene{}, folder.path());
  const Hdf5Reader file(folder / "fields.hdf");
  for (const auto& [key, text] : some_provenance()) EXPECT_EQ(file.text("/provenance/" + key), text);
  EXPECT_EQ(file.text_of("/", "grainvdb_version"), "1.2.3");
  EXPECT_EQ(file.text_of("/", "averaging"), "1 output time of 3 frames\n");
  EXPECT_FALSE(file.text_of("/", "title").empty());
}

TEST(Hdf5Sink, StoresOnlyTheChunksThatHoldActiveVoxels) {
  const TemporaryFolder folder;
  Scene scene;
  scene.first = {-50, -50, -50};
  scene.last = {50, 40, 60};  // 101 × 91 × 111 voxels: chunks of 26 × 31 × 28
  scene.times = 2;
  scene.active = [](const Coord& c, int t) {
    return (c.x == -30 && c.y == 20 && c.z == 10) || (t == 1 && c.x >= 49 && c.y >= 39 && c.z >= 59);
  };
  write_scene(scene, folder.path());
  const Hdf5Reader file(folder / "fields.hdf");
  EXPECT_THAT(file.chunk(points + "phi"), ElementsAre(1, 28, 31, 26));
  EXPECT_THAT(file.chunk(points + "stress"), ElementsAre(1, 28, 31, 26, 9));
  std::set<std::tuple<int, int, int, int>> occupied;
  for (int t = 0; t < 2; ++t)
    for_each_voxel(scene.first, scene.last, [&](const Coord& c) {
      if (scene.is_active(c, t)) occupied.insert({t, (c.z + 50) / 28, (c.y + 50) / 31, (c.x + 50) / 26});
    });
  EXPECT_EQ(occupied.size(), 3U);
  const std::uint64_t chunk_bytes = std::uint64_t{28} * 31 * 26 * 4;
  EXPECT_EQ(file.storage_size(points + "phi"), occupied.size() * chunk_bytes);
  EXPECT_EQ(file.storage_size(points + "stress"), occupied.size() * chunk_bytes * 9);
  EXPECT_EQ(file.storage_size(points + "mask"), occupied.size() * chunk_bytes);
}

TEST(Hdf5Sink, WritesAFieldWithoutVoxelsAsBackground) {
  const TemporaryFolder folder;
  Scene scene;
  scene.times = 2;
  scene.active = [](const Coord&, int) { return false; };
  write_scene(scene, folder.path());
  expect_scene_in(scene, folder / "fields.hdf");
  EXPECT_EQ(Hdf5Reader(folder / "fields.hdf").storage_size(points + "velocity"), 0U);
}

TEST(Hdf5Sink, WritesNoMaskWhenThereIsNone) {
  const TemporaryFolder folder;
  const Scene scene;
  OutputLayout layout = scene.layout();
  layout.fields.clear();
  layout.has_mask = false;
  const auto sink = make_hdf5_sink(folder.path());
  sink->begin(layout);
  sink->write(scene.time(0), {}, nullptr);
  sink->commit({});
  EXPECT_FALSE(Hdf5Reader(folder / "fields.hdf").has(points + "mask"));
}

TEST(Hdf5Sink, RefusesVoxelsOutsideTheBox) {
  const TemporaryFolder folder;
  const Scene scene;
  {
    OutputLayout layout = scene.layout();
    --layout.last.y;
    const auto sink = make_hdf5_sink(folder.path());
    sink->begin(layout);
    try {
      scene.write_time(*sink, 0);
      ADD_FAILURE() << "no LimitError";
    } catch (const LimitError& error) {
      EXPECT_EQ(error.exit_code(), 4);
      EXPECT_THAT(error.what(), AllOf(StartsWith(folder / "fields.hdf"), HasSubstr("(-3, -5, -9) to (37, 6, 4)"),
                                      HasSubstr("(-3, -5, -9) to (37, 5, 4)")));
    }
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

}  // namespace
}  // namespace grainvdb::hdf5_sink_test
