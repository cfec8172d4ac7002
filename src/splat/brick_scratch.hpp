#pragma once
/// Room for the candidates of one block of voxels; grows to what the densest block needs and is then reused.
#include <cstddef>
#include <cstdint>

#include <hwy/aligned_allocator.h>

namespace grainvdb {

class BrickScratch {
 public:
  /// Makes room for `candidates` candidates of `stride` values each. Contents are lost when it grows.
  void reserve(std::size_t candidates, std::size_t stride) {
    const std::size_t n = candidates + 32;  // vector stores run past the end
    if (n > capacity_) {
      capacity_ = n + n / 2;
      x = hwy::AllocateAligned<float>(capacity_);
      y = hwy::AllocateAligned<float>(capacity_);
      z = hwy::AllocateAligned<float>(capacity_);
      chosen = hwy::AllocateAligned<std::int32_t>(capacity_);
      in_brick = hwy::AllocateAligned<std::int32_t>(capacity_);
      weights = hwy::AllocateAligned<float>(capacity_ * 16);
      values_capacity_ = 0;
    }
    if (capacity_ * stride > values_capacity_) {
      values_capacity_ = capacity_ * stride;
      q = hwy::AllocateAligned<float>(values_capacity_);
    }
  }

  hwy::AlignedFreeUniquePtr<float[]> x, y, z, q;       // of the candidates of one block
  hwy::AlignedFreeUniquePtr<std::int32_t[]> chosen;    // which of the leaf's candidates touch the block
  hwy::AlignedFreeUniquePtr<std::int32_t[]> in_brick;  // which of the block's candidates touch the brick
  hwy::AlignedFreeUniquePtr<float[]> weights;          // [candidate of the brick][lane]

 private:
  std::size_t capacity_ = 0;
  std::size_t values_capacity_ = 0;
};

}  // namespace grainvdb
