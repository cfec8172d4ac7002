#pragma once
/// One frame on one lattice, on its way through the passes of a sweep: bucketed once, splatted pass by pass, sampled in
/// between.
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "average/window_sums.hpp"
#include "bin/buckets.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/leaf_buffers.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/region.hpp"
#include "pipeline/frame_checks.hpp"
#include "pipeline/material.hpp"
#include "pipeline/plane_splat.hpp"
#include "pipeline/splat_groups.hpp"
#include "splat/leaf_consumer.hpp"
#include "splat/sample.hpp"
#include "splat/splat.hpp"

namespace grainvdb {

/// What all frames on one lattice share.
struct SplatSetting {
  SplatSetting(const Pipeline& p, const Lattice& l) : pipeline(p), lattice(l), kernel(p.cutoff) {}
  const Pipeline& pipeline;
  Lattice lattice;
  LucyKernel kernel;
  std::map<Halo, Region> wanted;  ///< the leaves of every halo of the groups; empty where all leaves are wanted

  /// nullptr: all.
  const Region* wanted_leaves(const Halo& halo) const { return wanted.empty() ? nullptr : &wanted.at(halo); }
};

class FrameContext : public FrameView {
 public:
  /// Makes the checks of a frame (LimitError). Setting and groups must outlive the context.
  FrameContext(std::shared_ptr<const Material> material, const SplatSetting& setting, const SweepGroups& groups);

  /// Computes ahead what depends on nothing but this frame: buckets, topologies and values of the first pass. Sums take
  /// so many bytes per leaf. Throws LimitError before it allocates what would exceed limits.memory_gb.
  void prepare(std::size_t bytes_per_leaf);

  /// Splats all passes, each group of moments in one splat, and adds what `sums` wants. `means` are those of the sweep
  /// before, or nullptr. Throws LimitError as prepare does.
  void run(WindowSums& sums, std::size_t bytes_per_leaf, const MomentMeans* means);

  const Particles& particles() const override { return material_->particles; }
  const HalfBranches& branches(BranchKind set) const override { return material_->branches.at(set); }
  /// Of the largest set of half branches.
  std::size_t contact_count() const;
  std::vector<Vec3> interpolate_frame(const Moment& numerator, const Moment& denominator) const override;
  std::vector<Vec3> interpolate_mean(const Moment& numerator, const Moment& denominator) const override;
  std::vector<double> deviation_factors(const Moment& denominator) const override;
  std::vector<Vec3> interpolate_frame_profile(const Moment& numerator, const Moment& denominator,
                                              std::array<bool, 3> homogeneous) const override;

  /// The same at these positions, and of the particles that are wanted (deviation_factors).
  std::vector<Vec3> interpolate_frame(const Moment& numerator, const Moment& denominator,
                                      const Columns3& position) const;
  std::vector<Vec3> interpolate_mean(const Moment& numerator, const Moment& denominator,
                                     const Columns3& position) const;
  std::vector<double> deviation_factors(const Moment& denominator, std::span<const std::uint8_t> wanted) const;
  std::vector<Vec3> interpolate_frame_profile(const Moment& numerator, const Moment& denominator,
                                              std::array<bool, 3> homogeneous, const Columns3& position) const;

 private:
  /// Where a finished moment of this frame lies.
  struct Place {
    const LeafBuffers* buffers = nullptr;
    int channel = 0;
  };
  /// A group before its splat: its values, [entry][value], and what they are splatted onto.
  struct Started {
    std::vector<double> values{};
    std::shared_ptr<const HalfBranches> branches{};  // of a species
    std::unique_ptr<ContactSplat> contacts{};
    std::shared_ptr<const Topology> topology{};
  };

  Started start(const SplatGroup& group, std::size_t bytes_per_leaf);
  void start_contacts(const SplatGroup& group, Started& started);
  void start_contacts_of_species(const SplatGroup& group, Started& started);
  void bucket_particles();
  const std::shared_ptr<const Topology>& particle_leaves(const Halo& halo);
  const std::shared_ptr<const Topology>& contact_leaves(const SplatGroup& group);
  void splat_on_planes(const SplatGroup& group, const Started& started, WindowSums& sums);
  void splat_particles(const SplatGroup& group, const Started& started, const Buckets& buckets, WindowSums& sums);
  LeafBuffers splat_buffered(const SplatGroup& group, const Started& started, const Buckets& buckets) const;
  void splat(const SplatGroup& group, const Started& started, std::size_t bytes_per_leaf, WindowSums& sums);
  /// What takes the sums of a group's leaves: the sums of the window, and a buffer for the moments that are kept.
  LeafConsumer consumer(const SplatGroup& group, const std::shared_ptr<const Topology>& topology, WindowSums& sums);
  void keep(LeafBuffers buffers, const std::vector<MomentPtr>& moments, WindowSums& sums);
  RatioView ratio_of_frame(const Moment& numerator, const Moment& denominator) const;
  void combine_voxels(const MomentPtr& moment, WindowSums& sums);
  Outside outside() const;
  void check(std::size_t leaves, const SplatGroup& group, std::size_t bytes_per_leaf, std::size_t summed_leaves) const;

  std::shared_ptr<const Material> material_;
  const SplatSetting& setting_;
  const SweepGroups& groups_;
  const MomentMeans* means_ = nullptr;
  std::optional<PlaneSplat> planes_;  // where fields are averages over them
  std::optional<Buckets> buckets_;
  std::map<const Region*, std::shared_ptr<const Topology>> topologies_;  // of the particles
  std::map<std::pair<BranchKind, const Region*>, std::shared_ptr<const Topology>> contact_topologies_;
  std::map<const SplatGroup*, Started> started_;
  std::vector<std::unique_ptr<LeafBuffers>> buffers_;
  std::map<std::string, Place> places_;
};

}  // namespace grainvdb
