#pragma once
/// Whole runs of a pipeline, from text dumps to an HDF5 file.
#include "sizes.hpp"

namespace grainvdb::bench {

/// run/threads=N, in wall time.
void register_run(const Sizes& sizes);

/// Runs with one and with two threads and checks that the results have the same bytes.
void check_run(const Sizes& sizes);

}  // namespace grainvdb::bench
