#pragma once
/// DIR/fields.vdb, or DIR/fields_0000.vdb, fields_0001.vdb, … with several output times.
///
/// A field with one component is a FloatGrid, one with three a Vec3SGrid, one with nine the FloatGrids <name>_xx,
/// <name>_xy, … <name>_zz; the mask is an Int32Grid. Voxel centres lie where the lattice has them, in the dump's own
/// unit of length. Each grid has unit, description, equation, time, time_unit, length_unit, first_step, last_step and
/// frame_count as metadata; the file has the provenance as provenance/<key>.
#include <memory>
#include <string>

#include "grainvdb/field_sink.hpp"

namespace grainvdb {

std::unique_ptr<FieldSink> make_vdb_sink(const std::string& directory);

}  // namespace grainvdb
