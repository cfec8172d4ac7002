#include "pipeline/splat_groups.hpp"

#include <algorithm>

namespace grainvdb {
namespace {

int first_channel(const std::vector<MomentPtr>& moments, const std::string& name) {
  int channel = 0;
  for (const MomentPtr& m : moments) {
    if (m->name == name) return channel;
    channel += m->value_count();
  }
  return -1;
}

void add_weights(SplatGroup& group) {
  std::vector<MomentPtr>& all = group.moments;
  for (std::size_t m = 0; m < all.size(); ++m)
    if (const MomentPtr weight = all[m]->weight; weight && first_channel(all, weight->name) < 0) all.push_back(weight);
  for (const MomentPtr& m : all)
    group.weight_of.insert(group.weight_of.end(), static_cast<std::size_t>(m->value_count()),
                           m->weight ? first_channel(all, m->weight->name) : -1);
}

SweepGroups::Pass group_pass(const Plan& plan, const std::vector<MomentPtr>& pass, const std::set<std::string>& kept) {
  SweepGroups::Pass result;
  for (const MomentPtr& m : pass) {
    if (m->kind == Moment::Kind::voxels) {
      result.voxelwise.push_back(m);
      continue;
    }
    const auto same = [&](const SplatGroup& g) {
      const Moment& other = *g.moments[0];
      return other.kind == m->kind && m->kind != Moment::Kind::second_moments && other.branch_kind == m->branch_kind &&
             other.line_integral == m->line_integral && other.in_double == m->in_double && other.species == m->species;
    };
    auto it = std::find_if(result.groups.begin(), result.groups.end(), same);
    if (it == result.groups.end()) it = result.groups.insert(it, SplatGroup{});
    it->moments.push_back(m);
  }
  std::stable_partition(result.groups.begin(), result.groups.end(), [](const SplatGroup& g) { return !g.species(); });
  for (SplatGroup& group : result.groups) {
    group.asked_for = group.moments.size();
    for (const MomentPtr& m : group.moments) {
      if (kept.contains(m->name)) group.kept_channels += m->channels;
      group.halo = merged(group.halo, plan.halos.at(m->name));
    }
    add_weights(group);
  }
  return result;
}

}  // namespace

std::size_t SplatGroup::entries(const FrameView& view) const {
  return kind() == Moment::Kind::contacts ? view.branches(branch_kind()).size() : view.particles().size();
}

bool SplatGroup::buffered() const {
  return kind() == Moment::Kind::particle_gradients || kind() == Moment::Kind::particle_squares ||
         (kind() == Moment::Kind::particles && moments[0]->in_double);
}

int SplatGroup::buffered_channels() const {
  if (!buffered()) return kept_channels;
  int all = 0;
  for (const MomentPtr& m : moments) all += m->channels;
  return all;
}

bool SplatGroup::of_frame_alone() const {
  return std::all_of(moments.begin(), moments.end(),
                     [](const MomentPtr& m) { return m->frame_needs.empty() && m->mean_needs.empty(); });
}

SweepGroups group_moments(const Plan& plan, std::size_t sweep) {
  SweepGroups result;
  const auto& passes = plan.sweeps[sweep].passes;
  for (const auto& pass : passes)
    for (const MomentPtr& m : pass)
      for (const MomentPtr& need : m->frame_needs) result.kept.insert(need->name);
  for (const auto& pass : passes) result.passes.push_back(group_pass(plan, pass, result.kept));
  for (const SweepGroups::Pass& pass : result.passes)
    for (const SplatGroup& group : pass.groups)
      if (group.kind() != Moment::Kind::contacts) result.particle_halo = merged(result.particle_halo, group.halo);
  return result;
}

}  // namespace grainvdb
