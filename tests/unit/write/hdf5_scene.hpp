#pragma once
/// Scenes in files of the HDF5 sink.
#include <cmath>

#include "grainvdb/error.hpp"
#include "unit/write/hdf5_reader.hpp"
#include "unit/write/support.hpp"
#include "write/hdf5_sink.hpp"

namespace grainvdb::testing::hdf5_scene {

inline constexpr auto outside = static_cast<std::uint32_t>(Reason::outside);
inline const std::string points = "/VTKHDF/PointData/";

inline void write_scene(const Scene& scene, const std::string& folder) {
  const auto sink = make_hdf5_sink(folder);
  scene.write_all(*sink);
  sink->commit(some_provenance());
}

inline bool same(float a, float b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

/// Compares every value of the file with the scene's; the C order of the datasets is that of the loops.
inline void expect_scene_in(const Scene& scene, const std::string& path) {
  const Hdf5Reader file(path);
  const hsize_t nx = static_cast<hsize_t>(scene.last.x - scene.first.x + 1);
  const hsize_t ny = static_cast<hsize_t>(scene.last.y - scene.first.y + 1);
  const hsize_t nz = static_cast<hsize_t>(scene.last.z - scene.first.z + 1);
  const auto shape = [&](int components) {
    std::vector<hsize_t> s{nz, ny, nx};
    if (scene.times > 1) s.insert(s.begin(), static_cast<hsize_t>(scene.times));
    if (components > 1) s.push_back(static_cast<hsize_t>(components));
    return s;
  };
  for (const FieldMeta& m : scene.fields) {
    const std::string name = points + m.name;
    ASSERT_EQ(file.dims(name), shape(m.components)) << m.name;
    EXPECT_TRUE(file.stored_as(name, H5T_IEEE_F32LE));
    const std::vector<float> values = file.read<float>(name);
    std::size_t i = 0, wrong = 0;
    for (int t = 0; t < scene.times; ++t)
      for_each_voxel(scene.first, scene.last, [&](const Coord& c) {
        for (int k = 0; k < m.components; ++k)
          wrong += same(values[i++], scene.is_active(c, t) ? known_value(c, k, t) : m.background) ? 0U : 1U;
      });
    EXPECT_EQ(wrong, 0U) << m.name;
  }
  ASSERT_EQ(file.dims(points + "mask"), shape(1));
  EXPECT_TRUE(file.stored_as(points + "mask", H5T_STD_U32LE));
  const std::vector<std::uint32_t> mask = file.read<std::uint32_t>(points + "mask");
  std::size_t i = 0, wrong = 0;
  for (int t = 0; t < scene.times; ++t)
    for_each_voxel(scene.first, scene.last, [&](const Coord& c) {
      wrong += mask[i++] == (scene.is_active(c, t) ? known_flags(c, t) : outside) ? 0U : 1U;
    });
  EXPECT_EQ(wrong, 0U);
}

}  // namespace grainvdb::testing::hdf5_scene
