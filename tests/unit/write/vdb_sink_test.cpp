#include "write/vdb_sink.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <openvdb/openvdb.h>

#include "grainvdb/error.hpp"
#include "grainvdb/grids.hpp"
#include "unit/write/support.hpp"

namespace grainvdb::vdb_sink_test {
namespace {

using namespace testing;  // NOLINT: the folder's own helpers
using ::testing::ElementsAre;
using ::testing::IsEmpty;

void write_scene(const Scene& scene, const std::string& folder) {
  const auto sink = make_vdb_sink(folder);
  scene.write_all(*sink);
  sink->commit(some_provenance());
}

struct Content {
  explicit Content(const std::string& path) {
    openvdb::initialize();
    openvdb::io::File file(path);
    file.open(/*delayLoad=*/false);
    metadata = *file.getMetadata();
    const openvdb::GridPtrVecPtr all = file.getGrids();
    for (const auto& grid : *all) grids[grid->getName()] = grid;
  }
  template <class Grid>
  const Grid& get(const std::string& name) const {
    const auto grid = openvdb::gridConstPtrCast<Grid>(grids.at(name));
    if (!grid) throw std::runtime_error(name + " has another type");
    return *grid;
  }
  openvdb::MetaMap metadata;
  std::map<std::string, openvdb::GridBase::Ptr> grids;
};

bool same(float a, float b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}
openvdb::Coord at(const Coord& c) {
  return grid_index(c);
}

/// Compares values and active states, a margin of one leaf around the box included.
void expect_scene_in(const Scene& scene, int t, const std::string& path) {
  const Content content(path);
  const Coord first{scene.first.x - 8, scene.first.y - 8, scene.first.z - 8};
  const Coord last{scene.last.x + 8, scene.last.y + 8, scene.last.z + 8};
  const auto active = [&](const Coord& c) {
    const bool in_box = c.x >= scene.first.x && c.y >= scene.first.y && c.z >= scene.first.z && c.x <= scene.last.x &&
                        c.y <= scene.last.y && c.z <= scene.last.z;
    return in_box && scene.is_active(c, t);
  };
  std::size_t wrong = 0;
  const auto check = [&](const auto& grid, const auto& expected) {
    const auto accessor = grid.getConstAccessor();
    for_each_voxel(first, last, [&](const Coord& c) {
      const bool on = active(c);
      wrong += accessor.isValueOn(at(c)) == on && expected(c, on, accessor.getValue(at(c))) ? 0U : 1U;
    });
  };
  const auto check_float = [&](const std::string& name, int component) {
    check(content.get<openvdb::FloatGrid>(name),
          [&](const Coord& c, bool on, float value) { return same(value, on ? known_value(c, component, t) : 0.0F); });
  };
  check_float("phi", 0);
  for (int k = 0; k < 9; ++k) check_float(std::string("stress_") + "xyz"[k / 3] + "xyz"[k % 3], k);
  check(content.get<openvdb::Vec3SGrid>("velocity"), [&](const Coord& c, bool on, const openvdb::Vec3s& value) {
    bool good = true;
    for (int k = 0; k < 3; ++k) good = good && same(value[k], on ? known_value(c, k, t) : nan_background);
    return good;
  });
  check(content.get<openvdb::Int32Grid>("mask"), [&](const Coord& c, bool on, std::int32_t value) {
    return value == static_cast<std::int32_t>(on ? known_flags(c, t) : 1U);
  });
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(content.grids.size(), 12U);
}

TEST(VdbSink, WritesEveryValueOfAStaticResult) {
  const TemporaryFolder folder;
  const Scene scene;
  write_scene(scene, folder.path());
  EXPECT_THAT(folder.names(), ElementsAre("fields.vdb"));
  expect_scene_in(scene, 0, folder / "fields.vdb");
}

TEST(VdbSink, WritesOneFilePerOutputTime) {
  const TemporaryFolder folder;
  Scene scene;
  scene.times = 3;
  scene.active = [](const Coord& c, int t) { return (c.x + c.y + c.z + t) % 4 != 0 && c.x > 10 * t - 5; };
  write_scene(scene, folder.path());
  EXPECT_THAT(folder.names(), ElementsAre("fields_0000.vdb", "fields_0001.vdb", "fields_0002.vdb"));
  for (int t = 0; t < 3; ++t) expect_scene_in(scene, t, folder / ("fields_000" + std::to_string(t) + ".vdb"));
}

TEST(VdbSink, PutsVoxelCentresWhereTheLatticeHasThem) {
  const TemporaryFolder folder;
  const Scene scene;
  write_scene(scene, folder.path());
  const Content content(folder / "fields.vdb");
  for (const auto& [name, grid] : content.grids) {
    const openvdb::Vec3d centre = grid->indexToWorld(grid_index({-3, 2, 10}));
    // origin + (i + ½) h with multiples of 1/8: exact
    EXPECT_EQ(centre, openvdb::Vec3d(1 - 2.5 * 0.25, 2 + 2.5 * 0.25, 3 + 10.5 * 0.25)) << name;
  }
}

TEST(VdbSink, DescribesGridsAndFile) {
  const TemporaryFolder folder;
  Scene scene;
  scene.times = 2;
  write_scene(scene, folder.path());
  const Content content(folder / "fields_0001.vdb");
  for (const auto& [name, grid] : content.grids) {
    EXPECT_EQ(grid->metaValue<double>("time"), 0.625) << name;
    EXPECT_EQ(grid->metaValue<std::string>("time_unit"), "s");
    EXPECT_EQ(grid->metaValue<std::string>("length_unit"), "m");
    EXPECT_EQ(grid->metaValue<std::int64_t>("first_step"), 1010);
    EXPECT_EQ(grid->metaValue<std::int64_t>("last_step"), 1019);
    EXPECT_EQ(grid->metaValue<std::int64_t>("frame_count"), 4);
    EXPECT_EQ(grid->metaValue<std::string>("unit"), name == "mask" ? "1" : "Pa");
    EXPECT_FALSE(grid->metaValue<std::string>("description").empty());
  }
  EXPECT_EQ(content.grids.at("stress_zx")->metaValue<std::string>("equation"), "Σ stress W (6)");
  EXPECT_EQ(content.grids.at("velocity")->getVectorType(), openvdb::VEC_INVARIANT);
  EXPECT_EQ(content.grids.at("phi")->getGridClass(), openvdb::GRID_FOG_VOLUME);
  for (const auto& [key, text] : some_provenance())
    EXPECT_EQ(content.metadata.metaValue<std::string>("provenance/" + key), text);
}

TEST(VdbSink, WritesAFieldWithoutVoxels) {
  const TemporaryFolder folder;
  Scene scene;
  scene.active = [](const Coord&, int) { return false; };
  write_scene(scene, folder.path());
  expect_scene_in(scene, 0, folder / "fields.vdb");
}

TEST(VdbSink, LeavesNothingBehindWithoutCommit) {
  const TemporaryFolder folder;
  Scene scene;
  scene.times = 2;
  {
    const auto sink = make_vdb_sink(folder.path());
    scene.write_all(*sink);
    EXPECT_EQ(folder.names().size(), 2U);
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(VdbSink, ReplacesAnOlderResultWhole) {
  const TemporaryFolder folder;
  Scene scene;
  scene.times = 3;
  write_scene(scene, folder.path());
  for (const char* other : {"fields_12.vdb", "fields_00a0.vdb", "my_fields.vdb", "fields_0000.vdb.bak"})
    write_file(folder / other, "mine");
  scene.times = 2;
  write_scene(scene, folder.path());
  EXPECT_THAT(folder.names(), ElementsAre("fields_0000.vdb", "fields_0000.vdb.bak", "fields_0001.vdb",
                                          "fields_00a0.vdb", "fields_12.vdb", "my_fields.vdb"));
  scene.times = 1;
  write_scene(scene, folder.path());
  EXPECT_THAT(folder.names(),
              ElementsAre("fields.vdb", "fields_0000.vdb.bak", "fields_00a0.vdb", "fields_12.vdb", "my_fields.vdb"));
}

TEST(VdbSink, NamesTheFilesThatItLeaves) {
  const TemporaryFolder folder;
  Scene scene;
  scene.times = 2;
  const auto sink = make_vdb_sink(folder.path());
  EXPECT_THAT(sink->files(), IsEmpty());
  scene.write_all(*sink);
  EXPECT_THAT(sink->files(), ElementsAre(folder / "fields_0000.vdb", folder / "fields_0001.vdb"));
}

std::string uuid_of(const std::string& path) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open(false);
  return file.getUniqueTag();
}

TEST(VdbSink, GivesTheSameBytesForTheSameResultAndAnotherUuidForAnother) {
  const TemporaryFolder folder;
  Scene scene;
  write_scene(scene, folder / "a");
  write_scene(scene, folder / "b");
  EXPECT_TRUE(read_file(folder / "a/fields.vdb") == read_file(folder / "b/fields.vdb"));
  scene.active = [](const Coord& c, int) { return (c.x + c.y + c.z) % 5 != 1; };
  write_scene(scene, folder / "c");
  EXPECT_NE(uuid_of(folder / "a/fields.vdb"), uuid_of(folder / "c/fields.vdb"));
}

TEST(VdbSink, RefusesToBeUsedOutOfOrder) {
  const TemporaryFolder folder;
  const Scene scene;
  EXPECT_THROW(make_vdb_sink(folder.path())->commit({}), std::logic_error);
  EXPECT_THROW(scene.write_time(*make_vdb_sink(folder.path()), 0), std::logic_error);
  const auto sink = make_vdb_sink(folder.path());
  sink->begin(scene.layout());
  EXPECT_THROW(sink->begin(scene.layout()), std::logic_error);
  EXPECT_THROW(sink->commit({}), std::logic_error);
  scene.write_time(*sink, 0);
  EXPECT_THROW(scene.write_time(*sink, 0), std::logic_error);
}

}  // namespace
}  // namespace grainvdb::vdb_sink_test
