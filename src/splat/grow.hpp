#pragma once
/// Scratch memory that grows to what the largest leaf needs and is then reused.
#include <cstddef>

#include <hwy/aligned_allocator.h>

namespace grainvdb {

/// Elements aligned for vectors. Vector loads and stores may run `slack` elements past what was asked for.
template <class T>
class Grow {
 public:
  static constexpr std::size_t slack = 32;

  /// Room for n elements; what was there is lost when it grows.
  T* room(std::size_t n) {
    if (n + slack > capacity_) {
      capacity_ = n + n / 2 + slack;
      data_ = hwy::AllocateAligned<T>(capacity_);
    }
    return data_.get();
  }
  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  hwy::AlignedFreeUniquePtr<T[]> data_;
  std::size_t capacity_ = 0;
};

}  // namespace grainvdb
