#include "grainvdb/sparse_field.hpp"

#include <algorithm>
#include <stdexcept>

#include <openvdb/tree/LeafManager.h>

#include "grainvdb/grids.hpp"

namespace grainvdb {
namespace {

static_assert(openvdb::FloatTree::LeafNodeType::SIZE == leaf_size);
static_assert(sizeof(openvdb::FloatTree::LeafNodeType::NodeMaskType) == sizeof(LeafMask));

openvdb::FloatTree::Ptr make_tree(const Topology& topology, float background) {
  auto tree = std::make_shared<openvdb::FloatTree>(background);
  openvdb::tree::ValueAccessor<openvdb::FloatTree> accessor(*tree);
  for (std::size_t l = 0; l < topology.leaf_count(); ++l) {
    const Coord& o = topology.origin(l);
    auto* leaf = new openvdb::FloatTree::LeafNodeType(openvdb::Coord(o.x, o.y, o.z), background);
    openvdb::FloatTree::LeafNodeType::NodeMaskType mask;
    for (unsigned w = 0; w < 8; ++w) mask.getWord<std::uint64_t>(w) = topology.mask(l).words[w];
    leaf->setValueMask(mask);
    accessor.addLeaf(leaf);  // the tree owns it
  }
  return tree;
}

}  // namespace

SparseField::SparseField(FieldMeta meta, std::shared_ptr<const Topology> topology, const Lattice& lattice)
    : meta_(std::move(meta)),
      topology_(std::move(topology)),
      grids_(std::make_unique<Grids>()),
      leaves_(topology_->leaf_count() * components_()) {
  const double h = lattice.voxel();
  const Vec3& o = lattice.origin();
  const auto transform = openvdb::math::Transform::createLinearTransform(h);
  transform->postTranslate({o[0] + h / 2, o[1] + h / 2, o[2] + h / 2});
  for (std::size_t c = 0; c < components_(); ++c) {
    const auto tree = c == 0 ? make_tree(*topology_, meta_.background)
                             : std::make_shared<openvdb::FloatTree>(grids_->components[0]->tree(), meta_.background,
                                                                    openvdb::TopologyCopy());
    auto grid = openvdb::FloatGrid::create(tree);
    grid->setName(meta_.name);
    grid->setTransform(transform->copy());
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    for (std::size_t l = 0; l < topology_->leaf_count(); ++l) {
      const Coord& q = topology_->origin(l);
      leaves_[l * components_() + c] = tree->probeLeaf(openvdb::Coord(q.x, q.y, q.z))->buffer().data();
    }
    grids_->components.push_back(std::move(grid));
  }
}

SparseField::~SparseField() = default;
SparseField::SparseField(SparseField&&) noexcept = default;
SparseField& SparseField::operator=(SparseField&&) noexcept = default;

float SparseField::value(const Coord& c, int component) const {
  return grids_->components.at(static_cast<std::size_t>(component))->tree().getValue(openvdb::Coord(c.x, c.y, c.z));
}

}  // namespace grainvdb
