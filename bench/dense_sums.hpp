#pragma once
/// The reference that both sides of a comparison are checked against: sums in double precision over a dense box, with
/// what bounds their rounding.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <openvdb/openvdb.h>

#include "grids.hpp"
#include "scene.hpp"

namespace grainvdb::bench {

class DenseSums {
 public:
  /// Zero sums over the voxels that the supports of the points, or of branches that start there, can reach.
  DenseSums(const Columns3& position, double h, int channels);

  /// Adds values[c] times the weight to the channels of a voxel.
  void add(int i, int j, int k, double weight, const double* values);

  /// Terms added in all: kernel values computed.
  std::size_t terms() const { return terms_; }

  struct Tolerance {
    double relative = 0;  ///< to the sum of |terms|
    double per_term = 0;  ///< the same for every term of the sum: what adding up in single precision loses
    double absolute = 0;  ///< per unit of Σ |q| over the terms: an error of W
  };
  /// The largest error of the grids' values divided by what is tolerated: at most 1 if they agree. Infinite unless the
  /// voxels are active exactly where a term was added; with an absolute tolerance, inactive ones count as zero.
  double disagreement(const Grids& grids, const Tolerance& tolerance) const;

 private:
  std::size_t at(int i, int j, int k) const;
  double h_;
  openvdb::CoordBBox box_;
  std::size_t channels_;
  std::size_t terms_ = 0;
  std::vector<std::uint32_t> count_;
  std::vector<double> sum_, magnitude_, values_;
};

/// Σ q W by plain loops. `q` is laid out [particle][channel].
DenseSums sum_particles(const Scene& scene, double h, std::span<const double> q, int channels);

/// Σ q ∫W over half branches, in closed form. `q` is laid out [branch][channel].
DenseSums sum_branches(const HalfBranches& branches, double h, std::span<const double> q, int channels);

}  // namespace grainvdb::bench
