#pragma once
/// Blocks of an average whose length is not known beforehand.
#include <cstddef>

namespace grainvdb {

/// Frames of each block when there are so many frames in all: the least power of two with which they make no more than
/// twice `fewest` blocks, the last of which may not be full. There are `fewest` full ones at least as soon as there are
/// as many frames. Where the length grows, it doubles, and blocks are joined two by two.
constexpr std::size_t growing_block_length(std::size_t fewest, std::size_t frames) {
  std::size_t length = 1;
  while (frames > 2 * fewest * length) length *= 2;
  return length;
}

}  // namespace grainvdb
