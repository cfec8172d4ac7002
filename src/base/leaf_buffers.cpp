#include "grainvdb/leaf_buffers.hpp"

#include <new>
#include <utility>

#include <sys/mman.h>

namespace grainvdb {

LeafBuffers::LeafBuffers(std::shared_ptr<const Topology> topology, int channels)
    : topology_(std::move(topology)), channels_(channels) {
  const std::size_t size = bytes();
  if (size == 0) return;
  void* const pages = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (pages == MAP_FAILED) throw std::bad_alloc();
  // Fresh pages are zero without being written. Large ones are only advice: with 4 kB pages the faults take longer than
  // the splat that fills them.
  madvise(pages, size, MADV_HUGEPAGE);
  data_ = {static_cast<double*>(pages), PageUnmapper{size}};
}

LeafBlocks LeafBuffers::blocks() const {
  LeafBlocks all{topology_, std::vector<const double*>(topology_->leaf_count())};
  for (std::size_t l = 0; l < all.leaves.size(); ++l) all.leaves[l] = block(l, 0);
  return all;
}

void PageUnmapper::operator()(double* pages) const {
  munmap(pages, bytes);
}

}  // namespace grainvdb
