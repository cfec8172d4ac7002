#pragma once
/// Runs a pipeline: streams the frames through the plan's sweeps, averages, derives and writes.
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/field_sink.hpp"
#include "grainvdb/frame_source.hpp"
#include "grainvdb/mask.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/region.hpp"
#include "grainvdb/sparse_field.hpp"
#include "grainvdb/table.hpp"
#include "grainvdb/trace_report.hpp"
#include "grainvdb/tracer_sink.hpp"

namespace grainvdb {

/// How an average with average.until ended.
struct Stop {
  std::size_t frames = 0;        ///< that were read for it; bad ones count
  std::size_t frames_there = 0;  ///< that it could have had
  bool met = false;              ///< whether the target was met
  double error = 0;              ///< in the end, as the target is meant
};

struct Progress {
  std::size_t frames_done = 0;  ///< over all sweeps
  std::size_t frames_total = 0;
  std::string doing;    ///< e.g. "sweep 1 of 2"
  std::string error{};  ///< where averaging may stop by itself: how far it has come, in words
};

/// A kernel so narrow beside the grains that fields show these one by one.
struct NarrowKernel {
  double in_diameters = 0;  ///< its cutoff, in number mean diameters of the material of the first frame that has any
  double least = 0;         ///< limits.cutoff_in_diameters
};

struct RunReport {
  std::size_t frames = 0;         ///< that are in an average
  std::size_t resumed_at = 0;     ///< frames, over all sweeps, that an interrupted run had done before
  std::size_t active_voxels = 0;  ///< of the last output time
  std::size_t summed_leaves = 0;  ///< of the last output time: where moments were summed
  std::size_t channels = 0;       ///< splatted per frame, over all sweeps
  double memory = 0;              ///< peak of the run by its MemoryModel [byte]
  std::size_t grids = 0;          ///< OpenVDB grids allocated over the run, the mask apart
  double wall_seconds = 0;
  std::vector<std::pair<std::string, double>> seconds;      ///< by step of the run: read, splat, …; steps overlap
  std::vector<std::pair<std::string, std::size_t>> masked;  ///< reason → voxels, of the last output time
  std::vector<BadFrame> bad_frames;                         ///< that were left out
  std::optional<Stop> stop;                                 ///< where averaging could stop by itself
  std::optional<NarrowKernel> narrow_kernel;
  std::vector<std::string> averaging;  ///< what there is to say of the averages, in words
  std::vector<std::string> walls;      ///< where they are and what is done about them, in words
  std::vector<std::string> files;      ///< written, those of the tracers apart
  std::optional<TraceReport> trace;    ///< where there were tracers
  std::vector<Table> tables;           ///< of the measurements, in the units that are written
  Provenance tables_from;              ///< where the tables come from
  ReadCounters read;
};

/// What can only be checked once the dump is known: cutoff against periodic lengths, voxels against periods, frames
/// against the selection, extents against the limits, columns against the needs. Throws ConfigError, InputError or
/// LimitError. `grainvdb validate` calls it too. Returns the lattice with its periods.
Lattice check_against_input(const Pipeline& pipeline, const Plan& plan, FrameSource& source);

/// The same for the tracers, where there are any. Throws ConfigError.
void check_trace_against_input(const Pipeline& pipeline, const FrameSource& source);

/// The same for the measurements. Returns the lattice with its periods; one of unit voxels where the pipeline has none.
Lattice check_measure_against_input(const Pipeline& pipeline, FrameSource& source);

/// Reads frame k with every column that the run will need, and makes the checks that the run makes of each frame before
/// it computes anything. Throws InputError, IoError or LimitError.
void check_frame(const Pipeline& pipeline, const Plan& plan, const Lattice& lattice, FrameSource& source,
                 std::size_t k);

/// The fields of one output time.
struct OutputFields {
  OutputTime time;
  std::map<std::string, SparseField> fields;  ///< those that the pipeline wants, on one topology
  Mask mask;
};

/// Reads, splats, averages and derives, and hands over one output time after another. Frames are read ahead and
/// prepared while those before them are splatted; no more than limits.frames_in_flight are in memory. The fields have
/// the same bytes for any number of threads and of frames in flight. Where something fails, what belongs to the
/// earliest frame is thrown.
///
/// Where a region is given, or the pipeline has one, nothing is computed that fields within do not need, and they are
/// the same, to the last bit, as without it; output holds the voxels of the region.
///
/// Where the input says OnError::skip_frame, a frame for which reading it or its contacts throws an InputError is left
/// out of every sweep and stands in the report. So that this is known in the first sweep, that one reads the columns of
/// all. An output time that has no frame left has no voxels and a frame_count of 0; no frame left at all is an
/// InputError.
///
/// Where the pipeline has average.until, frames after that at which the target is met are in no sum, and what is wrong
/// with them does not matter; a few of them may have been read ahead.
///
/// `take` and `progress` are called by one thread at a time, `progress` after each frame of each sweep; what they throw
/// ends the run.
RunReport compute_fields(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                         const std::function<void(OutputFields)>& take,
                         const std::function<void(const Progress&)>& progress = {},
                         const std::optional<Region>& region = {});

/// Where a run notes how far it is, and how often.
struct CheckpointOptions {
  /// That of the results. The checkpoint is the folder .grainvdb-checkpoint in it, which is made where there is none
  /// and removed once the results are complete. Temporary files that an interrupted run left beside it are removed,
  /// too.
  std::string output_folder;
  double interval = 60;  ///< after which the sums are saved with the next frame [s]
};

/// Runs the whole pipeline into the sinks. One output time is written while the next is computed.
///
/// With a checkpoint, a run that ends before its results are complete, in whatever way, is continued by the next one
/// with the same folder, and the results have the same bytes as without the interruption. Each output time is saved
/// when it is finished, the sums of the one at hand after each interval. Throws ConfigError where the folder is that of
/// a run of another version or pipeline, or of other inputs; InputError where it is damaged; IoError where another run
/// is at work in it.
///
/// Without tracer sinks nothing is traced; without field sinks no field is written, and the checkpoint is used only
/// where measurements are made of fields or of averages over planes. What is measured of single frames begins anew. The
/// tables of the measurements are in the report.
RunReport run_pipeline(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                       const std::vector<std::unique_ptr<FieldSink>>& sinks,
                       const std::vector<std::unique_ptr<TracerSink>>& tracer_sinks,
                       const std::function<void(const Progress&)>& progress = {},
                       const std::optional<CheckpointOptions>& checkpoint = {});
RunReport run_pipeline(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                       const std::vector<std::unique_ptr<FieldSink>>& sinks,
                       const std::function<void(const Progress&)>& progress = {},
                       const std::optional<CheckpointOptions>& checkpoint = {});

}  // namespace grainvdb
