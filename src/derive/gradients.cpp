#include <limits>
#include <string>
#include <vector>

#include "derive/central_difference.hpp"
#include "derive/register.hpp"
#include "fields/moments.hpp"

namespace grainvdb {
namespace {

/// A vector field Σ w q W/Σ w W and the sums it is made of.
struct MeanVector {
  std::string field;
  MomentPtr (*numerator)(const StageSettings&);
  MomentPtr (*denominator)(const StageSettings&);
  MomentPtr (*numerator_gradient)(const StageSettings&);
  MomentPtr (*denominator_gradient)(const StageSettings&);

  std::vector<MomentPtr> moments(const StageSettings& s) const {
    return {numerator(s), denominator(s), numerator_gradient(s), denominator_gradient(s)};
  }
};

/// The quotient rule on u = Σ w v W/Σ w W, from the moments in double: ∂_j u_i = (Σ w v_i ∂_j W - u_i Σ w ∂_j W)/Σ w W.
/// In plug flow the two sums cancel to rounding of double, not to exactly 0.
void kernel_gradient(const StageInput& in, const MeanVector& u, SparseField& out) {
  const std::vector<MomentPtr> moments = u.moments(in.settings());
  for_each_leaf(in.topology(), [&](std::size_t leaf) {
    const double* w = in.moment(leaf, *moments[1], 0);
    for (int i = 0; i < 3; ++i) {
      const double* wv = in.moment(leaf, *moments[0], i);
      for (int j = 0; j < 3; ++j) {
        const double* dw = in.moment(leaf, *moments[3], j);
        const double* dwv = in.moment(leaf, *moments[2], 3 * i + j);
        float* to = out.leaf(leaf, 3 * i + j);
        in.topology().mask(leaf).for_each([&](int v) {
          if (w[v] > 0) {
            to[v] = static_cast<float>((dwv[v] - wv[v] / w[v] * dw[v]) / w[v]);
          } else {
            to[v] = std::numeric_limits<float>::quiet_NaN();
            in.mask().add(leaf, v, Reason::no_material);
          }
        });
      }
    }
  });
}

/// Gives the stage its option, needs and computation: the gradient of the field, never that of its numerator.
void set_gradient(Stage& stage, const MeanVector& u) {
  stage.components = 9;
  stage.options = {{.name = "method",
                    .default_value = std::string("central"),
                    .help = "central: second-order differences, one-sided where a neighbour is missing; "
                            "kernel: analytic derivative of the kernel sums",
                    .choices = {"central", "kernel"}}};
  const auto by_kernel = [name = stage.name](const StageSettings& settings) {
    return option<std::string>(settings, name, "method") == "kernel";
  };
  stage.needs = [by_kernel, u](const StageSettings& settings) {
    if (by_kernel(settings)) return StageNeeds{{}, u.moments(settings)};
    return StageNeeds{{u.field}, {}, 2};  // the next but one where a neighbour is missing
  };
  stage.compute = [by_kernel, u](const StageInput& in, SparseField& out) {
    if (by_kernel(in.settings())) {
      kernel_gradient(in, u, out);
    } else {
      central_difference(in.lattice(), in.field(u.field), out, in.mask(), Reason::no_gradient);
    }
  };
}

Stage velocity_gradient() {
  Stage s;
  s.name = "velocity_gradient";
  s.dimension = dimension::rate;
  s.description = "velocity gradient, row i: du_i/dx_j; an axis without neighbours leaves its derivatives undefined";
  s.equation = "central: (u(x+h) - u(x-h))/2h; kernel: (sum V v_i d_j W - u_i sum V d_j W)/sum V W";
  set_gradient(s, {"velocity", velocity_numerator, velocity_denominator, velocity_numerator_gradient,
                   velocity_denominator_gradient});
  return s;
}

Stage angular_velocity_gradient() {
  Stage s;
  s.name = "angular_velocity_gradient";
  s.dimension = {0, -1, -1};
  s.description = "gradient of the mean angular velocity, row i: domega_i/dx_j";
  s.equation = "as velocity_gradient, omega (A16) for u";
  set_gradient(s, {"angular_velocity", [](const StageSettings&) { return volume_spin_moment(); },
                   [](const StageSettings&) { return volume_moment(); },
                   [](const StageSettings&) { return volume_spin_gradient(); },
                   [](const StageSettings&) { return volume_gradient(); }});
  return s;
}

}  // namespace

void register_gradients(StageRegistry& registry) {
  registry.add(velocity_gradient());
  registry.add(angular_velocity_gradient());
}

}  // namespace grainvdb
