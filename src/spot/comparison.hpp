#pragma once
/// A calibration corrected by comparison: spot runs with known parameters, measured by the same estimators.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/table.hpp"

namespace grainvdb::spot {

struct ComparisonOptions {
  std::size_t rounds = 3;            ///< at most; fewer when parameters have settled
  std::size_t runs = 3;              ///< in each round, at least two: what they scatter by is an error
  std::optional<double> duration{};  ///< that is measured of each; that of the dumps' flow when not given [time]
  std::optional<double> height{};    ///< of the packing above the floor; all of the first frame when not given [length]
  std::uint64_t seed = 1;            ///< of the first run; the others have those that follow
};

/// Runs the spot file that a calibration would write, relaxation and all, in rounds of `runs`, measures each run as
/// `pipeline` measures the dumps, takes what the estimators make of its known parameters off `direct`, the table
/// `spot_calibration` of the dumps, and begins the next round with what results. Ends when no parameter changes by more
/// than its error, or after `rounds`.
///
/// Returns a table of the same numbers, for calibrated_spot_file, with the biases, and a row for each run. Their errors
/// contain the scatter of runs. The same input gives the same table on any number of threads, on which the runs of a
/// round are shared out. Dumps of runs lie in a new folder within `folder`, which is removed in the end.
///
/// A run is measured for as many frames as the dumps have in the flow, from as long after its start on as the first of
/// these comes after the first frame, or, where that is more, from when spots have filled it. `progress` is called by
/// several threads, one at a time; what it throws ends the comparison.
///
/// Throws InputError where `direct` does not tell every parameter or frames of flow are too few, or where runs do not
/// tell what is compared; ConfigError, where a parameter that results cannot be run.
Table calibrate_by_comparison(const Pipeline& pipeline, const Table& direct, FrameSource& source,
                              const ComparisonOptions& options, const std::string& folder,
                              const std::function<void(std::size_t done, std::size_t all)>& progress = {});

}  // namespace grainvdb::spot
