#include "pipeline/plane_runs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "grainvdb/measurement.hpp"

namespace grainvdb {
namespace {

bool are_same(const Planes& a, const Planes& b) {
  return a.axis == b.axis && a.area == b.area;
}

void add_fields(const std::vector<std::string>& more, std::vector<std::string>& fields) {
  for (const std::string& field : more)
    if (std::find(fields.begin(), fields.end(), field) == fields.end()) fields.push_back(field);
}

/// A grain has next to no share in the mean over a plane, and no correction for it is known there.
void leave_out_self_weight(PlaneRun& run) {
  for (const std::string stage : {"temperature", "rotational_fluctuation"}) {
    const auto it = run.pipeline.stages.find(stage);
    if (it == run.pipeline.stages.end()) continue;
    const auto option = it->second.find("self_weight");
    if (option == it->second.end() || option->second == OptionValue(std::string("none"))) continue;
    option->second = std::string("none");
    run.remarks.push_back("Exact averages over planes take no account of stages." + stage +
                          ".self_weight: the mean over a plane has too many grains for it to matter");
  }
}

/// What concerns fields in three dimensions, tracers and results is left out.
PlaneRun run_on_planes(const Pipeline& pipeline, const Planes& planes) {
  PlaneRun run{pipeline, {}, {}, {}};
  Pipeline& p = run.pipeline;
  p.planes = planes;
  p.fields.clear();
  p.measure.clear();
  p.trace.reset();
  if (p.region) run.remarks.emplace_back("Exact averages are over whole planes, whatever the region");
  p.region.reset();
  p.until.reset();
  p.scales.clear();
  leave_out_self_weight(run);
  return run;
}

/// The part of the kernel inside the walls must be the same all over a plane.
void check_walls(const Pipeline& pipeline, const std::string& measurement) {
  if (pipeline.walls.kernel == WallSpec::Kernel::cut) return;
  constexpr double rounding = 1e-9;
  const auto axis = static_cast<std::size_t>(pipeline.planes->axis);
  const std::vector<Wall> walls = WallDomain(pipeline.walls.surfaces).walls();
  const bool surfaces = std::all_of(walls.begin(), walls.end(), [&](const Wall& wall) {
    return wall.shape == Wall::Shape::plane && std::abs(wall.direction[axis]) > 1 - rounding;
  });
  const bool faces = std::all_of(pipeline.walls.faces.begin(), pipeline.walls.faces.end(),
                                 [&](const BoxFace& face) { return face.axis == pipeline.planes->axis; });
  if (surfaces && faces) return;
  throw ConfigError({pipeline.location("measure." + measurement),
                     "exact averages over planes know no walls across the planes", "walls.kernel other than cut",
                     std::string("walls.kernel: cut, or walls that are planes normal to ") + "xyz"[axis],
                     "The measurement profile, and source: profile, average fields with walls of any shape"});
}

}  // namespace

std::vector<PlaneRun> plane_runs(const Pipeline& pipeline) {
  std::vector<PlaneRun> runs;
  for (const auto& [name, options] : pipeline.measure) {
    const auto needs = find_measurement(name)->needs(options).planes;
    if (!needs) continue;
    auto run = std::find_if(runs.begin(), runs.end(),
                            [&](const PlaneRun& r) { return are_same(*r.pipeline.planes, needs->planes); });
    if (run == runs.end()) {
      run = runs.insert(run, run_on_planes(pipeline, needs->planes));
      check_walls(run->pipeline, name);
    }
    run->measurements.push_back(name);
    add_fields(needs->fields, run->pipeline.fields);
  }
  for (PlaneRun& run : runs) run.plan = make_plan(run.pipeline);
  return runs;
}

void set_area(Planes& planes, const FrameInfo& first) {
  if (planes.area > 0) return;
  double area = 1;
  for (int a = 0; a < 3; ++a) {
    if (a == planes.axis) continue;
    if (!first.box.periodic[static_cast<std::size_t>(a)])
      throw InputError({{first.file, 0},
                        "exact averages over planes need the area of the planes",
                        std::string("a box that is not periodic along ") + "xyz"[a],
                        "a box periodic along both axes of the planes, or the option area of the measurement",
                        "Where the material does not fill the planes evenly, measure `profile` instead"});
    area *= first.box.length(a);
  }
  planes.area = area;
}

ColumnSet plane_columns(const Pipeline& pipeline) {
  ColumnSet all;
  for (const PlaneRun& run : plane_runs(pipeline)) all |= all_columns(run.plan);
  return all;
}

}  // namespace grainvdb
