#pragma once
/// The stages of the coarse-grained fields, and a frame made by hand for their moments.
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "derive/register.hpp"
#include "fields/register.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/stage.hpp"

namespace grainvdb::testing {

/// The coarse-grained fields, and velocity_gradient for one_pass_corrected.
inline StageRegistry make_registry() {
  StageRegistry r;
  register_packing(r);
  register_velocity(r);
  register_mean_diameter(r);
  register_temperature(r);
  register_angular_velocity(r);
  register_rotational_fluctuation(r);
  register_contact_stress(r);
  register_kinetic_stress(r);
  register_stress(r);
  register_wall_force(r);
  register_bookkeeping(r);
  register_gradients(r);
  return r;
}

/// Particles and branches as given; every sampled mean is `mean`, and which one was asked for is noted.
class FakeView : public FrameView {
 public:
  const Particles& particles() const override { return p; }
  const HalfBranches& branches(BranchKind) const override { return b; }
  std::vector<Vec3> interpolate_frame(const Moment& n, const Moment& d) const override { return note("frame", n, d); }
  std::vector<Vec3> interpolate_mean(const Moment& n, const Moment& d) const override { return note("mean", n, d); }
  std::vector<double> deviation_factors(const Moment& d) const override {
    asked = "factors: " + d.name;
    return factors;
  }
  std::vector<Vec3> interpolate_frame_profile(const Moment& n, const Moment& d,
                                              std::array<bool, 3> axes) const override {
    homogeneous = axes;
    return note("profile", n, d);
  }

  Particles p;
  HalfBranches b;
  Vec3 mean{};
  std::vector<double> factors;
  mutable std::string asked;
  mutable std::array<bool, 3> homogeneous{};

 private:
  std::vector<Vec3> note(const std::string& what, const Moment& n, const Moment& d) const {
    asked = what + ": " + n.name + " / " + d.name;
    return std::vector<Vec3>(p.size(), mean);
  }
};

/// The values per entry that a moment makes of a view.
inline std::vector<double> values_of(const Moment& m, const FrameView& view) {
  const std::size_t entries =
      m.kind == Moment::Kind::contacts ? view.branches(m.branch_kind).size() : view.particles().size();
  std::vector<double> q(entries * static_cast<std::size_t>(m.value_count()));
  m.values(view, q);
  return q;
}

/// Settings with some options changed.
inline StageSettings settings_with(const StageRegistry& registry,
                                   const std::vector<std::array<std::string, 3>>& changes) {
  StageSettings s = registry.default_settings();
  for (const auto& [stage, name, value] : changes) s.at(stage).at(name) = value;
  return s;
}

/// The moments that a stage needs.
inline std::vector<MomentPtr> moments_of(const StageRegistry& registry, const std::string& stage,
                                         const StageSettings& settings) {
  return registry.find(stage)->needs(settings).moments;
}

}  // namespace grainvdb::testing
