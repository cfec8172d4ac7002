#include "measure/voxel_values.hpp"

#include <algorithm>
#include <cstddef>
#include <numbers>

#include "grainvdb/run.hpp"
#include "grainvdb/sparse_field.hpp"
#include "grainvdb/topology.hpp"

namespace grainvdb {

void for_each_value(const OutputFields& fields, const std::vector<std::string>& names,
                    const std::function<void(const Coord&, std::span<const double>)>& f) {
  std::vector<const SparseField*> read;
  std::size_t components = 0;
  for (const std::string& name : names) {
    read.push_back(&fields.fields.at(name));
    components += static_cast<std::size_t>(read.back()->components());
  }
  if (read.empty()) return;
  const Topology& topology = *read.front()->topology();
  std::vector<double> values(components);
  for (std::size_t leaf = 0; leaf < topology.leaf_count(); ++leaf)
    topology.mask(leaf).for_each([&](int offset) {
      std::size_t n = 0;
      for (const SparseField* field : read)
        for (int k = 0; k < field->components(); ++k) values[n++] = static_cast<double>(field->leaf(leaf, k)[offset]);
      f(voxel_at(topology.origin(leaf), offset), values);
    });
}

double independence(double voxel, const LucyKernel& kernel) {
  const double h = voxel / kernel.cutoff();
  return std::min(1.0, h * h * h * 455 / (176 * std::numbers::pi));
}

}  // namespace grainvdb
