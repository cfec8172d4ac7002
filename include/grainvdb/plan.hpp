#pragma once
/// What a pipeline's wanted outputs need, resolved backwards, so that nothing else is read, splatted or written.
#include <array>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/stage.hpp"

namespace grainvdb {

/// One sweep over the frames of a window.
struct Sweep {
  ColumnSet columns;                           ///< what is read
  std::set<BranchKind> branch_kinds;           ///< that moments sum over
  std::vector<std::vector<MomentPtr>> passes;  ///< the moments of each pass over a frame, in order
};

/// How far beyond the voxels that are wanted a moment is needed.
struct Halo {
  int stencil = 0;                   ///< voxels, for differences between voxels
  int samplings = 0;                 ///< how often values at particles are interpolated from voxels on the way
  std::array<bool, 3> whole_axes{};  ///< along these everywhere
  auto operator<=>(const Halo&) const = default;
};
/// What is enough for both.
Halo merged(const Halo& a, const Halo& b);

/// Standard errors, and the stages that are run again for them without each block of frames, in order.
struct ErrorPlan {
  std::vector<const Stage*> errors;
  std::vector<const Stage*> by_block;
};

struct Plan {
  std::vector<const Stage*> stages;     ///< in an order in which each finds its needs
  std::vector<Sweep> sweeps;            ///< one, or two where a moment needs a time mean
  std::vector<MomentPtr> means;         ///< the moments whose time means are kept
  std::map<std::string, Halo> halos;    ///< of every moment, by name
  ErrorPlan errors;                     ///< the standard errors that are among the stages
  ErrorPlan until;                      ///< that of average.until alone
  std::vector<MomentPtr> block_sums;    ///< the moments that errors need, which are summed by blocks as well
  std::vector<std::string> not_needed;  ///< stages of the registry that this plan does not run
  std::shared_ptr<const StageRegistry> with_species;  ///< keeps the stages where the pipeline has species
};

/// What is read of a frame in any of the sweeps.
ColumnSet all_columns(const Plan& plan);
/// The half branches that moments sum over in any of the sweeps.
std::set<BranchKind> all_branch_kinds(const Plan& plan);
/// Whether one of these tells wall grains from others.
bool tells_walls(const std::set<BranchKind>& kinds);

/// The stages are those of the registry and, where the pipeline has species, their partial fields.
/// Throws ConfigError for an unknown field (with "did you mean"), for a cycle among stages (naming it), and for a
/// kernel that could miss every voxel centre (c < √3/2 h) or is too narrow for a moment that interpolates to particles
/// (c < √3 h). Throws LimitError for
/// voxels so coarse that the volume of a grain errs by more than limits.volume_error.
Plan make_plan(const Pipeline& pipeline, const StageRegistry& registry = StageRegistry::standard());

/// The plan in words, as `grainvdb graph` prints it.
std::string describe(const Plan& plan, const Pipeline& pipeline);
/// The plan as a Graphviz digraph.
std::string describe_dot(const Plan& plan, const Pipeline& pipeline);

}  // namespace grainvdb
