#include "grainvdb/tune.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "grainvdb/run.hpp"
#include "pipeline/text.hpp"
#include "pipeline/trace_start.hpp"
#include "tune/field_error.hpp"
#include "tune/measured_run.hpp"
#include "tune/nine_digits.hpp"
#include "tune/profile_error.hpp"
#include "tune/proposal.hpp"
#include "tune/runs_stage.hpp"
#include "tune/tracer_error.hpp"

namespace grainvdb {
namespace {

constexpr std::size_t most_points = 100'000;
constexpr std::size_t most_combinations = 4;  // that are run to see whether the prediction holds

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Fields whose distance means nothing: axes without a sense of direction, counts, flags, errors of other fields.
bool has_a_norm(const std::string& field) {
  static const std::set<std::string> without{"principal_axes", "slip_lines", "frames", "mask"};
  return !without.contains(field) && !field.ends_with("_error");
}

/// Whether the volumes of the grains are read, so that phi costs no column.
bool has_volumes(const Plan& plan) {
  return std::any_of(plan.sweeps.begin(), plan.sweeps.end(),
                     [](const Sweep& s) { return s.columns.has(Column::radius); });
}

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// What the reference differs in. Between voxels of size h/2 the lattice is shifted by ½ (1 - 1/√3) of one along each
/// axis: to a lattice of the same size its points are where linear interpolation errs as much as in the mean over a
/// voxel, and they meet no other lattice's centres.
std::vector<std::string> reference_of(const Pipeline& pipeline, const Plan& plan) {
  const double voxel = pipeline.voxel / 2;
  const double shift = (1 - 1 / std::numbers::sqrt3) / 2;
  const auto shifted = [&](std::size_t axis) { return nine_digits(pipeline.origin[axis] + shift * voxel); };
  std::vector<std::string> set{"lattice.voxel=" + nine_digits(voxel),
                               "lattice.origin=[" + shifted(0) + ',' + shifted(1) + ',' + shifted(2) + ']'};
  if (runs_stage(plan, "contact_stress")) set.emplace_back("stages.contact_stress.line_integral=exact");
  for (const char* stage : {"velocity_gradient", "angular_velocity_gradient"})
    if (runs_stage(plan, stage)) set.push_back("stages." + std::string(stage) + ".method=kernel");
  if (!plan.sweeps.empty()) set.emplace_back("kernel.accumulation=double");
  if (pipeline.trace) set.emplace_back("trace.interpolation=cubic");
  return set;
}

bool traces_frames(const Pipeline& pipeline) {
  return pipeline.trace && pipeline.trace->through == TraceSpec::Through::frames;
}

/// Tracers through the mean go as far with fewer frames, and show only where they end.
void look_at_ends(TraceSpec& trace, const Pipeline& current, const FrameSource& source) {
  const std::vector<std::size_t> frames = select_frames(current.frames, source.frames().size());
  trace.duration = current.trace->duration.value_or(time_of(source.frames()[frames.back()]) -
                                                    time_of(source.frames()[frames.front()]));
  trace.every = std::int64_t{1} << 40;
}

class Tuning {
 public:
  Tuning(const TuneRequest& request, FrameSource& source)
      : request_(request),
        source_(source),
        clock_(request.clock ? request.clock : steady_seconds),
        current_(load({})),
        plan_(make_plan(current_)) {
    for (const std::string& field : current_.fields)
      (has_a_norm(field) ? report_.fields : report_.not_compared).push_back(field);
    field_count_ = std::ssize(report_.fields);
    planes_ = profile_quantities(current_, source_);
    report_.fields.insert(report_.fields.end(), planes_.begin(), planes_.end());
    if (current_.trace) {
      report_.fields.emplace_back("position");
      diameter_ = mean_diameter_of(current_, source_);
    }
    check_tolerances();
  }

  TunePlan plan() {
    list_trials();
    check_runs();
    check(load(reference_settings()));
    for (Trial& trial : report_.trials) unless_refused(trial, [&] { check(load(trial.set)); });
    return {planned_, reference_settings(), report_.fields, report_.not_compared, report_.trials};
  }

  TuneReport run() {
    list_trials();
    check_runs();
    run_reference();
    for (std::size_t repeat = 0; repeat < request_.repeats; ++repeat)
      for (Trial& trial : report_.trials) run_trial(trial, repeat);
    run_combinations();
    report_.front = pareto_front(report_.trials, request_.tolerance);
    report_.proposed = choose(report_.trials, request_.tolerance);
    report_.proposal_meets = meets(report_.trials[report_.proposed], request_.tolerance);
    return std::move(report_);
  }

 private:
  /// One mean over all frames, whatever the pipeline averages over, where no tracers go through frames.
  Pipeline load(const std::vector<std::string>& set) const {
    Pipeline pipeline = load_pipeline(request_.file, joined(request_.overrides, set));
    if (!traces_frames(pipeline)) pipeline.window = pipeline.window_step = 0;
    pipeline.until.reset();
    pipeline.reduced.reset();
    std::erase_if(pipeline.measure, [](const auto& m) { return m.first != "profile" && m.first != "plane_profile"; });
    return pipeline;
  }

  void check_tolerances() const {
    for (const auto& [field, most] : request_.tolerance) {
      if (std::find(report_.fields.begin(), report_.fields.end(), field) != report_.fields.end()) continue;
      throw ConfigError({{"--tolerance", 0},
                         "no wanted field that can be compared is called " + quote_text(field),
                         {},
                         join_choices(report_.fields),
                         did_you_mean(field, report_.fields)});
    }
  }

  void list_trials() {
    report_.trials.push_back({});
    knob_of_.emplace_back();
    for (const Knob& knob : request_.knobs)
      for (const std::string& value : knob.values) {
        Trial trial{joined({knob.key + '=' + value}, knob.along)};
        trial.knobs = 1;
        report_.trials.push_back(std::move(trial));
        knob_of_.push_back(knob.key);
      }
  }

  void check_runs() {
    const std::size_t combinations = request_.tolerance.empty() ? 0 : most_combinations;
    planned_ = 1 + (report_.trials.size() + combinations) * request_.repeats;
    if (planned_ <= request_.most_runs) return;
    throw LimitError({{"--max-runs", 0},
                      "more runs of the pipeline would be needed than are allowed",
                      std::to_string(planned_) + ": one of the reference, and " + std::to_string(request_.repeats) +
                          " of each of " + std::to_string(report_.trials.size() + combinations) + " settings",
                      "at most " + std::to_string(request_.most_runs),
                      "Try fewer knobs or values, repeat less often, or raise the limit"});
  }

  struct Timed {
    MeasuredRun result;
    double seconds;
  };

  Timed timed_run(Pipeline pipeline, const std::string& what) {
    if (pipeline.trace && !traces_frames(pipeline)) look_at_ends(*pipeline.trace, current_, source_);
    const Plan plan = make_plan(pipeline);
    TuneRequest::Step step{done_++, planned_, what, 0, 0};
    const auto tell = [&](const Progress& p) {
      step.frames = p.frames_done;
      step.frames_total = p.frames_total;
      if (request_.progress) request_.progress(step);
    };
    tell({});
    const double start = clock_();
    MeasuredRun result = measured_run(pipeline, plan, source_, tell);
    return {std::move(result), clock_() - start};
  }

  /// Of the current setting, at the planes of another.
  const std::vector<Table>& exact_tables(const Pipeline& pipeline) {
    const auto [it, is_new] = exact_.try_emplace({pipeline.voxel, pipeline.origin});
    if (is_new) {
      Pipeline exact = exact_profile(current_);
      exact.voxel = pipeline.voxel;
      exact.origin = pipeline.origin;
      it->second = measured_run(exact, make_plan(exact), source_, {}).tables;
    }
    return it->second;
  }

  std::vector<FieldError> errors_of(const Pipeline& pipeline, const MeasuredRun& found) {
    std::vector<FieldError> errors = field_errors(points_, found.fields);
    if (!planes_.empty()) {
      require_same_axis(current_, pipeline);
      for (FieldError& e : profile_errors(planes_, exact_tables(pipeline), found.tables))
        errors.push_back(std::move(e));
    }
    if (current_.trace) errors.push_back(position_error(reference_tracers_, found.tracers, diameter_));
    return errors;
  }

  std::vector<std::string> reference_settings() const {
    return joined(reference_of(current_, plan_), request_.reference);
  }

  void check(const Pipeline& pipeline) {
    checked_lattice_of(pipeline, make_plan(pipeline), source_);
    if (!planes_.empty()) require_same_axis(current_, pipeline);
  }

  void run_reference() {
    report_.reference = reference_settings();
    Pipeline pipeline = load(report_.reference);
    const bool with_phi = has_volumes(plan_);
    if (with_phi && std::find(pipeline.fields.begin(), pipeline.fields.end(), "phi") == pipeline.fields.end())
      pipeline.fields.emplace_back("phi");
    Timed timed = timed_run(pipeline, "the reference");
    report_.reference_seconds = timed.seconds;
    const std::vector<std::string> fields(report_.fields.begin(), report_.fields.begin() + field_count_);
    points_ = reference_points(timed.result.fields, fields, with_phi ? "phi" : "", most_points);
    report_.reference_points = points_.position.size();
    reference_tracers_ = std::move(timed.result.tracers);
  }

  void run_trial(Trial& trial, std::size_t repeat) {
    if (!trial.refused.empty()) return;
    unless_refused(trial, [&] {
      const Pipeline pipeline = load(trial.set);
      const Timed timed = timed_run(pipeline, trial.name());
      trial.seconds.push_back(timed.seconds);
      if (repeat == 0) trial.errors = errors_of(pipeline, timed.result);
    });
  }

  /// A setting that cannot be run is reported as refused; only the current one must be possible.
  template <class F>
  void unless_refused(Trial& trial, F work) {
    try {
      work();
    } catch (const Error& error) {
      const bool impossible = dynamic_cast<const ConfigError*>(&error) || dynamic_cast<const LimitError*>(&error);
      if (trial.set.empty() || !impossible) throw;
      trial.refused = error.what();
      trial.seconds.clear();
    }
  }

  /// Runs the combinations that promise to be faster than all that meets the tolerances so far, until one does.
  void run_combinations() {
    for (const Combination& c : promising(report_.trials, knob_of_, request_.tolerance, most_combinations)) {
      const Trial& best = report_.trials[choose(report_.trials, request_.tolerance)];
      if (meets(best, request_.tolerance) && c.seconds >= best.best_seconds()) return;
      Trial trial;
      for (std::size_t t : c.trials) trial.set = joined(trial.set, report_.trials[t].set);
      trial.knobs = c.trials.size();
      for (std::size_t repeat = 0; repeat < request_.repeats; ++repeat) run_trial(trial, repeat);
      report_.trials.push_back(std::move(trial));
      knob_of_.emplace_back();
    }
  }

  const TuneRequest& request_;
  FrameSource& source_;
  std::function<double()> clock_;
  Pipeline current_;
  Plan plan_;
  std::vector<std::string> knob_of_;  // of each trial
  std::ptrdiff_t field_count_ = 0;    // of what is compared; the rest are planes and tracers
  std::vector<std::string> planes_;   // the averages over them
  double diameter_ = 0;
  ReferencePoints points_;
  TracerPaths reference_tracers_;
  std::map<std::pair<double, Vec3>, std::vector<Table>> exact_;  // by voxel and origin
  std::size_t planned_ = 0;
  std::size_t done_ = 0;
  TuneReport report_;
};

}  // namespace

TunePlan plan_tuning(const TuneRequest& request, FrameSource& source) {
  return Tuning(request, source).plan();
}

TuneReport tune(const TuneRequest& request, FrameSource& source) {
  return Tuning(request, source).run();
}

}  // namespace grainvdb
