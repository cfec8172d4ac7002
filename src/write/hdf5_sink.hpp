#pragma once
/// DIR/fields.hdf: an HDF5 file in VTKHDF layout, and DIR/fields.xmf2 beside it where ParaView needs one.
///
///   /VTKHDF                    Version, Type, WholeExtent, Origin, Spacing, Direction as attributes
///   /VTKHDF/PointData/<name>   float32 (Z,Y,X[,C]) at the voxel centres; (T,Z,Y,X[,C]) with several output times
///   /VTKHDF/PointData/mask     uint32 bit flags, named by flag_masks and flag_meanings
///   /VTKHDF/Steps              the times again, as VTKHDF 2 has them; with several output times only
///   /x /y /z /time /component3 /component9   dimension scales, attached to every field
///   /first_step /last_step /frame_count      per output time
///   /provenance/<key>          one text each
///
/// Every dataset has `units` and `long_name`, every field `equation`. Voxels that no kernel reaches read as the field's
/// background; `_FillValue` says so where it is NaN (zero is a value, not a gap). An empty chunk takes no space.
#include <memory>
#include <string>

#include "grainvdb/field_sink.hpp"

namespace grainvdb {

std::unique_ptr<FieldSink> make_hdf5_sink(const std::string& directory);

}  // namespace grainvdb
