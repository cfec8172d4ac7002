#include "pipeline/inside_fractions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/parallel.hpp"

namespace grainvdb {
namespace {

constexpr int table_steps = 256;

/// A point inside a cylinder's wall or outside it, whichever the material is, at a distance.
Vec3 beside(const Wall& cylinder, double distance) {
  Vec3 across{};
  const auto& n = cylinder.direction;
  across[std::abs(n[0]) < 0.6 ? 0 : 1] = 1;
  const double along = across[0] * n[0] + across[1] * n[1] + across[2] * n[2];
  double length = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    across[a] -= along * n[a];
    length += across[a] * across[a];
  }
  const double outward = cylinder.encloses ? cylinder.radius - distance : cylinder.radius + distance;
  Vec3 x = cylinder.point;
  for (std::size_t a = 0; a < 3; ++a) x[a] += outward * across[a] / std::sqrt(length);
  return x;
}

}  // namespace

double leaf_reach(const Lattice& lattice) {
  return 0.5 * (leaf_edge - 1) * std::numbers::sqrt3 * lattice.voxel();
}

Vec3 leaf_middle(const Lattice& lattice, const Coord& origin) {
  Vec3 middle;
  for (int a = 0; a < 3; ++a)
    middle[static_cast<std::size_t>(a)] = lattice.centre(a, origin[a]) + 0.5 * (leaf_edge - 1) * lattice.voxel();
  return middle;
}

InsideFractions::InsideFractions(WallDomain domain, const LucyKernel& kernel, const Lattice& lattice)
    : domain_(std::move(domain)), kernel_(kernel), lattice_(lattice) {
  for (const Wall& wall : domain_.walls()) {
    Table table{WallDomain({wall}), {}};
    if (wall.shape == Wall::Shape::cylinder) {
      table.values.resize(table_steps + 1);
      parallel_for(table.values.size(), [&](std::size_t n) {
        const double distance = kernel_.cutoff() * static_cast<double>(n) / table_steps;
        const double deepest = wall.encloses ? std::min(distance, wall.radius) : distance;
        table.values[n] = table.wall.inside_fraction(kernel_, beside(table.wall.walls()[0], deepest));
      });
    }
    tables_.push_back(std::move(table));
  }
}

double InsideFractions::fraction(const Vec3& x) const {
  const Table* near = nullptr;
  double distance = 0;
  for (const Table& table : tables_) {
    const double d = table.wall.distance(x);
    if (d >= kernel_.cutoff()) continue;
    if (near != nullptr) return domain_.inside_fraction(kernel_, x);
    near = &table;
    distance = d;
  }
  if (near == nullptr) return 1;
  if (near->values.empty()) return near->wall.inside_fraction(kernel_, x);
  const double at = distance / kernel_.cutoff() * table_steps;
  const auto n = std::min(static_cast<std::size_t>(at), static_cast<std::size_t>(table_steps - 1));
  const double share = at - static_cast<double>(n);
  return (1 - share) * near->values[n] + share * near->values[n + 1];
}

std::unique_ptr<InsideFractions::Leaf> InsideFractions::leaf(const Coord& origin) const {
  auto result = std::make_unique<Leaf>();
  for (int v = 0; v < leaf_size; ++v) {
    const Vec3 x = lattice_.centre(voxel_at(origin, v));
    (*result)[static_cast<std::size_t>(v)] = domain_.contains(x) ? fraction(x) : 1;
  }
  return result;
}

std::vector<const InsideFractions::Leaf*> InsideFractions::of(const Topology& topology) {
  const double reach = kernel_.cutoff() + leaf_reach(lattice_);
  std::vector<Coord> missing;
  for (const Coord& origin : topology.origins())
    if (std::abs(domain_.distance(leaf_middle(lattice_, origin))) < reach && !leaves_.contains(origin))
      missing.push_back(origin);
  std::vector<std::unique_ptr<Leaf>> made(missing.size());
  parallel_for(missing.size(), [&](std::size_t n) { made[n] = leaf(missing[n]); });
  for (std::size_t n = 0; n < missing.size(); ++n) leaves_.emplace(missing[n], std::move(made[n]));
  std::vector<const Leaf*> result;
  for (const Coord& origin : topology.origins()) {
    const auto it = leaves_.find(origin);
    result.push_back(it == leaves_.end() ? nullptr : it->second.get());
  }
  return result;
}

}  // namespace grainvdb
