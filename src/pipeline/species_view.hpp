#pragma once
/// A frame as the moments of one species see it.
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/moment.hpp"

namespace grainvdb {

class FrameContext;

/// The particles of a species alone, in their order.
Particles particles_of_species(const Particles& all, int species);
/// Its half branches alone, those of contacts between two of its particles first, so that these stay together.
HalfBranches branches_of_species(const HalfBranches& all, int species);

class SpeciesView : public FrameView {
 public:
  /// `frame` must outlive the view. The only half branches that there are then are those of `branches`, a part of the
  /// frame's; nullptr: none.
  SpeciesView(const FrameContext& frame, int species, std::shared_ptr<const HalfBranches> branches);

  const Particles& particles() const override { return particles_; }
  const HalfBranches& branches(BranchKind) const override { return *branches_; }
  std::vector<Vec3> interpolate_frame(const Moment& numerator, const Moment& denominator) const override;
  std::vector<Vec3> interpolate_mean(const Moment& numerator, const Moment& denominator) const override;
  std::vector<double> deviation_factors(const Moment& denominator) const override;
  std::vector<Vec3> interpolate_frame_profile(const Moment& numerator, const Moment& denominator,
                                              std::array<bool, 3> homogeneous) const override;

 private:
  const FrameContext& frame_;
  int species_;
  Particles particles_;
  std::shared_ptr<const HalfBranches> branches_;
};

}  // namespace grainvdb
