#pragma once
/// A spot file: packing, container, spots or voids, relaxation and output of a run, read and checked.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "spot/container.hpp"
#include "spot/particle_store.hpp"
#include "spot/spot_model.hpp"
#include "spot/staggered_lattice.hpp"
#include "spot/void_model.hpp"

namespace grainvdb::spot {

/// What a run of the void model has instead of spots.
struct VoidRun {
  StaggeredLattice lattice;
  VoidParameters parameters;
};

struct SpotRun {
  Container container;
  Packing packing;
  SpotParameters parameters;       ///< not used with voids
  std::optional<VoidRun> voids{};  ///< instead of spots
  std::uint64_t seed = 1;
  double interval = 0;  ///< between snapshots [time]
  double end = 0;       ///< of the run [time]
  double from = 0;      ///< no snapshots before but that of the start [time]
  std::string units;
  std::string resolved;      ///< the file as YAML with all defaults
  std::size_t left_out = 0;  ///< grains of the dump that lie outside the container
};

/// Reads a spot file and its packing. `overrides` are "a.b=value" texts that win over the file. Throws ConfigError with
/// file and line for anything that cannot be run as written, InputError for a packing that cannot be used (grains of
/// several sizes, none in the container), IoError, or LimitError.
SpotRun load_spot_run(const std::string& file, const std::vector<std::string>& overrides = {});

}  // namespace grainvdb::spot
