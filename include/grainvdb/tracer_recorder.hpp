#pragma once
/// Turns tracers and fields into samples of their histories.
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "grainvdb/flow.hpp"
#include "grainvdb/mask.hpp"
#include "grainvdb/sparse_field.hpp"
#include "grainvdb/tracer_sink.hpp"
#include "grainvdb/tracers.hpp"

namespace grainvdb {

class LeafIndex;

/// What a sample holds beside times, places and stop codes.
struct RecordedColumns {
  std::vector<FieldMeta> fields{};
  bool strain = false;
  bool step_numbers = false;  ///< Co and K, which the tracers must compute
};

/// Keeps one sample, whatever the length of the histories: at most 93 bytes per tracer and 4 per recorded component.
class TracerRecorder {
 public:
  /// `lattice` and `interpolation` are those of the fields. Throws std::invalid_argument when Co and K are wanted of
  /// tracers that do not compute them.
  TracerRecorder(const Tracers& tracers, const Lattice& lattice, const RecordedColumns& columns,
                 Interpolation interpolation);
  ~TracerRecorder();
  TracerRecorder(TracerRecorder&&) noexcept;
  TracerRecorder& operator=(TracerRecorder&&) noexcept;

  /// The tracers now, with the fields sampled where they are; fields as in RecordedColumns, all on one topology. Where
  /// a field is undefined a tracer stops, or is given NaN, as TracerSettings::on_undefined says:
  /// TracerStop::left_material when one of the 8 voxels around is inactive, masked otherwise. Entries of tracers that
  /// stand still repeat the last sample in which they moved; those that never moved show their seeds, with the values
  /// that are defined there. `mask` tells why values are undefined and may be nullptr. The result is valid until the
  /// next call. Throws std::invalid_argument when tracers or fields are not those that were announced.
  const TracerSample& record(Tracers& tracers, const std::vector<const SparseField*>& fields, const Mask* mask,
                             std::int64_t step);

  /// How many samples of moving tracers had an undefined field, by reason.
  std::map<Reason, std::size_t> undefined() const;

 private:
  struct Undefined {
    std::array<std::size_t, 32> samples{};  ///< by the bit of the reason
  };
  void check(const Tracers& tracers, const std::vector<const SparseField*>& fields, const Mask* mask) const;
  void copy_state(const Tracers& tracers, std::size_t i);
  void record_some(Tracers& tracers, const std::vector<const SparseField*>& fields, const Mask* mask, std::size_t begin,
                   std::size_t end, Undefined& undefined);

  Lattice lattice_;
  RecordedColumns columns_;
  Interpolation interpolation_;
  std::shared_ptr<const Topology> topology_;  ///< of the last fields
  std::unique_ptr<LeafIndex> index_;
  TracerSample sample_;
  bool first_ = true;
  Undefined undefined_;
};

}  // namespace grainvdb
