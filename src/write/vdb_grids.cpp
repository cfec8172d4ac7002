#include "write/vdb_grids.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "grainvdb/grids.hpp"
#include "write/output_names.hpp"

namespace grainvdb {
namespace {

using openvdb::MetaMap;
using openvdb::StringMetadata;

MetaMap field_metadata(const FieldMeta& meta, const MetaMap& common) {
  MetaMap all(common);
  all.insertMeta("unit", StringMetadata(meta.unit));
  all.insertMeta("description", StringMetadata(meta.description));
  all.insertMeta("equation", StringMetadata(meta.equation));
  return all;
}

openvdb::GridBase::ConstPtr float_grid(const openvdb::FloatGrid& grid, const std::string& name,
                                       const MetaMap& metadata) {
  MetaMap all(metadata);
  all.insertMeta(openvdb::GridBase::META_GRID_NAME, StringMetadata(name));
  all.insertMeta(openvdb::GridBase::META_GRID_CLASS,
                 StringMetadata(openvdb::GridBase::gridClassToString(openvdb::GRID_FOG_VOLUME)));
  return grid.copyGridReplacingMetadata(all);
}

openvdb::GridBase::ConstPtr vector_grid(const SparseField& field, const MetaMap& metadata) {
  const openvdb::FloatGrid& x = *field.grids().components.front();
  const openvdb::Vec3s background(field.meta().background);
  const auto tree = std::make_shared<openvdb::Vec3STree>(x.tree(), background, openvdb::TopologyCopy());
  const Topology& topology = *field.topology();
  for (std::size_t l = 0; l < topology.leaf_count(); ++l) {
    auto& leaf = *tree->probeLeaf(grid_index(topology.origin(l)));
    topology.mask(l).for_each([&](int offset) {
      leaf.setValueOnly(static_cast<openvdb::Index>(offset),
                        {field.leaf(l, 0)[offset], field.leaf(l, 1)[offset], field.leaf(l, 2)[offset]});
    });
  }
  const auto grid = openvdb::Vec3SGrid::create(tree);
  for (auto it = metadata.beginMeta(); it != metadata.endMeta(); ++it) grid->insertMeta(it->first, *it->second);
  grid->setName(field.meta().name);
  grid->setTransform(x.transform().copy());
  // The components are numbers along the dump's axes, whatever becomes of the grid's transform.
  grid->setVectorType(openvdb::VEC_INVARIANT);
  return grid;
}

}  // namespace

openvdb::GridCPtrVec make_grids(const SparseField& field, const MetaMap& metadata) {
  const MetaMap all = field_metadata(field.meta(), metadata);
  const auto& components = field.grids().components;
  if (components.size() == 3) return {vector_grid(field, all)};
  if (components.size() == 1) return {float_grid(*components.front(), field.meta().name, all)};
  static constexpr std::string_view axes = "xyz";
  openvdb::GridCPtrVec grids;
  for (std::size_t c = 0; c < components.size(); ++c)
    grids.push_back(float_grid(*components[c], field.meta().name + '_' + axes[c / 3] + axes[c % 3], all));
  return grids;
}

void clear_inactive(openvdb::GridBase& grid) {
  grid.apply<openvdb::TypeList<openvdb::FloatGrid>>([](openvdb::FloatGrid& g) {
    for (auto leaf = g.tree().beginLeaf(); leaf; ++leaf)
      for (auto voxel = leaf->beginValueOff(); voxel; ++voxel) voxel.setValue(g.background());
  });
}

openvdb::GridBase::ConstPtr make_mask_grid(const Mask& mask, const Lattice& lattice, const MetaMap& metadata) {
  const auto tree = std::make_shared<openvdb::Int32Tree>(static_cast<std::int32_t>(Reason::outside));
  const Topology& topology = *mask.topology();
  openvdb::tree::ValueAccessor<openvdb::Int32Tree> accessor(*tree);
  for (std::size_t l = 0; l < topology.leaf_count(); ++l) {
    auto& leaf = *accessor.touchLeaf(grid_index(topology.origin(l)));
    topology.mask(l).for_each([&](int offset) {
      leaf.setValueOn(static_cast<openvdb::Index>(offset), static_cast<std::int32_t>(mask.leaf(l)[offset]));
    });
  }
  const auto grid = openvdb::Int32Grid::create(tree);
  for (auto it = metadata.beginMeta(); it != metadata.endMeta(); ++it) grid->insertMeta(it->first, *it->second);
  grid->setName(std::string(mask_name));
  grid->setTransform(grid_transform(lattice));
  grid->insertMeta("unit", StringMetadata("1"));
  grid->insertMeta("description", StringMetadata("why fields have no value: the sum of the flags that apply"));
  for (const ReasonInfo& r : reasons())
    grid->insertMeta("flag/" + std::to_string(static_cast<std::uint32_t>(r.reason)),
                     StringMetadata(std::string(r.name) + ": " + std::string(r.meaning)));
  return grid;
}

}  // namespace grainvdb
