#include "grainvdb/sparse_field.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/parallel.hpp"
#include "grainvdb/grids.hpp"

namespace grainvdb {
namespace {

static_assert(openvdb::FloatTree::LeafNodeType::SIZE == leaf_size);
static_assert(sizeof(openvdb::FloatTree::LeafNodeType::NodeMaskType) == sizeof(LeafMask));

using Tree = openvdb::FloatTree;
using Leaf = Tree::LeafNodeType;

/// A leaf whose values are not set.
Leaf* make_leaf(const Coord& origin, const LeafMask& active, float background) {
  auto* leaf = new Leaf(openvdb::PartialCreate(), grid_index(origin), background);
  Leaf::NodeMaskType mask;
  for (unsigned w = 0; w < 8; ++w) mask.getWord<std::uint64_t>(w) = active.words[w];
  leaf->setValueMask(mask);
  return leaf;
}

}  // namespace

openvdb::math::Transform::Ptr grid_transform(const Lattice& lattice) {
  const double h = lattice.voxel();
  const openvdb::Coord first = grid_index({0, 0, 0});
  auto transform = openvdb::math::Transform::createLinearTransform(h);
  openvdb::Vec3d start;
  for (int a = 0; a < 3; ++a) start[a] = lattice.origin()[a] + h * (0.5 - first[a]);
  transform->postTranslate(start);
  return transform;
}

SparseField SparseField::unset(FieldMeta meta, std::shared_ptr<const Topology> topology, const Lattice& lattice) {
  SparseField field(std::move(meta), std::move(topology));
  const auto transform = grid_transform(lattice);
  const float background = field.meta_.background;
  field.grids_->components.resize(field.components_());
  parallel_for(field.components_(), [&](std::size_t c) {
    const auto tree = std::make_shared<Tree>(background);
    openvdb::tree::ValueAccessor<Tree> accessor(*tree);
    std::vector<Leaf*> leaves(field.topology_->leaf_count());
    for (std::size_t l = 0; l < leaves.size(); ++l) {
      leaves[l] = make_leaf(field.topology_->origin(l), field.topology_->mask(l), background);
      accessor.addLeaf(leaves[l]);  // the tree owns it
    }
    for (std::size_t l = 0; l < leaves.size(); ++l) {
      leaves[l]->allocate();
      field.leaves_[l * field.components_() + c] = leaves[l]->buffer().data();
    }
    auto grid = openvdb::FloatGrid::create(tree);
    grid->setName(field.meta_.name);
    grid->setTransform(transform->copy());
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    field.grids_->components[c] = std::move(grid);
  });
  return field;
}

SparseField::SparseField(FieldMeta meta, std::shared_ptr<const Topology> topology)
    : meta_(std::move(meta)),
      topology_(std::move(topology)),
      grids_(std::make_unique<Grids>()),
      leaves_(topology_->leaf_count() * components_()) {}

SparseField::SparseField(FieldMeta meta, std::shared_ptr<const Topology> topology, const Lattice& lattice)
    : SparseField(unset(std::move(meta), std::move(topology), lattice)) {
  parallel_for(leaves_.size(), [&](std::size_t l) { std::fill_n(leaves_[l], leaf_size, meta_.background); });
}

SparseField::~SparseField() = default;
SparseField::SparseField(SparseField&&) noexcept = default;
SparseField& SparseField::operator=(SparseField&&) noexcept = default;

void SparseField::change_units(double size, std::string unit, const Lattice& lattice) {
  if (std::isfinite(meta_.background) && meta_.background != 0)
    throw std::invalid_argument("the background of a field would depend on its unit");
  if (size != 1)
    parallel_for(leaves_.size(), [&](std::size_t l) {
      std::transform(leaves_[l], leaves_[l] + leaf_size, leaves_[l],
                     [size](float value) { return static_cast<float>(static_cast<double>(value) / size); });
    });
  meta_.unit = std::move(unit);
  const auto transform = grid_transform(lattice);
  for (const auto& grid : grids_->components) grid->setTransform(transform->copy());
}

float SparseField::value(const Coord& c, int component) const {
  return grids_->components.at(static_cast<std::size_t>(component))->tree().getValue(grid_index(c));
}

}  // namespace grainvdb
