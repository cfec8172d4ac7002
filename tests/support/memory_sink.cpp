#include "support/memory_sink.hpp"

#include <cstddef>

namespace grainvdb::testing {

bool FieldCopy::active(const Coord& c) const {
  const auto leaf = topology->find(leaf_origin(c));
  return leaf && topology->mask(*leaf).test(leaf_offset(c));
}

float FieldCopy::at(const Coord& c, int component) const {
  const auto leaf = topology->find(leaf_origin(c));
  if (!leaf) return meta.background;
  const auto block = *leaf * static_cast<std::size_t>(meta.components) + static_cast<std::size_t>(component);
  return values[block * leaf_size + static_cast<std::size_t>(leaf_offset(c))];
}

std::uint32_t Written::mask_at(const Coord& c) const {
  const auto leaf = mask_topology->find(leaf_origin(c));
  if (!leaf) return static_cast<std::uint32_t>(Reason::outside);
  return mask[*leaf * leaf_size + static_cast<std::size_t>(leaf_offset(c))];
}

void MemorySink::write(const OutputTime& time, const std::vector<const SparseField*>& fields, const Mask* mask) {
  Written w;
  w.time = time;
  for (const SparseField* f : fields) {
    FieldCopy copy{f->meta(), f->topology(), {}};
    for (std::size_t l = 0; l < f->topology()->leaf_count(); ++l)
      for (int c = 0; c < f->components(); ++c)
        copy.values.insert(copy.values.end(), f->leaf(l, c), f->leaf(l, c) + leaf_size);
    w.fields.emplace(f->meta().name, std::move(copy));
  }
  if (mask != nullptr) {
    w.has_mask = true;
    w.mask_topology = mask->topology();
    for (std::size_t l = 0; l < w.mask_topology->leaf_count(); ++l)
      w.mask.insert(w.mask.end(), mask->leaf(l), mask->leaf(l) + leaf_size);
  }
  record_->times.push_back(std::move(w));
}

void MemorySink::commit(const Provenance& provenance) {
  record_->provenance = provenance;
  record_->committed = true;
}

}  // namespace grainvdb::testing
