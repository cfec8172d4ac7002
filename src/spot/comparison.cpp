#include "spot/comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "base/listed.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/run.hpp"
#include "measure/spot_comparison.hpp"
#include "measure/table_numbers.hpp"
#include "pipeline/number.hpp"
#include "pipeline/output_units.hpp"
#include "spot/calibration.hpp"
#include "spot/run_spot.hpp"
#include "spot/spot_file.hpp"
#include "write/text_file.hpp"

namespace grainvdb::spot {
namespace {

constexpr const char* measurement = "spot_calibration";
constexpr const char* result_name = "spot_calibration_by_comparison";
constexpr double speed_reach = 3;  // by what factor spots of a round may be faster or slower than those before
constexpr double filling = 1.15;   // of the time in which a spot rises through the packing: the last come, too

/// A folder for dumps that are only looked at.
class PassingFolder {
 public:
  explicit PassingFolder(const std::filesystem::path& parent) : path_(parent / "comparison_runs") {
    std::filesystem::remove_all(path_);
  }
  ~PassingFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  PassingFolder(const PassingFolder&) = delete;
  PassingFolder& operator=(const PassingFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

const OptionValues& given_options(const Pipeline& pipeline) {
  return pipeline.measure.at(measurement);
}

/// Whether the first frame tells the packing at rest, and is no part of the flow.
bool rests_first(const Pipeline& pipeline) {
  const OptionValues& o = given_options(pipeline);
  return std::get<std::string>(o.at("reference")) == "rest" && !(std::get<double>(o.at("phi_at_rest")) > 0);
}

/// Frames of the flow in the dumps.
struct FlowFrames {
  std::size_t count = 0;
  double interval = 0;  ///< [time]
  double since = 0;     ///< from the frame that is the packing to the first of them [time]
};

FlowFrames flow_frames(const Pipeline& pipeline, const FrameSource& source) {
  const auto from = std::get<std::int64_t>(given_options(pipeline).at("flow_from"));
  const std::vector<std::size_t> selected = select_frames(pipeline.frames, source.frames().size());
  std::vector<double> times;
  for (std::size_t k = rests_first(pipeline) ? 1 : 0; k < selected.size(); ++k) {
    const FrameInfo& frame = source.frames()[selected[k]];
    if (frame.step >= from && frame.time) times.push_back(*frame.time);
  }
  if (times.size() < 2)
    throw InputError({pipeline.location("measure.spot_calibration.flow_from"),
                      "there is no flow to compare with",
                      std::to_string(times.size()) + " frames with a time",
                      "at least two",
                      {}});
  const std::optional<double> packed = source.frames()[selected.front()].time;
  return {times.size(), (times.back() - times.front()) / static_cast<double>(times.size() - 1),
          times.front() - packed.value_or(times.front())};
}

/// Of runs that are made at the same time.
class SnapshotCount {
 public:
  explicit SnapshotCount(const std::function<void(std::size_t, std::size_t)>& progress) : progress_(progress) {}

  void expect(std::size_t more) { all_ = done_ + more; }
  void one_more() {
    if (!progress_) return;
    const std::lock_guard lock(one_at_a_time_);
    ++done_;
    progress_(done_, std::max(done_, all_));
  }

 private:
  const std::function<void(std::size_t, std::size_t)>& progress_;
  std::mutex one_at_a_time_;
  std::size_t done_ = 0, all_ = 0;
};

/// What the runs of all rounds share.
struct Comparison {
  const Pipeline& pipeline;
  FrameSource& source;
  const ComparisonOptions& options;
  FlowFrames flow;
  std::filesystem::path folder;
  SnapshotCount& snapshots;
};

// Without the grains above a height: what is measured lies below, and a run takes less.
void cut_off(SpotRun& run, double height) {
  const double top = run.container.box.lo[2] + height;
  if (!(top < run.container.box.hi[2])) return;
  run.container.box.hi[2] = top;
  Packing kept;
  kept.diameter = run.packing.diameter;
  for (std::size_t i = 0; i < run.packing.id.size(); ++i) {
    if (run.packing.position[i][2] > top) continue;
    kept.id.push_back(run.packing.id[i]);
    kept.position.push_back(run.packing.position[i]);
  }
  run.packing = std::move(kept);
}

// Pushes pack a flow more and more, so that it is compared at the age that the dumps have where these began with the
// packing; but not before spots have filled it.
double first_snapshot(const FlowFrames& flow, double height, double speed) {
  return std::ceil(std::max(filling * height / speed, flow.since) / flow.interval * (1 - 1e-12));
}

/// The run that a spot file says, for as long as is compared.
SpotRun comparison_run(const Comparison& all, const Table& parameters) {
  const std::string file = (all.folder / "spot.yaml").string();
  write_text_file(file, calibrated_spot_file(all.pipeline, parameters, all.source));
  SpotRun run = load_spot_run(file);
  if (all.options.height) cut_off(run, *all.options.height);
  run.interval = all.flow.interval;
  const double speed = run.parameters.hop_rate * run.parameters.step[2];
  const double first = first_snapshot(all.flow, run.container.box.length(2), speed);
  run.from = first * run.interval;
  run.end = (first + static_cast<double>(all.flow.count) - 1) * run.interval;
  return run;
}

SpotTruth truth_of(const SpotParameters& p) {
  return {p.radius, p.step[0] * p.step[0] / (2 * p.step[2]), p.influence, p.insertion_rate, p.hop_rate * p.step[2]};
}

/// As the dumps are measured.
SpotObservations measured(const Pipeline& of_dumps, const std::filesystem::path& folder) {
  Pipeline pipeline = of_dumps;
  pipeline.input = {};
  pipeline.input.particles = {(folder / "spot_*.dump").string()};
  pipeline.select.types.clear();  // a spot run has but one
  pipeline.species.clear();
  pipeline.walls.types.clear();
  pipeline.frames = {};
  if (!rests_first(of_dumps)) pipeline.frames.start = 1;
  pipeline.measure.at(measurement).at("flow_from") = std::int64_t{1};
  const Plan plan = make_plan(pipeline);
  const auto source = open_dumps(pipeline.input);
  const RunReport report = run_pipeline(pipeline, plan, *source, {});
  const auto table =
      std::find_if(report.tables.begin(), report.tables.end(), [](const Table& t) { return t.name == measurement; });
  return spot_observations(*table);
}

std::vector<SpotObservations> round_of_runs(const Comparison& all, const SpotRun& run, std::uint64_t first_seed) {
  std::vector<SpotObservations> seen(all.options.runs);
  tbb::parallel_for(std::size_t{0}, seen.size(), [&](std::size_t k) {
    const std::filesystem::path folder = all.folder / ("run_" + std::to_string(k));
    SpotRun own = run;
    own.seed = first_seed + k;
    run_spot(own, folder.string(), [&](std::size_t, std::size_t) { all.snapshots.one_more(); });
    // A thread that waits for parts of a measurement must not begin another run meanwhile.
    tbb::this_task_arena::isolate([&] { seen[k] = measured(all.pipeline, folder); });
    std::filesystem::remove_all(folder);
  });
  return seen;
}

[[noreturn]] void refuse_untold(const Pipeline& pipeline, const std::vector<std::string>& missing) {
  throw InputError({pipeline.location("measure.spot_calibration"),
                    "runs of the spot model with what the dumps say do not tell all that is compared",
                    listed(missing, [](const std::string& name) { return name; }), "numbers above 0 in each run",
                    "Compare longer runs, or take the direct estimates"});
}

/// What is observed, and what follows, in a table that has such numbers.
void replace_numbers(Table& table, const SpotObservations& by) {
  for (const Quantity& q : spot_quantities(by, spot_parameters(by)))
    for (Quantity& old : table.numbers)
      if (old.name == q.name) {
        old.value = q.value;
        old.error = q.error;
      }
}

// A flow that is a little too dense can make spots infinitely fast, or leave no speed.
SpotObservations within_reach(SpotObservations corrected, const SpotTruth& made) {
  double& speed = corrected.speed.value;
  speed = std::isfinite(speed) ? std::clamp(speed, made.speed / speed_reach, made.speed * speed_reach)
                               : made.speed * speed_reach;
  if (!std::isfinite(corrected.speed.error)) corrected.speed.error = speed;
  return corrected;
}

/// The parameters of a spot file.
constexpr std::array run_parameters{"radius", "step_side", "influence", "insertion_rate", "hop_rate"};

bool settled(const Table& before, const Table& now) {
  return std::all_of(run_parameters.begin(), run_parameters.end(), [&](const char* name) {
    const Quantity &old = number_of(before, name), &q = number_of(now, name);
    return std::abs(q.value - old.value) <= q.error;
  });
}

constexpr std::array<const char*, spot_observable_count> observables{"radius", "b", "diffusion_length", "outflow",
                                                                     "slowness"};
constexpr std::array<Dimension, spot_observable_count> dimensions{
    dimension::length, dimension::length, dimension::length, dimension::rate, Dimension{0, -1, 1}};

Table empty_result(const Table& direct) {
  Table t = direct;
  t.name = result_name;
  t.description = "parameters of the spot model that makes this flow, corrected by comparison with runs of it";
  t.equation = "what was seen, less what the same estimators make of known spots";
  t.remarks.clear();
  t.columns = {{"round", dimension::none, "of runs with the same parameters", {}},
               {"influence_made", dimension::none, "w of the run", {}},
               {"insertion_rate_made", dimension::rate, "lambda of the run", {}}};
  for (std::size_t i = 0; i < spot_observable_count; ++i) {
    const std::string name = observables[i];
    t.columns.push_back({name + "_made", dimensions[i], "what the run's parameters would be seen as", {}});
    t.columns.push_back({name + "_seen", dimensions[i], "what was seen of the run", {}});
  }
  return t;
}

void add_rows(Table& t, std::size_t round, const SpotTruth& made, const std::vector<double>& expected,
              const std::vector<SpotObservations>& runs) {
  for (const SpotObservations& run : runs) {
    const std::vector<double> seen = SpotComparison::observed(run);
    t.columns[0].values.push_back(static_cast<double>(round));
    t.columns[1].values.push_back(made.influence);
    t.columns[2].values.push_back(made.insertion_rate);
    for (std::size_t i = 0; i < spot_observable_count; ++i) {
      t.columns[3 + 2 * i].values.push_back(expected[i]);
      t.columns[4 + 2 * i].values.push_back(seen[i]);
    }
  }
}

void add_biases(Table& t, const std::vector<Estimate>& biases) {
  for (std::size_t i = 0; i < spot_observable_count; ++i) {
    const bool ratio = i + 1 < spot_observable_count;
    t.numbers.push_back({.name = std::string(observables[i]) + "_bias",
                         .value = biases[i].value,
                         .error = biases[i].error,
                         .dimension = ratio ? dimension::none : dimensions[i],
                         .description = ratio ? "what the estimator makes of known spots, over what is true"
                                              : "1/speed that the estimator makes of known spots, less what is true"});
  }
}

/// As long as was asked for, and how much longer that is than what the dumps have.
std::pair<FlowFrames, double> measured_frames(const FlowFrames& of_dumps, const std::optional<double>& duration) {
  if (!duration) return {of_dumps, 1};
  FlowFrames flow = of_dumps;
  flow.count = std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(*duration / flow.interval)) + 1);
  return {flow, static_cast<double>(flow.count) / static_cast<double>(of_dumps.count)};
}

void add_remarks(Table& t, bool has_settled) {
  if (!std::isfinite(number_of(t, "hop_rate").value))
    t.remarks.emplace_back(
        "The flow is denser than spots of any speed make it. Give a larger phi_at_rest for the direct estimate, or "
        "take that.");
  if (!has_settled)
    t.remarks.emplace_back("Parameters still changed by more than their errors in the last round: allow more of them.");
}

}  // namespace

Table calibrate_by_comparison(const Pipeline& pipeline, const Table& direct, FrameSource& source,
                              const ComparisonOptions& options, const std::string& folder,
                              const std::function<void(std::size_t, std::size_t)>& progress) {
  const auto [flow, duration_ratio] = measured_frames(flow_frames(pipeline, source), options.duration);
  const PassingFolder passing(folder);
  SnapshotCount snapshots(progress);
  const Comparison all{pipeline, source, options, flow, passing.path(), snapshots};
  SpotComparison comparison(spot_observations(direct));
  Table result = empty_result(direct), now = direct;
  bool has_settled = false;
  for (std::size_t round = 0; round < options.rounds && !has_settled; ++round) {
    const SpotRun run = comparison_run(all, now);
    snapshots.expect((options.rounds - round) * options.runs * (static_cast<std::size_t>(run.end / run.interval) + 1));
    const SpotTruth made = truth_of(run.parameters);
    const auto runs = round_of_runs(all, run, options.seed + round * options.runs);
    add_rows(result, round + 1, made, comparison.expected(made), runs);
    if (const auto missing = comparison.add_round(made, runs); !missing.empty()) refuse_untold(pipeline, missing);
    const SpotObservations corrected = comparison.corrected(duration_ratio);
    replace_numbers(result, corrected);
    has_settled = settled(now, result);
    replace_numbers(now, within_reach(corrected, made));
  }
  add_biases(result, comparison.biases());
  add_remarks(result, has_settled);
  OutputUnits(source.units(), std::nullopt).convert(result);
  return result;
}

}  // namespace grainvdb::spot
