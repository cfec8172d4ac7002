#include "golden/snapshot.hpp"

#include "support/sample_dumps.hpp"

namespace grainvdb::testing {
namespace {

std::size_t index_of_step(std::int64_t step) {
  return static_cast<std::size_t>((step - 60000) / 4000);
}

Pipeline pipeline_of(std::int64_t step, const std::string& gradient) {
  Pipeline p = shear_cell_pipeline({"phi", "density", "velocity", "angular_velocity", "mean_diameter", "temperature",
                                    "rotational_fluctuation", "contact_stress", "kinetic_stress", "velocity_gradient"});
  const auto index = static_cast<std::int64_t>(index_of_step(step));
  p.frames = {index, index + 1, 1};
  set_option(p, "kinetic_stress", "reference", std::string("instantaneous"));
  set_option(p, "velocity_gradient", "method", gradient);
  set_option(p, "contact_stress", "line_integral", std::string("exact"));
  return p;
}

}  // namespace

Snapshot::Snapshot(std::int64_t step, const std::string& gradient)
    : table(in_repository("tests/golden/shear_cell_" + std::to_string(step) + ".csv.gz")),
      pipeline(pipeline_of(step, gradient)),
      source(open_dumps(pipeline.input)),
      result(run(pipeline, *source)),
      frame(source->read(index_of_step(step), Column::velocity | Column::angular_velocity | Column::radius |
                                                  Column::mass | Column::type | Column::contacts)),
      reference(std::make_unique<Reference>(coarse_grain({frame}, pipeline))) {}

Coord Snapshot::voxel_of(std::size_t row) const {
  const auto i = [&](const char* name) { return static_cast<std::int32_t>(table.at(row, name)); };
  return {i("i"), i("j"), i("k")};
}

std::string tensor_column(const std::string& prefix, int component) {
  return prefix + "_" + "xyz"[component / 3] + "xyz"[component % 3];
}

}  // namespace grainvdb::testing
