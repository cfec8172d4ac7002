#pragma once
/// The measurements of a pipeline: what they see of the fields as these come, and their own passes over the frames,
/// which read nothing but what they need.
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/measurement.hpp"
#include "grainvdb/run.hpp"
#include "pipeline/bad_frames.hpp"
#include "pipeline/checkpoint.hpp"
#include "pipeline/plane_runs.hpp"
#include "pipeline/stopwatch.hpp"

namespace grainvdb {

class MeasurePass {
 public:
  /// Makes the checks of the input. All arguments must outlive the pass. Throws as check_measure_against_input does.
  MeasurePass(const Pipeline& pipeline, const Plan& plan, FrameSource& source);

  /// The fields of one output time, in order of time.
  void take(const OutputFields& output);
  /// Reads the frames for the measurements of frames and of averages over planes: those that are not bad by the report,
  /// up to where averaging ended. Without such measurements it reads nothing. With a checkpoint (nullptr: none)
  /// averages over planes go on where they were interrupted.
  void visit_frames(const RunReport& report, const std::function<void(const Progress&)>& progress,
                    const Checkpoint* checkpoint);
  /// Adds the tables to the report, and the frames that were found to be bad.
  void commit(RunReport& report);

 private:
  struct Entry {
    std::string name;
    MeasurementNeeds needs;
    std::unique_ptr<Measurement> measurement;
  };
  void measure(const Frame& frame);
  void visit_single_frames(const RunReport& report, const std::function<void(const Progress&)>& progress);
  void visit_planes(std::size_t number, const RunReport& report, const std::function<void(const Progress&)>& progress,
                    const Checkpoint* checkpoint);
  std::string steps_in_use(const RunReport& report) const;

  const Pipeline& pipeline_;
  const Plan& plan_;
  FrameSource& source_;
  std::vector<std::size_t> wanted_;
  Lattice lattice_;
  std::vector<Entry> entries_;
  std::vector<PlaneRun> plane_runs_;
  BadFrames bad_;
  std::vector<BadFrame> bad_on_planes_;
  std::vector<std::pair<std::string, double>> seconds_on_planes_;
  std::size_t resumed_on_planes_ = 0;  ///< frames, over all sweeps
  double memory_on_planes_ = 0;        ///< [byte]
  std::size_t measured_ = 0;           ///< frames
  Stopwatch clock_;
};

}  // namespace grainvdb
