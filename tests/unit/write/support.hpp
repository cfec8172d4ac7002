#pragma once
/// Small fields with known values, and a folder to write them to.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <unistd.h>

#include "grainvdb/field_sink.hpp"

namespace grainvdb::testing {

/// A new folder that is removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "grainvdb-write-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      all.push_back(entry.path().filename().string());
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  std::filesystem::path path_;
};

inline std::string read_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot open " + path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_file(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// Calls f(voxel) for each voxel first … last.
inline void for_each_voxel(const Coord& first, const Coord& last, const std::function<void(const Coord&)>& f) {
  for (std::int32_t z = first.z; z <= last.z; ++z)
    for (std::int32_t y = first.y; y <= last.y; ++y)
      for (std::int32_t x = first.x; x <= last.x; ++x) f({x, y, z});
}

/// The voxels of first … last for which `active` holds.
inline std::shared_ptr<const Topology> make_topology(const Coord& first, const Coord& last,
                                                     const std::function<bool(const Coord&)>& active) {
  std::vector<Coord> origins;
  std::vector<LeafMask> masks;
  for_each_voxel(leaf_origin(first), leaf_origin(last), [&](const Coord& o) {
    if (o != leaf_origin(o)) return;
    LeafMask mask;
    for (int offset = 0; offset < leaf_size; ++offset) {
      const Coord c = voxel_at(o, offset);
      const bool in_box =
          c.x >= first.x && c.y >= first.y && c.z >= first.z && c.x <= last.x && c.y <= last.y && c.z <= last.z;
      if (in_box && active(c)) mask.set(offset);
    }
    origins.push_back(o);
    masks.push_back(mask);
  });
  return std::make_shared<Topology>(std::move(origins), std::move(masks));
}

/// A number that tells voxel, component and time apart, exact in float for the small boxes of the tests.
inline float known_value(const Coord& c, int component, int time) {
  return static_cast<float>(c.x + 100 * c.y + 10000 * c.z) + 0.0625F * static_cast<float>(component) +
         0.01953125F * static_cast<float>(time);
}

/// known_value at the active voxels; rubbish at the others, which must never be seen.
inline void fill(SparseField& field, int time) {
  const Topology& topology = *field.topology();
  for (std::size_t l = 0; l < topology.leaf_count(); ++l)
    for (int k = 0; k < field.components(); ++k)
      for (int offset = 0; offset < leaf_size; ++offset)
        field.leaf(l, k)[offset] =
            topology.mask(l).test(offset) ? known_value(voxel_at(topology.origin(l), offset), k, time) : -12345.0F;
}

inline std::uint32_t known_flags(const Coord& c, int time) {
  return (c.x + time) % 3 == 0 ? static_cast<std::uint32_t>(Reason::low_pressure) : 0U;
}

inline FieldMeta meta_of(const std::string& name, int components, float background) {
  return {name, "Pa", components, "made up: " + name, "Σ " + name + " W (6)", background};
}

inline constexpr float nan_background = std::numeric_limits<float>::quiet_NaN();

/// A result: a box, the active voxels in it at each output time, and one field of each kind.
struct Scene {
  Lattice lattice{0.25, {1.0, 2.0, 3.0}};
  Coord first{-3, -5, -9};
  Coord last{37, 6, 4};
  int times = 1;
  std::function<bool(const Coord&, int)> active = [](const Coord& c, int) { return (c.x + c.y + c.z) % 5 != 0; };
  std::vector<FieldMeta> fields{meta_of("phi", 1, 0.0F), meta_of("velocity", 3, nan_background),
                                meta_of("stress", 9, 0.0F)};

  bool is_active(const Coord& c, int time) const { return active(c, time); }

  OutputLayout layout() const {
    OutputLayout l(lattice);
    l.first = first;
    l.last = last;
    l.time_count = static_cast<std::size_t>(times);
    l.fields = fields;
    l.has_mask = true;
    l.length_unit = "m";
    l.time_unit = "s";
    return l;
  }

  OutputTime time(int t) const {
    return {0.5 + 0.125 * t, 1000 + 10 * t, 1009 + 10 * t, static_cast<std::size_t>(3 + t)};
  }

  std::shared_ptr<const Topology> topology(int t) const {
    return make_topology(first, last, [&](const Coord& c) { return active(c, t); });
  }

  void write_time(FieldSink& sink, int t) const {
    const auto voxels = topology(t);
    std::vector<SparseField> made;
    for (const FieldMeta& m : fields) {
      made.emplace_back(m, voxels, lattice);
      fill(made.back(), t);
    }
    std::vector<const SparseField*> pointers;
    for (const SparseField& f : made) pointers.push_back(&f);
    Mask mask(voxels);
    for (std::size_t l = 0; l < voxels->leaf_count(); ++l)
      voxels->mask(l).for_each([&](int offset) {
        if (known_flags(voxel_at(voxels->origin(l), offset), t) != 0) mask.add(l, offset, Reason::low_pressure);
      });
    sink.write(time(t), pointers, &mask);
  }

  /// begin, and every write.
  void write_all(FieldSink& sink) const {
    sink.begin(layout());
    for (int t = 0; t < times; ++t) write_time(sink, t);
  }
};

inline std::unique_ptr<FieldSink> make_sink(const std::string& name, const std::string& folder) {
  for (const SinkInfo& s : sink_registry())
    if (s.name == name) return s.make(folder);
  throw std::runtime_error("no sink named " + name);
}

inline Provenance some_provenance() {
  return {{"version", "1.2.3"},
          {"averaging", "1 output time of 3 frames\n"},
          {"pipeline", "voxel: 1\n# Grüße, φ ≤ ½\n"},
          {"empty", ""}};
}

}  // namespace grainvdb::testing
