#include "grainvdb/memory_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "average/window_sums.hpp"
#include "base/parallel.hpp"
#include "grainvdb/lattice.hpp"
#include "pipeline/derive_errors.hpp"
#include "pipeline/schedule.hpp"
#include "pipeline/splat_groups.hpp"

namespace grainvdb {
namespace {

// Of a run whose dumps and fields are next to nothing, on x86-64; shared libraries are most of it.
constexpr double program = 50e6;
// Holes between blocks that the allocator keeps; measured.
constexpr double with_holes = 1.1;
// OpenVDB's root and first internal node.
constexpr double grid_root = 0.3e6;
// A leaf of 2 kB of values carries masks, an origin and a pointer.
constexpr double float_in_grid = 4.25;

// Tracers: what seeds, Tracers and TracerRecorder state, then ids, stop times and a column of places on their way into
// tracers.h5.
constexpr double tracer_sample = 93;
constexpr double tracer = (8 + 3 * 8) + 118 + tracer_sample + (8 + 8 + 3 * 8);

constexpr double bucket_entry = 4 + 3 * 8 + 3 * 4;  // point, index, local (Buckets)
constexpr double half_branch = 9 * 8;               // start, arm, force
constexpr double branch_plan = 8 + 4;               // how it is integrated, and which one a piece is of
constexpr double plane_entry = 2 * (8 + 4) + 4;     // index and point, before and after they are sorted; their order

bool has_wall_contacts(const Pipeline& pipeline) {
  return !pipeline.input.wall_contacts.files.empty();
}

bool has_contact_point(const ContactSpec& spec) {
  return spec.columns.contains("point") ||
         std::find(spec.compute.begin(), spec.compute.end(), "contactPoint") != spec.compute.end();
}

/// Pieces of a contact in the buckets. Its halves make one where its point is exact, and not just as good as a dump's
/// six digits; that of a contact with a wall, which counts as half a contact, is a piece of its own.
double pieces(const Pipeline& pipeline, const SplatGroup& group) {
  const bool joins = group.moments[0]->line_integral == LineIntegral::adaptive();
  return has_contact_point(pipeline.input.contacts) || !joins || has_wall_contacts(pipeline) ? 2 : 1;
}

constexpr double force_bytes = 3 * 8;

double column_bytes(ColumnSet columns) {
  double bytes = 8 + 3 * 8;  // id, position
  if (columns.has(Column::velocity)) bytes += 3 * 8;
  if (columns.has(Column::angular_velocity)) bytes += 3 * 8;
  if (columns.has(Column::radius)) bytes += 8;
  if (columns.has(Column::mass)) bytes += 8;
  if (columns.has(Column::type)) bytes += 4;
  if (columns.has(Column::force)) bytes += force_bytes;
  return bytes;
}

/// Ids, force and, where dumps have it, the contact point, as those of walls do.
double contact_bytes(const Pipeline& pipeline) {
  const bool points = has_contact_point(pipeline.input.contacts) || has_wall_contacts(pipeline);
  return 2 * 8 + 3 * 8 + (points ? 3 * 8 : 0);
}

void take_larger(double& a, double b) {
  a = std::max(a, b);
}

/// What groups of splats keep of every frame in flight, for each particle and contact and for each image of one.
struct GroupMemory {
  double particle_values = 0, contact = 0, contact_image = 0;
  double at_splat = 0;  ///< of a particle, while one of the groups is summed over planes

  /// On planes nothing is sorted into buckets but images of particles, and values are summed about their means.
  void add_on_planes(const SplatGroup& group, ColumnSet columns, bool ahead) {
    const double values = 8.0 * group.value_count();
    if (group.kind() == Moment::Kind::contacts) {
      contact += 2 * (values + (group.species() ? half_branch + sizeof(int) : 0));
      return;
    }
    if (ahead) particle_values += values;
    take_larger(at_splat, (ahead ? values : 2 * values) + (group.species() ? column_bytes(columns) : 0));
  }

  void add(const Pipeline& pipeline, const SplatGroup& group, bool ahead) {
    const double values = 8.0 * group.value_count();
    if (group.kind() == Moment::Kind::contacts) {
      contact += 2 * (values + branch_plan + (group.species() ? half_branch + sizeof(int) : 0));
      contact_image += pieces(pipeline, group) * (bucket_entry + 1 + 4.0 * (3 + group.value_count()));
    } else if (ahead) {
      particle_values += values;
    }
  }
};

/// Groups of a species have its own particles and contacts: together species have no more than all of one that has
/// the most of each.
GroupMemory memory_of_groups(const std::map<std::optional<int>, GroupMemory>& groups) {
  GroupMemory all, most;
  for (const auto& [species, memory] : groups) {
    if (!species) {
      all = memory;
      continue;
    }
    most.particle_values = std::max(most.particle_values, memory.particle_values);
    most.contact = std::max(most.contact, memory.contact);
    most.contact_image = std::max(most.contact_image, memory.contact_image);
    most.at_splat = std::max(most.at_splat, memory.at_splat);
  }
  return {all.particle_values + most.particle_values, all.contact + most.contact,
          all.contact_image + most.contact_image, std::max(all.at_splat, most.at_splat)};
}

/// What one sweep keeps of every frame in flight, and of the one that is splatted.
void add_sweep(const Plan& plan, const Pipeline& pipeline, std::size_t sweep, MemoryModel& model, double& buffered) {
  const bool reads_all = pipeline.input.on_error == OnError::skip_frame && sweep == 0;
  const ColumnSet columns = reads_all ? all_columns(plan) : plan.sweeps[sweep].columns;
  double particle = column_bytes(columns), kept = 0;
  bool by_species = false;
  std::map<std::optional<int>, GroupMemory> memory;
  take_larger(model.per_particle_read, particle);
  if (!pipeline.species.empty()) particle += sizeof(int);
  const SweepGroups groups = group_moments(plan, sweep);
  for (const SweepGroups::Pass& pass : groups.passes) {
    for (const SplatGroup& group : pass.groups) {
      kept += 8.0 * group.buffered_channels();
      const bool ahead = &pass == &groups.passes.front() && group.of_frame_alone();
      GroupMemory& taken = memory[group.species()];
      pipeline.planes ? taken.add_on_planes(group, columns, ahead) : taken.add(pipeline, group, ahead);
      by_species = by_species || (group.species() && group.kind() != Moment::Kind::contacts);
    }
    for (const MomentPtr& m : pass.voxelwise)
      if (groups.kept.contains(m->name)) kept += 8.0 * m->channels;
  }
  auto [particle_values, contact, contact_image, at_splat] = memory_of_groups(memory);
  if (columns.has(Column::contacts) || columns.has(Column::wall_contacts)) {
    contact += 2 * (half_branch + (pipeline.species.empty() ? 0 : sizeof(int)));
    take_larger(model.per_contact_read, contact_bytes(pipeline));
  }
  // Forces have corrected the contacts, and are gone, before there are values.
  if (columns.has(Column::force)) particle -= std::min(force_bytes, particle_values);
  particle += particle_values + at_splat;
  take_larger(model.per_particle, particle);
  take_larger(model.per_particle_image, pipeline.planes ? plane_entry : (by_species ? 2 * bucket_entry : bucket_entry));
  take_larger(model.per_contact, contact);
  take_larger(model.per_contact_image, contact_image);
  take_larger(buffered, kept);
}

bool is_wanted(const Pipeline& pipeline, const std::string& field) {
  const std::vector<std::string> fields = computed_fields(pipeline);
  return std::find(fields.begin(), fields.end(), field) != fields.end();
}

/// Components that exist at the same time while fields are derived one after another.
double components_at_hand(const Plan& plan, const Pipeline& pipeline) {
  std::vector<std::pair<std::string, int>> alive;
  int most = 0;
  for (std::size_t s = 0; s < plan.stages.size(); ++s) {
    if (!plan.stages[s]->compute) continue;
    alive.emplace_back(plan.stages[s]->name, plan.stages[s]->components);
    int now = 0;
    for (const auto& [name, components] : alive) now += components;
    most = std::max(most, now);
    std::set<std::string> needed;
    for (std::size_t later = s + 1; later < plan.stages.size(); ++later)
      for (const std::string& name : plan.stages[later]->needs(pipeline.stages).fields) needed.insert(name);
    std::erase_if(
        alive, [&](const auto& field) { return !is_wanted(pipeline, field.first) && !needed.contains(field.first); });
  }
  // For standard errors all that they need is derived once more beside it.
  for (const Stage* stage : plan.stages)
    if (!stage->error_of.empty()) most += stage->components;
  for (const Stage* stage : plan.errors.by_block) most += stage->components;
  return most;
}

double components_written(const Plan& plan, const Pipeline& pipeline) {
  int n = 0;
  for (const Stage* stage : plan.stages)
    if (is_wanted(pipeline, stage->name)) n += stage->components;
  return n;
}

/// Components that tracers record.
double components_recorded(const Plan& plan, const TraceSpec& trace) {
  int n = 0;
  for (const Stage* stage : plan.stages)
    if (std::find(trace.record.begin(), trace.record.end(), stage->name) != trace.record.end()) n += stage->components;
  return n;
}

/// The copies of the velocity that carry tracers: one through the mean, two between frames.
double flow_bytes_per_leaf(const TraceSpec& trace) {
  const double copies = trace.through == TraceSpec::Through::frames ? 2 : 1;
  const double edge = leaf_edge + (trace.interpolation == Interpolation::trilinear ? 1 : 3);
  return copies * edge * edge * edge * 4 * sizeof(float);
}

/// Sums of the window, of its blocks and of what windows share, and what standard errors are computed with.
double sum_bytes(const Plan& plan, const Pipeline& pipeline) {
  const TimeWindows windows = time_windows(pipeline, plan);
  const std::size_t shared = shared_parts(windows) * WindowSums::bytes_per_leaf(plan.means, {}, 0);
  const std::size_t sums =
      WindowSums::bytes_per_leaf(plan.means, plan.block_sums, pipeline.until ? 2 * pipeline.blocks : windows.blocks);
  return static_cast<double>(shared + sums + error_bytes_per_leaf(plan)) / leaf_size;
}

std::string rounded(double bytes) {
  return std::to_string(std::llround(bytes));
}

std::string per(const std::string& what, double each, double image) {
  return what + ' ' + (image > 0 ? '(' + rounded(each) + " + " + rounded(image) + " i)" : rounded(each));
}

}  // namespace

std::size_t frames_in_flight(const Limits& limits) {
  if (limits.frames_in_flight > 0) return limits.frames_in_flight;
  constexpr std::size_t most = 8;
  const std::size_t threads = thread_count();
  return threads == 1 ? 1 : std::min(threads + 1, most);
}

double MemoryModel::peak(const RunSize& size) const {
  const double frame = size.particles * (per_particle + per_particle_image * size.images) +
                       size.contacts * (per_contact + per_contact_image * size.images);
  return fixed + static_cast<double>(frames_in_flight) * frame + per_voxel * size.voxels + per_tracer * size.tracers;
}

double MemoryModel::more_than_sum(std::size_t runs, double particles, double contacts) const {
  return static_cast<double>(frames_in_flight) * (particles * per_particle_read + contacts * per_contact_read) -
         static_cast<double>(runs - 1) * program;
}

double images_per_particle(const Lattice& lattice, const Pipeline& pipeline) {
  double images = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (pipeline.planes && pipeline.planes->axis != axis) continue;
    if (const auto& period = lattice.period(axis))
      images *= 1 + 2 * pipeline.cutoff / (period->length * lattice.voxel());
  }
  return images;
}

MemoryModel memory_model(const Plan& plan, const Pipeline& pipeline) {
  MemoryModel model;
  model.frames_in_flight = frames_in_flight(pipeline.limits);
  double buffered = 0;
  for (std::size_t sweep = 0; sweep < plan.sweeps.size(); ++sweep) add_sweep(plan, pipeline, sweep, model, buffered);

  // Where there are several output times, one is written while frames of the next are splatted and its fields derived.
  const double at_hand = components_at_hand(plan, pipeline);
  const double written = pipeline.window > 0 ? components_written(plan, pipeline) : 0;
  const double mask = 4.0 * (pipeline.window > 0 ? 2 : 1);
  model.per_voxel =
      sum_bytes(plan, pipeline) + std::max(buffered, float_in_grid * at_hand) + float_in_grid * written + mask;
  if (pipeline.trace) {
    const double recorded = 4 * components_recorded(plan, *pipeline.trace);
    model.per_tracer = tracer + recorded;
    if (pipeline.reduced) model.per_tracer += tracer_sample + recorded;  // converted in a copy
    model.per_voxel += flow_bytes_per_leaf(*pipeline.trace) / leaf_size;
  }
  for (double* bytes : {&model.per_particle, &model.per_particle_image, &model.per_contact, &model.per_contact_image,
                        &model.per_voxel, &model.per_tracer, &model.per_particle_read, &model.per_contact_read})
    *bytes *= with_holes;
  model.program = program;
  model.fixed = program + grid_root * (at_hand + written);
  return model;
}

std::string to_string(const MemoryModel& model) {
  std::string frame = per("P", model.per_particle, model.per_particle_image);
  if (model.per_contact > 0) frame += " + " + per("C", model.per_contact, model.per_contact_image);
  return rounded(model.fixed / 1e6) + " MB + " + std::to_string(model.frames_in_flight) + " x [" + frame + "] + " +
         rounded(model.per_voxel) + " V" + (model.per_tracer > 0 ? " + " + rounded(model.per_tracer) + " N" : "") +
         " bytes";
}

std::string symbols(const MemoryModel& model) {
  return std::string("for P particles and C contacts a frame with i periodic images each, ") +
         (model.per_tracer > 0 ? "V voxels in the leaves that are summed, and N tracers"
                               : "and V voxels in the leaves that are summed");
}

std::string to_string_of_all(const MemoryModel& model, std::size_t runs) {
  std::string frame = "P " + rounded(model.per_particle_read);
  if (model.per_contact_read > 0) frame += " + C " + rounded(model.per_contact_read);
  return "the sum of all " + std::to_string(runs) + " - " + std::to_string(runs - 1) + " x " +
         rounded(model.program / 1e6) + " MB + " + std::to_string(model.frames_in_flight) + " x [" + frame + "] bytes";
}

}  // namespace grainvdb
