#pragma once
/// Turns tracers and fields into samples of their histories.
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

/// Which columns of a sample are filled.
struct RecordedColumns {
  std::vector<FieldMeta> fields;
  bool strain = false;
  bool step_numbers = false;  ///< Co and K; the tracers must compute them
};

/// Keeps one sample, whatever the length of the histories: 100 bytes per tracer and 4 per recorded component.
class TracerRecorder {
 public:
  TracerRecorder(const Tracers& tracers, const Lattice& lattice, const RecordedColumns& columns,
                 Interpolation interpolation);
  ~TracerRecorder();

  /// The tracers now: the fields, in the order of RecordedColumns, are sampled where the tracers are. A tracer at a
  /// place where one of them is undefined stops, or is given NaN, as TracerSettings::on_undefined says. Entries of
  /// tracers that stand still repeat the last sample in which they moved; those that never moved show their seeds.
  /// `mask` may be nullptr: it tells apart why values are undefined (see undefined_reasons). The result is valid until
  /// the next call.
  const TracerSample& record(Tracers& tracers, const std::vector<const SparseField*>& fields, const Mask* mask,
                             std::int64_t step);

  /// Why recorded fields stopped tracers or left NaN, over all samples: reason → tracers and samples.
  const std::map<Reason, std::size_t>& undefined_reasons() const { return reasons_; }

 private:
  Lattice lattice_;
  Interpolation interpolation_;
  std::shared_ptr<const Topology> topology_;  ///< of the last fields
  std::unique_ptr<LeafIndex> index_;
  TracerSample sample_;
  std::map<Reason, std::size_t> reasons_;
};

}  // namespace grainvdb
