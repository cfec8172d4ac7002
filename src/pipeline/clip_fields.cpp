#include "pipeline/clip_fields.hpp"

#include <cstddef>
#include <memory>
#include <utility>

#include "base/parallel.hpp"

namespace grainvdb {

DerivedFields clip_fields(const DerivedFields& all, const Region& region, const Lattice& lattice) {
  const Topology& whole = *all.mask.topology();
  const auto part = std::make_shared<const Topology>(region.clip(whole));
  std::vector<std::size_t> source;
  for (const Coord& origin : part->origins()) source.push_back(whole.find(origin).value());

  DerivedFields result{{}, Mask(part), all.grids};
  for (const auto& [name, field] : all.fields) {
    SparseField clipped(field.meta(), part, lattice);
    parallel_for(part->leaf_count(), [&](std::size_t l) {
      for (int c = 0; c < field.components(); ++c)
        part->mask(l).for_each(
            [&, from = field.leaf(source[l], c), to = clipped.leaf(l, c)](int v) { to[v] = from[v]; });
    });
    result.fields.emplace(name, std::move(clipped));
  }
  for (std::size_t l = 0; l < part->leaf_count(); ++l)
    part->mask(l).for_each([&](int v) { result.mask.add(l, v, static_cast<Reason>(all.mask.leaf(source[l])[v])); });
  return result;
}

}  // namespace grainvdb
