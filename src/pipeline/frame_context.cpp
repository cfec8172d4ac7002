#include "pipeline/frame_context.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>

#include <unistd.h>

#include "base/parallel.hpp"
#include "bin/branches.hpp"
#include "bin/leaf_bounds.hpp"
#include "grainvdb/stage.hpp"
#include "pipeline/number.hpp"
#include "splat/sample.hpp"
#include "splat/second_moments.hpp"
#include "splat/splat.hpp"

namespace grainvdb {
namespace {

template <class T>
void keep_rows(std::vector<T>& column, const std::vector<std::size_t>& rows) {
  if (column.empty()) return;
  for (std::size_t n = 0; n < rows.size(); ++n) column[n] = column[rows[n]];
  column.resize(rows.size());
}

bool selected(const Selection& s, const Box& box, const Particles& p, std::size_t i) {
  if (!s.types.empty() && std::find(s.types.begin(), s.types.end(), p.type[i]) == s.types.end()) return false;
  if (s.ids && (p.id[i] < s.ids->first || p.id[i] > s.ids->second)) return false;
  if (!s.region) return true;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const double x = box.wrap(a, p.position[axis][i]);
    if (x < s.region->first[axis] || x >= s.region->second[axis]) return false;
  }
  return true;
}

double memory_limit(const Limits& limits) {
  if (limits.memory_gb > 0) return limits.memory_gb * 1e9;
  return 0.75 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

// Refuses positions that lie too far from the box. `who` names the one at an index.
void check_extent(const Frame& frame, const Columns3& position, const Lattice& lattice, const Pipeline& pipeline,
                  const std::function<std::string(std::size_t)>& who) {
  constexpr double indexable = 1e9;  // voxels; farther out, wrapping into a period leaves nothing but rounding
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const bool periodic = frame.box.periodic[a];
    const double limit = periodic ? indexable : static_cast<double>(pipeline.limits.extent);
    const double middle = lattice.to_index(a, 0.5 * (frame.box.lo[axis] + frame.box.hi[axis]));
    for (std::size_t i = 0; i < position[axis].size(); ++i) {
      const double x = position[axis][i];
      const double index = lattice.to_index(a, x);
      if (std::abs(index - middle) <= limit && std::abs(index) < indexable) continue;
      const bool inside = x >= frame.box.lo[axis] && x <= frame.box.hi[axis];
      const char* what = inside ? " is too many voxels from the middle of the box" : " lies too far from the box";
      const char* hint = "Leave the stray particle out with select, correct lattice.voxel, or raise limits.extent";
      if (periodic) hint = "Correct the coordinate, or leave the particle out with select";
      if (inside) hint = "Choose larger voxels, or raise limits.extent";
      throw LimitError(
          {{frame.file, 0},
           who(i) + " of step " + std::to_string(frame.step) + what,
           std::string(1, "xyz"[a]) + " = " + print_number(x) + " at lattice.voxel " + print_number(pipeline.voxel),
           "at most " + print_number(limit) + " voxels from its middle" + (periodic ? "" : ", limits.extent"),
           hint});
    }
  }
}

// Refuses, before anything is computed, material so far apart that the box to be written would exceed the limit.
void check_spread(const Frame& frame, const Lattice& lattice, const Pipeline& pipeline) {
  const Particles& p = frame.particles;
  if (p.size() == 0) return;
  double voxels = 1;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const auto [lo, hi] = std::minmax_element(p.position[axis].begin(), p.position[axis].end());
    const auto& period = lattice.period(a);
    voxels *= period ? period->count : (*hi - *lo + pipeline.cutoff) / pipeline.voxel;
  }
  if (voxels <= static_cast<double>(pipeline.limits.dense_voxels)) return;
  throw LimitError({{frame.file, 0},
                    "the material of step " + std::to_string(frame.step) + " spans a box of too many voxels",
                    print_number(voxels),
                    "at most limits.dense_voxels = " + std::to_string(pipeline.limits.dense_voxels),
                    "Choose larger voxels, leave stray particles out with select, or raise the limit"});
}

}  // namespace

void apply_selection(const Selection& selection, const Box& box, Particles& particles) {
  if (selection.empty()) return;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (selected(selection, box, particles, i)) rows.push_back(i);
  keep_rows(particles.id, rows);
  for (Columns3* columns : {&particles.position, &particles.velocity, &particles.angular_velocity})
    for (std::vector<double>& column : *columns) keep_rows(column, rows);
  keep_rows(particles.radius, rows);
  keep_rows(particles.mass, rows);
  keep_rows(particles.type, rows);
}

FrameContext::FrameContext(Frame frame, const Pipeline& pipeline, const Lattice& lattice, const LucyKernel& kernel,
                           const std::set<std::string>& kept, const MomentMeans* means)
    : pipeline_(pipeline), lattice_(lattice), kernel_(kernel), kept_(kept), means_(means), frame_(std::move(frame)) {
  if (frame_.contacts.size() > 0) {
    branches_ = half_branches(frame_);
    frame_.contacts = {};
    check_extent(frame_, branches_.start, lattice_, pipeline_,
                 [](std::size_t) { return std::string("a particle with contacts"); });
  }
  apply_selection(pipeline_.select, frame_.box, frame_.particles);
  check_extent(frame_, frame_.particles.position, lattice_, pipeline_,
               [&](std::size_t i) { return "particle " + std::to_string(frame_.particles.id[i]); });
  check_spread(frame_, lattice_, pipeline_);
}

void FrameContext::bucket_particles() {
  if (buckets_) return;
  buckets_ = bin_points(lattice_, frame_.particles.position, kernel_.cutoff());
  topology_ = particle_topology(lattice_, kernel_, *buckets_);
}

// Splat buffers of this group, and the sums.
double FrameContext::memory_needed(double leaves, int values, const MomentSums& sums) const {
  const double summed = std::max(leaves, static_cast<double>(sums.leaf_count()));
  return leaves * leaf_size * sizeof(double) * values + summed * static_cast<double>(sums.bytes(1));
}

bool FrameContext::fits(double leaves, int values, const MomentSums& sums) const {
  return memory_needed(leaves, values, sums) <= memory_limit(pipeline_.limits);
}

void FrameContext::check_memory(std::size_t leaves, int values, const MomentSums& sums) const {
  if (fits(static_cast<double>(leaves), values, sums)) return;
  const double need = memory_needed(static_cast<double>(leaves), values, sums);
  const double limit = memory_limit(pipeline_.limits);
  throw LimitError(
      {{frame_.file, 0},
       "step " + std::to_string(frame_.step) + " needs more memory than is allowed",
       "at least " + std::to_string(need / 1e9) + " GB for " + std::to_string(leaves) + " leaves of 512 voxels",
       "at most " + std::to_string(limit / 1e9) + " GB",
       "Use larger voxels or fewer fields, or raise limits.memory_gb"});
}

std::size_t FrameContext::entries(Moment::Kind kind) const {
  return kind == Moment::Kind::contacts ? branches_.size() : frame_.particles.size();
}

void FrameContext::run_pass(const std::vector<MomentPtr>& pass, MomentSums& sums) {
  // One splat serves all moments that share kernel and nodes.
  std::vector<Group> groups;
  for (const MomentPtr& m : pass) {
    if (m->kind == Moment::Kind::voxels) continue;
    const auto same = [&](const Group& g) {
      return g[0]->kind == m->kind && m->kind != Moment::Kind::second_moments &&
             g[0]->line_integral == m->line_integral && g[0]->in_double == m->in_double;
    };
    const auto it = std::find_if(groups.begin(), groups.end(), same);
    if (it == groups.end()) {
      groups.push_back({m});
    } else {
      it->push_back(m);
    }
  }
  for (const Group& group : groups) splat_group(group, sums);
  for (const MomentPtr& m : pass)
    if (m->kind == Moment::Kind::voxels) combine_voxels(*m, sums);
}

FrameContext::Values FrameContext::values_of(Group& group) const {
  // A weight that nobody asked for is splatted along with what it weighs.
  const auto channel_of = [&](const Moment& wanted) {
    int channel = 0;
    for (const MomentPtr& m : group) {
      if (m->name == wanted.name) return channel;
      channel += m->value_count();
    }
    return -1;
  };
  for (std::size_t g = 0; g < group.size(); ++g)
    if (const MomentPtr weight = group[g]->weight; weight && channel_of(*weight) < 0) group.push_back(weight);

  Values all;
  for (const MomentPtr& m : group)
    all.weight_of.insert(all.weight_of.end(), static_cast<std::size_t>(m->value_count()),
                         m->weight ? channel_of(*m->weight) : -1);

  const std::size_t n = entries(group[0]->kind);
  const std::size_t stride = all.weight_of.size();
  all.q.resize(n * stride);
  if (group.size() == 1) {
    group[0]->values(*this, all.q);
    return all;
  }
  std::vector<std::size_t> first(group.size());
  for (std::size_t g = 1; g < group.size(); ++g)
    first[g] = first[g - 1] + static_cast<std::size_t>(group[g - 1]->value_count());
  parallel_for(group.size(), [&](std::size_t g) {
    const auto width = static_cast<std::size_t>(group[g]->value_count());
    std::vector<double> own(n * width);
    group[g]->values(*this, own);
    for (std::size_t i = 0; i < n; ++i)
      std::copy_n(own.data() + i * width, width, all.q.data() + i * stride + first[g]);
  });
  return all;
}

void FrameContext::splat_group(const Group& group, MomentSums& sums) {
  Group weighed = group;
  const Values values = values_of(weighed);
  const int channels = static_cast<int>(values.weight_of.size());
  const bool contacts = group[0]->kind == Moment::Kind::contacts;
  const Columns3& nodes = contacts ? branches_.start : frame_.particles.position;
  // Only where the most that it can be is too much is it worth looking closer.
  if (!fits(most_leaves(lattice_, nodes, 2 * kernel_.cutoff()), channels, sums))
    check_memory(static_cast<std::size_t>(least_leaves(lattice_, nodes, kernel_.cutoff())), channels, sums);
  if (!contacts) {
    bucket_particles();
    check_memory(topology_->leaf_count(), channels, sums);
  }
  const bool in_double = group[0]->kind == Moment::Kind::particle_gradients || group[0]->in_double;
  if (contacts || !in_double) {
    splat_leaves(group, values, sums);
  } else {
    keep(splat_in_double(group, values), group, sums);
  }
}

LeafBuffers FrameContext::splat_in_double(const Group& group, const Values& values) const {
  const int channels = static_cast<int>(values.weight_of.size());
  return group[0]->kind == Moment::Kind::particle_gradients
             ? splat_particle_gradients(lattice_, kernel_, *buckets_, topology_, values.q, channels)
             : splat_particles(lattice_, kernel_, *buckets_, topology_, values.q, channels);
}

void FrameContext::splat_leaves(const Group& group, const Values& values, MomentSums& sums) {
  if (group[0]->kind == Moment::Kind::contacts) {
    const ContactSplat splat(lattice_, kernel_, branches_, values.q, static_cast<int>(values.weight_of.size()),
                             group[0]->line_integral);
    check_memory(splat.topology()->leaf_count(), 0, sums);
    splat.sums(consumer(group, splat.topology(), sums));
  } else if (group[0]->kind == Moment::Kind::second_moments) {
    splat_second_moments(lattice_, kernel_, *buckets_, *topology_, values.q, consumer(group, topology_, sums));
  } else {
    splat_particles_fast(lattice_, kernel_, *buckets_, *topology_, values.q, values.weight_of,
                         consumer(group, topology_, sums));
  }
}

LeafConsumer FrameContext::consumer(const Group& group, const std::shared_ptr<const Topology>& topology,
                                    MomentSums& sums) {
  struct Part {
    std::size_t from, channels;  // of the splat
    int to = 0;                  // channel of the buffer
  };
  std::vector<Part> summed;
  std::vector<Part> kept;
  std::vector<MomentPtr> wanted;
  std::size_t from = 0;
  int to = 0;
  for (const MomentPtr& m : group) {
    const auto channels = static_cast<std::size_t>(m->channels);
    if (sums.wants(*m)) {
      summed.push_back({from, channels});
      wanted.push_back(m);
    }
    if (kept_.contains(m->name)) {
      kept.push_back({from, channels, to});
      to += m->channels;
    }
    from += channels;
  }
  buffers_.push_back(std::make_unique<LeafBuffers>(topology, to));
  LeafBuffers* const buffers = buffers_.back().get();
  to = 0;
  for (const MomentPtr& m : group)
    if (kept_.contains(m->name)) {
      places_[m->name] = {buffers, to};
      to += m->channels;
    }
  return [summed, kept, buffers, target = sums.target(wanted, *topology)](std::size_t leaf, const double* all) {
    for (std::size_t k = 0; k < summed.size(); ++k) target.add(leaf, k, all + summed[k].from * leaf_size);
    for (const Part& p : kept)
      std::copy_n(all + p.from * leaf_size, p.channels * leaf_size, buffers->block(leaf, p.to));
  };
}

void FrameContext::keep(LeafBuffers buffers, const Group& group, MomentSums& sums) {
  buffers_.push_back(std::make_unique<LeafBuffers>(std::move(buffers)));
  int channel = 0;
  for (const MomentPtr& m : group) {
    places_[m->name] = {buffers_.back().get(), channel};
    if (sums.wants(*m)) sums.add(m, *buffers_.back(), channel);
    channel += m->channels;
  }
  const auto is_kept = [&](const MomentPtr& m) { return kept_.contains(m->name); };
  if (std::none_of(group.begin(), group.end(), is_kept)) {
    for (const MomentPtr& m : group) places_.erase(m->name);
    buffers_.pop_back();
  }
}

void FrameContext::combine_voxels(const Moment& moment, MomentSums& sums) {
  std::vector<Place> channels;
  for (const MomentPtr& need : moment.frame_needs)
    for (int c = 0; c < need->channels; ++c)
      channels.push_back({places_.at(need->name).buffers, places_.at(need->name).channel + c});

  // All needs are particle moments, and those of one frame share its particle topology.
  LeafBuffers result(channels.at(0).buffers->topology(), moment.channels);
  for_each_leaf(*result.topology(), [&](std::size_t leaf) {
    std::vector<const double*> in;
    std::vector<double*> out;
    for (const Place& p : channels) in.push_back(p.buffers->block(leaf, p.channel));
    for (int c = 0; c < moment.channels; ++c) out.push_back(result.block(leaf, c));
    moment.voxels(in, out);
  });
  keep(std::move(result), {std::make_shared<const Moment>(moment)}, sums);
}

std::vector<Vec3> FrameContext::interpolate_frame(const Moment& numerator, const Moment& denominator) const {
  const Place n = places_.at(numerator.name);
  const Place d = places_.at(denominator.name);
  return sample_trilinear(lattice_, {n.buffers->blocks(), n.channel, d.buffers->blocks(), d.channel},
                          frame_.particles.position);
}

std::vector<Vec3> FrameContext::interpolate_frame_profile(const Moment& numerator, const Moment& denominator,
                                                          std::array<bool, 3> homogeneous) const {
  const Place n = places_.at(numerator.name);
  const Place d = places_.at(denominator.name);
  return sample_profile(lattice_, {n.buffers->blocks(), n.channel, d.buffers->blocks(), d.channel},
                        frame_.particles.position, homogeneous);
}

std::vector<Vec3> FrameContext::interpolate_mean(const Moment& numerator, const Moment& denominator) const {
  const LeafBlocks& values = means_->values();
  return sample_trilinear(lattice_,
                          {values, means_->first_channel(numerator), values, means_->first_channel(denominator)},
                          frame_.particles.position);
}

}  // namespace grainvdb
