#include "support/sample_dumps.hpp"

#include "support/run_in_memory.hpp"

namespace grainvdb::testing {

std::string in_repository(const std::string& path) {
  return std::string(GRAINVDB_SOURCE_DIR) + "/" + path;
}

InputSpec shear_cell_input(const std::string& folder) {
  InputSpec spec;
  spec.particles = {folder + "/dump*"};
  spec.contacts.files = {folder + "/contacts*"};
  spec.contacts.compute = {"pos", "id", "force", "history", "contactPoint", "delta"};
  spec.dt = 1e-6;
  spec.units = "si";
  return spec;
}

Pipeline shear_cell_pipeline(std::vector<std::string> fields) {
  Pipeline p = make_pipeline(0.4e-3, {0, 0, 0}, 2.4e-3, std::move(fields));
  p.input = shear_cell_input();
  return p;
}

}  // namespace grainvdb::testing
