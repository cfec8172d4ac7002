#pragma once
/// How far tracers end from those of a reference.
#include <vector>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/tracer_sink.hpp"
#include "grainvdb/tune.hpp"

namespace grainvdb {

/// Where tracers went, sample by sample: all of them, or one in every so many where there are more than 10 000.
struct TracerPaths {
  std::vector<double> time;
  std::vector<Columns3> displacement;           ///< from the seeds, which are those of every run [length]
  std::vector<std::vector<TracerStop>> stop{};  ///< [sample][tracer]
};

class PathSink final : public TracerSink {
 public:
  /// `to` must outlive the sink.
  explicit PathSink(TracerPaths& to) : to_(to) {}
  void begin(const TracerLayout& /*layout*/) override {}
  void write(const TracerSample& sample) override;
  void commit(const Provenance& /*provenance*/) override {}
  std::vector<std::string> files() const override { return {}; }

 private:
  TracerPaths& to_;
};

/// "position" at the last sample that both have, which is behind their first: rms and largest of |x - r| over the
/// tracers that move in both, in units of `diameter`. Those that move in the reference alone are undefined.
FieldError position_error(const TracerPaths& reference, const TracerPaths& found, double diameter);

/// Number mean of the material in the first frame of the pipeline that has any, bad frames passed over where the input
/// says so. Throws InputError where none has, and what reading throws.
double mean_diameter_of(const Pipeline& pipeline, FrameSource& source);

}  // namespace grainvdb
