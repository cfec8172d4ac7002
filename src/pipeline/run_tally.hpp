#pragma once
/// What a run has come to so far: the counts and sizes of its report.
#include <cstddef>

#include "base/bytes.hpp"
#include "grainvdb/memory_model.hpp"
#include "grainvdb/run.hpp"
#include "pipeline/derive_fields.hpp"
#include "pipeline/frame_context.hpp"

namespace grainvdb {

class RunTally {
 public:
  /// With so many images per particle.
  explicit RunTally(double images) { size_.images = images; }

  /// A frame that is in the sums.
  void add(const FrameContext& frame);
  /// An output time that is finished, for which so many leaves were summed.
  void add(const DerivedFields& output, std::size_t summed_leaves);
  void note_stop(const Stop& stop) { report_.stop = stop; }

  /// Whether select has kept a particle in any frame.
  bool has_material() const { return material_ > 0; }
  /// With what follows from the plan; the rest is left to whoever knows it.
  RunReport report(const Plan& plan, const Pipeline& pipeline) const;

  void save(ByteWriter& to) const;
  /// Into a tally of the same run that nothing was added to.
  void load(ByteReader& from);

 private:
  RunReport report_;
  RunSize size_;
  std::size_t material_ = 0;  // particles that select kept, over frames and sweeps
  double diameter_ = 0;       // their mean in the first frame that has some, where sizes are read
};

}  // namespace grainvdb
