#pragma once
/// Fields of one output time that are known functions of position.
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/measurement.hpp"
#include "grainvdb/run.hpp"

namespace grainvdb::testing {

struct SyntheticField {
  std::string name;
  int components;
  std::function<void(const Vec3& x, std::span<double> out)> value;
};

/// A scalar.
inline SyntheticField scalar(std::string name, std::function<double(const Vec3&)> value) {
  return {std::move(name), 1, [value = std::move(value)](const Vec3& x, std::span<double> out) { out[0] = value(x); }};
}

/// The fields on all voxels from first to last, inclusive.
inline OutputFields synthetic_output(const Lattice& lattice, const Coord& first, const Coord& last,
                                     const std::vector<SyntheticField>& fields, std::size_t frames = 1) {
  std::vector<Coord> origins;
  std::vector<LeafMask> masks;
  for (std::int32_t x = first.x; x <= last.x; ++x)
    for (std::int32_t y = first.y; y <= last.y; ++y)
      for (std::int32_t z = first.z; z <= last.z; ++z) {
        LeafMask mask;
        mask.set(leaf_offset({x, y, z}));
        origins.push_back(leaf_origin({x, y, z}));
        masks.push_back(mask);
      }
  const auto topology = std::make_shared<const Topology>(origins, masks);
  OutputFields output{{}, {}, Mask(topology)};
  output.time.frame_count = frames;
  for (const SyntheticField& synthetic : fields) {
    FieldMeta meta;
    meta.name = synthetic.name;
    meta.components = synthetic.components;
    SparseField field(meta, topology, lattice);
    std::vector<double> values(static_cast<std::size_t>(synthetic.components));
    for (std::size_t leaf = 0; leaf < topology->leaf_count(); ++leaf)
      topology->mask(leaf).for_each([&](int v) {
        synthetic.value(lattice.centre(voxel_at(topology->origin(leaf), v)), values);
        for (int c = 0; c < synthetic.components; ++c)
          field.leaf(leaf, c)[v] = static_cast<float>(values[static_cast<std::size_t>(c)]);
      });
    output.fields.emplace(synthetic.name, std::move(field));
  }
  return output;
}

/// The value of a number of a table by its name.
inline const Quantity& number_of(const Table& table, const std::string& name) {
  for (const Quantity& q : table.numbers)
    if (q.name == name) return q;
  throw std::out_of_range("no number " + name);
}
/// A column of a table by its name.
inline const std::vector<double>& column_of(const Table& table, const std::string& name) {
  for (const TableColumn& c : table.columns)
    if (c.name == name) return c.values;
  throw std::out_of_range("no column " + name);
}

/// The defaults of a measurement's options.
inline OptionValues defaults_of(const MeasurementInfo& info) {
  OptionValues values;
  for (const OptionInfo& option : info.options) values[option.name] = option.default_value;
  return values;
}

}  // namespace grainvdb::testing
