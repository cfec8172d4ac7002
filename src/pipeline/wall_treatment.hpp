#pragma once
/// What is done about the part of the kernel that walls cut off, at each step of a run that has a hand in it.
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "average/moment_sums.hpp"
#include "bin/mirror.hpp"
#include "grainvdb/frame_source.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/mask.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"
#include "pipeline/derive_fields.hpp"
#include "pipeline/inside_fractions.hpp"
#include "pipeline/material.hpp"

namespace grainvdb {

class WallTreatment {
 public:
  /// Nothing where the kernel is cut off. In mode mask without a clearance, reads frames until one has material. Throws
  /// as wall_domain and FrameSource::read do.
  static std::optional<WallTreatment> make(const Pipeline& pipeline, const Plan& plan, const Lattice& lattice,
                                           FrameSource& source, std::span<const std::size_t> wanted);

  /// In modes renormalise and mirror: leaves out what has its centre behind a wall. In mode mirror, adds images.
  void apply(Material& material) const;

  /// Means of which those at walls are divided by the part of the kernel inside, and the memory that these take.
  struct Renormalised {
    MomentMeans means;
    std::vector<std::unique_ptr<double[]>> leaves;
  };
  /// In mode renormalise; the means as they are in others.
  Renormalised renormalise(const MomentMeans& means, const std::vector<MomentPtr>& moments);

  /// Leaves voxels behind walls, and in mode mask those near them, without values.
  void mask(DerivedFields& fields) const;

  /// Where the walls are and what is done about them, in words.
  std::vector<std::string> describe() const;

 private:
  WallTreatment(WallSpec::Kernel mode, WallDomain domain, const LucyKernel& kernel, const Lattice& lattice);

  WallSpec::Kernel mode_;
  WallDomain domain_;
  Lattice lattice_;
  double clearance_ = 0;  // of voxel centres in mode mask
  double wall_clearance_ = 0;
  std::optional<InsideFractions> fractions_;
  std::optional<Mirror> mirror_;
};

}  // namespace grainvdb
