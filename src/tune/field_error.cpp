#include "tune/field_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace grainvdb {
namespace {

/// A number in [0, 1) that is as good as random, from a voxel's coordinates.
double hash_of(const Coord& c) {
  std::uint64_t z = 0;
  for (int a = 0; a < 3; ++a) {
    z += 0x9e3779b97f4a7c15ULL + static_cast<std::uint32_t>(c[a]);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    z ^= z >> 31;
  }
  return static_cast<double>(z >> 11) * 0x1p-53;
}

/// The voxels around a position and their weights, those without any left out.
class Stencil {
 public:
  Stencil(const Lattice& lattice, const Topology& topology, const Vec3& x) {
    std::array<std::int32_t, 3> base{};
    std::array<double, 3> part{};
    for (int a = 0; a < 3; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      const double u = lattice.wrap_index(a, lattice.to_index(a, x[axis]));
      base[axis] = static_cast<std::int32_t>(std::floor(u));
      part[axis] = u - base[axis];
    }
    for (int corner = 0; corner < 8; ++corner) {
      const std::array<int, 3> side{corner >> 2, (corner >> 1) & 1, corner & 1};
      double weight = 1;
      for (std::size_t a = 0; a < 3; ++a) weight *= side[a] == 1 ? part[a] : 1 - part[a];
      if (weight < 1e-9) continue;  // on a voxel centre or a face between voxels, to rounding
      const Coord c = lattice.wrap(Coord{base[0] + side[0], base[1] + side[1], base[2] + side[2]});
      const std::optional<std::size_t> leaf = leaf_of(topology, leaf_origin(c));
      const bool active = leaf && topology.mask(*leaf).test(leaf_offset(c));
      nodes_[count_++] = {active ? *leaf : inactive, static_cast<std::size_t>(leaf_offset(c)), weight};
    }
  }

  /// NaN where a value is missing.
  double value(const SparseField& field, int component) const {
    double sum = 0;
    double weights = 0;
    for (std::size_t n = 0; n < count_; ++n) {
      sum += nodes_[n].weight * static_cast<double>(value(field, component, nodes_[n]));
      weights += nodes_[n].weight;
    }
    return sum / weights;
  }

 private:
  /// Corners come in order, and most lie in the leaf of the one before.
  std::optional<std::size_t> leaf_of(const Topology& topology, const Coord& origin) {
    if (!last_ || topology.origin(*last_) != origin) last_ = topology.find(origin);
    return last_;
  }

  struct Node {
    std::size_t leaf = 0, offset = 0;
    double weight = 0;
  };
  static constexpr std::size_t inactive = std::numeric_limits<std::size_t>::max();

  static float value(const SparseField& field, int component, const Node& node) {
    return node.leaf == inactive ? field.meta().background : field.leaf(node.leaf, component)[node.offset];
  }

  std::array<Node, 8> nodes_{};
  std::size_t count_ = 0;
  std::optional<std::size_t> last_;
};

struct Sums {
  double weights = 0, difference = 0, reference = 0, largest = 0;
  std::size_t points = 0, undefined = 0;

  void add(const ReferencePoints::Field& expected, double weight, std::size_t point, const Stencil& at,
           const SparseField* found) {
    const auto components = static_cast<std::size_t>(expected.components);
    const float* r = expected.values.data() + point * components;
    if (std::any_of(r, r + components, [](float x) { return std::isnan(x); })) return;
    double distance = 0;
    double size = 0;
    for (std::size_t c = 0; c < components; ++c) {
      const double f = found == nullptr ? std::nan("") : at.value(*found, static_cast<int>(c));
      distance += (f - static_cast<double>(r[c])) * (f - static_cast<double>(r[c]));
      size += static_cast<double>(r[c]) * static_cast<double>(r[c]);
    }
    if (std::isnan(distance)) {
      ++undefined;
      return;
    }
    ++points;
    weights += weight;
    difference += weight * distance;
    reference += weight * size;
    largest = std::max(largest, distance);
  }

  FieldError error(const std::string& field) const {
    const auto over = [](double a, double b) { return a == 0 ? 0 : std::sqrt(a / b); };
    return {field, over(difference, reference), over(largest * weights, reference), points, undefined};
  }
};

}  // namespace

ReferencePoints reference_points(const FieldSet& reference, const std::vector<std::string>& names,
                                 const std::string& weight, std::size_t most) {
  ReferencePoints points;
  std::vector<const SparseField*> fields;
  for (const std::string& name : names) {
    fields.push_back(&reference.fields.at(name));
    points.fields.push_back({name, fields.back()->components(), std::isnan(fields.back()->meta().background), {}});
  }
  if (fields.empty()) return points;
  const Topology& topology = *fields.front()->topology();
  const double share = static_cast<double>(most) / static_cast<double>(topology.active_voxel_count());
  for (std::size_t l = 0; l < topology.leaf_count(); ++l)
    topology.mask(l).for_each([&](int offset) {
      const Coord c = voxel_at(topology.origin(l), offset);
      if (hash_of(c) >= share || points.position.size() == most) return;
      points.position.push_back(reference.lattice.centre(c));
      points.weight.push_back(weight.empty() ? 1.0 : reference.fields.at(weight).leaf(l)[offset]);
      for (std::size_t k = 0; k < fields.size(); ++k)
        for (int component = 0; component < points.fields[k].components; ++component)
          points.fields[k].values.push_back(fields[k]->leaf(l, component)[offset]);
    });
  return points;
}

std::vector<FieldError> field_errors(const ReferencePoints& reference, const FieldSet& found) {
  std::vector<const SparseField*> same;
  for (const ReferencePoints::Field& f : reference.fields) {
    const auto it = found.fields.find(f.name);
    same.push_back(it == found.fields.end() ? nullptr : &it->second);
  }
  std::vector<Sums> sums(reference.fields.size());
  static const Topology nothing;
  const Topology& topology = found.fields.empty() ? nothing : *found.fields.begin()->second.topology();
  for (std::size_t p = 0; p < reference.position.size(); ++p) {
    const Stencil at(found.lattice, topology, reference.position[p]);
    for (std::size_t k = 0; k < sums.size(); ++k)
      sums[k].add(reference.fields[k], reference.fields[k].is_ratio ? reference.weight[p] : 1, p, at, same[k]);
  }
  std::vector<FieldError> errors;
  for (std::size_t k = 0; k < sums.size(); ++k) errors.push_back(sums[k].error(reference.fields[k].name));
  return errors;
}

}  // namespace grainvdb
