#pragma once
/// Fields of an output time on their way into a file and back.
#include <memory>

#include "base/bytes.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/run.hpp"
#include "grainvdb/topology.hpp"

namespace grainvdb {

void save_topology(ByteWriter& to, const Topology& topology);
std::shared_ptr<const Topology> load_topology(ByteReader& from);

void save_output(ByteWriter& to, const OutputFields& output);
OutputFields load_output(ByteReader& from, const Lattice& lattice);

}  // namespace grainvdb
