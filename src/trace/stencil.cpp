#include "trace/stencil.hpp"

#include <cmath>
#include <limits>

#include "trace/cell.hpp"
#include "trace/spline.hpp"

namespace grainvdb {
namespace {

/// Σ weight × value; NaN where one is.
template <class Nodes>
double sum_over(const Nodes& nodes, const SparseField& field, int component) {
  double sum = 0;
  for (const auto& n : nodes.node) sum += n.weight * static_cast<double>(field.leaf(n.leaf, component)[n.offset]);
  return sum;
}

}  // namespace

Stencil::Stencil(const Lattice& lattice, const Topology& topology, const LeafIndex& index, Interpolation interpolation)
    : lattice_(lattice), topology_(topology), index_(index), interpolation_(interpolation) {}

template <std::size_t n>
void Stencil::find(const Coord& first, const std::array<std::array<double, n>, 3>& weights, Nodes<n * n * n>& to) {
  std::array<std::array<std::int32_t, n>, 3> voxel{};
  for (int a = 0; a < 3; ++a)
    for (std::size_t i = 0; i < n; ++i)
      voxel[static_cast<std::size_t>(a)][i] = lattice_.wrap(a, first[a] + static_cast<std::int32_t>(i));
  to.active = true;
  Coord origin{1, 1, 1};  // of no leaf
  std::size_t leaf = 0, at = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t k = 0; k < n; ++k) {
        const Coord c{voxel[0][i], voxel[1][j], voxel[2][k]};
        if (leaf_origin(c) != origin) leaf = index_.find(origin = leaf_origin(c));
        to.node[at++] = {leaf, leaf_offset(c), weights[0][i] * weights[1][j] * weights[2][k]};
        to.active = to.active && leaf != index_.leaf_count() && topology_.mask(leaf).test(leaf_offset(c));
      }
}

void Stencil::move_to(const Vec3& x) {
  const Cell cell = cell_at(lattice_, x);
  find<2>(cell.voxel, {linear_weights(cell.within[0]), linear_weights(cell.within[1]), linear_weights(cell.within[2])},
          eight_);
  many_.active = false;
  if (interpolation_ == Interpolation::tricubic && eight_.active)
    find<4>({cell.voxel.x - 1, cell.voxel.y - 1, cell.voxel.z - 1},
            {cubic_weights(cell.within[0]), cubic_weights(cell.within[1]), cubic_weights(cell.within[2])}, many_);
}

bool Stencil::sample(const SparseField& field, float* to) const {
  bool defined = true;
  for (int c = 0; c < field.components(); ++c) {
    double value = many_.active ? sum_over(many_, field, c) : std::numeric_limits<double>::quiet_NaN();
    if (std::isnan(value) && eight_.active) value = sum_over(eight_, field, c);
    to[c] = static_cast<float>(value);
    defined = defined && !std::isnan(value);
  }
  return defined;
}

std::uint32_t Stencil::reasons(const SparseField& field, const Mask* mask) const {
  std::uint32_t bits = 0;
  for (const Node& n : eight_.node) {
    if (n.leaf == index_.leaf_count() || !topology_.mask(n.leaf).test(n.offset)) {
      bits |= static_cast<std::uint32_t>(Reason::outside);
      continue;
    }
    for (int c = 0; c < field.components() && mask != nullptr; ++c)
      if (std::isnan(field.leaf(n.leaf, c)[n.offset])) bits |= mask->leaf(n.leaf)[n.offset];
  }
  return bits;
}

}  // namespace grainvdb
