#pragma once
/// The tracers of a pipeline on their way through its output times.
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "grainvdb/field_sink.hpp"
#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/run.hpp"
#include "grainvdb/seeds.hpp"
#include "grainvdb/trace_report.hpp"
#include "grainvdb/tracer_recorder.hpp"
#include "grainvdb/tracer_sink.hpp"
#include "pipeline/output_units.hpp"
#include "pipeline/trace_neighbourhood.hpp"

namespace grainvdb {

/// Memory, besides the fields it is given: the flow at two output times, and one sample.
class TraceRun {
 public:
  using Sinks = std::vector<std::unique_ptr<TracerSink>>;

  /// `wanted` are the frames of the pipeline, in ascending order. Pipeline, seeds and sinks must outlive the run.
  TraceRun(const Pipeline& pipeline, const FrameSource& source, const Lattice& lattice,
           std::span<const std::size_t> wanted, const TracerSeeds& seeds, const Sinks& sinks);
  ~TraceRun();

  /// From here on, tracers must stay where fields are known: before they could leave the neighbourhood, it grows along
  /// the ways that they are about to take, and LeftNeighbourhood is thrown. It must outlive the run.
  void stay_in(TraceNeighbourhood& neighbourhood);

  /// Moves the tracers on to the next output time, or through the mean, and writes samples. Output times come in the
  /// order of the trace: backwards, the latest first. Throws ConfigError when no seed lies in the material.
  void take(const OutputFields& output);

  /// Puts the histories under their names, with the report in the provenance. There must have been an output time;
  /// through frames, throws InputError unless there were two.
  void commit(Provenance provenance);

  const TraceReport& report() const { return report_; }
  /// Says that the fields were computed around the tracers alone.
  void found_nearby(std::size_t passes, double share);

 private:
  std::shared_ptr<const FlowGrid> flow_grid(const OutputFields& output) const;
  void start(const OutputFields& output);
  void move(const Flow& flow, double until);
  void keep_near(const Flow& flow, double until);
  void record(const OutputFields& output, std::int64_t step);
  const TracerSample& in_output_units(const TracerSample& sample, const OutputFields& output);
  void take_mean(const OutputFields& output);
  void take_frame(const OutputFields& output);
  TracerLayout layout(const OutputFields& output) const;
  TracerSettings settings() const;
  bool backward() const { return spec_.direction == TraceSpec::Direction::backward; }
  std::vector<const SparseField*> recorded(const OutputFields& output) const;

  const Pipeline& pipeline_;
  const TraceSpec& spec_;
  const Sinks& sinks_;
  Lattice lattice_;
  OutputUnits units_;
  Box box_;
  const TracerSeeds& seeds_;
  double first_time_, last_time_;  ///< of the frames
  std::size_t outputs_;            ///< that are expected
  std::size_t taken_ = 0;
  double previous_time_ = 0;
  double end_time_ = 0;                          ///< of the tracers
  double fastest_ = 0, fastest_now_ = 0;         ///< speed in the flow, and at the last output time
  TraceNeighbourhood* neighbourhood_ = nullptr;  ///< none: fields are known everywhere
  std::shared_ptr<const FlowGrid> previous_;
  std::optional<Tracers> tracers_;
  std::optional<TracerRecorder> recorder_;
  TracerSample written_;  ///< the last one, where its units are not those of the dump
  TraceReport report_;
};

}  // namespace grainvdb
