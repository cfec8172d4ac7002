#include "pipeline/contact_keys.hpp"

#include <cstddef>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/key_builders.hpp"

namespace grainvdb {
namespace {

std::vector<std::string> compute_keywords() {
  return {"pos",      "vel",           "id",
          "force",    "force_normal",  "force_tangential",
          "torque",   "torque_normal", "torque_tangential",
          "history",  "contactArea",   "delta",
          "heatFlux", "contactPoint",  "ms_id",
          "verbose"};
}

using ColumnNames = std::map<std::string, std::vector<std::string>>;

ColumnNames& contact_columns(Pipeline& p) {
  return p.input.contacts.columns;
}

ColumnNames& wall_contact_columns(Pipeline& p) {
  return p.input.wall_contacts.columns;
}

/// Keys of a map from quantities to names of columns.
struct ColumnKeys {
  Schema& schema;
  std::string section;
  ColumnNames& (*columns)(Pipeline&);

  void add(const char* name, std::size_t count, bool required, const char* help) const {
    auto key = texts_key(section, name, help, {}, [name, to = columns](Pipeline& p, const ConfigValue& v) {
      to(p)[name] = std::get<std::vector<std::string>>(v);
    });
    key.fewest = key.most = count;
    key.required = required;
    schema.keys.push_back(key);
  }
};

/// The names of the first `count` columns of a compute from `first` on, counted from 1.
std::vector<std::string> columns_of(const std::string& compute, std::size_t first, std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t n = first; n < first + count; ++n) names.push_back("c_" + compute + '[' + std::to_string(n) + ']');
  return names;
}

void name_ids(ColumnNames& columns, const std::string& compute) {
  columns["id1"] = columns_of(compute, 1, 1);
  columns["id2"] = columns_of(compute, 2, 1);
}

void name_forces(ColumnNames& columns, const std::string& compute) {
  columns["normal_force"] = columns_of(compute, 1, 3);
  columns["tangential_force"] = columns_of(compute, 4, 3);
}

KeyInfo compute_name_key(const char* name, const char* help, void (*apply)(ColumnNames&, const std::string&)) {
  KeyInfo key{"input.contacts.lammps", name, ValueType::text, help};
  key.required = true;
  key.apply = [apply](Pipeline& p, const ConfigValue& v) { apply(contact_columns(p), std::get<std::string>(v)); };
  return key;
}

void add_lammps_keys(Schema& schema) {
  schema.sections.push_back({"input.contacts.lammps",
                             "Names of the LAMMPS computes that made a dump of a granular pair style, in place of "
                             "columns."});
  schema.keys.push_back(compute_name_key("ids", "Of compute property/local patom1 patom2.", &name_ids));
  schema.keys.push_back(compute_name_key("forces",
                                         "Of compute pair/local fx fy fz p1 p2 p3, the normal force and the "
                                         "tangential one.",
                                         &name_forces));
}

void add_pair_contact_keys(Schema& schema) {
  schema.sections.push_back(
      {"input.contacts",
       "Contact dumps, for the contact stress. Give compute (LIGGGHTS), lammps or columns, or none "
       "of these for columns named id1 id2 fx fy fz."});
  auto files = texts_key("input.contacts", "files", "Contact dumps, as input.particles.", {},
                         [](Pipeline& p, const ConfigValue& v) { p.input.contacts.files = input_paths(p, v); });
  files.required = true;
  schema.keys.push_back(files);
  schema.keys.push_back(texts_key(
      "input.contacts", "compute", "Keywords of the LIGGGHTS compute pair/gran/local that made the dump, in any order.",
      compute_keywords(),
      [](Pipeline& p, const ConfigValue& v) { p.input.contacts.compute = std::get<std::vector<std::string>>(v); }));

  schema.sections.push_back({"input.contacts.columns", "Names of the columns, for dumps of other computes."});
  const ColumnKeys column{schema, "input.contacts.columns", contact_columns};
  column.add("id1", 1, true, "Id of the first particle, on which the force acts.");
  column.add("id2", 1, true, "Id of the second particle.");
  column.add("force", 3, false, "Total contact force on id1.");
  column.add("normal_force", 3, false, "Normal part of the force on id1; with tangential_force in place of force.");
  column.add("tangential_force", 3, false, "Tangential part of the force on id1.");
  column.add("point", 3, false, "Contact point; without it, the radius-weighted point between the centres.");
  add_lammps_keys(schema);
}

void add_wall_contact_keys(Schema& schema) {
  const std::string section = "input.wall_contacts";
  schema.sections.push_back(
      {section,
       "Dumps of contacts with walls that are no grains, such as meshes, for the contact stress "
       "and wall_force. Give compute or columns, or none of these for MercuryDPM .fstat files and "
       "columns named id fx fy fz cx cy cz."});
  auto files = texts_key(section, "files", "Dumps of such contacts, as input.particles.", {},
                         [](Pipeline& p, const ConfigValue& v) { p.input.wall_contacts.files = input_paths(p, v); });
  files.required = true;
  schema.keys.push_back(files);
  schema.keys.push_back(texts_key(
      section, "compute",
      "Keywords of the LIGGGHTS compute wall/gran/local that made the dump, in any order; pos, whose first half is the "
      "contact point, id and force are needed.",
      compute_keywords(), [](Pipeline& p, const ConfigValue& v) {
        p.input.wall_contacts.compute = std::get<std::vector<std::string>>(v);
      }));

  schema.sections.push_back({section + ".columns", "Names of the columns, for other dumps."});
  const ColumnKeys column{schema, section + ".columns", wall_contact_columns};
  column.add("id", 1, true, "Id of the particle.");
  column.add("mesh", 1, false, "Number of the mesh; with triangle, to find contacts that come twice.");
  column.add("triangle", 1, false, "Number of the triangle in its mesh.");
  column.add("force", 3, false, "Force of the wall on the particle.");
  column.add("normal_force", 3, false, "Normal part of that force; with tangential_force in place of force.");
  column.add("tangential_force", 3, false, "Tangential part of that force.");
  column.add("point", 3, true, "Contact point.");
}

}  // namespace

void add_contact_keys(Schema& schema) {
  add_pair_contact_keys(schema);
  add_wall_contact_keys(schema);
}

std::map<std::string, std::vector<std::string>> lammps_contact_columns(const std::string& ids,
                                                                       const std::string& forces) {
  ColumnNames columns;
  name_ids(columns, ids);
  name_forces(columns, forces);
  return columns;
}

}  // namespace grainvdb
