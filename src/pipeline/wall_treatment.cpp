#include "pipeline/wall_treatment.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/parallel.hpp"
#include "bin/inside.hpp"
#include "pipeline/number.hpp"
#include "pipeline/wall_domain.hpp"

namespace grainvdb {
namespace {

/// How far behind a wall images can have a part in a value before it: one cutoff for a sum, and one more each time that
/// values at particles are interpolated from voxels, the farthest of which is √3 h away.
double image_depth(const Pipeline& pipeline, const Plan& plan) {
  int samplings = 0, stencil = 0;
  for (const auto& [moment, halo] : plan.halos) {
    samplings = std::max(samplings, halo.samplings);
    stencil = std::max(stencil, halo.stencil);
  }
  return pipeline.cutoff * (1 + samplings) + 2 * pipeline.voxel * (samplings + stencil);
}

}  // namespace

WallTreatment::WallTreatment(WallSpec::Kernel mode, WallDomain domain, const LucyKernel& kernel, const Lattice& lattice)
    : mode_(mode), domain_(std::move(domain)), lattice_(lattice) {
  if (mode_ == WallSpec::Kernel::renormalise) fractions_.emplace(domain_, kernel, lattice);
}

std::optional<WallTreatment> WallTreatment::make(const Pipeline& pipeline, const Plan& plan, const Lattice& lattice,
                                                 FrameSource& source, std::span<const std::size_t> wanted) {
  const WallSpec::Kernel mode = pipeline.walls.kernel;
  if (mode == WallSpec::Kernel::cut) return std::nullopt;
  WallTreatment treatment(mode, wall_domain(pipeline, source, wanted), LucyKernel(pipeline.cutoff), lattice);
  if (mode == WallSpec::Kernel::mask) {
    treatment.wall_clearance_ = wall_clearance(pipeline, source, wanted);
    treatment.clearance_ = pipeline.cutoff + treatment.wall_clearance_;
  }
  if (mode == WallSpec::Kernel::mirror)
    treatment.mirror_.emplace(treatment.domain_.walls(), image_depth(pipeline, plan));
  return treatment;
}

void WallTreatment::apply(Material& material) const {
  if (mode_ == WallSpec::Kernel::mask) return;
  keep_inside(domain_, material.particles);
  for (auto& [kind, branches] : material.branches)
    if (kind != BranchKind::at_walls) keep_inside(domain_, branches);  // which lie about the wall, on either side
  if (!mirror_) return;
  mirror_->add_images(material.particles);
  for (auto& [kind, branches] : material.branches) mirror_->add_images(branches);
}

WallTreatment::Renormalised WallTreatment::renormalise(const MomentMeans& means,
                                                       const std::vector<MomentPtr>& moments) {
  Renormalised result{means, {}};
  if (!fractions_) return result;
  const std::vector<const InsideFractions::Leaf*> inside = fractions_->of(*means.topology());
  std::vector<std::size_t> at_walls;
  for (std::size_t l = 0; l < inside.size(); ++l)
    if (inside[l] != nullptr) at_walls.push_back(l);
  std::size_t channels = 0;
  for (const MomentPtr& m : moments)
    if (means.holds(*m)) channels = std::max(channels, static_cast<std::size_t>(means.first_channel(*m) + m->channels));
  result.leaves.resize(at_walls.size());
  parallel_for(at_walls.size(), [&](std::size_t n) {
    const std::size_t leaf = at_walls[n];
    const double* from = means.values().block(leaf, 0);
    auto& to = result.leaves[n];
    to = std::make_unique<double[]>(channels * leaf_size);
    for (std::size_t c = 0; c < channels; ++c)
      for (std::size_t v = 0; v < leaf_size; ++v) to[c * leaf_size + v] = from[c * leaf_size + v] / (*inside[leaf])[v];
  });
  for (std::size_t n = 0; n < at_walls.size(); ++n) result.means.replace(at_walls[n], result.leaves[n].get());
  return result;
}

void WallTreatment::mask(DerivedFields& all) const {
  const Topology& topology = *all.mask.topology();
  const double reach = std::max(clearance_, 0.0) + leaf_reach(lattice_);
  parallel_for(topology.leaf_count(), [&](std::size_t l) {
    const Coord& origin = topology.origin(l);
    if (domain_.distance(leaf_middle(lattice_, origin)) > reach) return;
    topology.mask(l).for_each([&](int v) {
      const double distance = domain_.distance(lattice_.centre(voxel_at(origin, v)));
      if (distance >= clearance_ && distance >= 0) return;
      if (distance < 0) all.mask.add(l, v, Reason::behind_wall);
      if (mode_ == WallSpec::Kernel::mask) all.mask.add(l, v, Reason::near_wall);
      for (auto& [name, field] : all.fields)
        for (int c = 0; c < field.components(); ++c) field.leaf(l, c)[v] = std::numeric_limits<float>::quiet_NaN();
    });
  });
}

std::vector<std::string> WallTreatment::describe() const {
  std::vector<std::string> lines;
  for (const Wall& wall : domain_.walls()) lines.push_back(to_string(wall));
  if (mode_ == WallSpec::Kernel::renormalise) lines.emplace_back("sums divided by the part of the kernel inside");
  if (mirror_) lines.push_back("mirror images to a depth of " + print_number(mirror_->depth()));
  if (mode_ == WallSpec::Kernel::mask)
    lines.push_back("voxels masked whose kernel comes nearer than " + print_number(wall_clearance_));
  return lines;
}

}  // namespace grainvdb
