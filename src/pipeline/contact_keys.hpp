#pragma once
/// The sections input.contacts and input.wall_contacts of a pipeline file, half_step apart.
#include <map>
#include <string>
#include <vector>

#include "pipeline/schema.hpp"

namespace grainvdb {

void add_contact_keys(Schema& schema);

/// What input.contacts.lammps stands for: the columns, for input.contacts.columns, of a dump of the LAMMPS computes
/// `ids`, property/local patom1 patom2, and `forces`, pair/local fx fy fz p1 p2 p3.
std::map<std::string, std::vector<std::string>> lammps_contact_columns(const std::string& ids,
                                                                       const std::string& forces);

}  // namespace grainvdb
