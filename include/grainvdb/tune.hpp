#pragma once
/// Speed against accuracy, measured on the user's own dumps: what each setting of a pipeline costs, how far its fields
/// lie from those of a reference run, and which is the cheapest that is good enough.
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"

namespace grainvdb {

/// How far a field lies from the reference. Compared at voxel centres of the reference, which lie between those of any
/// setting: there the setting's field is interpolated trilinearly, as it is read in use, so that the voxel size counts.
/// Sums run over the points at which both have a value, and over all components; fields that are ratios are weighted
/// with the reference's phi, where it can be had, since they vary wildly where there is next to nothing.
///
/// "profile.phi" and the like are of planes: the averages of measure.profile or measure.plane_profile against the exact
/// ones of all frames at the same planes. "position" is of tracers: where they are at the last
/// sample that both runs have, against the reference; rms and largest are distances in mean diameters.
struct FieldError {
  std::string field;
  double rms = 0;             ///< √(Σ|f - r|²/Σ|r|²); 0 where both are zero, infinite where only r is
  double largest = 0;         ///< max|f - r| over the root mean square of r
  std::size_t points = 0;     ///< at which both have a value
  std::size_t undefined = 0;  ///< at which the reference alone has one
};

/// One setting that was tried.
struct Trial {
  std::vector<std::string> set;      ///< "key=value" where it differs from the current setting; none: the current one
  std::vector<double> seconds{};     ///< of every repeat: all but writing
  std::vector<FieldError> errors{};  ///< of the wanted fields that can be compared, in their order
  std::string refused{};             ///< why it cannot be run; empty when it was
  std::size_t knobs = 0;             ///< that are turned

  double best_seconds() const;
  double worst_seconds() const;
  /// What it sets, "as it is" for the current setting.
  std::string name() const;
};

/// A key of the pipeline file and the values that are tried, as in --set. The current value is not among them.
struct Knob {
  std::string key;
  std::vector<std::string> values;
  std::vector<std::string> along{};  ///< "key=value" that belong to each of the values
};

struct TuneRequest {
  std::string file;                           ///< the pipeline
  std::vector<std::string> overrides{};       ///< "key=value" of the current setting
  std::vector<std::string> reference{};       ///< "key=value" on top of what the reference has by itself
  std::map<std::string, double> tolerance{};  ///< field → largest rms
  std::vector<Knob> knobs{};                  ///< those to try; see default_knobs
  std::size_t repeats = 3;                    ///< runs of each setting, of which the fastest counts
  std::size_t most_runs = 120;                ///< of the pipeline, in all
  std::function<double()> clock{};            ///< seconds since any moment; the steady clock when empty
  /// Called before each run and after each of its frames: runs done, runs planned, what runs, frames done, frames.
  struct Step {
    std::size_t run, runs;
    std::string what;
    std::size_t frames, frames_total;
  };
  std::function<void(const Step&)> progress{};
};

struct TuneReport {
  std::vector<std::string> reference;  ///< the reference's overrides, complete
  std::size_t reference_points = 0;    ///< voxel centres at which fields are compared
  double reference_seconds = 0;
  std::vector<std::string> fields;        ///< that are compared
  std::vector<std::string> not_compared;  ///< wanted fields without a norm: directions, counts
  std::vector<Trial> trials;              ///< the current setting first
  std::vector<bool> front;                ///< of each trial: no other is both faster and closer (see score)
  std::size_t proposed = 0;     ///< of the trials; the current one where it is good enough and none is surely cheaper
  bool proposal_meets = false;  ///< whether the proposed trial keeps to the tolerances
};

/// What is tried unless the user says otherwise: the voxel size (×½ … 2, as periods allow), the line integral, the
/// modes of temperature and spin fluctuation, the gradient, how sums are added up, the interpolation of the tracers,
/// the way to the profile, the number of frames; each only where something that is compared depends on it.
std::vector<Knob> default_knobs(const Pipeline& pipeline, const Plan& plan, FrameSource& source);

/// Runs the reference, the current setting, every value of every knob by itself, and then the combinations that
/// promise to be the cheapest within the tolerances. The reference has voxels of half the size on a lattice shifted
/// by a fraction of them, line integrals in closed form, sums in double, gradients of the kernel, and tracers
/// carried by splines. The output is averaged over all frames in one window; where tracers go through
/// frames the windows are those of the pipeline, and fields are compared at the last. Measurements but those of
/// profiles are left out. Throws ConfigError for a setting that cannot be the current or the reference one and for a
/// tolerance of a field that is not compared (with "did you mean"); LimitError where more than `most_runs` would be
/// needed; and what running the pipeline throws.
TuneReport tune(const TuneRequest& request, FrameSource& source);

/// What `tune` would do.
struct TunePlan {
  std::size_t runs = 0;                ///< of the pipeline at most, repeats and combinations included
  std::vector<std::string> reference;  ///< as in TuneReport, as are the next two
  std::vector<std::string> fields;
  std::vector<std::string> not_compared;
  std::vector<Trial> settings;  ///< that would be tried by themselves, with why those are refused that are none
};

/// Makes the checks that `tune` makes before its first run. Throws as it does.
TunePlan plan_tuning(const TuneRequest& request, FrameSource& source);

/// The largest ratio of an error to its tolerance; without tolerances the largest error. Infinite when refused.
double score(const Trial& trial, const std::map<std::string, double>& tolerance);

/// The report as a table and a proposal, as `grainvdb tune` prints it.
std::string describe(const TuneReport& report, const std::map<std::string, double>& tolerance);
/// The plan in words.
std::string describe(const TunePlan& plan);
/// One row per setting and field.
std::string to_csv(const TuneReport& report, const std::map<std::string, double>& tolerance);

}  // namespace grainvdb
