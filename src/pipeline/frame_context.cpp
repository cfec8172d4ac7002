#include "pipeline/frame_context.hpp"

#include <algorithm>
#include <utility>

#include "base/parallel.hpp"
#include "bin/leaf_bounds.hpp"
#include "grainvdb/stage.hpp"
#include "pipeline/species_view.hpp"
#include "splat/accumulate.hpp"
#include "splat/own_weight.hpp"
#include "splat/sample.hpp"

namespace grainvdb {
namespace {

SplatMemory memory_of(const SplatGroup& group, std::size_t bytes_per_leaf, std::size_t summed_leaves) {
  return {group.buffered_channels(), bytes_per_leaf, summed_leaves};
}

/// The values of a group's entries, [entry][value].
std::vector<double> values_of(const SplatGroup& group, const FrameView& view) {
  const std::vector<MomentPtr>& moments = group.moments;
  const std::size_t n = group.entries(view);
  const std::size_t stride = group.weight_of.size();
  std::vector<double> all(n * stride);
  if (moments.size() == 1) {
    moments[0]->values(view, all);
    return all;
  }
  std::vector<std::size_t> first(moments.size());
  for (std::size_t m = 1; m < moments.size(); ++m)
    first[m] = first[m - 1] + static_cast<std::size_t>(moments[m - 1]->value_count());
  parallel_for(moments.size(), [&](std::size_t m) {
    const auto width = static_cast<std::size_t>(moments[m]->value_count());
    std::vector<double> own(n * width);
    moments[m]->values(view, own);
    for (std::size_t i = 0; i < n; ++i) std::copy_n(own.data() + i * width, width, all.data() + i * stride + first[m]);
  });
  return all;
}

}  // namespace

FrameContext::FrameContext(std::shared_ptr<const Material> material, const SplatSetting& setting,
                           const SweepGroups& groups)
    : material_(std::move(material)), setting_(setting), groups_(groups) {
  if (const auto& planes = setting_.pipeline.planes) planes_.emplace(setting_.lattice, setting_.kernel, *planes);
  check_extents(*material_, setting_.lattice, setting_.pipeline);
  if (setting_.wanted.empty()) check_spread(*material_, setting_.lattice, setting_.pipeline);
}

std::size_t FrameContext::contact_count() const {
  std::size_t most = 0;
  for (const auto& [kind, branches] : material_->branches) most = std::max(most, branches.size() / 2);
  return most;
}

void FrameContext::prepare(std::size_t bytes_per_leaf) {
  for (const SplatGroup& group : groups_.passes.at(0).groups) {
    if (group.of_frame_alone()) {
      started_.emplace(&group, start(group, bytes_per_leaf));
    } else if (group.kind() != Moment::Kind::contacts) {
      particle_leaves(group.halo);
    }
  }
}

void FrameContext::run(WindowSums& sums, std::size_t bytes_per_leaf, const MomentMeans* means) {
  means_ = means;
  for (const SweepGroups::Pass& pass : groups_.passes) {
    for (const SplatGroup& group : pass.groups) {
      auto ready = started_.extract(&group);
      splat(group, ready ? std::move(ready.mapped()) : start(group, bytes_per_leaf), bytes_per_leaf, sums);
    }
    for (const MomentPtr& m : pass.voxelwise) combine_voxels(m, sums);
  }
}

void FrameContext::check(std::size_t leaves, const SplatGroup& group, std::size_t bytes_per_leaf,
                         std::size_t summed_leaves) const {
  check_memory(leaves, memory_of(group, bytes_per_leaf, summed_leaves), *material_, setting_.pipeline);
}

void FrameContext::bucket_particles() {
  if (buckets_) return;
  buckets_ = bin_points(setting_.lattice, particles().position, setting_.kernel.cutoff(),
                        setting_.wanted_leaves(groups_.particle_halo));
}

const std::shared_ptr<const Topology>& FrameContext::particle_leaves(const Halo& halo) {
  const Region* const wanted = setting_.wanted_leaves(halo);
  auto& topology = topologies_[wanted];
  if (topology) return topology;
  if (planes_) return topology = planes_->topology(particles());
  bucket_particles();
  return topology = particle_topology(setting_.lattice, setting_.kernel, *buckets_, wanted);
}

const std::shared_ptr<const Topology>& FrameContext::contact_leaves(const SplatGroup& group) {
  const Region* const wanted = setting_.wanted_leaves(group.halo);
  auto& topology = contact_topologies_[{group.branch_kind(), wanted}];
  if (topology) return topology;
  const HalfBranches& all = branches(group.branch_kind());
  if (planes_) return topology = planes_->topology(all);
  const std::vector<double> any(all.size());  // the voxels do not depend on the values
  const LineIntegral method = group.moments[0]->line_integral;
  topology = ContactSplat(setting_.lattice, setting_.kernel, all, any, 1, method, wanted).topology();
  return topology;
}

FrameContext::Started FrameContext::start(const SplatGroup& group, std::size_t bytes_per_leaf) {
  const bool contacts = group.kind() == Moment::Kind::contacts;
  const Columns3& nodes = contacts ? branches(group.branch_kind()).start : particles().position;
  const double cutoff = setting_.kernel.cutoff();
  // Only where the most that it can be is too much is it worth looking closer.
  if (setting_.wanted_leaves(group.halo) == nullptr &&
      !fits(most_leaves(setting_.lattice, nodes, 2 * cutoff), memory_of(group, bytes_per_leaf, 0), setting_.pipeline))
    check(static_cast<std::size_t>(least_leaves(setting_.lattice, nodes, cutoff)), group, bytes_per_leaf, 0);
  Started started;
  if (!contacts) {
    started.values =
        group.species() ? values_of(group, SpeciesView(*this, *group.species(), nullptr)) : values_of(group, *this);
    started.topology = particle_leaves(group.halo);
  } else if (group.species()) {
    start_contacts_of_species(group, started);
  } else {
    start_contacts(group, started);
  }
  return started;
}

void FrameContext::start_contacts(const SplatGroup& group, Started& started) {
  const Region* const wanted = setting_.wanted_leaves(group.halo);
  started.values = values_of(group, *this);
  if (planes_) {
    started.topology = contact_leaves(group);
    return;
  }
  started.contacts =
      std::make_unique<ContactSplat>(setting_.lattice, setting_.kernel, branches(group.branch_kind()), started.values,
                                     group.value_count(), group.moments[0]->line_integral, wanted);
  started.topology = started.contacts->topology();
  contact_topologies_[{group.branch_kind(), wanted}] = started.topology;
}

// At the voxels that the branches of all reach: what a species has there is nothing, and not unknown.
void FrameContext::start_contacts_of_species(const SplatGroup& group, Started& started) {
  const int species = *group.species();
  started.branches = std::make_shared<const HalfBranches>(branches_of_species(branches(group.branch_kind()), species));
  started.values = values_of(group, SpeciesView(*this, species, started.branches));
  started.topology = contact_leaves(group);
  if (planes_) return;
  started.contacts = std::make_unique<ContactSplat>(
      setting_.lattice, setting_.kernel, *started.branches, started.values, group.value_count(),
      group.moments[0]->line_integral, setting_.wanted_leaves(group.halo), started.topology);
}

void FrameContext::splat(const SplatGroup& group, const Started& started, std::size_t bytes_per_leaf,
                         WindowSums& sums) {
  check(started.topology->leaf_count(), group, bytes_per_leaf, sums.leaf_count());
  if (planes_) {
    splat_on_planes(group, started, sums);
  } else if (started.contacts) {
    started.contacts->sums(consumer(group, started.topology, sums), setting_.pipeline.accumulation);
  } else if (group.species()) {
    splat_particles(group, started, keep_points(*buckets_, particles().species, *group.species()), sums);
  } else {
    splat_particles(group, started, *buckets_, sums);
  }
}

void FrameContext::splat_on_planes(const SplatGroup& group, const Started& started, WindowSums& sums) {
  const auto splat = [&](const auto& entries) {
    keep(planes_->splat(group, entries, started.values, started.topology),
         {group.moments.begin(), group.moments.begin() + static_cast<std::ptrdiff_t>(group.asked_for)}, sums);
  };
  if (group.kind() == Moment::Kind::contacts) {
    splat(started.branches ? *started.branches : branches(group.branch_kind()));
  } else if (group.species()) {
    splat(particles_of_species(particles(), *group.species()));
  } else {
    splat(particles());
  }
}

void FrameContext::splat_particles(const SplatGroup& group, const Started& started, const Buckets& buckets,
                                   WindowSums& sums) {
  const auto& [pipeline, lattice, kernel, wanted] = setting_;
  if (group.buffered()) {
    keep(splat_buffered(group, started, buckets), {group.moments.begin(), group.moments.begin() + group.asked_for},
         sums);
  } else if (group.kind() == Moment::Kind::second_moments) {
    accumulate_second_moments(pipeline.accumulation, lattice, kernel, buckets, *started.topology, started.values,
                              consumer(group, started.topology, sums));
  } else {
    accumulate_particles(pipeline.accumulation, lattice, kernel, buckets, *started.topology, started.values,
                         group.weight_of, consumer(group, started.topology, sums));
  }
}

LeafBuffers FrameContext::splat_buffered(const SplatGroup& group, const Started& started,
                                         const Buckets& buckets) const {
  const auto& [pipeline, lattice, kernel, wanted] = setting_;
  const int values = group.value_count();
  if (group.kind() == Moment::Kind::particle_gradients)
    return splat_particle_gradients(lattice, kernel, buckets, started.topology, started.values, values);
  if (group.kind() == Moment::Kind::particle_squares)
    return splat_particle_squares(lattice, kernel, buckets, started.topology, started.values, values);
  return accumulate_buffered(pipeline.accumulation, lattice, kernel, buckets, started.topology, started.values, values);
}

LeafConsumer FrameContext::consumer(const SplatGroup& group, const std::shared_ptr<const Topology>& topology,
                                    WindowSums& sums) {
  struct Part {
    std::size_t from, channels;  // of the splat
    int to = 0;                  // channel of the buffer
  };
  buffers_.push_back(std::make_unique<LeafBuffers>(topology, group.kept_channels));
  LeafBuffers* const buffers = buffers_.back().get();
  std::vector<Part> summed;
  std::vector<Part> kept;
  std::vector<MomentPtr> wanted;
  std::size_t from = 0;
  int to = 0;
  for (std::size_t k = 0; k < group.asked_for; ++k) {
    const MomentPtr& m = group.moments[k];
    const auto channels = static_cast<std::size_t>(m->channels);
    if (sums.wants(*m)) {
      summed.push_back({from, channels});
      wanted.push_back(m);
    }
    if (groups_.kept.contains(m->name)) {
      kept.push_back({from, channels, to});
      places_[m->name] = {buffers, to};
      to += m->channels;
    }
    from += channels;
  }
  return [summed, kept, buffers, target = sums.target(wanted, *topology)](std::size_t leaf, const double* all) {
    for (std::size_t k = 0; k < summed.size(); ++k) target.add(leaf, k, all + summed[k].from * leaf_size);
    for (const Part& p : kept)
      std::copy_n(all + p.from * leaf_size, p.channels * leaf_size, buffers->block(leaf, p.to));
  };
}

void FrameContext::keep(LeafBuffers buffers, const std::vector<MomentPtr>& moments, WindowSums& sums) {
  buffers_.push_back(std::make_unique<LeafBuffers>(std::move(buffers)));
  int channel = 0;
  for (const MomentPtr& m : moments) {
    places_[m->name] = {buffers_.back().get(), channel};
    if (sums.wants(*m)) sums.add(m, *buffers_.back(), channel);
    channel += m->channels;
  }
  const auto is_kept = [&](const MomentPtr& m) { return groups_.kept.contains(m->name); };
  if (std::none_of(moments.begin(), moments.end(), is_kept)) {
    for (const MomentPtr& m : moments) places_.erase(m->name);
    buffers_.pop_back();
  }
}

void FrameContext::combine_voxels(const MomentPtr& moment, WindowSums& sums) {
  std::vector<Place> channels;
  for (const MomentPtr& need : moment->frame_needs)
    for (int c = 0; c < need->channels; ++c)
      channels.push_back({places_.at(need->name).buffers, places_.at(need->name).channel + c});

  // All needs are particle moments: they share their topology, but where a region leaves some of them more leaves.
  LeafBuffers result(channels.at(0).buffers->topology(), moment->channels);
  const Topology& topology = *result.topology();
  for_each_leaf(topology, [&](std::size_t leaf) {
    std::vector<const double*> in;
    std::vector<double*> out;
    for (const Place& p : channels) {
      const bool shared = p.buffers->topology() == result.topology();
      in.push_back(
          p.buffers->block(shared ? leaf : p.buffers->topology()->find(topology.origin(leaf)).value(), p.channel));
    }
    for (int c = 0; c < moment->channels; ++c) out.push_back(result.block(leaf, c));
    moment->voxels(in, out);
  });
  keep(std::move(result), {moment}, sums);
}

Outside FrameContext::outside() const {
  return setting_.wanted.empty() ? Outside::refuse : Outside::undefined;
}

std::vector<Vec3> FrameContext::interpolate_frame(const Moment& numerator, const Moment& denominator) const {
  return interpolate_frame(numerator, denominator, particles().position);
}

std::vector<Vec3> FrameContext::interpolate_frame(const Moment& numerator, const Moment& denominator,
                                                  const Columns3& position) const {
  return sample_trilinear(setting_.lattice, ratio_of_frame(numerator, denominator), position);
}

RatioView FrameContext::ratio_of_frame(const Moment& numerator, const Moment& denominator) const {
  const Place n = places_.at(numerator.name);
  const Place d = places_.at(denominator.name);
  return {n.buffers->blocks(), n.channel, d.buffers->blocks(), d.channel, outside()};
}

std::vector<double> FrameContext::deviation_factors(const Moment& denominator) const {
  return deviation_factors(denominator, {});
}

std::vector<double> FrameContext::deviation_factors(const Moment& denominator,
                                                    std::span<const std::uint8_t> wanted) const {
  const Place d = places_.at(denominator.name);
  std::vector<double> weight(particles().size());
  denominator.values(*this, weight);
  return grainvdb::deviation_factors(setting_.lattice, setting_.kernel, particles().position, weight,
                                     d.buffers->blocks(), d.channel, outside(), wanted);
}

std::vector<Vec3> FrameContext::interpolate_frame_profile(const Moment& numerator, const Moment& denominator,
                                                          std::array<bool, 3> homogeneous) const {
  return interpolate_frame_profile(numerator, denominator, homogeneous, particles().position);
}

std::vector<Vec3> FrameContext::interpolate_frame_profile(const Moment& numerator, const Moment& denominator,
                                                          std::array<bool, 3> homogeneous,
                                                          const Columns3& position) const {
  return sample_profile(setting_.lattice, ratio_of_frame(numerator, denominator), position, homogeneous);
}

std::vector<Vec3> FrameContext::interpolate_mean(const Moment& numerator, const Moment& denominator) const {
  return interpolate_mean(numerator, denominator, particles().position);
}

std::vector<Vec3> FrameContext::interpolate_mean(const Moment& numerator, const Moment& denominator,
                                                 const Columns3& position) const {
  const LeafBlocks& values = means_->values();
  return sample_trilinear(
      setting_.lattice,
      {values, means_->first_channel(numerator), values, means_->first_channel(denominator), outside()}, position);
}

}  // namespace grainvdb
