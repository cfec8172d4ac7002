#include "pipeline/trace_run.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "grainvdb/error.hpp"
#include "pipeline/number.hpp"
#include "pipeline/schedule.hpp"
#include "pipeline/trace_start.hpp"

namespace grainvdb {
namespace {

/// The same field with the other sign, for tracers that go back in time.
SparseField negated(const SparseField& field, const Lattice& lattice) {
  SparseField result(field.meta(), field.topology(), lattice);
  for_each_leaf(*field.topology(), [&](std::size_t leaf) {
    for (int k = 0; k < field.components(); ++k)
      std::transform(field.leaf(leaf, k), field.leaf(leaf, k) + leaf_size, result.leaf(leaf, k), std::negate<>());
  });
  return result;
}

std::vector<FieldMeta> metas(const std::vector<const SparseField*>& fields) {
  std::vector<FieldMeta> all;
  for (const SparseField* field : fields) all.push_back(field->meta());
  return all;
}

double largest_speed(const SparseField& velocity) {
  double largest = 0;  // squared
  const Topology& topology = *velocity.topology();
  for (std::size_t l = 0; l < topology.leaf_count(); ++l)
    topology.mask(l).for_each([&](int v) {
      double sum = 0;
      for (int c = 0; c < 3; ++c) sum += std::pow(static_cast<double>(velocity.leaf(l, c)[v]), 2);
      if (sum > largest) largest = sum;  // not so for NaN
    });
  return std::sqrt(largest);
}

double largest(double so_far, const std::vector<double>& values) {
  for (const double v : values)
    if (v > so_far) so_far = v;  // not so for NaN
  return so_far;
}

}  // namespace

TraceRun::TraceRun(const Pipeline& pipeline, const FrameSource& source, const Lattice& lattice,
                   std::span<const std::size_t> wanted, const TracerSeeds& seeds, const Sinks& sinks)
    : pipeline_(pipeline),
      spec_(*pipeline.trace),
      sinks_(sinks),
      lattice_(lattice),
      units_(source.units(), pipeline.reduced),
      box_(trace_box(source, wanted)),
      seeds_(seeds),
      first_time_(time_of(source.frames()[wanted.front()])),
      last_time_(time_of(source.frames()[wanted.back()])),
      outputs_(windows_of(pipeline, wanted).size()) {
  report_.limits = spec_.limits;
  report_.through_frames = spec_.through == TraceSpec::Through::frames;
  report_.tracers = seeds_.size();
}

TraceRun::~TraceRun() = default;

void TraceRun::take(const OutputFields& output) {
  if (report_.through_frames) {
    take_frame(output);
  } else {
    take_mean(output);
  }
  ++taken_;
}

void TraceRun::take_mean(const OutputFields& output) {
  const Flow flow(flow_grid(output));
  tracers_.emplace(seeds_, box_, flow, 0.0, settings());
  start(output);
  const double duration = spec_.duration.value_or(last_time_ - first_time_);
  end_time_ = duration;
  fastest_ = neighbourhood_ != nullptr ? largest_speed(output.fields.at("velocity")) : 0;
  const double dt = spec_.dt.value_or(duration / static_cast<double>(spec_.steps.value_or(1)));
  const double steps = std::max(1.0, std::ceil(duration / dt * (1 - 1e-9)));
  if (steps > 1e9)
    throw ConfigError({pipeline_.location("trace.dt"), "the trace has too many steps", print_number(steps),
                       "at most 1e9 steps", "Take a longer trace.dt or a shorter trace.duration"});
  const auto last = static_cast<std::int64_t>(steps);
  for (std::int64_t step = 0; step < last;) {
    step = std::min(step + spec_.every, last);
    move(flow, step == last ? duration : static_cast<double>(step) * dt);
    record(output, step);
  }
}

void TraceRun::take_frame(const OutputFields& output) {
  // Backwards, tracers see the time run from the latest frame on.
  const double time = backward() ? last_time_ - output.time.time : output.time.time;
  // Where frames were left out there may be nothing, or nothing new: tracers go on to the next output time.
  if (output.time.frame_count == 0 || (previous_ && !(time > previous_time_))) return;
  std::shared_ptr<const FlowGrid> now = flow_grid(output);
  const double fastest = neighbourhood_ != nullptr ? largest_speed(output.fields.at("velocity")) : 0;
  fastest_ = std::max(std::exchange(fastest_now_, fastest), fastest);
  if (!previous_) {
    end_time_ = backward() ? last_time_ - first_time_ : last_time_;
    tracers_.emplace(seeds_, box_, Flow(now), time, settings());
    start(output);
  } else {
    move(Flow(previous_, previous_time_, now, time), time);
    const bool is_last = taken_ + 1 == outputs_;
    if (is_last || taken_ % static_cast<std::size_t>(spec_.every) == 0)
      record(output, backward() ? static_cast<std::int64_t>(taken_) : output.time.last_step);
  }
  previous_ = std::move(now);
  previous_time_ = time;
}

std::shared_ptr<const FlowGrid> TraceRun::flow_grid(const OutputFields& output) const {
  const SparseField& velocity = output.fields.at("velocity");
  const SparseField* const shear_rate = spec_.strain ? &output.fields.at("shear_rate") : nullptr;
  if (!backward()) return std::make_shared<FlowGrid>(lattice_, velocity, shear_rate, spec_.interpolation);
  return std::make_shared<FlowGrid>(lattice_, negated(velocity, lattice_), shear_rate, spec_.interpolation);
}

TracerSettings TraceRun::settings() const {
  TracerSettings settings;
  settings.on_undefined = spec_.on_undefined;
  settings.step_numbers = true;
  settings.limits = spec_.limits;
  if (spec_.scheme == TraceSpec::Scheme::adaptive) {
    AdaptiveSteps adaptive{*spec_.tolerance};
    if (spec_.dt) adaptive.longest = *spec_.dt;
    settings.stepping = adaptive;
    return settings;
  }
  const double duration = spec_.duration.value_or(last_time_ - first_time_);  // through frames: one step between two
  settings.stepping = FixedSteps{spec_.dt.value_or(duration / static_cast<double>(spec_.steps.value_or(1)))};
  return settings;
}

void TraceRun::start(const OutputFields& output) {
  const auto& stops = tracers_->state().stop;
  if (std::none_of(stops.begin(), stops.end(), [](TracerStop s) { return s == TracerStop::moving; }))
    throw ConfigError({pipeline_.location("trace.seeds"), "no seed of a tracer lies in the material",
                       std::to_string(stops.size()) + " seeds", "places that the kernel reaches from a particle",
                       "'grainvdb info' shows where the particles are"});
  RecordedColumns columns;
  columns.fields = metas(recorded(output));
  columns.strain = spec_.strain;
  columns.step_numbers = true;
  recorder_.emplace(*tracers_, lattice_, columns, spec_.interpolation);
  for (const auto& sink : sinks_) sink->begin(layout(output));
  record(output, report_.through_frames && !backward() ? output.time.last_step : 0);
}

void TraceRun::stay_in(TraceNeighbourhood& neighbourhood) {
  neighbourhood_ = &neighbourhood;
  for (std::size_t i = 0; i < seeds_.size(); ++i) {
    Vec3 x{};
    bool inside = true;
    for (std::size_t a = 0; a < 3; ++a) {
      x[a] = seeds_.position[a][i];
      inside = inside && (box_.periodic[a] || (x[a] >= box_.lo[a] && x[a] <= box_.hi[a]));
    }
    if (inside) neighbourhood.add(x, leaf_edge);
  }
}

/// A step goes no further than the greatest speed takes it, at any of its stages; splines may overshoot by half, and
/// voxels up to two away are sampled.
void TraceRun::keep_near(const Flow& flow, double until) {
  const TracerState& state = tracers_->state();
  const double overshoot = spec_.interpolation == Interpolation::tricubic ? 2 : 1;
  const double reach = 2 + overshoot * fastest_ * (until - tracers_->time()) / lattice_.voxel();
  const auto place = [&](std::size_t i) {
    return Vec3{state.position[0][i], state.position[1][i], state.position[2][i]};
  };
  bool all = true;
  for (std::size_t i = 0; i < tracers_->size() && all; ++i)
    all = state.stop[i] != TracerStop::moving || neighbourhood_->holds(place(i), reach);
  if (all) return;
  if (reach > TraceNeighbourhood::widest) throw LeftNeighbourhood{.grew = false};
  const double rest = end_time_ - tracers_->time();
  for (std::size_t i = 0; i < tracers_->size(); ++i) {
    if (state.stop[i] != TracerStop::moving) continue;
    neighbourhood_->add(place(i), reach);
    if (const auto value = flow.first().at(place(i)))
      neighbourhood_->add_way(place(i),
                              {rest * value->velocity[0], rest * value->velocity[1], rest * value->velocity[2]});
  }
  neighbourhood_->end_growth();
  throw LeftNeighbourhood{.grew = true};
}

void TraceRun::found_nearby(std::size_t passes, double share) {
  report_.nearby_passes = passes;
  report_.nearby_share = share;
}

void TraceRun::move(const Flow& flow, double until) {
  if (neighbourhood_ != nullptr) keep_near(flow, until);
  const TracerState& state = tracers_->state();
  report_.moves += static_cast<std::size_t>(std::count(state.stop.begin(), state.stop.end(), TracerStop::moving));
  const AdvanceReport done = tracers_->advance(flow, until);
  report_.steps += done.steps;
  report_.above_courant_limit += done.above_courant_limit;
  report_.above_gradient_limit += done.above_gradient_limit;
  report_.largest_courant = largest(report_.largest_courant, state.courant);
  report_.largest_gradient_number = largest(report_.largest_gradient_number, state.gradient_number);
}

void TraceRun::record(const OutputFields& output, std::int64_t step) {
  const TracerSample& sample =
      in_output_units(recorder_->record(*tracers_, recorded(output), &output.mask, step), output);
  for (const auto& sink : sinks_) sink->write(sample);
  ++report_.samples;
}

const TracerSample& TraceRun::in_output_units(const TracerSample& sample, const OutputFields& output) {
  if (!units_.reduced()) return sample;
  written_ = sample;
  units_.convert(written_, metas(recorded(output)));
  return written_;
}

std::vector<const SparseField*> TraceRun::recorded(const OutputFields& output) const {
  std::vector<const SparseField*> fields;
  for (const std::string& name : spec_.record) fields.push_back(&output.fields.at(name));
  return fields;
}

TracerLayout TraceRun::layout(const OutputFields& output) const {
  TracerLayout layout;
  layout.id = seeds_.id;
  layout.box = units_.converted(box_);
  for (const FieldMeta& meta : metas(recorded(output))) layout.fields.push_back(units_.converted(meta));
  layout.length_unit = units_.symbol(dimension::length);
  layout.time_unit = units_.symbol(dimension::time);
  layout.unit_system = units_.system();
  if (report_.through_frames && !backward()) {
    layout.time_meaning = "time of the simulation";
  } else {
    layout.time_meaning =
        std::string("time ") + (backward() ? "back " : "") + "from the start" +
        (report_.through_frames ? ", at " + print_number(units_.converted(last_time_, dimension::time))
                                : " through the time mean");
  }
  return layout;
}

void TraceRun::commit(Provenance provenance) {
  if (report_.through_frames && report_.samples < 2)
    throw InputError({{pipeline_.file, 0},
                      "tracers need two output times, and bad frames have left one",
                      {},
                      "two frames that can be used",
                      {}});
  report_.undefined = recorder_->undefined();
  for (const TracerStop stop : tracers_->state().stop) ++report_.ended[stop];
  std::string text;
  for (const std::string& line : describe(report_)) text += line + '\n';
  provenance.emplace_back("trace", text);
  for (const auto& sink : sinks_) {
    sink->commit(provenance);
    for (const std::string& file : sink->files()) report_.files.push_back(file);
  }
}

}  // namespace grainvdb
