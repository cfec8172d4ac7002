#pragma once
/// Where tracers may come, as far as a run knows: the only leaves that must be splatted when nothing but tracers is
/// wanted.
#include <cstddef>
#include <set>

#include "grainvdb/frame.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/region.hpp"

namespace grainvdb {

/// Thrown when tracers could leave their neighbourhood. Where it has grown, the trace has to begin again; where one
/// move may lead too far for that, it needs whole grids.
struct LeftNeighbourhood {
  bool grew = false;
};

class TraceNeighbourhood {
 public:
  static constexpr double widest = 64;  ///< reach that can be asked for [voxels]

  explicit TraceNeighbourhood(const Lattice& lattice) : lattice_(lattice) {}

  /// Adds the leaves within `reach` ≤ widest voxels of x along every axis.
  void add(const Vec3& x, double reach);
  /// Adds the leaves within a leaf's edge of the straight way from x to x + way [length], but for what is farther than
  /// 64 voxels, and twice as many each time that the neighbourhood has grown.
  void add_way(const Vec3& x, const Vec3& way);
  void end_growth() { farthest_ *= 2; }

  /// Whether every leaf within `reach` voxels of x belongs to it.
  bool holds(const Vec3& x, double reach) const;
  Region region() const { return Region::leaves({leaves_.begin(), leaves_.end()}); }

 private:
  template <class F>
  bool all_leaves(const Vec3& x, double reach, const F& f) const;

  Lattice lattice_;
  std::set<Coord> leaves_;
  double farthest_ = 64;
};

/// What part of the particles must be splatted so that the fields in a region come out right, from 0 to 1.
double share_of_particles(const Particles& particles, const Region& region, const Plan& plan, const Lattice& lattice,
                          double cutoff);

/// Whether a trace that splats only this part of the particles is expected to be cheaper than one through whole grids.
/// Reading a particle costs about as much as 100 values of the kernel, of which a splat takes 4π/3 (c/h)³ per particle;
/// `passes` over the frames are expected, since it is not known beforehand where tracers go.
bool neighbourhood_pays(double share, double cutoff_in_voxels, int passes);

}  // namespace grainvdb
