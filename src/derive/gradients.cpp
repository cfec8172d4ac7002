#include <limits>

#include "derive/central_difference.hpp"
#include "derive/register.hpp"
#include "fields/moments.hpp"

namespace grainvdb {
namespace {

bool by_kernel(const StageSettings& settings) {
  return option<std::string>(settings, "velocity_gradient", "method") == "kernel";
}

/// The quotient rule on u = Σ w v W/Σ w W, from the moments in double: ∂_j u_i = (Σ w v_i ∂_j W - u_i Σ w ∂_j W)/Σ w W.
/// In plug flow the two sums cancel to rounding of double, not to exactly 0.
void kernel_gradient(const StageInput& in, SparseField& out) {
  const MomentPtr weight = velocity_denominator(in.settings());
  const MomentPtr momentum = velocity_numerator(in.settings());
  const MomentPtr weight_gradient = velocity_denominator_gradient(in.settings());
  const MomentPtr momentum_gradient = velocity_numerator_gradient(in.settings());
  for_each_leaf(in.topology(), [&](std::size_t leaf) {
    const double* w = in.moment(leaf, *weight, 0);
    for (int i = 0; i < 3; ++i) {
      const double* wv = in.moment(leaf, *momentum, i);
      for (int j = 0; j < 3; ++j) {
        const double* dw = in.moment(leaf, *weight_gradient, j);
        const double* dwv = in.moment(leaf, *momentum_gradient, 3 * i + j);
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

}  // namespace

void register_gradients(StageRegistry& registry) {
  Stage s;
  s.name = "velocity_gradient";
  s.components = 9;
  s.dimension = dimension::rate;
  s.description = "velocity gradient, row i: du_i/dx_j; an axis without neighbours leaves its derivatives undefined";
  s.equation = "central: (u(x+h) - u(x-h))/2h; kernel: (sum V v_i d_j W - u_i sum V d_j W)/sum V W";
  s.options = {{.name = "method",
                .default_value = std::string("central"),
                .help = "central: second-order differences, one-sided where a neighbour is missing; "
                        "kernel: analytic derivative of the kernel sums",
                .choices = {"central", "kernel"}}};
  s.needs = [](const StageSettings& settings) {
    if (!by_kernel(settings)) return StageNeeds{{"velocity"}, {}};
    return StageNeeds{{},
                      {velocity_numerator(settings), velocity_denominator(settings),
                       velocity_numerator_gradient(settings), velocity_denominator_gradient(settings)}};
  };
  s.compute = [](const StageInput& in, SparseField& out) {
    if (by_kernel(in.settings())) {
      kernel_gradient(in, out);
    } else {
      central_difference(in.lattice(), in.field("velocity"), out, in.mask());
    }
  };
  registry.add(std::move(s));
}

}  // namespace grainvdb
