#include "grainvdb/plan.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>
#include <utility>

#include "bin/half_step.hpp"
#include "pipeline/number.hpp"
#include "pipeline/species_stages.hpp"
#include "pipeline/text.hpp"

namespace grainvdb {
namespace {

// The wanted stages and all that they need, each after its needs; among those that could come next, the one registered
// first.
class StageOrder {
 public:
  StageOrder(const Pipeline& pipeline, const StageRegistry& registry)
      : pipeline_(pipeline), registry_(registry), asks_(key_of_fields(pipeline)) {
    for (const std::string& field : pipeline.fields) visit(field, asks_);
    asks_ = pipeline.trace ? "trace" : "measure";
    for (const std::string& field : computed_fields(pipeline)) visit(field, asks_);
    if (!pipeline.until) return;
    asks_ = "average.until";
    visit(pipeline.until->field + "_error", asks_);
  }

  std::vector<const Stage*> ordered() const {
    std::vector<const Stage*> result;
    std::set<std::string> done;
    while (result.size() < needs_.size())
      for (const Stage& stage : registry_.stages()) {  // the first that is ready, then again from the top
        const auto it = needs_.find(stage.name);
        if (it == needs_.end() || done.contains(stage.name)) continue;
        const auto& fields = it->second.fields;
        if (!std::all_of(fields.begin(), fields.end(), [&](const auto& f) { return done.contains(f); })) continue;
        result.push_back(&stage);
        done.insert(stage.name);
        break;
      }
    return result;
  }

  const StageNeeds& needs(const std::string& stage) const { return needs_.at(stage); }

 private:
  void visit(const std::string& field, const std::string& asker) {
    if (const auto it = std::find(path_.begin(), path_.end(), field); it != path_.end()) {
      std::string cycle;
      for (auto step = it; step != path_.end(); ++step) cycle += *step + " -> ";
      throw ConfigError({pipeline_.location(asks_), "the stages need one another in a circle", cycle + field, {}, {}});
    }
    if (needs_.contains(field)) return;
    const Stage* stage = registry_.find(field);
    if (stage == nullptr) {
      std::vector<std::string> names;
      for (const Stage& s : registry_.stages()) names.push_back(s.name);
      throw ConfigError({pipeline_.location(asks_),
                         "no stage makes the field " + quote_text(field) + ", which " + asker + " asks for",
                         {},
                         join_choices(names),
                         did_you_mean(field, names)});
    }
    if (const auto conflict = stage->conflict ? stage->conflict(pipeline_.stages) : std::nullopt) {
      const std::string key =
          "stages." + (stage->species_of.empty() ? field : stage->species_of) + "." + conflict->option;
      throw ConfigError({pipeline_.location(key),
                         "the options of stage " + quote_text(field) + " do not go together",
                         conflict->option + " " + conflict->found,
                         conflict->expected,
                         {}});
    }
    const StageNeeds needs = stage->needs ? stage->needs(pipeline_.stages) : StageNeeds{};
    path_.push_back(field);
    for (const std::string& need : needs.fields) visit(need, "stage " + quote_text(field));
    path_.pop_back();
    needs_.emplace(field, needs);
  }

  const Pipeline& pipeline_;
  const StageRegistry& registry_;
  std::string asks_;  // the key that wants fields now
  std::vector<std::string> path_;
  std::map<std::string, StageNeeds> needs_;
};

// Moments by name, each with the sweep and the pass in which it can be computed first.
class MomentOrder {
 public:
  struct Entry {
    MomentPtr moment;
    std::size_t sweep = 0;
    std::size_t pass = 0;
  };

  void add(const MomentPtr& moment) {
    if (const auto it = index_.find(moment->name); it != index_.end()) {
      const Moment& known = *entries_[it->second].moment;
      if (known.kind != moment->kind || known.channels != moment->channels)
        throw std::logic_error("two different moments are named '" + moment->name + "'");
      return;
    }
    Entry entry{moment};
    for (const MomentPtr& need : moment->frame_needs) {
      add(need);
      const Entry& n = of(*need);
      entry.sweep = std::max(entry.sweep, n.sweep);
      // Voxel moments follow their needs within a pass; others need the complete sums.
      entry.pass = std::max(entry.pass, moment->kind == Moment::Kind::voxels ? n.pass : n.pass + 1);
    }
    for (const MomentPtr& need : moment->mean_needs) {
      add(need);
      entry.sweep = std::max(entry.sweep, of(*need).sweep + 1);
    }
    index_.emplace(moment->name, entries_.size());
    entries_.push_back(entry);
  }

  /// Needs come before what needs them.
  const std::vector<Entry>& entries() const { return entries_; }
  const Entry& of(const Moment& moment) const { return entries_[index_.at(moment.name)]; }

 private:
  std::vector<Entry> entries_;
  std::map<std::string, std::size_t> index_;
};

void require_in_frame(const MomentOrder& order, const Moment& moment, std::set<std::string>& wanted) {
  if (!wanted.insert(moment.name).second) return;
  for (const MomentPtr& need : order.of(moment).moment->frame_needs) require_in_frame(order, *need, wanted);
}

Sweep make_sweep(const MomentOrder& order, std::size_t number) {
  std::set<std::string> wanted;
  for (const auto& entry : order.entries())
    if (entry.sweep == number) require_in_frame(order, *entry.moment, wanted);
  Sweep sweep;
  for (const auto& entry : order.entries()) {
    if (!wanted.contains(entry.moment->name)) continue;
    if (sweep.passes.size() <= entry.pass) sweep.passes.resize(entry.pass + 1);
    sweep.passes[entry.pass].push_back(entry.moment);
    sweep.columns |= entry.moment->columns;
    if (entry.moment->kind == Moment::Kind::contacts) sweep.branch_kinds.insert(entry.moment->branch_kind);
  }
  return sweep;
}

// The voxel centre nearest to a particle can be half a voxel diagonal away: a narrower kernel can miss all centres, and
// the particle would be lost.
void check_reach(const Pipeline& pipeline) {
  const double least = 0.5 * std::numbers::sqrt3 * pipeline.voxel;
  if (pipeline.cutoff < least)
    throw ConfigError(
        {pipeline.location("kernel.cutoff"), "the kernel is so narrow that particles fall between the voxel centres",
         "kernel.cutoff " + print_number(pipeline.cutoff) + " at lattice.voxel " + print_number(pipeline.voxel),
         "a cutoff of at least sqrt(3)/2 voxels, " + print_number(least) + "; 3 voxels and more give accurate fields",
         "Use smaller voxels or a wider kernel."});
}

// Sums over coarse voxels are no integrals: a grain's volume comes out larger or smaller with its place.
void check_voxel(const Pipeline& pipeline) {
  const double error = grain_volume_error(pipeline.cutoff / pipeline.voxel);
  if (error > pipeline.limits.volume_error)
    throw LimitError(
        {pipeline.location("lattice.voxel"), "the voxels are too coarse for the kernel",
         "a cutoff of " + short_number(pipeline.cutoff / pipeline.voxel) +
             " voxels, at which the volume of a grain is off by up to " + short_number(error),
         "at most limits.volume_error = " + print_number(pipeline.limits.volume_error) + "; 3 voxels give 0.0022",
         "Use smaller voxels or a wider kernel, or raise the limit."});
}

// Sampling at a particle reads the eight voxels around it, the farthest of them up to √3 h away; all must be within
// its kernel.
void check_cutoff(const Pipeline& pipeline, const Stage& stage, const Moment& moment) {
  const bool samples =
      moment.kind != Moment::Kind::voxels && !(moment.frame_needs.empty() && moment.mean_needs.empty());
  const double least = std::numbers::sqrt3 * pipeline.voxel;
  if (samples && pipeline.cutoff < least)
    throw ConfigError(
        {pipeline.location("kernel.cutoff"),
         "the kernel is too narrow for " + quote_text(stage.name) + ", which interpolates to the particles",
         "kernel.cutoff " + print_number(pipeline.cutoff) + " at lattice.voxel " + print_number(pipeline.voxel),
         "a cutoff of at least sqrt(3) voxels, " + print_number(least), "Use smaller voxels or a wider kernel."});
  for (const auto* needs : {&moment.frame_needs, &moment.mean_needs})
    for (const MomentPtr& need : *needs) check_cutoff(pipeline, stage, *need);
}

// What needs a thing comes after it.
std::map<std::string, Halo> find_halos(const std::vector<const Stage*>& stages, const StageOrder& order,
                                       const MomentOrder& moments) {
  std::map<std::string, Halo> of_field;
  std::map<std::string, Halo> of_moment;
  const auto widen = [](Halo& halo, const Halo& by) { halo = merged(halo, by); };
  for (auto stage = stages.rbegin(); stage != stages.rend(); ++stage) {
    const StageNeeds& needs = order.needs((*stage)->name);
    Halo halo = of_field[(*stage)->name];
    halo.stencil += needs.stencil;
    for (const std::string& field : needs.fields) widen(of_field[field], halo);
    for (const MomentPtr& moment : needs.moments) widen(of_moment[moment->name], halo);
  }
  for (auto entry = moments.entries().rbegin(); entry != moments.entries().rend(); ++entry) {
    const Moment& moment = *entry->moment;
    Halo halo = of_moment[moment.name];
    if (moment.kind != Moment::Kind::voxels) {
      ++halo.samplings;
      for (std::size_t a = 0; a < 3; ++a) halo.whole_axes[a] = halo.whole_axes[a] || moment.whole_axes[a];
    }
    for (const auto* needs : {&moment.frame_needs, &moment.mean_needs})
      for (const MomentPtr& need : *needs) widen(of_moment[need->name], halo);
  }
  return of_moment;
}

// What standard errors derive again.
ErrorPlan plan_errors(std::vector<const Stage*> errors, const std::vector<const Stage*>& stages,
                      const StageOrder& order) {
  ErrorPlan plan{std::move(errors), {}};
  std::set<std::string> again;
  for (const Stage* stage : plan.errors) again.insert(stage->error_of);
  for (auto stage = stages.rbegin(); stage != stages.rend(); ++stage) {
    if (!again.contains((*stage)->name)) continue;
    plan.by_block.insert(plan.by_block.begin(), *stage);
    const StageNeeds& needs = order.needs((*stage)->name);
    again.insert(needs.fields.begin(), needs.fields.end());
  }
  return plan;
}

// The mean over time that a later sweep is about is not known while the first one is under way.
void check_until(const Pipeline& pipeline, const Plan& plan, const StageOrder& stages, const MomentOrder& moments) {
  for (const Stage* stage : plan.until.by_block)
    for (const MomentPtr& moment : stages.needs(stage->name).moments)
      if (moments.of(*moment).sweep > 0)
        throw ConfigError({pipeline.location("average.until.field"),
                           "averaging cannot stop by a field that takes a second sweep over the frames",
                           pipeline.until->field + ", which needs " + quote_text(stage->name),
                           "a field that is known after one sweep",
                           "stages.kinetic_stress.reference: time_mean_moments takes one sweep"});
}

std::vector<const Stage*> error_stages(const std::vector<const Stage*>& stages) {
  std::vector<const Stage*> errors;
  std::copy_if(stages.begin(), stages.end(), std::back_inserter(errors),
               [](const Stage* s) { return !s->error_of.empty(); });
  return errors;
}

// The moments behind standard errors, in the order of the means.
std::vector<MomentPtr> block_sums(const Plan& plan, const StageOrder& order) {
  std::set<std::string> names;
  for (const Stage* stage : plan.errors.by_block)
    for (const MomentPtr& moment : order.needs(stage->name).moments) names.insert(moment->name);
  std::vector<MomentPtr> sums;
  std::copy_if(plan.means.begin(), plan.means.end(), std::back_inserter(sums),
               [&](const MomentPtr& m) { return names.contains(m->name); });
  return sums;
}

/// Sums over half branches take those of contacts with walls in. Where these are the only walls, sums at walls need no
/// others.
void need_wall_contacts(const Pipeline& pipeline, Sweep& sweep) {
  if (sweep.branch_kinds.empty()) return;
  sweep.columns |= Column::wall_contacts;
  const bool wall_grains = !pipeline.walls.types.empty() || !pipeline.select.empty();
  if (!wall_grains && sweep.branch_kinds == std::set{BranchKind::at_walls})
    sweep.columns = sweep.columns.without(Column::contacts);
}

}  // namespace

Halo merged(const Halo& a, const Halo& b) {
  Halo halo{std::max(a.stencil, b.stencil), std::max(a.samplings, b.samplings), {}};
  for (std::size_t axis = 0; axis < 3; ++axis) halo.whole_axes[axis] = a.whole_axes[axis] || b.whole_axes[axis];
  return halo;
}

ColumnSet all_columns(const Plan& plan) {
  ColumnSet all;
  for (const Sweep& sweep : plan.sweeps) all |= sweep.columns;
  return all;
}

std::set<BranchKind> all_branch_kinds(const Plan& plan) {
  std::set<BranchKind> all;
  for (const Sweep& sweep : plan.sweeps) all.insert(sweep.branch_kinds.begin(), sweep.branch_kinds.end());
  return all;
}

bool tells_walls(const std::set<BranchKind>& kinds) {
  return kinds.contains(BranchKind::outside_walls) || kinds.contains(BranchKind::at_walls);
}

namespace {

Plan plan_of_stages(const Pipeline& pipeline, const StageRegistry& registry) {
  if (computed_fields(pipeline).empty()) {  // measurements of frames alone
    Plan nothing;
    for (const Stage& stage : registry.stages()) nothing.not_needed.push_back(stage.name);
    return nothing;
  }
  check_reach(pipeline);
  check_voxel(pipeline);
  const StageOrder stages(pipeline, registry);
  Plan plan;
  plan.stages = stages.ordered();

  MomentOrder moments;
  std::set<std::string> kept;
  for (const Stage* stage : plan.stages)
    for (const MomentPtr& moment : stages.needs(stage->name).moments) {
      check_cutoff(pipeline, *stage, *moment);
      moments.add(moment);
      kept.insert(moment->name);
    }
  std::size_t sweeps = 1;
  for (const auto& entry : moments.entries()) {
    sweeps = std::max(sweeps, entry.sweep + 1);
    for (const MomentPtr& need : entry.moment->mean_needs) kept.insert(need->name);
  }
  for (std::size_t s = 0; s < sweeps; ++s) plan.sweeps.push_back(make_sweep(moments, s));
  // The selection by type is made in every sweep.
  for (Sweep& sweep : plan.sweeps)
    if (!pipeline.select.types.empty() || (tells_walls(sweep.branch_kinds) && !pipeline.walls.types.empty()))
      sweep.columns |= Column::type;
  for (Sweep& sweep : plan.sweeps) sweep.columns |= columns_of(pipeline.species);
  if (!pipeline.input.wall_contacts.files.empty())
    for (Sweep& sweep : plan.sweeps) need_wall_contacts(pipeline, sweep);
  if (const auto& half_step = pipeline.input.contacts.half_step)
    for (Sweep& sweep : plan.sweeps)
      if (sweep.columns.has(Column::contacts) || sweep.columns.has(Column::wall_contacts))
        sweep.columns |= half_step_columns(*half_step);
  for (const auto& entry : moments.entries())
    if (kept.contains(entry.moment->name)) plan.means.push_back(entry.moment);
  plan.errors = plan_errors(error_stages(plan.stages), plan.stages, stages);
  plan.block_sums = block_sums(plan, stages);
  if (pipeline.until) {
    plan.until = plan_errors({registry.find(pipeline.until->field + "_error")}, plan.stages, stages);
    check_until(pipeline, plan, stages, moments);
  }
  plan.halos = find_halos(plan.stages, stages, moments);
  for (const Stage& stage : registry.stages())
    if (std::find(plan.stages.begin(), plan.stages.end(), &stage) == plan.stages.end())
      plan.not_needed.push_back(stage.name);
  return plan;
}

}  // namespace

Plan make_plan(const Pipeline& pipeline, const StageRegistry& registry) {
  if (pipeline.species.empty()) return plan_of_stages(pipeline, registry);
  auto all = std::make_shared<const StageRegistry>(with_species(registry, pipeline));
  Plan plan = plan_of_stages(pipeline, *all);
  plan.with_species = std::move(all);
  return plan;
}

}  // namespace grainvdb
