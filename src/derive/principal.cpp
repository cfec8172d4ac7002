#include <algorithm>

#include "derive/register.hpp"
#include "derive/tensor.hpp"
#include "derive/voxelwise.hpp"

namespace grainvdb {
namespace {

Stage principal_stress() {
  Stage s;
  s.name = "principal_stress";
  s.components = 3;
  s.dimension = dimension::stress;
  s.description = "principal stresses in ascending compression (tension positive, the largest first)";
  s.equation = "eigenvalues of (sigma + sigma^T)/2";
  set_formula(
      s,
      [](const StageSettings&) { return [](VoxelNotes&, const Tensor& stress) { return principal_values(stress); }; },
      TensorInput{"stress"});
  return s;
}

// An axis is defined when its principal stress is apart from its neighbours. Rounding to float turns an axis by up to
// float_tensor_rounding/gap, so 0.01 rad at the default gap of 1e-5.
Stage principal_axes() {
  Stage s;
  s.name = "principal_axes";
  s.components = 9;
  s.description = "row k: unit axis of principal stress k; its first component beyond 1/2 in magnitude is positive";
  s.equation = "eigenvectors of (sigma + sigma^T)/2";
  s.options = {{.name = "gap",
                .default_value = 1e-5,
                .help = "an axis is undefined where its principal stress is within gap max|sigma_k| of another",
                .minimum = 0,
                .maximum = 2}};
  set_formula(
      s,
      [](const StageSettings& settings) {
        const double gap = option<double>(settings, "principal_axes", "gap");
        return [gap](VoxelNotes& notes, const Tensor& stress) {
          const PrincipalFrame frame = principal_frame(stress);
          const bool upper = frame.relative_gap(0) > gap;
          const bool lower = frame.relative_gap(1) > gap;
          if (!upper || !lower) notes.add(Reason::degenerate_stress_axes);
          const std::array<bool, 3> defined{upper, upper && lower, lower};
          Tensor axes = detail::nan_value<Tensor>();
          for (std::size_t k = 0; k < 3; ++k)
            if (defined[k])
              std::copy(frame.axes[k].begin(), frame.axes[k].end(), axes.begin() + 3 * static_cast<int>(k));
          return axes;
        };
      },
      TensorInput{"stress"});
  return s;
}

Stage principal_gap() {
  Stage s;
  s.name = "principal_gap";
  s.description = "smallest difference between principal stresses, relative to the largest magnitude among them";
  s.equation = "min(s1 - s2, s2 - s3)/max|s_k|";
  set_formula(
      s,
      [](const StageSettings&) {
        return [](VoxelNotes& notes, const Tensor& stress) {
          PrincipalFrame frame;
          frame.values = principal_values(stress);
          return frame.largest_magnitude() > 0 ? std::min(frame.relative_gap(0), frame.relative_gap(1))
                                               : notes.undefined(Reason::degenerate_stress_axes);
        };
      },
      TensorInput{"stress"});
  return s;
}

}  // namespace

void register_principal(StageRegistry& registry) {
  registry.add(principal_stress());
  registry.add(principal_axes());
  registry.add(principal_gap());
}

}  // namespace grainvdb
