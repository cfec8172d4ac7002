#include <algorithm>
#include <cmath>
#include <exception>
#include <sstream>
#include <stdexcept>

#include "grainvdb/run.hpp"
#include "pipeline/frame_checks.hpp"
#include "pipeline/material.hpp"
#include "pipeline/measure_needs.hpp"
#include "pipeline/plane_runs.hpp"
#include "pipeline/plane_splat.hpp"
#include "pipeline/schedule.hpp"
#include "pipeline/spot_input.hpp"
#include "pipeline/wall_domain.hpp"

namespace grainvdb {
namespace {

std::string text(double x) {
  std::ostringstream out;
  out.precision(9);
  out << x;
  return out.str();
}

void check_plan(const Pipeline& pipeline, const Plan& plan) {
  if (plan.means.empty())
    throw ConfigError({pipeline.location(key_of_fields(pipeline)),
                       "nothing to compute: no field that is made from particles is wanted",
                       {},
                       "at least one field besides mask",
                       "`grainvdb stages` lists them"});
  const bool contacts = std::any_of(plan.sweeps.begin(), plan.sweeps.end(),
                                    [](const Sweep& s) { return s.columns.has(Column::contacts); });
  if (contacts && pipeline.input.contacts.files.empty())
    throw ConfigError({pipeline.location(key_of_fields(pipeline)),
                       "the wanted fields need contacts, and the input has none", "no input.contacts",
                       "input.contacts.files", "Name the contact dumps, or ask for kinetic_stress instead of stress"});
}

void check_wall_grains(const Pipeline& pipeline, const Plan& plan) {
  if (!tells_walls(all_branch_kinds(plan)) || !pipeline.walls.types.empty() || !pipeline.select.empty() ||
      !pipeline.input.wall_contacts.files.empty())
    return;
  throw ConfigError({pipeline.location(key_of_fields(pipeline)),
                     "the wanted fields tell wall grains from material, and nothing says which are which",
                     "neither walls.types nor select",
                     "walls.types: the types of the wall grains; or select, which leaves them out",
                     "Of walls that are no grains, name the contacts: input.wall_contacts"});
}

void check_periodic_box(const Pipeline& pipeline, const FrameInfo& first, const FrameInfo& frame) {
  for (int a = 0; a < 3; ++a) {
    const std::string axis(1, "xyz"[a]);
    if (frame.box.periodic[a] != first.box.periodic[a])
      throw InputError({{frame.file, 0},
                        "the box changes its periodicity along " + axis,
                        "step " + std::to_string(frame.step),
                        "the boundaries of step " + std::to_string(first.step),
                        "Choose frames with one kind of box"});
    if (!first.box.periodic[a]) continue;
    const double length = first.box.length(a);
    if (std::abs(frame.box.length(a) - length) > 1e-6 * length)
      throw InputError({{frame.file, 0},
                        "the periodic box length along " + axis + " changes",
                        text(frame.box.length(a)) + " at step " + std::to_string(frame.step),
                        text(length) + " as at step " + std::to_string(first.step),
                        "Fields of a deforming periodic box have no common lattice: choose frames of one size"});
    const bool across_planes = !pipeline.planes || pipeline.planes->axis == a;
    if (across_planes && pipeline.cutoff > 0.5 * length)
      throw ConfigError({pipeline.location("kernel.cutoff"), "the cutoff exceeds half the periodic box along " + axis,
                         text(pipeline.cutoff), "at most " + text(0.5 * length),
                         "A particle would meet its own image"});
  }
}

/// Before the first frame is read: what only the last sweep wants of the last frame would else be missed after hours.
/// Where bad frames are skipped, there must be one that is not.
void require_columns(const Pipeline& pipeline, ColumnSet columns, FrameSource& source,
                     const std::vector<std::size_t>& wanted) {
  if (pipeline.input.on_error == OnError::error) {
    for (std::size_t k : wanted) source.require(k, columns);
    return;
  }
  std::exception_ptr first;
  for (std::size_t k : wanted) {
    try {
      return source.require(k, columns);
    } catch (const InputError&) {
      if (!first) first = std::current_exception();
    }
  }
  std::rethrow_exception(first);
}

/// The last output time may be shorter, but where it is the only one.
void require_blocks(const Pipeline& pipeline, const Plan& plan, std::size_t frames) {
  if (plan.errors.errors.empty()) return;
  const WindowSchedule schedule = schedule_windows(time_windows(pipeline, plan), frames);
  const Window& first = schedule.windows.front();
  if ((pipeline.until ? frames : first.blocks.size()) >= pipeline.blocks) return;
  throw ConfigError({pipeline.location("average.blocks"),
                     "the output times have too few frames for the standard errors that are wanted",
                     std::to_string(first.frames.count) + (first.frames.count == 1 ? " frame" : " frames"),
                     "at least one for each of average.blocks = " + std::to_string(pipeline.blocks) + " blocks",
                     "Average over more frames, or lower average.blocks (to 2 at least)"});
}

std::vector<std::size_t> wanted_frames(const Pipeline& pipeline, const FrameSource& source) {
  std::vector<std::size_t> wanted = select_frames(pipeline.frames, source.frames().size());
  if (wanted.empty())
    throw ConfigError({pipeline.location("frames"),
                       "no frame is selected",
                       {},
                       "a range within the " + std::to_string(source.frames().size()) + " frames of the input",
                       {}});
  return wanted;
}

/// With the periods of the box, in which no particle may meet its own image.
Lattice lattice_in(const Pipeline& pipeline, const FrameSource& source, const std::vector<std::size_t>& wanted) {
  const auto& frames = source.frames();
  const FrameInfo& first = frames[wanted.front()];
  for (std::size_t k : wanted) check_periodic_box(pipeline, first, frames[k]);
  Lattice lattice(pipeline.voxel, pipeline.origin);
  try {
    lattice.set_periods(pipeline.planes ? box_of_planes(*pipeline.planes, first.box, pipeline.voxel, pipeline.origin)
                                        : first.box);
  } catch (const std::invalid_argument& e) {
    throw ConfigError({pipeline.location("lattice.voxel"), e.what(), {}, {}, {}});
  }
  return lattice;
}

}  // namespace

void check_frame(const Pipeline& pipeline, const Plan& plan, const Lattice& lattice, FrameSource& source,
                 std::size_t k) {
  const Material material = make_material(source.read(k, all_columns(plan)), pipeline, all_branch_kinds(plan));
  check_extents(material, lattice, pipeline);
  if (!pipeline.region) check_spread(material, lattice, pipeline);
}

Lattice check_against_input(const Pipeline& pipeline, const Plan& plan, FrameSource& source) {
  refuse_forces_of_spots(pipeline, plan, source);
  check_plan(pipeline, plan);
  check_wall_grains(pipeline, plan);
  const std::vector<std::size_t> wanted = wanted_frames(pipeline, source);
  Lattice lattice = lattice_in(pipeline, source, wanted);
  require_blocks(pipeline, plan, wanted.size());
  wall_domain(pipeline, source, wanted);
  require_columns(pipeline, all_columns(plan), source, wanted);
  return lattice;
}

Lattice check_measure_against_input(const Pipeline& pipeline, FrameSource& source) {
  const std::vector<std::size_t> wanted = wanted_frames(pipeline, source);
  if (const auto columns = measured_columns(pipeline)) {
    refuse_contacts_of_spots(pipeline, source);
    if (columns->has(Column::contacts) && pipeline.input.contacts.files.empty())
      throw ConfigError({pipeline.location("measure"), "the wanted measurements need contacts, and the input has none",
                         "no input.contacts", "input.contacts.files", "Name the contact dumps"});
    require_columns(pipeline, *columns, source, wanted);
  }
  wall_domain(pipeline, source, wanted);
  for (PlaneRun& run : plane_runs(pipeline)) {
    set_area(*run.pipeline.planes, source.frames()[wanted.front()]);
    check_against_input(run.pipeline, run.plan, source);
  }
  return pipeline.voxel > 0 ? lattice_in(pipeline, source, wanted) : Lattice(1, {});
}

}  // namespace grainvdb
