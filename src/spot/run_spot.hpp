#pragma once
/// Runs a spot file into a folder of dumps.
#include <cstddef>
#include <functional>
#include <string>

#include "spot/spot_file.hpp"

namespace grainvdb::spot {

struct SpotReport {
  std::size_t snapshots = 0;
  std::size_t particles_at_start = 0, particles_at_end = 0, drained = 0;
  double time = 0;
  SpotCounters counters;
};

/// Refuses a folder that holds dumps of a spot run already: those of two would be read as one. Throws ConfigError.
void refuse_used_folder(const std::string& folder);

/// How many dumps a run writes where particles are left until its end.
std::size_t most_snapshots(const SpotRun& run);

/// Writes spot_0000000.dump, spot_0000001.dump, …, each complete under its name, spot.yaml, the resolved file, and
/// drained.txt, the id and time of every particle that has left, in the order in which they left. Ends early when no
/// particle is left. Refuses a used folder. `progress` is called with the share that is done
/// after each snapshot. Throws ConfigError or IoError.
SpotReport run_spot(const SpotRun& run, const std::string& folder,
                    const std::function<void(std::size_t done, std::size_t all)>& progress = {});

}  // namespace grainvdb::spot
