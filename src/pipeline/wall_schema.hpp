#pragma once
/// The section `walls` of pipeline files.
#include "grainvdb/pipeline.hpp"
#include "pipeline/schema.hpp"

namespace grainvdb {

void add_walls(Schema& schema);

/// Throws ConfigError for walls that cannot be, or that the kernel's mode has no use for.
void check_walls(const Pipeline& pipeline);

/// "x_lo", "x_hi", ….
std::string face_name(const BoxFace& face);

}  // namespace grainvdb
