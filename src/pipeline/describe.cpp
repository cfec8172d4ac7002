#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "base/listed.hpp"
#include "grainvdb/measurement.hpp"
#include "grainvdb/memory_model.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/units.hpp"
#include "pipeline/measure_needs.hpp"
#include "pipeline/number.hpp"
#include "pipeline/plane_runs.hpp"
#include "pipeline/species.hpp"
#include "pipeline/wall_domain.hpp"
#include "pipeline/wall_schema.hpp"

namespace grainvdb {
namespace {

constexpr ColumnSet every_column() {
  return Column::velocity | Column::angular_velocity | Column::radius | Column::mass | ColumnSet(Column::type) |
         Column::contacts;
}

/// What there is to read, contacts with walls only where the input has them.
std::vector<std::string> columns_there(const Pipeline& pipeline) {
  const bool walls = !pipeline.input.wall_contacts.files.empty();
  return column_names(walls ? every_column() | Column::wall_contacts : every_column());
}

std::string joined(const std::vector<std::string>& names, const char* none) {
  return names.empty() ? none : listed(names);
}

std::string counted(std::size_t n, const std::string& noun) {
  return std::to_string(n) + ' ' + noun + (n == 1 ? "" : "s");
}

const char* kind_name(Moment::Kind kind) {
  switch (kind) {
    case Moment::Kind::particles:
      return "splat of particles";
    case Moment::Kind::particle_squares:
      return "splat of particles with the square of the kernel";
    case Moment::Kind::particle_gradients:
      return "splat of particles with the kernel's gradient";
    case Moment::Kind::second_moments:
      return "splat of particles with the second moments of velocity and place";
    case Moment::Kind::contacts:
      return "splat of contacts";
    case Moment::Kind::voxels:
      break;
  }
  return "computed from the above, voxel by voxel";
}

// Before a dump has been opened the unit system may be unknown; units are then powers of mass, length and time.
std::string unit_symbol(const Pipeline& pipeline, const Dimension& dimension) {
  static const UnitSystem any{"", "mass", "length", "time"};
  const UnitSystem* system = pipeline.input.units ? find_unit_system(*pipeline.input.units) : nullptr;
  return (system != nullptr ? *system : any).symbol(dimension);
}

std::vector<std::string> names_of(const std::vector<MomentPtr>& moments) {
  std::vector<std::string> names;
  for (const MomentPtr& moment : moments) names.push_back(moment->name);
  return names;
}

std::vector<std::string> names_of(const std::vector<const Stage*>& stages) {
  std::vector<std::string> names;
  for (const Stage* stage : stages) names.push_back(stage->name);
  return names;
}

bool is_written(const Pipeline& pipeline, const Stage& stage) {
  return std::find(pipeline.fields.begin(), pipeline.fields.end(), stage.name) != pipeline.fields.end();
}

std::string describe_sweep(const Sweep& sweep) {
  std::string text = "  reads " + joined(column_names(sweep.columns), "nothing") + '\n';
  for (std::size_t p = 0; p < sweep.passes.size(); ++p) {
    text += "  pass " + std::to_string(p + 1) + " over each frame\n";
    for (const MomentPtr& moment : sweep.passes[p]) {
      text += "    " + moment->name + ": " + counted(static_cast<std::size_t>(moment->channels), "channel") + ", " +
              kind_name(moment->kind);
      if (!moment->frame_needs.empty()) text += "; from " + joined(names_of(moment->frame_needs), "") + " of the frame";
      if (!moment->mean_needs.empty()) text += "; from the time mean of " + joined(names_of(moment->mean_needs), "");
      text += '\n';
    }
  }
  return text;
}

std::vector<std::string> columns_not_read(const Plan& plan, const Pipeline& pipeline) {
  const std::vector<std::string> read = column_names(columns_read(plan, pipeline));
  std::vector<std::string> rest;
  for (const std::string& name : columns_there(pipeline))
    if (std::find(read.begin(), read.end(), name) == read.end()) rest.push_back(name);
  return rest;
}

std::string corner_text(const Vec3& x) {
  return '(' + print_number(x[0]) + ", " + print_number(x[1]) + ", " + print_number(x[2]) + ')';
}

std::string frame_text(const Pipeline& pipeline) {
  const FrameRange& r = pipeline.frames;
  if (!r.start && !r.stop && r.step == 1) return "all";
  return (r.start ? std::to_string(*r.start) : "") + ':' + (r.stop ? std::to_string(*r.stop) : "") + ':' +
         std::to_string(r.step);
}

std::string wall_text(const WallSpec& walls) {
  if (walls.kernel == WallSpec::Kernel::cut) return {};
  std::string text = "walls: ";
  if (walls.kernel == WallSpec::Kernel::renormalise) text += "sums divided by the part of the kernel inside of\n";
  if (walls.kernel == WallSpec::Kernel::mirror) text += "mirror images of grains and contacts behind\n";
  if (walls.kernel == WallSpec::Kernel::mask)
    text += "voxels masked whose kernel comes nearer than " +
            (walls.clearance ? print_number(*walls.clearance) : std::string("1.5 radii of the largest grain")) +
            " to\n";
  const WallDomain domain(walls.surfaces);
  for (const Wall& wall : domain.walls()) text += "  " + to_string(wall) + '\n';
  for (const BoxFace& face : walls.faces) text += "  face " + face_name(face) + " of the box\n";
  return text;
}

std::string window_text(const Pipeline& pipeline) {
  if (pipeline.window == 0) return "averaged over all of them";
  std::string text =
      pipeline.window == 1 ? "each by itself" : "averaged over windows of " + counted(pipeline.window, "frame");
  if (pipeline.window_step > 0) text += ", one every " + counted(pipeline.window_step, "frame");
  return text;
}

std::string trace_text(const TraceSpec& trace) {
  const bool adaptive = trace.scheme == TraceSpec::Scheme::adaptive;
  std::string text = "traced: through the ";
  text += trace.through == TraceSpec::Through::mean ? "time mean" : "output times";
  if (trace.direction == TraceSpec::Direction::backward) text += ", back in time";
  text += adaptive ? ", by steps of order 3(2)" : ", by Runge-Kutta steps of order 4";
  text += ", recording " + joined(trace.record, "no field") + (trace.strain ? " and the strain" : "");
  return text + ", as " + joined(trace.formats, "nothing") + '\n';
}

std::string planes_text(const PlaneNeeds& needs) {
  return "exact averages over planes normal to " + std::string(1, "xyz"[needs.planes.axis]) + " of " +
         joined(needs.fields, "");
}

/// Of the passes for averages over planes, which come one after another behind that for fields.
std::string plane_memory_text(const Pipeline& pipeline) {
  std::string text;
  for (const PlaneRun& run : plane_runs(pipeline)) {
    const MemoryModel memory = memory_model(run.plan, run.pipeline);
    text += "peak memory of averages over planes normal to " + std::string(1, "xyz"[run.pipeline.planes->axis]) + ": " +
            to_string(memory) + "\n  " + symbols(memory) + ", 64 for each plane\n";
  }
  return text;
}

std::string measure_text(const Pipeline& pipeline) {
  std::string text;
  for (const auto& [name, options] : pipeline.measure) {
    const MeasurementInfo& info = *find_measurement(name);
    const MeasurementNeeds needs = info.needs(options);
    text += "measured: " + name + ": " + info.equation + "; from ";
    if (needs.particles) text += joined(column_names(*needs.particles), "") + " of every frame";
    if (needs.particles && !needs.fields.empty()) text += " and ";
    if (!needs.fields.empty()) text += joined(needs.fields, "");
    if (needs.planes) text += (needs.particles ? " and " : "") + planes_text(*needs.planes);
    text += '\n';
  }
  return text;
}

}  // namespace

std::string describe(const Plan& plan, const Pipeline& pipeline) {
  std::string text = "pipeline " + pipeline.file + '\n';
  if (pipeline.region)
    text += "region: " + corner_text(pipeline.region->first) + " to " + corner_text(pipeline.region->second) + '\n';
  for (const Species& species : pipeline.species) text += "species " + to_string(species) + '\n';
  text += wall_text(pipeline.walls);
  text += "frames: " + frame_text(pipeline) + "; " + window_text(pipeline) + "\n\n";
  for (std::size_t s = 0; s < plan.sweeps.size(); ++s) {
    text += "sweep " + std::to_string(s + 1) + " of " + std::to_string(plan.sweeps.size()) + '\n';
    text += describe_sweep(plan.sweeps[s]);
  }

  if (!plan.stages.empty()) text += "\nstages, in order\n";
  for (const Stage* stage : plan.stages)
    text += "  " + stage->name + " [" + unit_symbol(pipeline, stage->dimension) + "]: " + stage->equation +
            (is_written(pipeline, *stage) ? "" : " (not written)") + '\n';

  if (!plan.stages.empty()) text += "\ntime means kept: " + joined(names_of(plan.means), "none") + '\n';
  if (!plan.errors.by_block.empty())
    text += "standard errors: from sums over " + (pipeline.until ? "up to " : std::string()) +
            counted(pipeline.until ? 2 * pipeline.blocks : pipeline.blocks, "block") + " of frames; derived again " +
            "without each: " + joined(names_of(plan.errors.by_block), "none") + '\n';
  if (!plan.stages.empty()) {
    const MemoryModel memory = memory_model(plan, pipeline);
    text += "peak memory: " + to_string(memory) + "\n  " + symbols(memory) + '\n';
  }
  text += plane_memory_text(pipeline);
  text += "written: " + joined(pipeline.fields, "nothing") + " as " + joined(pipeline.formats, "nothing") + '\n';
  if (pipeline.trace) text += trace_text(*pipeline.trace);
  text += measure_text(pipeline);
  text += "not read: " + joined(columns_not_read(plan, pipeline), "nothing is left out") + '\n';
  text += "not needed: " + joined(plan.not_needed, "no stage is left out") + '\n';
  return text;
}

}  // namespace grainvdb
