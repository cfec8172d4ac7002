#pragma once
/// The moments of a sweep, sorted by what splats them together.
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "grainvdb/moment.hpp"
#include "grainvdb/plan.hpp"

namespace grainvdb {

/// Moments that one splat serves: they share kernel and nodes.
struct SplatGroup {
  /// Those of the pass, then weights that nobody asked for, which are splatted along with what they weigh.
  std::vector<MomentPtr> moments;
  std::size_t asked_for = 0;   ///< the first so many of the moments
  std::vector<int> weight_of;  ///< of each value: the channel that weighs it, or -1
  int kept_channels = 0;       ///< of moments that others of the frame are made of
  Halo halo;                   ///< enough for all of them

  Moment::Kind kind() const { return moments[0]->kind; }
  BranchKind branch_kind() const { return moments[0]->branch_kind; }
  /// The species whose particles or half branches alone it sums over.
  std::optional<int> species() const { return moments[0]->species; }
  /// How many particles or half branches it sums over of what it sees of a frame.
  std::size_t entries(const FrameView& view) const;
  int value_count() const { return static_cast<int>(weight_of.size()); }
  /// Whether a buffer for all its channels is needed: those are added up in double precision.
  bool buffered() const;
  int buffered_channels() const;
  /// Whether its values follow from the particles and contacts alone.
  bool of_frame_alone() const;
};

struct SweepGroups {
  struct Pass {
    std::vector<SplatGroup> groups;    ///< those of species behind those of all material
    std::vector<MomentPtr> voxelwise;  ///< made of others after the splats
  };
  std::vector<Pass> passes;
  Halo particle_halo;          ///< enough for all groups of particles
  std::set<std::string> kept;  ///< names of the moments that others of the same frame are made of
};

SweepGroups group_moments(const Plan& plan, std::size_t sweep);

}  // namespace grainvdb
