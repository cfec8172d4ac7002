#pragma once
/// A stage makes one field. It describes itself: what it needs and gives, its unit, equation and options; nobody else
/// knows. The registry of stages alone feeds the graph, `grainvdb stages`, the validation and the documentation.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/leaf_buffers.hpp"
#include "grainvdb/mask.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/options.hpp"
#include "grainvdb/sparse_field.hpp"
#include "grainvdb/units.hpp"

namespace grainvdb {

/// What must be there before a stage can run.
struct StageNeeds {
  std::vector<std::string> fields;  ///< fields made by other stages
  std::vector<MomentPtr> moments;   ///< time-averaged moments
  int stencil = 0;                  ///< how many voxels beyond its own the stage looks
};

/// What a stage sees when it runs.
class StageInput {
 public:
  virtual ~StageInput() = default;
  virtual const Lattice& lattice() const = 0;
  virtual const LucyKernel& kernel() const = 0;
  virtual const StageSettings& settings() const = 0;
  virtual const Topology& topology() const = 0;
  /// A field among the stage's needs.
  virtual const SparseField& field(const std::string& name) const = 0;
  /// The time-mean values of a channel of a moment among the stage's needs, in one leaf.
  virtual const double* moment(std::size_t leaf, const Moment& moment, int channel) const = 0;
  /// The number of frames in which a kernel reached each voxel, in one leaf.
  virtual const double* frame_count(std::size_t leaf) const = 0;
  /// Where a stage notes why it leaves a voxel undefined. Concurrent calls for different leaves are safe.
  virtual Mask& mask() const = 0;
};

/// An option whose value does not go with those of others.
struct OptionConflict {
  std::string option;
  std::string found;
  std::string expected;
};

struct Stage {
  std::string name;  ///< of the field it gives
  int components = 1;
  Dimension dimension{};
  bool additive = false;    ///< zero where no kernel reaches (sums such as phi); NaN there otherwise
  std::string description;  ///< one line
  std::string equation;     ///< formula with its tag
  std::vector<OptionInfo> options{};
  /// Option values that are refused together where the stage is asked for; empty where none are.
  std::function<std::optional<OptionConflict>(const StageSettings&)> conflict{};
  std::function<StageNeeds(const StageSettings&)> needs;
  /// Fills `out` at every active voxel; leaves NaN and a reason in the mask where the field is undefined. Empty where
  /// something else is needed than time means: for `mask`, the reasons gathered from all stages, and for standard
  /// errors.
  std::function<void(const StageInput&, SparseField& out)> compute;
  /// For standard errors: the field among the needs that is derived again without each block of frames.
  std::string error_of{};
  /// Whether there is such a field of each species of grains (Pipeline::species) as well: needs and compute must do
  /// with sums over particles and half branches, and with other such fields.
  bool by_species = false;
  /// As `conflict`, where the stage is asked for of a species.
  std::function<std::optional<OptionConflict>(const StageSettings&)> species_conflict{};
  /// For the field of a species: that of all grains.
  std::string species_of{};
  /// Whether it is made of forces, or of momentum that grains carry. Snapshots of a spot run have neither: such fields
  /// are refused for them, with all that need one.
  bool of_forces = false;
};

/// The stages that can be asked for, by name.
class StageRegistry {
 public:
  /// Throws std::invalid_argument when the name is taken.
  void add(Stage stage);
  /// nullptr when there is no such stage.
  const Stage* find(const std::string& name) const;
  /// In order of registration.
  const std::vector<Stage>& stages() const { return stages_; }
  /// The default option values of every stage.
  StageSettings default_settings() const;

  /// All stages that come with the library.
  static const StageRegistry& standard();

 private:
  std::vector<Stage> stages_;
};

/// Calls f(leaf index) for every leaf, in parallel. The result must not depend on the order of the calls.
void for_each_leaf(const Topology& topology, const std::function<void(std::size_t)>& f);

}  // namespace grainvdb
