#pragma once
/// The part of the kernel inside the walls at the voxels of leaves.
#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/topology.hpp"
#include "grainvdb/walls.hpp"

namespace grainvdb {

class InsideFractions {
 public:
  InsideFractions(WallDomain domain, const LucyKernel& kernel, const Lattice& lattice);

  using Leaf = std::array<double, leaf_size>;
  /// For each leaf of a topology the fraction at its voxels, 1 where the centre lies behind a wall; nullptr where it is
  /// 1 throughout. What is computed for one topology is kept for the next: 4 kB for each leaf at a wall.
  std::vector<const Leaf*> of(const Topology& topology);

 private:
  /// The fraction beside a cylinder alone, which depends on the distance only: linear between values 1/256 of the
  /// cutoff apart, good to 1e-5.
  struct Table {
    WallDomain wall;
    std::vector<double> values;
  };
  double fraction(const Vec3& x) const;
  std::unique_ptr<Leaf> leaf(const Coord& origin) const;

  WallDomain domain_;
  LucyKernel kernel_;
  Lattice lattice_;
  std::vector<Table> tables_;  // one for each wall, without values for those that are no cylinder
  std::map<Coord, std::unique_ptr<Leaf>> leaves_;
};

/// The distance from the middle of a leaf beyond which no centre of its voxels lies.
double leaf_reach(const Lattice& lattice);
/// The middle of a leaf.
Vec3 leaf_middle(const Lattice& lattice, const Coord& origin);

}  // namespace grainvdb
