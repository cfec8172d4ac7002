#pragma once
/// Counts of pairs of grains by distance, and what uniformly spread grains would have.
#include <cstddef>
#include <limits>
#include <vector>

#include "grainvdb/frame.hpp"
#include "measure/counted_region.hpp"

namespace grainvdb {

/// The radial distribution function
///
///     g(r_k) = Σ_i n_ik / Σ_i ρ V_ik,   ρ = (N-1)/V,
///
/// n_ik the grains in shell k about grain i, V_ik the volume of the shell that lies within the material, exactly, ρ the
/// density of the other N-1 counted grains in the volume V of the counted region. Each pair counts once, by its
/// nearest image: along periodic axes shells end half a period away, along others at the outermost centres. The mean
/// for grains spread uniformly is thus 1 at any distance, in a periodic box, a slab or a closed box.
class PairCounts {
 public:
  PairCounts(double reach, std::size_t bins);

  /// One frame more. Its grains must be those that the region is to be filled with.
  void add(const Box& box, const Columns3& position, const CountedRegion& region);

  std::size_t bins() const { return pairs_.size(); }
  double edge(std::size_t k) const { return reach_ * static_cast<double>(k) / static_cast<double>(bins()); }
  /// NaN where no pair can be: no shell lies within the material.
  double g(std::size_t k) const { return pairs_[k] / expected_[k]; }
  /// The counting error, √(number of pairs) for pairs that come independently of each other.
  double error(std::size_t k) const;
  /// Mean number of grains nearer than the outer end of shell k, about a counted grain.
  double neighbours(std::size_t k) const;
  /// Distance of the closest pair; infinity where there is none.
  double closest() const { return closest_; }
  /// Mean over frames, as of ρ above.
  double density() const { return density_ / static_cast<double>(frames_); }
  double grains() const { return grains_; }

 private:
  double reach_;
  std::vector<double> pairs_, squares_, expected_;
  double grains_ = 0, density_ = 0, closest_ = std::numeric_limits<double>::infinity();
  std::size_t frames_ = 0;
};

}  // namespace grainvdb
