#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "derive/central_difference.hpp"
#include "derive/register.hpp"
#include "derive/tensor.hpp"
#include "derive/voxelwise.hpp"

namespace grainvdb {
namespace {

using SlipLines = std::array<double, 6>;

Stage mean_extreme_stress() {
  Stage s;
  s.name = "mean_extreme_stress";
  s.dimension = dimension::stress;
  s.description = "mean of the two extreme principal stresses, compression positive: p of plane plasticity";
  s.equation = "p = (p1 + p3)/2, p1 < p3 the extreme principal stresses";
  set_formula(
      s, [](const StageSettings&) { return [](VoxelNotes&, const Vec3& s3) { return -(s3[0] + s3[2]) / 2; }; },
      VectorInput{"principal_stress"});
  return s;
}

/// -Σ_k s_k (s_k·F) over the two slip lines. In the plane of the extreme axes, with the major one at the angle ψ from
/// x, Σ s_k s_kᵀ = 1 + cos 2ε [[cos 2ψ, sin 2ψ], [sin 2ψ, -cos 2ψ]], as the source has it.
Vec3 against_force(const SlipLines& slip, const Vec3& force) {
  Vec3 drift{};
  for (std::size_t k : {0U, 3U}) {
    const double along = slip[k] * force[0] + slip[k + 1] * force[1] + slip[k + 2] * force[2];
    for (std::size_t i = 0; i < 3; ++i) drift[i] -= along * slip[k + i];
  }
  return drift;
}

/// The friction angle that the slip lines were drawn with: the angle between them is 2ε = π/2 - φ_f, so that
/// s_1·s_2 = sin φ_f.
double cosine_squared_of_friction(const SlipLines& slip) {
  const double sine = slip[0] * slip[3] + slip[1] * slip[4] + slip[2] * slip[5];
  return 1 - sine * sine;
}

Vec3 gravity_of(const StageSettings& settings) {
  const auto& g = option<std::vector<double>>(settings, "spot_drift", "gravity");
  return {g[0], g[1], g[2]};
}

// The friction of slip_lines applies here too. γ(1 - μ_k/μ) is nobody's measurement; what it multiplies is given.
Stage spot_drift() {
  Stage s;
  s.name = "spot_drift";
  s.components = 3;
  s.dimension = dimension::force_density;
  s.description =
      "drift of spots by the stochastic flow rule, for gamma (1 - mu_k/mu) = 1: against the net force, "
      "along both slip lines";
  s.equation = "D1 = -sum_k s_k s_k.(rho g - cos^2(phi_f) grad p), s_k the slip lines, p = mean_extreme_stress";
  s.options = {{.name = "gravity",
                .default_value = std::vector<double>{0, 0, -9.81},
                .help = "body force per mass, three numbers [length/time^2]; in reduced units often [0, 0, -1]"}};
  s.conflict = [](const StageSettings& settings) -> std::optional<OptionConflict> {
    const std::size_t n = option<std::vector<double>>(settings, "spot_drift", "gravity").size();
    if (n == 3) return std::nullopt;
    return OptionConflict{"gravity", "with " + std::to_string(n) + " numbers", "three: along x, y and z"};
  };
  s.needs = [](const StageSettings&) { return StageNeeds{{"density", "slip_lines", "mean_extreme_stress"}, {}, 2}; };
  s.compute = [](const StageInput& in, SparseField& out) {
    // The pressure gradient lies where the drift comes to lie.
    central_difference(in.lattice(), in.field("mean_extreme_stress"), out, in.mask(), Reason::no_stress_gradient);
    const Vec3 gravity = gravity_of(in.settings());
    for_each_leaf(in.topology(), [&](std::size_t leaf) {
      const detail::LeafReader<1> density(in.field("density"), leaf);
      const detail::LeafReader<6> slip_lines(in.field("slip_lines"), leaf);
      const detail::LeafReader<3> pressure_gradient(out, leaf);
      in.topology().mask(leaf).for_each([&](int v) {
        const SlipLines slip = slip_lines(v);
        const Vec3 gradient = pressure_gradient(v);
        const double share = cosine_squared_of_friction(slip);
        Vec3 force;
        for (std::size_t i = 0; i < 3; ++i) force[i] = density(v) * gravity[i] - share * gradient[i];
        const bool undefined = detail::is_nan(force) || detail::is_nan(slip);
        detail::store(out, leaf, v, undefined ? detail::nan_value<Vec3>() : against_force(slip, force));
      });
    });
  };
  return s;
}

}  // namespace

void register_spot_drift(StageRegistry& registry) {
  registry.add(mean_extreme_stress());
  registry.add(spot_drift());
}

}  // namespace grainvdb
