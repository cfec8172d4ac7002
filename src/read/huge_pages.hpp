#pragma once
/// Large pages for large columns.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <sys/mman.h>

namespace grainvdb {

/// Makes room in a vector, in large pages where it is large: with pages of 4 kB, taking the memory of a new column
/// takes as long as making its numbers out of text.
template <class T>
void reserve_pages(std::vector<T>& values, std::size_t count) {
  constexpr std::size_t page = std::size_t{1} << 12, worth_it = std::size_t{1} << 22;
  if (count * sizeof(T) < worth_it) return values.reserve(count);
  // The GNU allocator always maps more than this by itself. What it takes from its heap instead has been touched at the
  // ends, and a page that was touched stays small. Only address space: what is not written takes no memory.
  constexpr std::size_t mapped = (std::size_t{1} << 25) + page;
  values.reserve(std::max(count, mapped / sizeof(T)));
  const auto begin = reinterpret_cast<std::uintptr_t>(values.data());
  const std::size_t before = begin % page, bytes = before + values.capacity() * sizeof(T);
  // Only advice: nothing is lost where it is not followed.
  madvise(reinterpret_cast<char*>(values.data()) - before, (bytes + page - 1) / page * page, MADV_HUGEPAGE);
}

}  // namespace grainvdb
