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
  const auto corner = [&](const char* name, const char* help, Vec3 Box::*side) {
    auto key = vector_key("input.box", name, help, [side](Pipeline& p, const ConfigValue& v) {
      if (!p.input.box) p.input.box.emplace();
      (*p.input.box).*side = vector_of(v);
    });
    key.required = true;
    schema.keys.push_back(key);
  };
  corner("lo", "Lower corner.", &Box::lo);
  corner("hi", "Upper corner.", &Box::hi);
}

}  // namespace grainvdb
