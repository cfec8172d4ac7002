#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "grainvdb/run.hpp"
#include "grainvdb/tune.hpp"
#include "tune/measured_run.hpp"
#include "tune/nine_digits.hpp"
#include "tune/profile_error.hpp"
#include "tune/runs_stage.hpp"

namespace grainvdb {
namespace {

/// Voxels of about these multiples of the current size. Where the box is periodic they must divide its lengths, which
/// the current size does: h · g/m for whole m, g the greatest common divisor of the numbers of voxels.
Knob voxel_knob(const Pipeline& pipeline, const Lattice& lattice) {
  int common = 0;
  for (int a = 0; a < 3; ++a)
    if (const auto& period = lattice.period(a)) common = std::gcd(common, period->count);
  Knob knob{"lattice.voxel", {}};
  std::set<double> seen{pipeline.voxel};
  for (double factor : {2.0, 1.5, 0.75, 0.5}) {
    const double fitting = common == 0 ? factor : common / std::max(1.0, std::round(common / factor));
    if (const double voxel = fitting * pipeline.voxel; seen.insert(voxel).second)
      knob.values.push_back(nine_digits(voxel));
  }
  return knob;
}

/// Every second and every fourth of the selected frames.
Knob frame_knob(const Pipeline& pipeline, std::size_t frames) {
  const auto text = [](const std::optional<std::int64_t>& i) { return i ? std::to_string(*i) : std::string(); };
  Knob knob{"frames", {}};
  for (std::size_t factor : {2, 4})
    if (frames > factor)
      knob.values.push_back(text(pipeline.frames.start) + ':' + text(pipeline.frames.stop) + ':' +
                            std::to_string(pipeline.frames.step * static_cast<std::int64_t>(factor)));
  return knob;
}

/// The choices of a stage's option, less the current one and those that `left_out` names.
Knob option_knob(const Pipeline& pipeline, const std::string& stage, const std::string& name,
                 const std::set<std::string>& left_out) {
  Knob knob{"stages." + stage + '.' + name, {}};
  for (const OptionInfo& o : StageRegistry::standard().find(stage)->options)
    if (o.name == name)
      for (const std::string& choice : o.choices)
        if (choice != option<std::string>(pipeline.stages, stage, name) && !left_out.contains(choice))
          knob.values.push_back(choice);
  return knob;
}

Knob accumulation_knob(const Pipeline& pipeline) {
  Knob knob{"kernel.accumulation", {}};
  for (const auto& [text, way] : {std::pair{"float", Accumulation::single}, std::pair{"shifted", Accumulation::shifted},
                                  std::pair{"double", Accumulation::twofold}})
    if (way != pipeline.accumulation) knob.values.emplace_back(text);
  return knob;
}

Knob interpolation_knob(const TraceSpec& trace) {
  return {"trace.interpolation", {trace.interpolation == Interpolation::trilinear ? "cubic" : "trilinear"}};
}

}  // namespace

std::vector<Knob> default_knobs(const Pipeline& pipeline, const Plan& plan, FrameSource& source) {
  std::vector<Knob> knobs{voxel_knob(pipeline, checked_lattice_of(pipeline, plan, source))};
  const auto add = [&](const std::string& stage, const std::string& name, const std::set<std::string>& left_out) {
    if (runs_stage(plan, stage)) knobs.push_back(option_knob(pipeline, stage, name, left_out));
  };
  // Rules of more points than five are as slow as `adaptive`, and no more exact where that counts.
  add("contact_stress", "line_integral", {"gauss4", "gauss6", "gauss7", "gauss8"});
  add("kinetic_stress", "reference", {"instantaneous"});  // another stress, not another way to the same
  for (const char* stage : {"temperature", "rotational_fluctuation"})
    for (const char* name : {"mode", "self_weight"}) add(stage, name, {});
  for (const char* stage : {"velocity_gradient", "angular_velocity_gradient"}) add(stage, "method", {});
  if (!plan.sweeps.empty()) knobs.push_back(accumulation_knob(pipeline));
  if (pipeline.trace) knobs.push_back(interpolation_knob(*pipeline.trace));
  if (!profile_quantities(pipeline, source).empty())
    if (const auto knob = profile_knob(pipeline)) knobs.push_back(*knob);
  knobs.push_back(frame_knob(pipeline, select_frames(pipeline.frames, source.frames().size()).size()));
  std::erase_if(knobs, [](const Knob& k) { return k.values.empty(); });
  return knobs;
}

}  // namespace grainvdb
