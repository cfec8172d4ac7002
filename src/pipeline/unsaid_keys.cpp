#include "pipeline/unsaid_keys.hpp"

#include <string>
#include <variant>
#include <vector>

#include "grainvdb/pipeline.hpp"
#include "pipeline/key_builders.hpp"

namespace grainvdb {

void add_unsaid_keys(Schema& schema) {
  schema.keys.push_back(texts_key(
      "input", "columns",
      "Names of all columns, in the order of the dump command, for binary LAMMPS dumps that do not name them.", {},
      [](Pipeline& p, const ConfigValue& v) { p.input.columns = std::get<std::vector<std::string>>(v); }));
  KeyInfo periodic{"input", "periodic", ValueType::text, "Which axes are periodic, for MercuryDPM and VTK files."};
  periodic.choices = {"none", "x", "y", "z", "xy", "xz", "yz", "xyz"};
  periodic.apply = [](Pipeline& p, const ConfigValue& v) { p.input.periodic = std::get<std::string>(v); };
  schema.keys.push_back(periodic);
  schema.sections.push_back({"input.box", "The box, for VTK files and two-dimensional MercuryDPM files."});
  add_box_keys(
      schema, "input.box", [](Pipeline & p) -> auto& { return p.input.box; });
}

}  // namespace grainvdb
