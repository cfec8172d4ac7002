#pragma once
/// A scene as LAMMPS text dumps with a pipeline file, for whole runs.
#include <cstddef>
#include <string>

namespace grainvdb::bench {

/// Writes `frames` snapshots of a scene in motion, their contacts and pipeline.yaml into an existing folder. Returns
/// the path of the pipeline file.
std::string write_dumps(std::size_t particles, std::size_t frames, const std::string& folder);

}  // namespace grainvdb::bench
