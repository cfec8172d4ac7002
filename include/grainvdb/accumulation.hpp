#pragma once
/// How the terms of a sum over particles or contacts of one frame are added up at a voxel (kernel.accumulation). Frames
/// are always added up in double precision.
#include <cstdint>

namespace grainvdb {

enum class Accumulation : std::uint8_t {
  /// In single precision about a local reference of the values, and again in double where rounding at the rims of the
  /// supports could show: good to 1e-5 of the sum of |terms| everywhere, to single precision of δv however large u is.
  shifted,
  /// In single precision with neither: what the rest is for. Single precision of u is left of δv, and moments that are
  /// else summed in double, for the one-pass variance, lose (u/δv)² of it.
  single,
  /// In double precision throughout, by plain loops over the terms: slow.
  twofold
};

}  // namespace grainvdb
