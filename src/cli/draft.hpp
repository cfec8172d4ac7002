#pragma once
/// The text of a pipeline file for a directory of dumps.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/survey.hpp"
#include "grainvdb/frame_source.hpp"

namespace grainvdb::cli {

/// What the dumps of one sort of contacts hold.
struct ContactDumps {
  std::vector<std::string> columns;
  bool known = false;  ///< whether the columns can be told apart
};

/// What a new pipeline file is made of.
struct Draft {
  InputSpec input;      ///< as given on the command line; files as they shall stand in the file
  std::string command;  ///< the file's own name, for the examples in it
  ContactDumps contacts, wall_contacts;
  bool times_known = false;  ///< whether the dumps or the command line give times
  bool units_known = false;
  Survey survey;
  Box box;
  double voxel = 0;                            ///< [length]
  std::vector<std::string> fields;             ///< to write
  std::map<std::string, std::string> refused;  ///< field → why the dumps do not give it
};

/// The fields that a new file asks for where the dumps have what they need, in this order.
const std::vector<std::string>& common_fields();

/// A commented pipeline file.
std::string pipeline_text(const Draft& draft);

}  // namespace grainvdb::cli
