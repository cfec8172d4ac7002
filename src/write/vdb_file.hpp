#pragma once
/// OpenVDB files whose every write is checked. openvdb::io::File does not notice a full disk.
#include <openvdb/openvdb.h>

#include "write/atomic_file.hpp"

namespace grainvdb {

/// Writes grids in the given order, with `metadata` for the file as a whole; the result is what openvdb::io::File would
/// write, except that its UUID, which OpenVDB draws at random, is made from the content: equal content, equal bytes.
/// Throws IoError.
void write_vdb(AtomicFile& file, const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata);

/// Reads back the grids, in the order of their names, of a file that write_vdb wrote and that is finished but not yet
/// published.
openvdb::GridPtrVecPtr read_vdb(const AtomicFile& file);

/// openvdb::initialize(), once.
void initialize_openvdb();

}  // namespace grainvdb
