#pragma once
/// The group /provenance of HDF5 files.
#include "grainvdb/field_sink.hpp"
#include "write/hdf5_file.hpp"

namespace grainvdb {

/// A text for each entry.
inline void write_provenance(Hdf5File& hdf5, const Provenance& provenance) {
  hdf5.create_group("/provenance");
  for (const auto& [key, text] : provenance) hdf5.create_text("/provenance/" + key, text);
}

}  // namespace grainvdb
