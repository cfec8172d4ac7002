#include "rasterize_splat.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include <openvdb/points/PointConversion.h>
#include <openvdb/points/PointTransfer.h>
#include <openvdb/tools/Prune.h>

#include "lucy.hpp"

namespace grainvdb::bench {
namespace {

namespace vdb = openvdb;
namespace points = openvdb::points;
using vdb::Vec3f;

/// Positions in single precision relative to their voxel, attributes uncompressed.
points::PointDataGrid::Ptr make_points(const Scene& scene, const vdb::math::Transform& transform) {
  std::vector<vdb::Vec3R> position(scene.size());
  std::vector<Vec3f> velocity(scene.size()), spin(scene.size());
  std::vector<float> diameter(scene.size());
  const auto row = [](const Columns3& columns, std::size_t i) {
    return vdb::Vec3R(columns[0][i], columns[1][i], columns[2][i]);
  };
  for (std::size_t i = 0; i < scene.size(); ++i) {
    position[i] = row(scene.position, i);
    velocity[i] = Vec3f(row(scene.velocity, i));
    spin[i] = Vec3f(row(scene.spin, i));
    diameter[i] = static_cast<float>(scene.diameter[i]);
  }
  const points::PointAttributeVector<vdb::Vec3R> positions(position);
  const auto index = vdb::tools::createPointIndexGrid<vdb::tools::PointIndexGrid>(positions, transform);
  auto grid = points::createPointDataGrid<points::NullCodec, points::PointDataGrid>(*index, positions, transform);
  points::appendAttribute<Vec3f>(grid->tree(), "velocity");
  points::appendAttribute<Vec3f>(grid->tree(), "spin");
  points::appendAttribute<float>(grid->tree(), "diameter");
  points::populateAttribute(grid->tree(), index->tree(), "velocity", points::PointAttributeVector<Vec3f>(velocity));
  points::populateAttribute(grid->tree(), index->tree(), "spin", points::PointAttributeVector<Vec3f>(spin));
  points::populateAttribute(grid->tree(), index->tree(), "diameter", points::PointAttributeVector<float>(diameter));
  return grid;
}

/// Leaves within reach of a leaf with points, all voxels active: the transfer scheme takes off those without kernel.
vdb::FloatTree::Ptr leaves_in_reach(const points::PointDataTree& tree, int reach) {
  auto leaves = std::make_shared<vdb::FloatTree>(0.0F);
  vdb::tree::ValueAccessor<vdb::FloatTree> accessor(*leaves);
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    vdb::CoordBBox box;
    leaf->evalActiveBoundingBox(box);
    box.expand(reach);
    const vdb::Coord first = box.min() & ~7;
    for (int x = first.x(); x <= box.max().x(); x += 8)
      for (int y = first.y(); y <= box.max().y(); y += 8)
        for (int z = first.z(); z <= box.max().z(); z += 8) accessor.touchLeaf({x, y, z})->setValuesOn();
  }
  return leaves;
}

using Volumes = points::VolumeTransfer<vdb::FloatTree, vdb::FloatTree, vdb::FloatTree, vdb::FloatTree, vdb::FloatTree,
                                       vdb::FloatTree, vdb::FloatTree, vdb::FloatTree, vdb::FloatTree, vdb::FloatTree,
                                       vdb::FloatTree, vdb::FloatTree, vdb::FloatTree, vdb::FloatTree>;
static_assert(Volumes::Size == all_channels);
using Channels = std::make_index_sequence<all_channels>;

/// Σ q W over the points, in single precision. A row of eight voxels along z is weighed at once, its channels added one
/// after another, so that the compiler can use vectors.
class LucyTransfer : public Volumes {
 public:
  template <std::size_t... c>
  LucyTransfer(const std::vector<vdb::FloatTree::Ptr>& trees, double h, std::index_sequence<c...>)
      : Volumes(*trees[c]...),
        reach_(static_cast<float>(cutoff / h)),
        inverse_reach_(1 / reach_),
        peak_(static_cast<float>(lucy_peak(cutoff))) {}

  // Every thread has a copy, with handles of its own.
  LucyTransfer(const LucyTransfer& other)
      : Volumes(other), reach_(other.reach_), inverse_reach_(other.inverse_reach_), peak_(other.peak_) {}

  vdb::Int32 range(const vdb::Coord&, std::size_t) const { return static_cast<vdb::Int32>(std::ceil(reach_)); }

  void initialize(const vdb::Coord& origin, std::size_t index, const vdb::CoordBBox& bounds) {
    Volumes::initialize(origin, index, bounds);
    sums_ = own_buffers(Channels());
    origin_ = origin;
  }

  bool startPointLeaf(const points::PointDataTree::LeafNodeType& leaf) {
    position_ = handle<Vec3f>(leaf, "P");
    velocity_ = handle<Vec3f>(leaf, "velocity");
    spin_ = handle<Vec3f>(leaf, "spin");
    diameter_ = handle<float>(leaf, "diameter");
    return true;
  }

  void rasterizePoint(const vdb::Coord& voxel, vdb::Index id, const vdb::CoordBBox&) {
    // Relative to the leaf, so that single precision has the digits.
    const Vec3f p = Vec3f((voxel - origin_).asVec3s()) + position_->get(id);
    // No further than reach_ from the leaf, nor from the row.
    const auto beyond2 = [](float u) {
      const float beyond = std::max({-u, u - 7, 0.0F});
      return beyond * beyond;
    };
    const float reach2 = reach_ * reach_ - beyond2(p[2]);
    if (beyond2(p[0]) + beyond2(p[1]) >= reach2) return;
    const std::array<float, all_channels> q = values(id);
    for (int x = 0; x < 8; ++x) {
      const float dx = static_cast<float>(x) - p[0];
      for (int y = 0; y < 8; ++y) {
        const float dy = static_cast<float>(y) - p[1];
        const float row2 = dx * dx + dy * dy;
        if (row2 < reach2) add_row(static_cast<std::size_t>(64 * x + 8 * y), row2, p[2], q);
      }
    }
  }

  bool endPointLeaf(const points::PointDataTree::LeafNodeType&) { return true; }

  /// Only voxels that the kernel reaches stay active; the first channel is positive there.
  bool finalize(const vdb::Coord&, std::size_t) {
    for (vdb::Index v = 0; v < 512; ++v)
      if (!(sums_[0][v] > 0)) mask(0)->setOff(v);
    for (std::size_t c = 1; c < sums_.size(); ++c) *mask(c) = *mask(0);
    return true;
  }

 private:
  template <std::size_t... c>
  std::array<float*, all_channels> own_buffers(std::index_sequence<c...>) {
    return {buffer<c>()...};
  }

  template <class T>
  static std::unique_ptr<points::AttributeHandle<T>> handle(const points::PointDataTree::LeafNodeType& leaf,
                                                            const char* name) {
    return std::make_unique<points::AttributeHandle<T>>(leaf.constAttributeArray(name));
  }

  std::array<float, all_channels> values(vdb::Index id) const {
    const Vec3f u = velocity_->get(id), w = spin_->get(id);
    const float d = diameter_->get(id);
    const float v = peak_ * static_cast<float>(std::numbers::pi / 6) * d * d * d;
    return {
        v,        v * u[0],        v * u[1],        v * u[2],        v * d,           v * w[0],        v * w[1],
        v * w[2], v * u[0] * u[0], v * u[1] * u[1], v * u[2] * u[2], v * u[0] * u[1], v * u[0] * u[2], v * u[1] * u[2]};
  }

  void add_row(std::size_t first, float row2, float z, const std::array<float, all_channels>& q) {
    float weight[8];
    for (int k = 0; k < 8; ++k) {
      const float dz = static_cast<float>(k) - z;
      const float r = std::sqrt(row2 + dz * dz) * inverse_reach_;
      const float p = std::max(1 - r, 0.0F);
      weight[k] = p * p * p * (1 + 3 * r);
    }
    for (std::size_t c = 0; c < sums_.size(); ++c) {
      float* __restrict to = sums_[c] + first;
      const float value = q[c];
      for (int k = 0; k < 8; ++k) to[k] += value * weight[k];
    }
  }

  float reach_;  ///< of the kernel, in voxels
  float inverse_reach_;
  float peak_;
  vdb::Coord origin_;
  std::array<float*, all_channels> sums_{};
  std::unique_ptr<points::AttributeHandle<Vec3f>> position_, velocity_, spin_;
  std::unique_ptr<points::AttributeHandle<float>> diameter_;
};

}  // namespace

Grids rasterize_splat(const Scene& scene, double h) {
  const auto transform = plain_transform(h);
  const auto grid = make_points(scene, *transform);

  std::vector<vdb::FloatTree::Ptr> trees{leaves_in_reach(grid->tree(), static_cast<int>(std::ceil(cutoff / h)))};
  while (trees.size() < all_channels)
    trees.push_back(std::make_shared<vdb::FloatTree>(*trees[0], 0.0F, vdb::TopologyCopy()));
  LucyTransfer transfer(trees, h, Channels());
  points::rasterize(*grid, transfer);

  Grids grids;
  for (const auto& tree : trees) {
    vdb::tools::pruneInactive(*tree);
    grids.push_back(vdb::FloatGrid::create(tree));
    grids.back()->setTransform(transform->copy());
  }
  return grids;
}

}  // namespace grainvdb::bench
