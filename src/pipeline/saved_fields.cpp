#include "pipeline/saved_fields.hpp"

#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

namespace grainvdb {
namespace {

constexpr std::size_t float_bytes = leaf_size * sizeof(float);

void save_field(ByteWriter& to, const SparseField& field) {
  const FieldMeta& meta = field.meta();
  for (const std::string& text : {meta.name, meta.unit, meta.description, meta.equation}) to.text(text);
  to.number(meta.components);
  to.number(meta.background);
  to.number(meta.dimension);
  for (std::size_t l = 0; l < field.topology()->leaf_count(); ++l)
    for (int c = 0; c < field.components(); ++c) to.write(field.leaf(l, c), float_bytes);
}

SparseField load_field(ByteReader& from, const std::shared_ptr<const Topology>& topology, const Lattice& lattice) {
  FieldMeta meta;
  for (std::string* text : {&meta.name, &meta.unit, &meta.description, &meta.equation}) *text = from.text();
  meta.components = from.number<int>();
  meta.background = from.number<float>();
  meta.dimension = from.number<Dimension>();
  SparseField field = SparseField::unset(std::move(meta), topology, lattice);
  for (std::size_t l = 0; l < topology->leaf_count(); ++l)
    for (int c = 0; c < field.components(); ++c) from.read(field.leaf(l, c), float_bytes);
  return field;
}

void load_mask(ByteReader& from, Mask& mask) {
  std::vector<std::uint32_t> bits(leaf_size);
  for (std::size_t l = 0; l < mask.topology()->leaf_count(); ++l) {
    from.read(bits.data(), bits.size() * sizeof(std::uint32_t));
    for (int v = 0; v < leaf_size; ++v) mask.add(l, v, static_cast<Reason>(bits[static_cast<std::size_t>(v)]));
  }
}

}  // namespace

void save_topology(ByteWriter& to, const Topology& topology) {
  to.numbers(topology.origins());
  for (std::size_t l = 0; l < topology.leaf_count(); ++l) to.number(topology.mask(l));
}

std::shared_ptr<const Topology> load_topology(ByteReader& from) {
  std::vector<Coord> origins = from.numbers<Coord>();
  std::vector<LeafMask> masks(origins.size());
  for (LeafMask& mask : masks) mask = from.number<LeafMask>();
  return std::make_shared<const Topology>(std::move(origins), std::move(masks));
}

void save_output(ByteWriter& to, const OutputFields& output) {
  const Topology& topology = *output.mask.topology();
  to.number(output.time.time);
  to.number(output.time.first_step);
  to.number(output.time.last_step);
  to.number(std::uint64_t{output.time.frame_count});
  save_topology(to, topology);
  for (std::size_t l = 0; l < topology.leaf_count(); ++l)
    to.write(output.mask.leaf(l), leaf_size * sizeof(std::uint32_t));
  to.number(std::uint64_t{output.fields.size()});
  for (const auto& [name, field] : output.fields) {
    if (field.topology() != output.mask.topology()) throw std::logic_error("fields of an output time differ in voxels");
    save_field(to, field);
  }
}

OutputFields load_output(ByteReader& from, const Lattice& lattice) {
  OutputTime time;
  time.time = from.number<double>();
  time.first_step = from.number<std::int64_t>();
  time.last_step = from.number<std::int64_t>();
  time.frame_count = from.count();
  const std::shared_ptr<const Topology> topology = load_topology(from);
  OutputFields output{time, {}, Mask(topology)};
  load_mask(from, output.mask);
  for (std::size_t left = from.count(); left > 0; --left) {
    SparseField field = load_field(from, topology, lattice);
    std::string name = field.meta().name;
    output.fields.emplace(std::move(name), std::move(field));
  }
  return output;
}

}  // namespace grainvdb
