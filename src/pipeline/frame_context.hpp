#pragma once
/// One frame on its way through the passes of a sweep: bucketed once, splatted pass by pass, sampled in between.
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "average/moment_sums.hpp"
#include "bin/buckets.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/leaf_buffers.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/pipeline.hpp"
#include "splat/leaf_consumer.hpp"

namespace grainvdb {

/// Keeps the particles that the selection counts as material.
void apply_selection(const Selection& selection, const Box& box, Particles& particles);

class FrameContext : public FrameView {
 public:
  /// Takes the frame. `kept` names the moments whose values other moments of the frame ask for; `means` are those of
  /// the sweep before, or nullptr.
  FrameContext(Frame frame, const Pipeline& pipeline, const Lattice& lattice, const LucyKernel& kernel,
               const std::set<std::string>& kept, const MomentMeans* means);

  /// Splats the moments of one pass, in one splat per kind, and adds those that `sums` wants.
  void run_pass(const std::vector<MomentPtr>& pass, MomentSums& sums);

  const Particles& particles() const override { return frame_.particles; }
  const HalfBranches& branches() const override { return branches_; }
  std::vector<Vec3> interpolate_frame(const Moment& numerator, const Moment& denominator) const override;
  std::vector<Vec3> interpolate_mean(const Moment& numerator, const Moment& denominator) const override;
  std::vector<Vec3> interpolate_frame_profile(const Moment& numerator, const Moment& denominator,
                                              std::array<bool, 3> homogeneous) const override;

 private:
  /// Where a finished moment of this frame lies.
  struct Place {
    const LeafBuffers* buffers = nullptr;
    int channel = 0;
  };
  using Group = std::vector<MomentPtr>;

  /// The values of all moments of a group, [entry][value], with the channel that weighs each value or -1.
  struct Values {
    std::vector<double> q;
    std::vector<int> weight_of;
  };
  void splat_group(const Group& group, MomentSums& sums);
  void combine_voxels(const Moment& moment, MomentSums& sums);
  /// Splats into the sums, with no buffer but for the moments that are kept.
  void splat_leaves(const Group& group, const Values& values, MomentSums& sums);
  LeafConsumer consumer(const Group& group, const std::shared_ptr<const Topology>& topology, MomentSums& sums);
  void keep(LeafBuffers buffers, const Group& group, MomentSums& sums);
  /// Appends to the group the weights that it lacks.
  Values values_of(Group& group) const;
  LeafBuffers splat_in_double(const Group& group, const Values& values) const;
  void bucket_particles();
  /// Refuses, before it is allocated, what would exceed limits.memory_gb (LimitError).
  void check_memory(std::size_t leaves, int values, const MomentSums& sums) const;
  double memory_needed(double leaves, int values, const MomentSums& sums) const;
  bool fits(double leaves, int values, const MomentSums& sums) const;
  std::size_t entries(Moment::Kind kind) const;

  const Pipeline& pipeline_;
  const Lattice& lattice_;
  const LucyKernel& kernel_;
  const std::set<std::string>& kept_;
  const MomentMeans* means_;
  Frame frame_;
  HalfBranches branches_;
  std::optional<Buckets> buckets_;
  std::shared_ptr<const Topology> topology_;
  std::vector<std::unique_ptr<LeafBuffers>> buffers_;
  std::map<std::string, Place> places_;
};

}  // namespace grainvdb
