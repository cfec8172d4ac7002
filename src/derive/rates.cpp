#include "derive/register.hpp"
#include "derive/tensor.hpp"
#include "derive/voxelwise.hpp"

namespace grainvdb {

void register_rates(StageRegistry& registry) {
  Stage s;
  s.name = "shear_rate";
  s.dimension = dimension::rate;
  s.description = "equivalent shear rate |gd|";
  s.equation = "|gd| = sqrt(2 D':D'), D = (grad u + grad u^T)/2, D' its deviator  (A8)-(A10)";
  set_formula(
      s,
      [](const StageSettings&) {
        return [](VoxelNotes&, const Tensor& velocity_gradient) { return shear_rate_of(velocity_gradient); };
      },
      TensorInput{"velocity_gradient"});
  registry.add(std::move(s));
}

}  // namespace grainvdb
