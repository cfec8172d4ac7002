#include "pipeline/trace_schema.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/tracer_sink.hpp"
#include "pipeline/key_builders.hpp"
#include "pipeline/species_keys.hpp"

namespace grainvdb {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TraceSpec& trace_of(Pipeline& pipeline) {
  if (!pipeline.trace) pipeline.trace.emplace();
  return *pipeline.trace;
}

SeedSpec::Grid& grid_of(Pipeline& pipeline) {
  auto& grid = trace_of(pipeline).seeds.grid;
  if (!grid) grid.emplace();
  return *grid;
}

SeedSpec::OnParticles& particles_of(Pipeline& pipeline) {
  auto& particles = trace_of(pipeline).seeds.particles;
  if (!particles) particles.emplace();
  return *particles;
}

/// A key that names one value of an enumeration; the first is the default.
template <class T>
KeyInfo choice_key(std::string name, std::string help, std::vector<std::pair<std::string, T>> values,
                   T TraceSpec::*member) {
  KeyInfo key{"trace", std::move(name), ValueType::text, std::move(help)};
  for (const auto& [text, value] : values) key.choices.push_back(text);
  key.default_value = key.choices.front();
  key.apply = [values = std::move(values), member](Pipeline& p, const ConfigValue& v) {
    for (const auto& [text, value] : values)
      if (text == std::get<std::string>(v)) trace_of(p).*member = value;
  };
  return key;
}

void add_seeds(Schema& schema) {
  schema.sections.push_back({"trace.seeds", "Where tracers start: grid, points or particles.", true});
  auto points = vector_key("trace.seeds", "points", "A list of places.", [](Pipeline& p, const ConfigValue& v) {
    trace_of(p).seeds.points = std::get<std::vector<Vec3>>(v);
  });
  points.type = ValueType::points;
  points.fewest = 1;
  points.most = std::numeric_limits<std::size_t>::max();
  schema.keys.push_back(points);

  schema.sections.push_back({"trace.seeds.grid",
                             "A regular grid over a box, or over a plane or line where lo equals hi along some axes.",
                             false, true});
  auto lo = vector_key("trace.seeds.grid", "lo", "Lower corner; -.inf is the side of the box.",
                       [](Pipeline& p, const ConfigValue& v) { grid_of(p).lo = vector_of(v); });
  lo.default_value = std::vector<double>(3, -infinity);
  auto hi = vector_key("trace.seeds.grid", "hi", "Upper corner; .inf is the side of the box.",
                       [](Pipeline& p, const ConfigValue& v) { grid_of(p).hi = vector_of(v); });
  hi.default_value = std::vector<double>(3, infinity);
  lo.infinite_allowed = hi.infinite_allowed = true;
  schema.keys.push_back(lo);
  schema.keys.push_back(hi);
  auto spacing = vector_key("trace.seeds.grid", "spacing", "Distance between seeds: one number, or one per axis.",
                            [](Pipeline& p, const ConfigValue& v) { grid_of(p).spacing = vector_of(v); });
  spacing.required = true;
  spacing.one_for_all = true;
  spacing.minimum = 0;
  spacing.above_minimum = true;
  schema.keys.push_back(spacing);

  schema.sections.push_back(
      {"trace.seeds.particles", "On material particles of the first frame: give ids, or every.", false, true});
  KeyInfo ids{"trace.seeds.particles", "ids", ValueType::integers, "Ids of the particles."};
  ids.apply = [](Pipeline& p, const ConfigValue& v) { particles_of(p).ids = std::get<std::vector<std::int64_t>>(v); };
  schema.keys.push_back(ids);
  KeyInfo every{"trace.seeds.particles", "every", ValueType::integer, "Every n-th particle in ascending order of id."};
  every.minimum = 1;
  every.apply = [](Pipeline& p, const ConfigValue& v) {
    particles_of(p).every = static_cast<std::size_t>(std::get<std::int64_t>(v));
  };
  schema.keys.push_back(every);
}

void add_motion(Schema& schema) {
  using Spec = TraceSpec;
  schema.keys.push_back(choice_key<Spec::Through>(
      "through",
      "What carries tracers: the mean of all frames, or the output times with straight lines in time between them.",
      {{"mean", Spec::Through::mean}, {"frames", Spec::Through::frames}}, &Spec::through));
  schema.keys.push_back(
      choice_key<Spec::Scheme>("scheme", "Runge-Kutta steps of order 4, or the embedded pair 3(2) with a tolerance.",
                               {{"rk4", Spec::Scheme::rk4}, {"adaptive", Spec::Scheme::adaptive}}, &Spec::scheme));
  schema.keys.push_back(choice_key<Interpolation>(
      "interpolation", "How the velocity between voxel centres is formed.",
      {{"trilinear", Interpolation::trilinear}, {"cubic", Interpolation::tricubic}}, &Spec::interpolation));
  schema.keys.push_back(choice_key<Spec::Direction>(
      "direction", "Where the material goes to, or where it came from.",
      {{"forward", Spec::Direction::forward}, {"backward", Spec::Direction::backward}}, &Spec::direction));
  schema.keys.push_back(number_key("trace", "dt", "time",
                                   "Longest step. Through the mean, samples are taken at multiples of it.",
                                   [](Pipeline& p, const ConfigValue& v) { trace_of(p).dt = std::get<double>(v); }));
  KeyInfo steps{"trace", "steps", ValueType::integer, "Number of steps over the duration, in place of dt."};
  steps.minimum = 1;
  steps.maximum = 1e9;
  steps.apply = [](Pipeline& p, const ConfigValue& v) { trace_of(p).steps = std::get<std::int64_t>(v); };
  schema.keys.push_back(steps);
  schema.keys.push_back(
      number_key("trace", "duration", "time",
                 "How long tracers move through the mean; by default from the first frame to the last.",
                 [](Pipeline& p, const ConfigValue& v) { trace_of(p).duration = std::get<double>(v); }));
  schema.keys.push_back(
      number_key("trace", "tolerance", "length", "Error of a step that the adaptive scheme allows along each axis.",
                 [](Pipeline& p, const ConfigValue& v) { trace_of(p).tolerance = std::get<double>(v); }));
}

/// A limit beyond which histories through frames are said to mean nothing.
KeyInfo limit_key(std::string name, std::string of, double StepLimits::*limit) {
  KeyInfo key =
      number_key("trace", std::move(name), "",
                 "Limit of " + std::move(of) +
                     " between frames, above which the run says that histories through frames mean nothing.",
                 [limit](Pipeline& p, const ConfigValue& v) { trace_of(p).limits.*limit = std::get<double>(v); });
  key.default_value = StepLimits{}.*limit;
  key.hint.clear();
  return key;
}

void add_record(Schema& schema, const StageRegistry& registry) {
  std::vector<std::string> fields;
  for (const Stage& stage : registry.stages())
    if (stage.name != "mask") fields.push_back(stage.name);
  auto record =
      texts_key("trace", "record", "Fields that are recorded along the way.", fields,
                [](Pipeline& p, const ConfigValue& v) { trace_of(p).record = std::get<std::vector<std::string>>(v); });
  record.hint = hint_at_species(registry);
  record.name_pattern = pattern_of_species(registry);
  record.fewest = 0;
  record.default_value = std::vector<std::string>{};
  schema.keys.push_back(record);
  KeyInfo strain{"trace", "strain", ValueType::boolean, "Whether the accumulated strain, ∫|γ̇|dt, is recorded."};
  strain.default_value = true;
  strain.apply = [](Pipeline& p, const ConfigValue& v) { trace_of(p).strain = std::get<bool>(v); };
  schema.keys.push_back(strain);
  schema.keys.push_back(choice_key<OnUndefined>(
      "on_undefined", "What becomes of a tracer where a recorded quantity is undefined: it stops, or records NaN.",
      {{"stop", OnUndefined::stop}, {"carry_on", OnUndefined::carry_on}}, &TraceSpec::on_undefined));
  KeyInfo every{"trace", "every", ValueType::integer, "Steps, or output times, from one sample to the next."};
  every.minimum = 1;
  every.default_value = std::int64_t{1};
  every.apply = [](Pipeline& p, const ConfigValue& v) { trace_of(p).every = std::get<std::int64_t>(v); };
  schema.keys.push_back(every);
  std::vector<std::string> formats;
  for (const TracerSinkInfo& sink : tracer_sink_registry()) formats.push_back(sink.name);
  auto format = texts_key("trace", "formats", "File formats.", formats, [](Pipeline& p, const ConfigValue& v) {
    trace_of(p).formats = std::get<std::vector<std::string>>(v);
  });
  format.default_value = std::vector<std::string>{"h5md"};
  schema.keys.push_back(format);
  using Neighbourhood = TraceSpec::Neighbourhood;
  schema.keys.push_back(choice_key<Neighbourhood>(
      "neighbourhood",
      "Whether only what tracers may come to is splatted, in two passes or more over the frames, where neither fields "
      "are written nor a region is given: auto goes by cost.",
      {{"auto", Neighbourhood::automatic}, {"always", Neighbourhood::always}, {"never", Neighbourhood::never}},
      &TraceSpec::neighbourhood));
}

void check_seeds(const Pipeline& p) {
  const SeedSpec& seeds = p.trace->seeds;
  const int kinds = (seeds.grid ? 1 : 0) + (seeds.points.empty() ? 0 : 1) + (seeds.particles ? 1 : 0);
  if (kinds != 1)
    throw ConfigError({p.location("trace.seeds"),
                       kinds == 0 ? "the seeds of the tracers are missing" : "the seeds are given in more than one way",
                       {},
                       "one of trace.seeds.grid, trace.seeds.points and trace.seeds.particles",
                       {}});
  if (seeds.grid)
    for (int a = 0; a < 3; ++a)
      if (!(seeds.grid->lo[a] <= seeds.grid->hi[a]) || seeds.grid->lo[a] == infinity || seeds.grid->hi[a] == -infinity)
        throw ConfigError({p.location("trace.seeds.grid"),
                           std::string("trace.seeds.grid is turned round along ") + "xyz" [a],
                           {},
                           "lo <= hi",
                           {}});
  const bool ids = p.where.contains("trace.seeds.particles.ids"),
             every = p.where.contains("trace.seeds.particles.every");
  if (seeds.particles && ids == every)
    throw ConfigError({p.location("trace.seeds.particles"),
                       ids ? "the particles are given in two ways" : "the particles are missing",
                       {},
                       "either trace.seeds.particles.ids or trace.seeds.particles.every",
                       {}});
}

}  // namespace

void add_trace(Schema& schema, const StageRegistry& registry) {
  schema.sections.push_back(
      {"trace", "Points that move with the material, and what they meet on their way.", false, true});
  add_seeds(schema);
  add_motion(schema);
  schema.keys.push_back(limit_key("courant_limit", "Co = |u|Δt/h", &StepLimits::courant));
  schema.keys.push_back(limit_key("gradient_limit", "K = |∇u|Δt", &StepLimits::gradient_number));
  add_record(schema, registry);
}

void check_trace(const Pipeline& p) {
  if (!p.trace) return;
  check_seeds(p);
  const TraceSpec& trace = *p.trace;
  const bool adaptive = trace.scheme == TraceSpec::Scheme::adaptive;
  const bool mean = trace.through == TraceSpec::Through::mean;
  const auto refuse = [&](const char* key, const char* what, const char* expected, const char* hint) {
    throw ConfigError({p.location(key), what, {}, expected, hint});
  };
  if (adaptive && !trace.tolerance)
    refuse("trace.scheme", "the adaptive scheme needs a tolerance", "trace.tolerance, a length",
           "A thousandth of a voxel is a good start.");
  if (!adaptive && trace.tolerance)
    refuse("trace.tolerance", "steps of rk4 have no tolerance", "trace.scheme: adaptive, or no tolerance", "");
  if (trace.dt && trace.steps) refuse("trace.steps", "the step is given twice", "either trace.dt or trace.steps", "");
  if (mean && !trace.dt && !trace.steps)
    refuse("trace", "the step of the tracers is missing", "trace.dt, a time, or trace.steps, their number",
           "Half a voxel at the greatest velocity is a good start.");
  if (!mean && trace.duration)
    refuse("trace.duration", "through frames, tracers move from the first frame to the last",
           "no duration; or trace.through: mean", "Choose frames with 'frames'.");
  if (!mean && trace.steps)
    refuse("trace.steps", "through frames, steps are not counted over a duration", "trace.dt, a time, or neither",
           "Without dt there is one step between two output times.");
  if (!mean && trace.direction == TraceSpec::Direction::backward && p.input.on_error != OnError::error)
    refuse("trace.direction", "frames that may be left out cannot be followed back in time",
           "input.on_error: error, or trace.direction: forward", "");
  if (!mean && trace.direction == TraceSpec::Direction::backward &&
      trace.neighbourhood == TraceSpec::Neighbourhood::always)
    refuse("trace.neighbourhood", "tracers that go back through frames need whole grids",
           "trace.neighbourhood: auto or never", "");
  if (mean && p.window != 0)
    refuse("average.window", "tracers through the mean need one mean of all frames",
           "average.window: all, or trace.through: frames", "");
}

}  // namespace grainvdb
