#pragma once
/// Fields that are kept in memory for the tests to look at.
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "grainvdb/field_sink.hpp"

namespace grainvdb::testing {

/// A copy of a field: values laid out [leaf][component][offset in leaf].
struct FieldCopy {
  FieldMeta meta;
  std::shared_ptr<const Topology> topology;
  std::vector<float> values;

  bool active(const Coord& c) const;
  /// The background outside the topology.
  float at(const Coord& c, int component = 0) const;
  /// Calls f(voxel) for every active voxel.
  template <class F>
  void for_each_active(F&& f) const {
    for (std::size_t l = 0; l < topology->leaf_count(); ++l)
      topology->mask(l).for_each([&](int offset) { f(voxel_at(topology->origin(l), offset)); });
  }
};

/// What was written for one output time.
struct Written {
  OutputTime time;
  std::map<std::string, FieldCopy> fields;
  bool has_mask = false;
  std::shared_ptr<const Topology> mask_topology;
  std::vector<std::uint32_t> mask;

  const FieldCopy& field(const std::string& name) const { return fields.at(name); }
  std::uint32_t mask_at(const Coord& c) const;
};

/// Everything that was written, shared between the sink, which the run owns, and the test.
struct Record {
  std::vector<OutputLayout> layouts;
  std::vector<Written> times;
  Provenance provenance;
  bool committed = false;
};

class MemorySink : public FieldSink {
 public:
  explicit MemorySink(std::shared_ptr<Record> record) : record_(std::move(record)) {}
  void begin(const OutputLayout& layout) override { record_->layouts.push_back(layout); }
  void write(const OutputTime& time, const std::vector<const SparseField*>& fields, const Mask* mask) override;
  void commit(const Provenance& provenance) override;
  std::vector<std::string> files() const override { return {}; }

 private:
  std::shared_ptr<Record> record_;
};

}  // namespace grainvdb::testing
