#pragma once
/// What is said where no frame has a grain that counts.
#include <cstddef>
#include <span>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"

namespace grainvdb {

/// Throws InputError: select keeps no particle of these frames, of which there is one at least. Where select names
/// types, it tells those that the first frame with particles has, which is read for it.
[[noreturn]] void refuse_no_material(const Pipeline& pipeline, FrameSource& source,
                                     std::span<const std::size_t> frames);

}  // namespace grainvdb
