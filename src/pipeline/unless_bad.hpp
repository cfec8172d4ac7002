#pragma once
/// What a run does with the first frames before its sweeps, where bad ones may be passed over.
#include <cstddef>
#include <optional>
#include <type_traits>

#include "grainvdb/error.hpp"
#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"

namespace grainvdb {

/// f() of a frame; nothing where f throws an InputError and the input says that such frames are left out.
template <class F>
std::optional<std::invoke_result_t<F&>> unless_bad(const InputSpec& input, F f) {
  try {
    return f();
  } catch (const InputError&) {
    if (input.on_error == OnError::error) throw;
  }
  return std::nullopt;
}

/// Frame k with these columns; nothing where it is to be left out. Throws InputError or IoError.
inline std::optional<Frame> read_unless_bad(const InputSpec& input, FrameSource& source, std::size_t k,
                                            ColumnSet columns) {
  return unless_bad(input, [&] { return source.read(k, columns); });
}

}  // namespace grainvdb
