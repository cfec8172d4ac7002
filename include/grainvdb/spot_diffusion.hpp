#pragma once
/// How far spots that walk on a lattice spread the grains that they meet. Pure functions.
#include <vector>

#include "grainvdb/box.hpp"

namespace grainvdb {

/// The common part of two balls of a radius, their centres that far apart, over the volume of one:
/// 1 - 3q/4 + q³/16, q = distance/radius < 2, else 0.
double ball_overlap(double distance, double radius);

/// Spots move all grains within `radius` of the middle of their step, and each step is (±Δx, ±Δy, Δz).
struct SpotWalk {
  double radius = 0;  ///< > 0 [length]
  Vec3 step{};        ///< Δx, Δy ≥ 0, Δz > 0 [length]
};

/// s in Var(Δx) = 2 s (b/w) h: what grains spread by sideways while they fall by h, over what they would if each step
/// that they are moved by were independent of the others. It is less than 1, for a spot that takes a grain along to one
/// side is more likely to leave it on that side, and does not take it further; one that comes back takes it back.
///
/// Two steps of one spot, m apart, move the same grain where their middles, D apart, both lie within R of it: a part
/// Ω(D) = ball_overlap of the grains of either. With ξ = ±Δx of both,
///     c_m = ⟨ξ ξ' Ω(D)⟩/Δx² = ¼⟨Ω(D + Δx) + Ω(D - Δx) - 2Ω(D)⟩ ≤ 0
/// over the walks in between, exact sums over the lattice. A spot makes K steps in a time, Poisson of mean n; then
///     s(n) = 1 + (2/n) Σ_m ⟨max(K - m, 0)⟩ c_m,  s(∞) = 1 + 2 Σ_m c_m.
class DiffusionShare {
 public:
  /// Along x; for y exchange the first two components of the step. Throws std::invalid_argument for a radius or a Δz
  /// that is not positive.
  explicit DiffusionShare(const SpotWalk& walk);

  /// s(n) over a time in which a spot makes n ≥ 0 steps on average; 1 at first.
  double after(double steps) const;
  /// s(∞): over times long beside that which a spot takes to pass a grain.
  double finally() const;

 private:
  std::vector<double> correlation_;  ///< c_m, from m = 1
};

}  // namespace grainvdb
