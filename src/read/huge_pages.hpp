#pragma once
/// Large pages for large columns.
#include <cstddef>
#include <cstdint>
#include <vector>

#include <sys/mman.h>

namespace grainvdb {

/// Asks the system to back the memory that a vector has reserved with large pages. With pages of 4 kB, filling a new
/// column takes longer than it takes to make its numbers out of text. Does nothing for small vectors.
template <class T>
void advise_huge_pages(std::vector<T>& values) {
  constexpr std::size_t page = std::size_t{1} << 12, worth_it = std::size_t{1} << 22;
  const std::size_t bytes = values.capacity() * sizeof(T);
  if (bytes < worth_it) return;
  const auto begin = reinterpret_cast<std::uintptr_t>(values.data());
  const std::size_t skipped = (page - begin % page) % page;
  // Only advice: nothing is lost where it is not followed.
  madvise(reinterpret_cast<char*>(values.data()) + skipped, (bytes - skipped) / page * page, MADV_HUGEPAGE);
}

}  // namespace grainvdb
