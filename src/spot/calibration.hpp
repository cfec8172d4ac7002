#pragma once
/// A spot file from a calibration: the silo of the dumps, run by the spot model.
#include <string>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/table.hpp"

namespace grainvdb::spot {

/// Refuses pipelines whose silo cannot be told in a spot file: without measure.spot_calibration and its slot_width, in
/// other units than the dumps, grains chosen by id. Throws ConfigError, before anything is measured.
void check_calibration(const Pipeline& pipeline);

/// The text of a spot file: its packing is the first of the frames that the pipeline takes, its container as wide as
/// `side_walls` says or the grains are, its parameters those of the table `spot_calibration`, with their errors in
/// remarks; snapshots as far apart as the frames, for as long. Paths of dumps are absolute. Throws InputError where a
/// parameter could not be measured, or no grain of that frame lies above the floor.
std::string calibrated_spot_file(const Pipeline& pipeline, const Table& calibration, FrameSource& source);

}  // namespace grainvdb::spot
